#include "host/base/stop_signal.hpp"

#include <pthread.h>
#include <signal.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <mutex>
#include <string>
#include <thread>

#include "host/base/atomic_files.hpp"

namespace pvg {
namespace {

constexpr int TRY_AGAIN = 75;  // exit code, as main gives it

std::atomic<bool> stop = false;
// A driver that compiles a kernel does not come to look at the flag, and no one wants to wait for it.
constexpr double MOST_SECONDS_TO_STOP = 1.5;

sigset_t stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int number : {SIGINT, SIGTERM, SIGUSR1, SIGHUP}) sigaddset(&signals, number);
  return signals;
}

// ---- Threads that libraries began before main, as OpenBLAS does, have the signals open: one of them would take a
// signal, and end the process. Nobody can change the mask of another thread, so each changes its own, in a handler.

std::atomic<int> n_masked = 0;

void block_in_this_thread(int, siginfo_t*, void* context) {
  sigset_t& mask = static_cast<ucontext_t*>(context)->uc_sigmask;  // holds again when the handler returns
  for (const int number : {SIGINT, SIGTERM, SIGUSR1, SIGHUP}) sigaddset(&mask, number);
  ++n_masked;
}

// Does a thread hear of SIGTERM? Some libraries block everything in theirs.
bool hears(const std::filesystem::path& task) {
  std::ifstream status(task / "status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("SigBlk:")) return !(std::stoull(line.substr(7), nullptr, 16) >> (SIGTERM - 1) & 1);
  return false;  // it has ended
}

void block_in_other_threads() {
  const int asks = SIGRTMIN + 7;
  struct sigaction action = {};
  action.sa_sigaction = block_in_this_thread;
  action.sa_flags = SA_SIGINFO | SA_RESTART;
  sigaction(asks, &action, nullptr);
  int n_asked = 0;
  std::error_code ignored;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task", ignored)) {
    const int thread = std::atoi(task.path().filename().c_str());
    if (thread != syscall(SYS_gettid) && hears(task.path()))
      n_asked += syscall(SYS_tgkill, getpid(), thread, asks) == 0;
  }
  for (int i = 0; i < 100 && n_masked < n_asked; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
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
  const int second = wait_for(signals, MOST_SECONDS_TO_STOP);
  remove_unfinished();
  if (second > 0) {  // at once, as the signal usually does
    signal(second, SIG_DFL);
    pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
    raise(second);
  }
  // a launch on the device cannot be taken back: who waits for a long one does not come to look at the flag
  std::fprintf(stderr,
               "phyvisgen: stopped in the middle of a step; what was finished stays, give the same command again\n");
  _exit(TRY_AGAIN);
}

}  // namespace

const std::atomic<bool>& stop_on_signals() {
  static std::once_flag once;
  std::call_once(once, [] {
    const sigset_t signals = stop_signals();
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // threads that begin later inherit it
    block_in_other_threads();
    std::thread(listen).detach();
  });
  return stop;
}

}  // namespace pvg
