#include "console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdio>

#include "interrupt.h"

namespace foucault::app {
namespace {

constexpr auto kRedrawInterval = std::chrono::milliseconds(100);
constexpr int kBarWidth = 30;

/// Whatever a message quotes: no line breaks, nothing that a terminal obeys.
std::string one_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
  return text;
}

std::string minutes_and_seconds(double seconds) {
  const auto whole = static_cast<int64_t>(seconds + 0.5);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

}  // namespace

Console::Console(bool quiet)
    : quiet_(quiet), show_progress_(!quiet && isatty(STDERR_FILENO) == 1) {}

Console::~Console() { clear_progress(); }

void Console::say(const std::string& line) { print(line + "\n"); }

void Console::print(const std::string& text) {
  if (quiet_) return;
  clear_progress();
  // Results matter more than words about them: main() looks whether these came out.
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

void Console::say(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) say(line);
}

void Console::say_once(const std::string& line) {
  if (said_once_.insert(line).second) say(line);
}

void Console::warn(const std::string& text) {
  constexpr std::size_t kMostRemembered = 10'000;
  if (warned_.size() == kMostRemembered) warned_.clear();
  if (!warned_.insert(text).second) return;
  clear_progress();
  fmt::print(stderr, "foucault: warning: {}\n", one_line(text));
}

void Console::progress(const std::string& stage, double part) {
  stop_if_interrupted();
  if (!show_progress_) return;
  const Clock::time_point now = Clock::now();
  if (stage != stage_) {
    stage_ = stage;
    stage_begin_ = now;
  } else if (now - last_draw_ < kRedrawInterval) {
    return;
  }
  draw(std::clamp(part, 0.0, 1.0), now);
}

std::function<void(double)> Console::progress_of(const std::string& stage) {
  return [this, stage](double part) { progress(stage, part); };
}

void Console::draw(double part, Clock::time_point now) {
  const double elapsed = std::chrono::duration<double>(now - stage_begin_).count();
  const int filled = static_cast<int>(part * kBarWidth);
  const std::string remaining =
      part > 0.01 ? "ETA " + minutes_and_seconds(elapsed / part * (1 - part)) : "";
  fmt::print(stderr, "\r{:<12} [{:#<{}}{:-<{}}] {:3.0f} % {:<12}", stage_, "", filled, "",
             kBarWidth - filled, 100 * part, remaining);
  std::fflush(stderr);
  last_draw_ = now;
  drawn_ = true;
}

void Console::clear_progress() {
  if (!drawn_) return;
  fmt::print(stderr, "\r{:70}\r", "");
  std::fflush(stderr);
  drawn_ = false;
}

void print_error(const std::string& text) {
  fmt::print(stderr, "foucault: error: {}\n", one_line(text));
}

}  // namespace foucault::app
