#include "host/base/stop_signal.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <thread>

namespace pvg {
namespace {

using std::chrono::milliseconds;

constexpr int HEARD = 42, NOT_HEARD = 43;

// A thread that was there first, as those of libraries are, does not end the process by taking the signal.
void stop_beside_an_older_thread(int signal) {
  std::thread([] {
    for (;;) std::this_thread::sleep_for(milliseconds(500));
  }).detach();
  std::this_thread::sleep_for(milliseconds(20));
  const std::atomic<bool>& stop = stop_on_signals();
  kill(getpid(), signal);
  for (int i = 0; i < 1000 && !stop; ++i) std::this_thread::sleep_for(milliseconds(1));
  _exit(stop ? HEARD : NOT_HEARD);
}

TEST(StopSignalDeathTest, IsHeardBesideThreadsThatWereThereBefore) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGUSR1})
    EXPECT_EXIT(stop_beside_an_older_thread(signal), testing::ExitedWithCode(HEARD), "") << signal;
}

}  // namespace
}  // namespace pvg
