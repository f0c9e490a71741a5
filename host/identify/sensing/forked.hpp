// Work in a process of its own, forked from this one. Threads with a device `basic` each end PoCL 3.1 (an assertion in
// its cache of compiled kernels), but a process that has only one thread in the driver can be forked with it.
#pragma once
#include <sys/types.h>

#include <functional>
#include <vector>

#include "host/identify/sensing/deadline.hpp"

namespace pvg::diagnose {

class Forked {
 public:
  // The copy of this process runs `work`, whose bytes come back; it ends with this process.
  explicit Forked(const std::function<std::vector<char>()>& work);
  ~Forked();  // work that nobody has asked for is ended
  Forked(Forked&& other) noexcept;
  Forked& operator=(Forked&&) = delete;

  // Waits for what the work returned. Throws a Failure with its reason if it threw, or if the process was ended,
  // TryAgain where the user stopped this one, and OutOfTime at the deadline.
  std::vector<char> result(Clock::time_point deadline = Clock::time_point::max());

 private:
  pid_t process_ = -1;
  int pipe_ = -1;  // where it can be read
};

}  // namespace pvg::diagnose
