#include "text_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "foucault/core/error.h"

namespace foucault::rawlog {

namespace {

constexpr size_t kLongestTextLine = 1U << 16;
constexpr size_t kTextBlock = 1U << 16;

void append_utf8(std::string& text, unsigned code) {
  const auto put = [&](unsigned byte) { text.push_back(static_cast<char>(byte)); };
  if (code < 0x80) return put(code);
  if (code < 0x800) {
    put(0xC0 | (code >> 6));
  } else {
    put(0xE0 | (code >> 12));
    put(0x80 | ((code >> 6) & 0x3F));
  }
  put(0x80 | (code & 0x3F));
}

/// Characters outside the basic plane, which no table's numbers or names need, become '?'.
std::string from_utf16(std::string_view bytes, bool little) {
  constexpr unsigned kSurrogates = 0xD800;
  constexpr unsigned kBehindThem = 0xE000;
  std::string text;
  for (size_t i = 0; i + 1 < bytes.size(); i += 2) {
    const auto first = static_cast<unsigned char>(bytes[i]);
    const auto second = static_cast<unsigned char>(bytes[i + 1]);
    const unsigned code = little ? first | (second << 8) : second | (first << 8);
    append_utf8(text, code >= kSurrogates && code < kBehindThem ? '?' : code);
  }
  return text;
}

bool begins_with(const std::string& text, std::string_view with) {
  return text.compare(0, with.size(), with) == 0;
}

}  // namespace

TextLines::TextLines(const std::string& path, std::string named)
    : named_(std::move(named)), file_(open_for_reading(path)) {
  gzbuffer(file_.get(), kGzipBuffer);
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  file_size_ = error ? 0 : static_cast<double>(size);
}

std::optional<std::string_view> TextLines::next() {
  for (;;) {
    const size_t end = block_.find(end_of_line_, searched_);
    if (end != std::string::npos) return take(end, end + 1);
    searched_ = block_.size();
    check_length();
    if (refill()) continue;
    if (is_cut_ || line_ == block_.size()) return std::nullopt;
    return take(block_.size(), block_.size());
  }
}

std::string_view TextLines::take(size_t end, size_t next) {
  std::string_view line(block_.data() + line_, end - line_);
  line_ = searched_ = next;
  ++lines_;
  while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.remove_suffix(1);
  return line;
}

/// Of a line whose end is still to come.
void TextLines::check_length() {
  if (block_.size() - line_ < kLongestTextLine) return;
  const size_t zeros = block_.find_last_not_of('\0') + 1;  // 0: there are only zeros
  if (zeros < block_.size()) {
    zeros_ += static_cast<int64_t>(block_.size() - std::max(zeros, line_));
    block_.resize(std::max(zeros, line_));
    searched_ = block_.size();
  }
  if (block_.size() - line_ < kLongestTextLine) return;
  throw DataError(fmt::format("{}:{}: the line is longer than {} characters; is this a text file?",
                              named_, lines_ + 1, kLongestTextLine - 1));
}

bool TextLines::refill() {
  const std::string bytes = read();
  if (bytes.empty()) return false;
  block_.erase(0, line_);
  searched_ -= line_;
  line_ = 0;
  block_ += bytes;
  return true;
}

/// The next bytes of the text; none at the end.
std::string TextLines::read() {
  std::string bytes = std::exchange(half_, {});
  const size_t before = bytes.size();
  bytes.resize(before + kTextBlock);
  const int read = gzread(file_.get(), bytes.data() + before, static_cast<unsigned>(kTextBlock));
  int error = Z_OK;
  gzerror(file_.get(), &error);
  if (read < 0) {
    throw DataError(
        fmt::format("'{}' is truncated or damaged after line {}; copy it again", named_, lines_));
  }
  is_cut_ = error == Z_BUF_ERROR;
  bytes.resize(before + static_cast<size_t>(read));
  if (read == 0) return {};
  if (!std::exchange(has_begun_, true)) begin(bytes);
  if (encoding_ == Encoding::bytes) return bytes;
  if (bytes.size() % 2 != 0) {
    half_ = bytes.back();
    bytes.pop_back();
  }
  return from_utf16(bytes, encoding_ == Encoding::utf16_little);
}

/// What the first bytes tell of the others.
void TextLines::begin(std::string& bytes) {
  constexpr std::string_view kZip = "PK\x03\x04";
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  constexpr std::string_view kLittle = "\xFF\xFE";
  constexpr std::string_view kBig = "\xFE\xFF";
  if (begins_with(bytes, kZip)) {
    throw DataError(fmt::format(
        "'{}' is a zip archive, as .xlsx files are; unpack it, or save the table as CSV", named_));
  }
  if (begins_with(bytes, kMark)) bytes.erase(0, kMark.size());
  if (begins_with(bytes, kLittle)) encoding_ = Encoding::utf16_little;
  if (begins_with(bytes, kBig)) encoding_ = Encoding::utf16_big;
  if (encoding_ != Encoding::bytes) bytes.erase(0, kLittle.size());
  const auto has = [&](char sign) { return bytes.find(sign) != std::string::npos; };
  if (has('\r') && !has('\n')) end_of_line_ = '\r';
}

double TextLines::progress() const {
  return file_size_ > 0 ? std::min(1.0, static_cast<double>(gzoffset(file_.get())) / file_size_)
                        : 1.0;
}

}  // namespace foucault::rawlog
