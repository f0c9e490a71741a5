// Ctrl-C, SIGTERM, SIGHUP (the terminal is gone) and SIGUSR1 (what batch systems send before they end a job) ask for a
// clean end; a second one ends at once.
#pragma once
#include <atomic>

namespace pvg {

// The flag turns true once one of the signals arrives. Threads that run before the first call must not start others.
// What is still under way 1.5 s later ends with the process (exit code 75), and what is in the making goes.
const std::atomic<bool>& stop_on_signals();

}  // namespace pvg
