// A bar with rate and time left on a terminal, a plain line now and then elsewhere. Writes to stderr, so that stdout
// stays for results. On a terminal each line is as wide as that is at the moment, and stands where it stood before.
#pragma once
#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

namespace pvg {

class Progress {
 public:
  // unit: what is counted, with an s, such as "frames"; total 0: nothing is shown
  Progress(std::string label, std::string unit, std::size_t total);
  ~Progress();  // ends the line
  Progress(const Progress&) = delete;
  void advance_to(std::size_t done);  // from any thread
  // Counts anew under another name in the same place. total 0: is not known yet; a terminal shows that it starts.
  // done: of what was done before, which the rate leaves out.
  void begin(std::string label, std::size_t total, std::size_t done = 0);
  // Takes the lines off a terminal: what is printed next stands in their place.
  void clear();
  // A line above this one on a terminal, such as that of the set an episode is of, given the width of its bar. With it,
  // both lines are taken away at the end.
  void set_line_above(std::function<std::string(int)> line) { line_above_ = std::move(line); }

 private:
  void show(std::size_t done, double seconds);
  void take_away();
  std::string label_, unit_;
  std::function<std::string(int)> line_above_;
  std::vector<std::size_t> widths_;  // of the lines that stand there
  std::size_t total_, done_before_ = 0;
  bool is_terminal_;
  std::chrono::steady_clock::time_point start_, last_;
  std::mutex mutex_;
};

// How far a set of episodes is.
struct SetProgress {
  std::size_t total = 0;
  std::size_t done_before = 0, failed_before = 0;  // by earlier runs
  std::size_t done = 0, failed = 0;                // by this one
  double seconds = 0;                              // of this one
  std::size_t left() const { return total - done_before - failed_before - done - failed; }
};

// "set  [####----]  12/40 episodes  92 % succeeded  3.10/min  9 min 02 s left"; the rate and the time left are those of
// this run.
std::string set_progress_line(const SetProgress& set, int bar_width);

// Whether stderr is a terminal.
bool shows_on_terminal();

// A line that fits `width` columns: `line` is asked for it with the width of its bar, an eighth of the line and at most
// 24, so that bars of lines below each other are alike; none where there is little room; what is still too long is cut.
std::string fitted_line(const std::function<std::string(int)>& line, int width);

// One line of progress: "episode 0  [####----]  12/40 frames  3.1 frames/s  9 s left". seconds: since `done_before`
// were done
std::string progress_line(const std::string& label, const std::string& unit, std::size_t done, std::size_t total,
                          double seconds, int bar_width, std::size_t done_before = 0);

}  // namespace pvg
