// What real cameras add: fisheye, a lens of finite size, motion blur, rolling shutter, vignetting, noise; and optical
// flow. Truth: OpenCV's formulas, geometry by hand.
#include <gtest/gtest.h>

#include "host/base/error.hpp"
#include "host/render/camera.hpp"
#include "host/render/sensor.hpp"
#include "tests/render/test_scene.hpp"

namespace pvg::test {
namespace {

using Kind = VisualMaterial::Kind;
using Optics = ManyPaths;

VisualMaterial white() {
  VisualMaterial m = material(Kind::emissive);
  m.emission = Vec3f::Ones();
  return m;
}

// of the light in a picture [pixels]
Eigen::Vector2d centroid(const RenderedFrame& frame) {
  Eigen::Vector2d sum(0, 0);
  double light = 0;
  for (int i = 0; i < frame.width * frame.height; ++i) {
    const double L = frame.rgb[std::size_t(3 * i)];
    sum += L * Eigen::Vector2d(i % frame.width, i / frame.width);
    light += L;
  }
  return sum / light;
}

TEST_F(Optics, FisheyeShowsPointsWhereTheFormulaPutsThem) {
  for (const double angle : {0.2, 0.9, 1.7}) {  // from the axis; the last one is behind the camera
    Scene scene;
    Camera& camera = look_at(scene, {0, 0, 0}, {1, 0, 0}, 160, 120, 40);
    camera.model = Camera::Model::fisheye;
    camera.distortion = {0.02, -0.01, 0.003, -0.0005};
    add(scene, sphere(0.02f, 12), white(), Vec3(std::cos(angle), -std::sin(angle), 0));  // to the right
    const double t = angle * angle;
    const double seen = angle * (1 + t * (0.02 + t * (-0.01 + t * (0.003 - t * 0.0005))));
    const Eigen::Vector2d at = centroid(picture(scene, 16));
    EXPECT_NEAR(at.x(), camera.cx + 40 * seen, 0.1) << angle;
    EXPECT_NEAR(at.y(), camera.cy, 0.1);
  }
}

// a point at distance z, with the lens in focus at f, is a disc of the radius f_pixels r |1/z - 1/f|
TEST_F(Optics, PointOutOfFocusIsADiscOfTheRightSize) {
  Scene scene;
  Camera& camera = look_at(scene, {0, 0, 0}, {0, 1, 0}, 96, 96, 400);
  camera.lens_radius = 0.05;
  camera.focus_distance = 1;
  add(scene, sphere(0.004f, 12), white(), Vec3(0, 2, 0));
  const RenderedFrame frame = picture(scene, 256);
  const double radius = 400 * 0.05 * 0.5;
  double light = 0, squares = 0;
  for (int i = 0; i < 96 * 96; ++i) {
    const double L = frame.rgb[std::size_t(3 * i)], x = i % 96 - camera.cx, y = i / 96 - camera.cy;
    light += L;
    squares += L * (x * x + y * y);
  }
  // the mean square radius of an even disc is half the square of its radius; the ball itself adds a little
  EXPECT_NEAR(std::sqrt(2 * squares / light), radius, 0.03 * radius);
  scene.cameras[0].focus_distance = 2;
  const Mean sharp = mean(picture(scene, 256));
  EXPECT_NEAR(sharp.value, light / (96 * 96), 0.03 * sharp.value);  // the same light in fewer pixels
}

// a ball that goes to the right at 1 m/s, seen from 1 m
Scene passing() {
  Scene scene;
  RigidBody body;
  body.name = "ball";
  scene.rigid_bodies = {body};
  add(scene, sphere(0.02f, 12), white()).rigid = 0;
  look_at(scene, {0, 0, 0}, {0, 1, 0}, 96, 64, 200);
  return scene;
}
SceneState at_time(double time) {
  SceneState state;
  state.time = time;
  state.rigid = {AffineMap::Zero()};
  state.rigid[0].leftCols<3>() = Eigen::Matrix3d::Identity();
  state.rigid[0].col(3) = Vec3(time, 1, 0);
  return state;
}

TEST_F(Optics, MotionBlurIsSpreadOverTheExposure) {
  Scene scene = passing();
  scene.cameras[0].exposure_time = 0.1;
  Device device;
  RenderSettings settings;
  settings.samples = 64;
  Renderer renderer(device, scene, settings);
  const RenderedFrame frame = renderer.render(0, 0, at_time, 0.1);
  // the shutter is open from 0 to 0.1 s: 20 pixels to the right, the middle of the light halfway
  EXPECT_NEAR(centroid(frame).x(), scene.cameras[0].cx + 10, 0.3);
  double squares = 0, light = 0;
  for (int i = 0; i < 96 * 64; ++i) {
    const double L = frame.rgb[std::size_t(3 * i)], x = i % 96 - scene.cameras[0].cx - 10;
    light += L;
    squares += L * x * x;
  }
  // evenly over 20 pixels: variance 400 / 12; the ball's own is a quarter of its squared radius of 4 pixels
  EXPECT_NEAR(squares / light, 400.0 / 12 + 4, 3);
  // ground truth is that of the picture's time
  EXPECT_EQ(frame.instance[std::size_t(32 * 96 + 47 + 20)], 1u);
  EXPECT_EQ(frame.instance[std::size_t(32 * 96 + 47)], 0u);
}

TEST_F(Optics, RollingShutterReadsUpperRowsEarlier) {
  Scene scene = passing();
  scene.visual_meshes[0] = box({-0.02f, -0.001f, -0.3f}, {0.02f, 0.001f, 0.3f});  // a standing bar
  scene.cameras[0].row_time = 0.001;
  Device device;
  Renderer renderer(device, scene, {});
  const RenderedFrame frame = renderer.render(0, 0, at_time, 0.1);
  const auto middle = [&](int row) {
    double sum = 0, light = 0;
    for (int x = 0; x < 96; ++x) {
      light += frame.rgb[std::size_t(3 * (row * 96 + x))];
      sum += frame.rgb[std::size_t(3 * (row * 96 + x))] * x;
    }
    return sum / light;
  };
  // strips of 8 rows: the first is read 56 rows, 56 ms, 11.2 pixels before the last (at the bar's front, 0.999 m)
  EXPECT_NEAR(middle(60) - middle(4), 56 * 0.001 * 200 / 0.999, 0.3);
}

TEST(Sensor, NoiseHasTheSpreadOfItsElectronsAndVignettingItsPolynomial) {
  Camera camera;
  camera.width = 200;
  camera.height = 100;
  camera.cx = 99.5;
  camera.cy = 49.5;
  camera.full_well = 5000;
  camera.read_noise = 10;
  std::vector<float> rgb(200 * 100 * 3, 0.25f), again = rgb, other = rgb;
  expose_sensor(camera, 7, rgb);
  double sum = 0, squares = 0;
  for (const float x : rgb) {
    sum += x;
    squares += (x - 0.25) * (x - 0.25);
  }
  const double n = double(rgb.size()), variance = (5000 * 0.25 + 100) / (5000.0 * 5000.0);
  EXPECT_NEAR(sum / n, 0.25, 4 * std::sqrt(variance / n));
  EXPECT_NEAR(squares / n, variance, 4 * variance * std::sqrt(2 / n));
  expose_sensor(camera, 7, again);
  EXPECT_EQ(rgb, again);
  expose_sensor(camera, 8, other);
  EXPECT_NE(rgb, other);

  camera.full_well = camera.read_noise = 0;
  camera.vignetting = {-0.3, 0.1};
  std::vector<float> flat(200 * 100 * 3, 1.0f);
  expose_sensor(camera, 7, flat);
  const double r2 = (99.5 * 99.5 + 49.5 * 49.5) / (100.0 * 100 + 50 * 50);
  EXPECT_NEAR(flat[0], 1 - 0.3 * r2 + 0.1 * r2 * r2, 1e-6);
  EXPECT_NEAR(flat[3 * (50 * 200 + 100)], 1, 1e-4);
}

TEST_F(Optics, FlowIsTheWayOfThePointsAndTellsWhatIsHidden) {
  Scene scene = passing();
  add(scene, quad({-5, 2, -5}, {10, 0, 0}, {0, 0, 10}), material(Kind::diffuse));  // a wall behind, at 2 m
  Device device;
  Renderer renderer(device, scene, {});
  renderer.set_state(at_time(0));
  const RenderedFrame frame = renderer.render(0, 0);
  const FlowFrame flow = renderer.flow(at_time(0.1));
  const std::size_t ball = 32 * 96 + 47, hidden = ball + 20, wall = 32 * 96 + 10;
  EXPECT_EQ(frame.instance[ball], 1u);
  // the point that is seen is the front of the ball, 0.98 m away
  EXPECT_NEAR(flow.flow[2 * ball], 0.1 * 200 / 0.98, 0.02);
  EXPECT_NEAR(flow.flow[2 * ball + 1], 0, 1e-3);
  EXPECT_EQ(flow.state[ball], 0);
  EXPECT_EQ(frame.instance[hidden], 2u);
  EXPECT_NEAR(flow.flow[2 * hidden], 0, 1e-3);
  EXPECT_EQ(flow.state[hidden], 1);  // the ball moves before it
  EXPECT_EQ(flow.state[wall], 0);
  EXPECT_EQ(renderer.flow(at_time(1)).state[ball], 2);  // beyond the right border
  EXPECT_NEAR(frame.distance[wall], std::sqrt(4 + std::pow(37.5 / 200 * 2, 2) + std::pow(0.5 / 200 * 2, 2)), 1e-4);
  EXPECT_NEAR(frame.depth[wall], 2, 1e-5);
}

TEST_F(Optics, GroundTruthMayLookThroughGlass) {
  Scene scene;
  add(scene, box({-1, 0.9f, -1}, {1, 1, 1}), material(Kind::dielectric));
  add(scene, quad({-5, 2, -5}, {10, 0, 0}, {0, 0, 10}), material(Kind::diffuse));
  look_at(scene, {0, 0, 0}, {0, 1, 0}, 16, 16, 40);
  for (const bool through : {false, true}) {
    Device device;
    RenderSettings settings;
    settings.samples = 1;
    settings.sees_through_glass = through;
    const RenderedFrame frame = Renderer(device, scene, settings).render(0, 0);
    EXPECT_EQ(frame.instance[100], through ? 2u : 1u);
    EXPECT_NEAR(frame.depth[100], through ? 2 : 0.9, 1e-5);
  }
}

TEST(CameraCheck, AbsurdIntrinsicsAreRefused) {
  Scene scene;
  const Camera good = look_at(scene, {0, 0, 0}, {0, 1, 0}, 64, 48, 50);
  check_camera(good);
  const auto refused = [&](const std::function<void(Camera&)>& spoil) {
    Camera camera = good;
    spoil(camera);
    EXPECT_THROW(check_camera(camera), UsageError);
  };
  refused([](Camera& c) { c.fx = 0; });
  refused([](Camera& c) { c.fy = NAN; });
  refused([](Camera& c) { c.fx = 1e30; });
  refused([](Camera& c) { c.cx = 1e6; });
  refused([](Camera& c) { c.width = 1 << 20; });
  refused([](Camera& c) { c.distortion = {1, 2, 3}; });
  refused([](Camera& c) { c.distortion = {0, 0, 0, INFINITY}; });
  refused([](Camera& c) { c.lens_radius = -1; });
  refused([](Camera& c) { c.read_noise = 1; });
}

}  // namespace
}  // namespace pvg::test
