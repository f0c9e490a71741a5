// Ctrl-C, SIGTERM and SIGUSR1 (what batch systems send before they end a job) ask for a clean end; a second one ends at
// once.
#pragma once
#include <atomic>

namespace pvg {

// The flag turns true once one of the signals arrives. The first call must come before other threads begin.
const std::atomic<bool>& stop_on_signals();

// What is still under way so long after a signal [s] ends with the process
// (exit code 75), and the folders in the making go. Batch systems and container platforms kill after 10 s and more.
void stop_within(double most_seconds);

}  // namespace pvg
