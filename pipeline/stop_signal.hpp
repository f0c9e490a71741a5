// Ctrl-C, SIGTERM and SIGUSR1 (what batch systems send before they end a job) ask for a clean end; a second one ends at
// once.
#pragma once
#include <atomic>

namespace pvg {

// Installs the handlers; the flag turns true once one of the signals arrives.
const std::atomic<bool>& stop_on_signals();

}  // namespace pvg
