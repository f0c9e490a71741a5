// Wraps that must keep a bound, around a ball from which they are 0.6 of their spacing away.
#include "host/capture/objects/sound_wrap.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host/base/error.hpp"
#include "host/capture/objects/surface_distance.hpp"
#include "host/geometry/primitive_shapes.hpp"
#include "tests/expect_error.hpp"

namespace pvg {
namespace {

const WrapSettings COARSE = {4e-3, 0,
                             16e-3};  // the offset is 2.4 mm, and of the fourth attempt 0.93^3 of that, 1.93 mm

TEST(SoundWrap, TheFirstThatKeepsTheBoundIsTaken) {
  const TriangleMesh ball = sphere_surface(0.03, 3);
  const NearestTriangle source(ball);
  const SoundWrap first = sound_wrap(source, COARSE, 2.8e-3, "ball");
  EXPECT_EQ(first.settings.spacing, COARSE.spacing);
  const SoundWrap last = sound_wrap(source, COARSE, 2.05e-3, "ball");
  EXPECT_DOUBLE_EQ(last.settings.spacing, std::pow(0.93, 3) * COARSE.spacing);
  EXPECT_DOUBLE_EQ(last.settings.bridge, std::pow(0.93, 3) * COARSE.bridge);
  for (const SoundWrap& wrap : {first, last}) {
    EXPECT_TRUE(is_sound(wrap.mesh));
    EXPECT_EQ(wrap.distance, surface_distances(wrap.mesh, ball).back());
    EXPECT_NEAR(wrap.distance, 0.6 * wrap.settings.spacing, 0.05 * wrap.settings.spacing);
  }
}

TEST(SoundWrap, WhereNoneKeepsTheBoundOneSentenceSaysHowFarTheNearestIs) {
  const TriangleMesh ball = sphere_surface(0.03, 3);
  expect_error<UsageError>([&] { sound_wrap(NearestTriangle(ball), COARSE, 1.5e-3, "ball.obj"); },
                           {"ball.obj", "is 1.9", "1.50 mm of --bridge", "take another --bridge"});
}

}  // namespace
}  // namespace pvg
