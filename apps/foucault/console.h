#pragma once

#include <chrono>
#include <functional>
#include <set>
#include <string>
#include <vector>

namespace foucault::app {

/// What the program says. Results go to stdout; warnings and a progress bar to stderr, the bar only
/// if stderr is a terminal. `quiet` leaves warnings and errors.
class Console {
 public:
  explicit Console(bool quiet);
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  /// A line of the result.
  void say(const std::string& line);
  void say(const std::vector<std::string>& lines);
  /// Once for each line: of what is gone through twice.
  void say_once(const std::string& line);

  /// A text of whole lines.
  void print(const std::string& text);

  /// `foucault: warning: <text>`, once for each text (of ten thousand, if there are so many).
  void warn(const std::string& text);

  /// Part done of a stage, 0 to 1; cheap enough to call for every measurement.
  /// Throws Interrupted after Ctrl-C.
  void progress(const std::string& stage, double part);

  /// The same as a callback for one stage. The console must outlive it.
  std::function<void(double)> progress_of(const std::string& stage);

  /// Takes the progress bar away.
  void clear_progress();

 private:
  using Clock = std::chrono::steady_clock;

  void draw(double part, Clock::time_point now);

  bool quiet_;
  bool show_progress_;
  bool drawn_ = false;
  std::string stage_;
  Clock::time_point stage_begin_;
  Clock::time_point last_draw_;
  std::set<std::string> warned_, said_once_;
};

/// `foucault: error: <text>` on stderr, newlines in it flattened.
void print_error(const std::string& text);

}  // namespace foucault::app
