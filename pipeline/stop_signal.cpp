#include "pipeline/stop_signal.hpp"

#include <signal.h>

namespace pvg {
namespace {

// a signal handler can reach nothing but a global
std::atomic<bool> stop = false;
static_assert(std::atomic<bool>::is_always_lock_free);

void ask_to_stop(int) { stop = true; }

}  // namespace

const std::atomic<bool>& stop_on_signals() {
  struct sigaction action {};
  action.sa_handler = ask_to_stop;
  action.sa_flags = int(SA_RESETHAND | SA_RESTART);  // the next one has its usual effect
  for (const int number : {SIGINT, SIGTERM, SIGUSR1}) sigaction(number, &action, nullptr);
  return stop;
}

}  // namespace pvg
