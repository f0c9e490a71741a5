// Worlds that come and go while others step: each has the bits that it has alone, and fails alone.
#include "pipeline/episode/shared_simulation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "tests/physics/step/small_scenes.hpp"

namespace pvg {
namespace {

// A box that slides and falls onto a floor; other numbers for each `which`.
PhysicalScene sliding_box(int which) {
  PhysicalScene scene = empty_scene("slide", 0.005);
  RigidBody box = box_body("box", Vec3::Constant(0.05), 1000, Vec3(0, 0, 0.056 + 0.001 * which));
  box.velocity = Vec3(0.3 + 0.1 * which, 0, 0);
  scene.rigid_bodies = {fixed_box("floor", Vec3(2, 2, 0.05), Vec3(0, 0, -0.05)), box};
  return scene;
}

int n_steps(int which) { return 20 + 7 * which; }

Eigen::Matrix<double, 3, 4> last_pose(SharedSimulation& shared, int which) {
  const auto world = shared.join(sliding_box(which));
  for (int i = 0; i < n_steps(which); ++i) world->step({});
  return world->state().rigid[1];
}

TEST(SharedSimulation, WorldsThatComeAndGoHaveTheBitsTheyHaveAlone) {
  constexpr int N = 7;
  Device device;
  SharedSimulation shared(device);
  std::vector<Eigen::Matrix<double, 3, 4>> together(N), alone(N);
  std::mutex turn;
  int next = 0;
  const auto run = [&] {
    for (;;) {
      int which;
      {
        const std::lock_guard lock(turn);
        if (next == N) return;
        which = next++;
      }
      together[which] = last_pose(shared, which);
    }
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < 3; ++i) threads.emplace_back(run);
  for (std::thread& thread : threads) thread.join();
  for (int which = 0; which < N; ++which) {
    SharedSimulation own(device);
    alone[which] = last_pose(own, which);
    EXPECT_EQ(together[which], alone[which]) << which;
    EXPECT_GT(alone[which](0, 3), 0.01) << "it slid";
  }
}

TEST(SharedSimulation, WhoFailsLeavesAndIsNamedAsIfAlone) {
  Device device;
  SharedSimulation shared(device);
  auto good = shared.join(sliding_box(0));
  PhysicalScene bad = sliding_box(1);
  bad.rigid_bodies[1].velocity.x() = INFINITY;
  const auto failing = shared.join(bad);
  std::string message;
  std::thread other([&] {
    try {
      failing->step({});
    } catch (const StepFailure& failure) {
      message = failure.what();
      EXPECT_EQ(failure.events.at(0).world, 0u);
    }
  });
  for (int i = 0; i < n_steps(0); ++i) good->step({});
  const Eigen::Matrix<double, 3, 4> pose = good->state().rigid[1];
  good.reset();  // else the other one, if it comes late, waits for its next step
  other.join();
  std::string message_alone;
  try {
    Simulation(device, bad).step(std::vector<double>{});
  } catch (const StepFailure& failure) {
    message_alone = failure.what();
  }
  EXPECT_FALSE(message.empty());
  EXPECT_EQ(message, message_alone);
  EXPECT_THROW(failing->step({}), UsageError);
  SharedSimulation own(device);
  EXPECT_EQ(pose, last_pose(own, 0));
}

TEST(SharedSimulation, AStartThatIntersectsIsRefusedAndTheOthersGoOn) {
  Device device;
  SharedSimulation shared(device);
  const auto good = shared.join(sliding_box(0));
  good->step({});
  PhysicalScene bad = sliding_box(1);
  bad.rigid_bodies[1].pose.translation().z() = 0;
  EXPECT_THROW(shared.join(bad), UsageError);
  for (int i = 1; i < n_steps(0); ++i) good->step({});
  SharedSimulation own(device);
  EXPECT_EQ(good->state().rigid[1], last_pose(own, 0));
}

TEST(SharedSimulation, ComputeUnitsBesideEachOtherHaveTheBitsOfTheWholeDevice) {
  Device device;
  std::vector<Device> units = device.compute_units();
  if (device.info().compute_units < 2) {
    EXPECT_TRUE(units.empty());
    GTEST_SKIP() << "a device of one compute unit";
  }
  if (units.empty()) GTEST_SKIP() << "the driver does not divide this device";
  ASSERT_EQ(units.size(), device.info().compute_units);
  std::vector<Eigen::Matrix<double, 3, 4>> poses(units.size());
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < units.size(); ++i)
    threads.emplace_back([&, i] {
      EXPECT_EQ(units[i].info().compute_units, 1u);
      SharedSimulation simulation(units[i]);
      poses[i] = last_pose(simulation, int(i % 3));
    });
  for (std::thread& thread : threads) thread.join();
  SharedSimulation whole(device);
  for (std::size_t i = 0; i < units.size(); ++i) EXPECT_EQ(poses[i], last_pose(whole, int(i % 3))) << i;
}

TEST(AutomaticWorlds, FollowTheDeviceAndItsMemory) {
  DeviceInfo device;
  device.memory_bytes = 16'000'000'000;
  device.compute_units = 6;
  EXPECT_EQ(automatic_worlds(device, 50'000'000), 6u);     // a CPU
  EXPECT_EQ(automatic_worlds(device, 2'000'000'000), 2u);  // half of the memory, each world twice
  device.is_gpu = true;
  EXPECT_EQ(automatic_worlds(device, 50'000'000), 32u);
  EXPECT_EQ(automatic_worlds(device, 2'000'000'000), 2u);    // half of the memory, each world twice
  EXPECT_EQ(automatic_worlds(device, 100'000'000'000), 1u);  // whatever it takes
}

}  // namespace
}  // namespace pvg
