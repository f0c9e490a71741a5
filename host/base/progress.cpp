#include "host/base/progress.hpp"
#include "host/base/counted.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pvg {
namespace {

constexpr int USUAL_WIDTH = 80, MOST_BAR = 24, LEAST_BAR = 6;  // columns
constexpr double TERMINAL_PERIOD = 0.1, LINE_PERIOD = 10;      // least time between two prints [s]

std::string time_text(double seconds) {
  char text[32];
  const long whole = std::lround(seconds);
  if (whole < 60)
    std::snprintf(text, sizeof text, "%ld s", whole);
  else if (whole < 3600)
    std::snprintf(text, sizeof text, "%ld min %02ld s", whole / 60, whole % 60);
  else
    std::snprintf(text, sizeof text, "%ld h %02ld min", whole / 3600, whole % 3600 / 60);
  return text;
}

std::string bar(double share, int width) {
  if (width <= 0) return "";
  const int full = int(share * width);
  return "[" + std::string(std::size_t(full), '#') + std::string(std::size_t(width - full), '-') + "]  ";
}

// asked each time, so that a window that is resized is followed
int terminal_width() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : USUAL_WIDTH;
}

}  // namespace

bool shows_on_terminal() { return isatty(STDERR_FILENO); }

std::string fitted_line(const std::function<std::string(int)>& line, int width) {
  constexpr int AROUND = 4;  // brackets and blanks of a bar
  const int free = width - int(line(0).size()) - AROUND;
  std::string text = line(free >= LEAST_BAR ? std::min({free, MOST_BAR, std::max(width / 8, LEAST_BAR)}) : 0);
  if (int(text.size()) > width) text.resize(std::size_t(std::max(width, 0)));
  return text;
}

std::string set_progress_line(const SetProgress& set, int bar_width) {
  const std::size_t made = set.done + set.failed, there = made + set.done_before + set.failed_before;
  std::string line = "set  " + bar(set.total ? double(there) / double(set.total) : 1, bar_width);
  line += std::to_string(there) + "/" + counted(set.total, "episode");
  char text[64];
  if (there > 0) {
    const double share = double(set.done + set.done_before) / double(there);
    std::snprintf(text, sizeof text, "  %.0f %% succeeded", 100 * share);
    line += text;
  }
  if (made == 0 || !(set.seconds > 0)) return line;
  const double rate = double(made) / set.seconds;
  std::snprintf(text, sizeof text, "  %.*f/min", rate < 10 / 60.0 ? 2 : 0, 60 * rate);
  line += text;
  line += there < set.total ? "  " + time_text(double(set.total - there) / rate) + " left"
                            : "  in " + time_text(set.seconds);
  return line;
}

std::string progress_line(const std::string& label, const std::string& unit, std::size_t done, std::size_t total,
                          double seconds, int bar_width, std::size_t done_before) {
  const double share = total ? double(done) / double(total) : 1;
  std::string line = label + "  " + bar(share, bar_width);
  line += std::to_string(done) + "/" + counted(total, unit.substr(0, unit.size() - 1), unit);
  // no rate before there is something to divide
  if (done > done_before && seconds > 0) {
    const double rate = double(done - done_before) / seconds;
    // per minute what takes longer than 10 s each, whose rate per second would have one digit or none
    const double shown = rate < 0.1 ? 60 * rate : rate;
    char text[64];
    std::snprintf(text, sizeof text, "  %.*f %s/%s", shown < 10 ? 2 : 0, shown, unit.c_str(), rate < 0.1 ? "min" : "s");
    line += text;
    line += done < total ? "  " + time_text(double(total - done) / rate) + " left" : "  in " + time_text(seconds);
  }
  return line;
}

Progress::Progress(std::string label, std::string unit, std::size_t total)
    : label_(std::move(label)),
      unit_(std::move(unit)),
      total_(total),
      is_terminal_(shows_on_terminal()),
      start_(std::chrono::steady_clock::now()),
      last_(start_ - std::chrono::hours(1)) {}

namespace {
// To the first of lines that stand there, and all of them away; those wider than the terminal have become several.
std::string away_with(const std::vector<std::size_t>& widths, int width) {
  std::size_t up = 0;
  for (const std::size_t columns : widths) up += 1 + (columns > 0 ? (columns - 1) / std::size_t(width) : 0);
  return (up > 1 ? "\x1b[" + std::to_string(up - 1) + "A" : "") + "\r\x1b[J";
}
}  // namespace

void Progress::take_away() {
  if (widths_.empty()) return;
  std::fputs(away_with(widths_, terminal_width()).c_str(), stderr);
  std::fflush(stderr);
  widths_.clear();
}

Progress::~Progress() {
  if (!is_terminal_ || widths_.empty()) return;
  if (line_above_)
    take_away();
  else
    std::fputc('\n', stderr);
  std::fflush(stderr);
}

void Progress::begin(std::string label, std::size_t total, std::size_t done) {
  const std::lock_guard lock(mutex_);
  label_ = std::move(label);
  total_ = total;
  done_before_ = done;
  start_ = std::chrono::steady_clock::now();
  last_ = start_ - std::chrono::hours(1);
  if (is_terminal_) show(done, 0);
}

void Progress::clear() {
  const std::lock_guard lock(mutex_);
  if (is_terminal_) take_away();
}

void Progress::show(std::size_t done, double seconds) {
  const auto line = [&](int bar_width) {
    return total_ > 0 ? progress_line(label_, unit_, done, total_, seconds, bar_width, done_before_)
                      : label_ + "  starts";
  };
  if (!is_terminal_) {
    std::fprintf(stderr, "%s\n", line(0).c_str());
    return;
  }
  const int width = terminal_width();
  std::string text = away_with(widths_, width);
  widths_.clear();
  // the last column stays free: a letter there would begin the next line on some terminals
  if (line_above_) {
    const std::string above = fitted_line(line_above_, width - 1);
    text += above + "\n";
    widths_.push_back(above.size());
  }
  const std::string mine = fitted_line(line, width - 1);
  widths_.push_back(mine.size());
  std::fputs((text + mine).c_str(), stderr);
  std::fflush(stderr);
}

void Progress::advance_to(std::size_t done) {
  const std::lock_guard lock(mutex_);
  if (total_ == 0) return;
  const auto now = std::chrono::steady_clock::now();
  const std::chrono::duration<double> since = now - last_, all = now - start_;
  if (done < total_ && since.count() < (is_terminal_ ? TERMINAL_PERIOD : LINE_PERIOD)) return;
  last_ = now;
  show(done, all.count());
}

}  // namespace pvg
