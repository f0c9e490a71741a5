#include "host/base/stop_signal.hpp"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <mutex>
#include <thread>

#include "host/base/atomic_files.hpp"

namespace pvg {
namespace {

constexpr int TRY_AGAIN = 75;  // exit code, as main gives it

std::atomic<bool> stop = false;
std::atomic<double> most_seconds_to_stop = std::numeric_limits<double>::infinity();

sigset_t stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int number : {SIGINT, SIGTERM, SIGUSR1}) sigaddset(&signals, number);
  return signals;
}

// Waits for a signal so long [s]; its number, or less than 1.
int wait_for(const sigset_t& signals, double seconds) {
  if (!std::isfinite(seconds)) return sigwaitinfo(&signals, nullptr);
  timespec time{};
  time.tv_sec = std::time_t(seconds);
  time.tv_nsec = long((seconds - std::floor(seconds)) * 1e9);
  return sigtimedwait(&signals, nullptr, &time);
}

// The one thread that hears of the signals: all others have them blocked. A handler would not do, for LLVM puts its own
// in its place when OpenCL's driver compiles a kernel, and that of SIGUSR1 forgets ours.
void listen() {
  const sigset_t signals = stop_signals();
  while (wait_for(signals, std::numeric_limits<double>::infinity()) < 1) {
  }
  stop = true;
  const int second = wait_for(signals, most_seconds_to_stop);
  remove_unfinished_folders();
  if (second > 0) {  // at once, as the signal usually does
    signal(second, SIG_DFL);
    pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
    raise(second);
  }
  // a launch on the device cannot be taken back: who waits for a long one does not come to look at the flag
  std::fprintf(stderr,
               "phyvisgen: stopped in the middle of a step; the episodes that were finished stay, the same command "
               "continues\n");
  _exit(TRY_AGAIN);
}

}  // namespace

const std::atomic<bool>& stop_on_signals() {
  static std::once_flag once;
  std::call_once(once, [] {
    const sigset_t signals = stop_signals();
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // threads that begin later inherit it
    std::thread(listen).detach();
  });
  return stop;
}

void stop_within(double most_seconds) { most_seconds_to_stop = most_seconds; }

}  // namespace pvg
