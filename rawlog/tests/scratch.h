#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "foucault/core/error.h"

namespace foucault::test {

/// A folder that lives as long as the test.
class Scratch {
 public:
  Scratch() {
    std::string pattern = (std::filesystem::temp_directory_path() / "rawlog-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~Scratch() { std::filesystem::remove_all(folder_); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::string text_file(const std::string& name, const std::string& contents) const {
    std::ofstream(path(name), std::ios::binary) << contents;
    return path(name);
  }

  /// Names of what lies in the folder, sorted.
  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
      found.push_back(entry.path().filename().string());
    }
    std::sort(found.begin(), found.end());
    return found;
  }

 private:
  std::filesystem::path folder_;
};

/// Where the recordings lie: $FOUCAULT_DATA_DIR, else beside the source.
inline std::string data_dir() {
  const char* set = std::getenv("FOUCAULT_DATA_DIR");
  return set != nullptr ? set : std::string(FOUCAULT_SOURCE_DIR) + "/../shared/data";
}

/// Values as they lie in memory, one behind the other.
template <class... T>
std::string packed(const T&... values) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
  return bytes;
}

/// A mapping with an IMU that is there from 2000 to 2100, and what `more` says.
inline std::string imu_at_all_times(const Scratch& scratch, const std::string& more = "") {
  scratch.text_file("imu.csv",
                    "946684800,0,0,0,0,0,-9.8\n946684801,0,0,0,0,0,-9.8\n"
                    "4102444800,0,0,0,0,0,-9.8\n4102444801,0,0,0,0,0,-9.8\n");
  return scratch.text_file("mapping.yaml",
                           "imu:\n  file: imu.csv\n  header: false\n  columns: {time: 1, gyro_x: "
                           "2, gyro_y: 3, gyro_z: 4, accel_x: 5, accel_y: 6, accel_z: 7}\n  time: "
                           "{system: unix}\n" +
                               more);
}

inline std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The message of the error that `action` must throw; it must be one line.
template <class Error>
std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    const std::string what = error.what();
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    return what;
  } catch (const std::exception& error) {
    ADD_FAILURE() << "another class of error: " << error.what();
    return {};
  }
  ADD_FAILURE() << "no error";
  return {};
}

}  // namespace foucault::test
