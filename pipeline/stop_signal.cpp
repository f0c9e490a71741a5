#include "pipeline/stop_signal.hpp"

#include <semaphore.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <thread>

#include "host/io/atomic_files.hpp"

namespace pvg {
namespace {

constexpr int TRY_AGAIN = 75;  // exit code, as main gives it

// a signal handler can reach nothing but a global
std::atomic<bool> stop = false;
static_assert(std::atomic<bool>::is_always_lock_free);
sem_t was_asked;
[[maybe_unused]] const int is_made = sem_init(&was_asked, 0, 0);

void ask_to_stop(int) {
  const int old = errno;
  stop = true;
  sem_post(&was_asked);
  errno = old;
}

// A launch on the device cannot be taken back: who waits for a long one does not come to look at the flag.
void end_late(double most_seconds) {
  while (sem_wait(&was_asked) != 0) {
  }
  std::this_thread::sleep_for(std::chrono::duration<double>(most_seconds));
  remove_unfinished_folders();
  std::fprintf(stderr,
               "phyvisgen: stopped in the middle of a step; the episodes that were finished stay, the same command "
               "continues\n");
  _exit(TRY_AGAIN);
}

}  // namespace

const std::atomic<bool>& stop_on_signals() {
  struct sigaction action {};
  action.sa_handler = ask_to_stop;
  action.sa_flags = int(SA_RESETHAND | SA_RESTART);  // the next one has its usual effect
  for (const int number : {SIGINT, SIGTERM, SIGUSR1}) sigaction(number, &action, nullptr);
  return stop;
}

void stop_within(double most_seconds) { std::thread(end_late, most_seconds).detach(); }

}  // namespace pvg
