#include "foucault/store/file_hash.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#include "foucault/core/error.h"

namespace foucault::store {
namespace {

[[noreturn]] void cannot_read(const std::string& path, int why) {
  throw DataError(fmt::format("cannot read '{}': {}", path, std::strerror(why)));
}

struct stat state_of(const std::string& path) {
  struct stat there {};
  if (stat(path.c_str(), &there) != 0) cannot_read(path, errno);
  return there;
}

void wait_until_old(const std::string& path) {
  constexpr auto kResolution = std::chrono::milliseconds(20);  // of Linux: its timer, 1 to 10 ms
  const struct stat there = state_of(path);
  const auto changed =
      std::chrono::seconds(there.st_mtim.tv_sec) + std::chrono::nanoseconds(there.st_mtim.tv_nsec);
  const auto age = std::chrono::system_clock::now().time_since_epoch() - changed;
  if (age < kResolution) std::this_thread::sleep_for(kResolution);
}

}  // namespace

std::string file_stamp(const std::string& path) {
  const struct stat there = state_of(path);
  return fmt::format("{}\n{}\n{}.{:09}",
                     std::filesystem::absolute(path).lexically_normal().string(), there.st_size,
                     there.st_mtim.tv_sec, there.st_mtim.tv_nsec);
}

Key hash_file(const std::string& path) {
  wait_until_old(path);
  const std::string before = file_stamp(path);
  std::ifstream file(path, std::ios::binary);
  if (!file) cannot_read(path, errno);
  Sha256 hash;
  std::vector<char> block(1 << 20);
  while (file.read(block.data(), static_cast<std::streamsize>(block.size())) || file.gcount() > 0) {
    hash.add({block.data(), static_cast<std::size_t>(file.gcount())});
  }
  if (file.bad()) cannot_read(path, errno);
  if (file_stamp(path) != before) {
    throw DataError(fmt::format("'{}' changed while it was read; wait until it is written", path));
  }
  return hash.finish();
}

}  // namespace foucault::store
