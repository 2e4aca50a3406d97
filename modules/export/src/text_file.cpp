#include "foucault/export/text_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

namespace foucault::exports {

TextFile::TextFile(const std::filesystem::path& path)
    : path_(path), file_(std::fopen(path.c_str(), "wb")) {
  if (!file_) fail();
}

void TextFile::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size()) fail();
}

void TextFile::close() {
  if (std::fclose(file_.release()) != 0) fail();
}

void TextFile::fail() const {
  throw WriteError(fmt::format("cannot write '{}': {}", path_.string(), std::strerror(errno)));
}

void write_text_file(const std::filesystem::path& path, std::string_view text) {
  TextFile file(path);
  file.write(text);
  file.close();
}

}  // namespace foucault::exports
