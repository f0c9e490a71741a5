// A bar with rate and time left on a terminal, a plain line now and then elsewhere. Writes to stderr, so that stdout
// stays for results.
#pragma once
#include <chrono>
#include <mutex>
#include <string>

namespace pvg {

class Progress {
 public:
  // unit: what is counted, such as "frames"; total 0: nothing is shown
  Progress(std::string label, std::string unit, std::size_t total);
  ~Progress();  // ends the line
  Progress(const Progress&) = delete;
  void advance_to(std::size_t done);  // from any thread
  // What stands behind the line on a terminal, where there is room for one line alone.
  void set_remark(std::string remark) { remark_ = std::move(remark); }

 private:
  void show(std::size_t done, double seconds);
  std::string label_, unit_, remark_;
  std::size_t total_, shown_ = 0;
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
};

// "set  [####----]  12/40 episodes  92 % succeeded  3.1 episodes/min  9 min 02 s left"; the rate and the time left are
// those of this run.
std::string set_progress_line(const SetProgress& set, int bar_width);

// One line of progress: "episode 0  [####----]  12/40 frames  3.1 frames/s  9 s left".
std::string progress_line(const std::string& label, const std::string& unit, std::size_t done, std::size_t total,
                          double seconds, int bar_width);

}  // namespace pvg
