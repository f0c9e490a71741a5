// The time at which simulations end, whatever is under way: what a stage has by then counts.
#pragma once
#include <algorithm>
#include <chrono>

#include "host/base/error.hpp"

namespace pvg::diagnose {

using Clock = std::chrono::steady_clock;

// Thrown by a simulation that its deadline has ended. Whoever gave the deadline catches it.
struct OutOfTime : Failure {
  OutOfTime() : Failure("the time given by --minutes is over") {}
};

inline double seconds_until(Clock::time_point time) {
  return std::chrono::duration<double>(time - Clock::now()).count();
}

// When this share of the time from now to a deadline is over.
inline Clock::time_point after_share(Clock::time_point deadline, double share) {
  const auto now = Clock::now();
  return now + std::chrono::duration_cast<Clock::duration>(share * (deadline - now));
}

// From now to the end of its scope a deadline is the earlier one of itself and `time`.
class EarlierDeadline {
 public:
  EarlierDeadline(Clock::time_point& deadline, Clock::time_point time) : deadline_(deadline), before_(deadline) {
    deadline_ = std::min(deadline_, time);
  }
  ~EarlierDeadline() { deadline_ = before_; }
  EarlierDeadline(const EarlierDeadline&) = delete;
  EarlierDeadline& operator=(const EarlierDeadline&) = delete;

 private:
  Clock::time_point& deadline_;
  Clock::time_point before_;
};

// Whether `work` came to its end before `deadline` or the earlier `time`; what it had done by then stays.
template <class Work>
bool ends_by(Clock::time_point& deadline, Clock::time_point time, const Work& work) {
  const EarlierDeadline earlier(deadline, time);
  try {
    work();
  } catch (const OutOfTime&) {
    return false;
  }
  return true;
}

}  // namespace pvg::diagnose
