// Steps of Newton's method that are halved on the device (halve_and_move of kernels/solve/nodes.cl).
#include <gtest/gtest.h>

#include <limits>

#include "host/device/device.hpp"
#include "shared/types.h"
#include "solve/site.h"

namespace pvg {
namespace {

// The step of a world is halved where its energy rose by more than rounding or is not a number, if it is active; its
// node and the site on it move by that.
TEST(Newton, RisingStepsAreHalved) {
  Device device;
  Program program(device, "solve/nodes.cl");
  Kernel halve_and_move = program.kernel("halve_and_move");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Buffer<u32> world(device, std::vector<u32>{0, 1, 2, 3, 4}, "world");
  const Buffer<u32> is_active(device, std::vector<u32>{1, 1, 1, 1, 0}, "is_active");
  const Buffer<f64> before(device, std::vector<double>{-2, -2, -2, -2, -2}, "before"),
      after(device, std::vector<double>{-2.5, -1.9, -2 + 1e-12, nan, 5}, "after"),
      step(device, std::vector<double>{1, 1, 1, 0.5, 1}, "step"), x(device, std::vector<double>(15, 1), "x"),
      direction(device, std::vector<double>(15, 4), "direction");
  std::vector<Site> on_node(5);
  for (u32 i = 0; i < 5; ++i) on_node[i] = {{i, i, i, i}, {1, 0, 0, 0}};
  const Buffer<Site> sites(device, on_node, "sites");
  Buffer<f64> halved(device, 5, "halved"), trial(device, 15, "trial"), trial_sites(device, 15, "trial_sites");
  halve_and_move(5, 5u, 5u, 5u, 5u, world, sites, is_active, before, after, 1e-12, step, x, direction, halved, trial,
                 trial_sites);
  EXPECT_EQ(halved.read(), (std::vector<double>{1, 0.5, 1, 0.25, 1}));
  std::vector<double> moved;
  for (const double length : {1.0, 0.5, 1.0, 0.25, 1.0}) moved.insert(moved.end(), 3, 1 + 4 * length);
  EXPECT_EQ(trial.read(), moved);
  EXPECT_EQ(trial_sites.read(), moved);
}

}  // namespace
}  // namespace pvg
