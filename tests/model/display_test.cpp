// What a scale shows of the forces on it, worked out by hand.
#include "host/model/display.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pvg {
namespace {

Display on_body(int rigid) {
  Display display;
  display.rigid = rigid;
  return display;
}

TEST(Display, WeighsWhatPressesAndNotWhatCarries) {
  const Scene scene;  // g = 9.81 m/s^2
  WorldState state;
  state.pair_force = {{0, 1, {0, 0, -12}, {0, 0, 0}},       // the table, body 0, carries body 1
                      {1, 2, {0, 0, -0.981}, {0.3, 0, 0}},  // body 2 presses on the scale with 0.981 N
                      {1, 3, {0, 0, 5}, {0, 0, 0}},         // body 3 lifts it
                      {2, 3, {0, 0, 100}, {0, 0, 0}}};      // is no matter of the scale
  EXPECT_NEAR(load_on(on_body(1), scene, state), 0.1, 1e-15);
  Display second = on_body(2);
  second.tare = 0.5;
  EXPECT_NEAR(load_on(second, scene, state), -0.5, 1e-15);  // carried by the scale, lifted by body 3
}

TEST(Display, FrictionDownwardWeighsToo) {
  Scene scene;
  scene.gravity = Vec3(0, -2, 0);
  WorldState state;
  state.pair_force = {{4, 7, {1, 0, 0}, {0, -3, 0}}};  // body 7 drags body 4 down with 3 N
  EXPECT_NEAR(load_on(on_body(4), scene, state), 1.5, 1e-15);
  EXPECT_NEAR(load_on(on_body(7), scene, state), 0, 1e-15);
  scene.gravity = Vec3::Zero();
  EXPECT_EQ(load_on(on_body(4), scene, state), 0);
}

TEST(Display, ReadingFollowsWithItsTimeConstant) {
  Display display;
  display.time_constant = 0.5;
  EXPECT_NEAR(settled(display, 0, 0.2, 0.5), 0.2 * (1 - std::exp(-1)), 1e-15);
  // two halves of a step as the whole one
  EXPECT_NEAR(settled(display, settled(display, 0.1, 0.2, 0.01), 0.2, 0.01), settled(display, 0.1, 0.2, 0.02), 1e-15);
  display.time_constant = 0;
  EXPECT_EQ(settled(display, 0, 0.2, 0.01), 0.2);
}

TEST(Display, FiguresAreGramsInStepsOfTheResolution) {
  Display display;
  display.digits = 5;
  display.resolution = 1e-4;
  EXPECT_EQ(shown_figures(display, 0.10004), "100.0");
  EXPECT_EQ(shown_figures(display, 0.10006), "100.1");
  EXPECT_EQ(shown_figures(display, -0.00004), "0.0");
  EXPECT_EQ(shown_figures(display, -0.0123), "-12.3");
  EXPECT_EQ(shown_figures(display, 9.99994), "9999.9");
  EXPECT_EQ(shown_figures(display, 12), "-----");
  display.resolution = 2e-5;
  EXPECT_EQ(shown_figures(display, 0.100032), "100.04");
  display.resolution = 1e-3;
  EXPECT_EQ(shown_figures(display, 1.2344), "1234");
  display.resolution = 5e-3;
  EXPECT_EQ(shown_figures(display, 1.2344), "1235");
}

}  // namespace
}  // namespace pvg
