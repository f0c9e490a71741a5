// What Newton's method decides per world on the device (kernels/solve/newton.cl).
#include <gtest/gtest.h>

#include <limits>

#include "host/device/device.hpp"
#include "shared/types.h"

namespace pvg {
namespace {

// The step of a world is halved where its energy rose by more than rounding or is not a number, if it is active.
TEST(Newton, RisingStepsAreHalved) {
  Device device;
  Program program(device, "solve/newton.cl");
  Kernel halve = program.kernel("halve_rising_steps");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Buffer<u32> is_active(device, std::vector<u32>{1, 1, 1, 1, 0}, "is_active");
  const Buffer<f64> before(device, std::vector<double>{-2, -2, -2, -2, -2}, "before"),
      after(device, std::vector<double>{-2.5, -1.9, -2 + 1e-12, nan, 5}, "after");
  Buffer<f64> step(device, std::vector<double>{1, 1, 1, 0.5, 1}, "step");
  halve(5, 5u, is_active, before, after, 1e-12, step);
  EXPECT_EQ(step.read(), (std::vector<double>{1, 0.5, 1, 0.25, 1}));
}

}  // namespace
}  // namespace pvg
