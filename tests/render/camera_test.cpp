// Camera, ground truth and repeatability.
#include "host/render/camera.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "host/base/error.hpp"
#include "host/pictures/picture.hpp"
#include "host/pictures/srgb.hpp"
#include "host/render/look.hpp"
#include "tests/render/test_scene.hpp"

namespace pvg::test {
namespace {

using Kind = VisualMaterial::Kind;
using Picture = ManyPaths;

const char* const text = R"(
#include "sensors/camera.cl"
kernel void unproject(const uint n, const PinholeCamera c, global const float* pixel, global float* ray) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  float3 d = (float3)(0.0f);
  pixel_direction(c, vload2(i, pixel), &d);
  vstore3(d, i, ray);
})";

// OpenCV's projection, in double
Eigen::Vector2d project(const Camera& c, const Vec3& p) {
  std::vector<double> k = c.distortion;
  k.resize(8, 0.0);
  const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
  const double radial =
      (1 + k[0] * r2 + k[1] * r2 * r2 + k[4] * r2 * r2 * r2) / (1 + k[5] * r2 + k[6] * r2 * r2 + k[7] * r2 * r2 * r2);
  return {c.fx * (x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x)) + c.cx,
          c.fy * (y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y) + c.cy};
}

TEST(Camera, RaysOfPixelsProjectBackToThem) {
  Device device;
  Kernel unproject = Program::from_text(device, "unproject", text).kernel("unproject");
  for (const std::vector<double>& distortion :
       std::vector<std::vector<double>>{{},
                                        {-0.3, 0.1, 0.001, -0.002},
                                        {0.1, -0.2, 0.002, 0.001, 0.05},
                                        {0.3, 0.1, 0, 0.001, 0.02, 0.4, 0.05, 0.01}}) {
    Scene scene;
    Camera& camera = look_at(scene, {0, 0, 0}, {0, 0, 1}, 64, 48, 50);
    camera.fy = 47;
    camera.distortion = distortion;
    std::vector<float> pixels;
    for (int y = 0; y < 48; y += 3)
      for (int x = 0; x < 64; x += 3) pixels.insert(pixels.end(), {float(x), float(y)});
    const unsigned n = unsigned(pixels.size() / 2);
    Buffer<float> rays(device, 3 * n, "ray");
    unproject(n, n, pinhole_camera(camera, Eigen::Matrix4d::Identity()), Buffer<float>(device, pixels, "pixel"), rays);
    const std::vector<float> ray = rays.read();
    for (unsigned i = 0; i < n; ++i) {
      const Eigen::Vector2d pixel = project(camera, {ray[3 * i], ray[3 * i + 1], ray[3 * i + 2]});
      ASSERT_NEAR(pixel.x(), pixels[2 * i], 2e-3);
      ASSERT_NEAR(pixel.y(), pixels[2 * i + 1], 2e-3);
    }
  }
}

// small balls appear where the formula puts their centres
TEST_F(Picture, DistortedPictureShowsPointsWhereTheFormulaPutsThem) {
  Scene scene;
  Camera& camera = look_at(scene, {0, 0, 0}, {1, 0, 0}, 160, 120, 120);
  camera.distortion = {-0.25, 0.08, 0.002, -0.001, 0.01};
  const std::vector<Vec3> centres = {{0, 0, 2}, {0.8, 0.5, 2}, {-0.7, 0.6, 1.8}, {0.9, -0.6, 2.2}};
  const Pose pose = camera.pose;
  const Camera seen_by = camera;
  for (const Vec3& centre : centres) add(scene, sphere(0.05f, 16), material(Kind::diffuse), pose * centre);
  const RenderedFrame frame = picture(scene, 1);
  for (std::size_t ball = 0; ball < centres.size(); ++ball) {
    Eigen::Vector2d sum(0, 0);
    int n = 0;
    for (int i = 0; i < 160 * 120; ++i) {
      if (frame.instance[i] != ball + 1) continue;
      sum += Eigen::Vector2d(i % 160, i / 160);
      ++n;
    }
    ASSERT_GT(n, 10);
    EXPECT_LT((sum / n - project(seen_by, centres[ball])).norm(), 0.5);
  }
}

TEST_F(Picture, DepthOfASphereIsAnalytic) {
  Scene scene;
  add(scene, sphere(0.5f, 256), material(Kind::diffuse));
  look_at(scene, {0, 0, 2}, {0, 0, 0}, 65, 65, 60);
  const RenderedFrame frame = picture(scene, 1);
  int n_seen = 0;
  for (int i = 0; i < 65 * 65; ++i) {
    const Vec3 ray((i % 65 - 32) / 60.0, (i / 65 - 32) / 60.0, 1);
    // |t ray - (0, 0, 2)| = 0.5
    const double a = ray.squaredNorm(), discriminant = 4 - a * 3.75;
    if (std::abs(discriminant) < 0.02) continue;  // at the rim the polyhedron differs
    if (discriminant < 0) {
      EXPECT_TRUE(std::isinf(frame.depth[i]));
      EXPECT_EQ(frame.instance[i], 0u);
      continue;
    }
    ++n_seen;
    const double depth = (2 - std::sqrt(discriminant)) / a;
    ASSERT_NEAR(frame.depth[i], depth, 2e-3);
    ASSERT_EQ(frame.instance[i], 1u);
    // world normal: the camera looks down, x right, y down
    const Vec3 normal = scene.cameras[0].pose.linear() * ((depth * ray - Vec3(0, 0, 2)) / 0.5);
    ASSERT_LT((normal - Vec3(frame.normal[3 * i], frame.normal[3 * i + 1], frame.normal[3 * i + 2])).norm(), 0.02);
  }
  EXPECT_GT(n_seen, 500);
}

// everything at once: lights, glass, metal, texture coordinates, two bodies
Scene little_of_everything() {
  Scene scene;
  add(scene, quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), material(Kind::shadow_receiver)).casts_shadow_on_receivers =
      false;
  add(scene, sphere(0.2f, 16), material(Kind::dielectric), {0, 0, 0.3});
  add(scene, box({-0.1f, -0.1f, 0}, {0.1f, 0.1f, 0.2f}), material(Kind::conductor, {0.9f, 0.7f, 0.4f}),
      {0.4, 0.1, 0.01});
  add(scene, box({-0.1f, -0.1f, 0}, {0.1f, 0.1f, 0.2f}), material(Kind::diffuse), {-0.4, 0.1, 0.01});
  add_light(scene, {-0.3, -0.3, 1.5}, {0, 0.6, 0}, {0.6, 0, 0}, {6, 6, 6});
  look_at(scene, {0, -1.5, 0.7}, {0, 0, 0.2}, 70, 50, 60);
  return scene;
}

TEST_F(Picture, SameSeedSameBits) {
  Device device;
  const Scene scene = little_of_everything();
  RenderSettings settings;
  settings.samples = 8;
  settings.seed = 42;
  Renderer first(device, scene, settings), second(device, scene, settings);
  const RenderedFrame a = first.render(0, 3), b = second.render(0, 3), other = first.render(0, 4),
                      again = first.render(0, 3);
  EXPECT_EQ(a.rgb, b.rgb);
  EXPECT_EQ(a.depth, b.depth);
  EXPECT_EQ(a.rgb, again.rgb);
  EXPECT_NE(a.rgb, other.rgb);
  EXPECT_EQ(a.depth, other.depth);
  EXPECT_EQ(a.dropped_samples, 0u);
  settings.seed = 43;
  EXPECT_NE(a.rgb, Renderer(device, scene, settings).render(0, 3).rgb);
}

TEST_F(Picture, MoreSamplesThanFitOneBatchChangeNothingButNoise) {
  Scene scene = little_of_everything();
  scene.cameras.clear();
  look_at(scene, {0, -1.5, 0.7}, {0, 0, 0.2}, 40, 30, 35);
  const RenderedFrame few = picture(scene, 64), many = picture(scene, 400);  // 480 000 paths: several batches
  double difference = 0;
  for (std::size_t i = 0; i < few.rgb.size(); ++i) difference += few.rgb[i] - many.rgb[i];
  EXPECT_NEAR(difference / double(few.rgb.size()), 0, 0.01);
  EXPECT_EQ(few.instance, many.instance);
}

// small enough for a simulated device, with every stage and material in it
TEST(Render, FewPathsThroughEverything) {
  Scene scene = little_of_everything();
  scene.environment = Vec3f::Constant(0.1f);
  scene.cameras.clear();
  look_at(scene, {0, -1.5, 0.7}, {0, 0, 0.2}, 12, 8, 11).distortion = {-0.1, 0.02, 0.001, 0.001};
  const RenderedFrame frame = picture(scene, 2, true, 6);
  EXPECT_EQ(frame.dropped_samples, 0u);
  EXPECT_GT(mean(frame).value, 0.1);
  EXPECT_EQ(*std::max_element(frame.instance.begin(), frame.instance.end()), 4u);
  EXPECT_GE(frame.rays, 2u * 12 * 8);
}

TEST(Render, SamplesThatAreNotFiniteAreLeftOutAndCounted) {
  Device device;
  Kernel accumulate = Program(device, "render/accumulate.cl").kernel("accumulate");
  Launch launch{};
  launch.camera.width = 2;
  launch.camera.height = 1;
  launch.n_pixels = 2;
  launch.n_samples = 3;
  const float nan = std::nanf(""), inf = INFINITY;
  Buffer<F32x4> radiance(
      device,
      std::vector<F32x4>{
          {{1, 2, 3, 0}}, {{nan, 0, 0, 0}}, {{3, 4, 5, 0}}, {{0, inf, 0, 0}}, {{1, 1, -inf, 0}}, {{0, 0, nan, 0}}},
      "radiance");
  Buffer<std::uint32_t> pixels(device, std::vector<std::uint32_t>{1, 0}, "pixels");
  Buffer<F32x4> film(device, 2, "film");
  Buffer<float> squares(device, 2, "squares");
  Buffer<std::uint32_t> dropped(device, 2, "dropped");
  film.zero();
  squares.zero();
  dropped.zero();
  accumulate(2, 2u, launch, pixels, radiance, film, squares, dropped);
  const std::vector<F32x4> sums = film.read();
  EXPECT_EQ(std::vector<float>(sums[1].v, sums[1].v + 4), (std::vector<float>{4, 6, 8, 2}));
  EXPECT_EQ(std::vector<float>(sums[0].v, sums[0].v + 4), (std::vector<float>{0, 0, 0, 0}));
  EXPECT_EQ(dropped.read(), (std::vector<std::uint32_t>{3, 1}));
}

TEST_F(Picture, VisualsFollowTheirBodies) {
  Scene scene;
  RigidBody body;
  body.name = "cube";
  scene.rigid_bodies.push_back(body);
  add(scene, box({-0.1f, -0.1f, -0.1f}, {0.1f, 0.1f, 0.1f}), material(Kind::diffuse)).rigid = 0;
  SoftBody soft;
  soft.name = "drop";
  soft.mesh.nodes_per_element = 4;
  soft.mesh.points = {{0, 0, 0}, {0.2, 0, 0}, {0, 0.2, 0}, {0, 0, 0.2}};
  soft.mesh.elements = {0, 1, 2, 3};
  soft.mesh.surface = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  soft.pose.translation() = Vec3(1, 0, 0);
  scene.soft_bodies.push_back(soft);
  Visual visual;
  visual.name = "drop";
  visual.soft = 0;
  visual.material = 0;
  visual.subdivision_levels = 0;
  scene.visuals.push_back(visual);
  look_at(scene, {0, 0, 3}, {0, 0, 0}, 101, 101, 100);  // 3 cm per pixel at z = 0
  Camera on_body = scene.cameras[0];
  on_body.rigid = 0;
  scene.cameras.push_back(on_body);

  Device device;
  RenderSettings settings;
  settings.samples = 1;
  Renderer renderer(device, scene, settings);
  const RenderedFrame before = renderer.render(0, 0);
  EXPECT_EQ(before.instance[101 * 50 + 50], 1u);
  EXPECT_NEAR(before.depth[101 * 50 + 50], 2.9, 1e-5);
  EXPECT_EQ(std::count(before.instance.begin(), before.instance.end(), 2u) > 10, true);

  SceneState state;
  AffineMap moved = Pose::Identity().matrix().topRows<3>();
  moved(2, 3) = 0.5;
  state.rigid = {moved};
  state.soft = {{{-1, 0, 1}, {-0.5, 0, 1}, {-1, 0.5, 1}, {-1, 0, 1.5}}};
  renderer.set_state(state);
  const RenderedFrame after = renderer.render(0, 0);
  EXPECT_NEAR(after.depth[101 * 50 + 50], 2.4, 1e-5);
  // the centroid of the slanted face, (-5/6, 1/6, 7/6), seen where the camera (x right is -x or x) puts it
  const Vec3 p = scene.cameras[0].pose.inverse() * Vec3(-5 / 6.0, 1 / 6.0, 7 / 6.0);
  const int pixel = 101 * int(std::lround(50 + 100 * p.y() / p.z())) + int(std::lround(50 + 100 * p.x() / p.z()));
  EXPECT_EQ(after.instance[pixel], 2u);
  EXPECT_NEAR(after.depth[pixel], 3 - 7 / 6.0, 0.02);
  // a camera on the body sees it unmoved
  EXPECT_NEAR(renderer.render(1, 0).depth[101 * 50 + 50], 2.9, 1e-5);
  EXPECT_NEAR(renderer.camera_pose(1)(2, 3), 3.5, 1e-12);
}

// a sheet that hangs in an evenly bright world sends back its albedo on both sides
TEST_F(Picture, AClothFollowsItsPointsAndHasTwoSides) {
  Scene scene;
  Cloth cloth;
  cloth.name = "sheet";
  cloth.mesh = {{{-0.2, -0.2, 0}, {0.2, -0.2, 0}, {0.2, 0.2, 0}, {-0.2, 0.2, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  cloth.pose.translation() = Vec3(5, 0, 0);
  scene.cloths = {cloth};
  scene.materials = {material(Kind::diffuse, Vec3f::Constant(0.5f))};
  Visual visual;
  visual.name = "sheet";
  visual.cloth = visual.material = 0;
  visual.subdivision_levels = 2;
  scene.visuals.push_back(visual);
  scene.environment = Vec3f::Ones();
  look_at(scene, {0, 0, 3}, {0, 0, 0}, 101, 101, 100);
  look_at(scene, {0, 0, -3}, {0, 0, 0}, 101, 101, 100);
  Device device;
  RenderSettings settings;
  settings.samples = 16;
  Renderer renderer(device, scene, settings);
  constexpr std::size_t MIDDLE = 101 * 50 + 50;
  EXPECT_EQ(renderer.render(0, 0).instance[MIDDLE], 0u);
  SceneState state;
  state.cloth = {cloth.mesh.points};
  for (Vec3& x : state.cloth[0]) x.z() += 0.5;
  renderer.set_state(state);
  for (const int side : {0, 1}) {
    const RenderedFrame frame = renderer.render(side, 0);
    EXPECT_EQ(frame.instance[MIDDLE], 1u);
    EXPECT_NEAR(frame.depth[MIDDLE], side == 0 ? 2.5 : 3.5, 1e-5);
    EXPECT_NEAR(frame.rgb[3 * MIDDLE], 0.5, 1e-3);
  }
  state.cloth.clear();
  EXPECT_THROW(renderer.set_state(state), UsageError);
}

TEST(Render, RefusesWhatCannotBeShown) {
  Device device;
  const auto message = [&](const Scene& scene) -> std::string {
    try {
      Renderer(device, scene, {});
    } catch (const UsageError& e) {
      return e.what();
    }
    return "accepted";
  };
  const auto contains = [](const std::string& text, const std::string& word) {
    return text.find(word) != std::string::npos;
  };
  Scene scene = little_of_everything();
  EXPECT_EQ(message(scene), "accepted");
  scene.visual_meshes[1].points[3].x() = std::nanf("");
  EXPECT_TRUE(contains(message(scene), "visual 1: vertex 3")) << message(scene);
  scene = little_of_everything();
  scene.materials[3].color = {2, 0, 0};
  EXPECT_TRUE(contains(message(scene), "color must be in [0, 1]")) << message(scene);
  scene = little_of_everything();
  scene.cameras[0].distortion = {1, 2, 3};
  EXPECT_TRUE(contains(message(scene), "camera camera: distortion")) << message(scene);
  scene = little_of_everything();
  scene.visuals[2].mesh = 17;
  EXPECT_TRUE(contains(message(scene), "visual 2: its mesh")) << message(scene);
  scene = little_of_everything();
  scene.lights[0].edge_u = scene.lights[0].edge_v;
  EXPECT_TRUE(contains(message(scene), "light 0: its edges")) << message(scene);
}

TEST(Image, SrgbIsTheStandardCurve) {
  const std::vector<float> linear = {0, 1, 0.5f, 2, -1, 0.0031308f};
  EXPECT_EQ(encode_srgb8(linear, 2, 1).rgb, (std::vector<std::uint8_t>{0, 255, 188, 255, 0, 10}));
  for (int byte = 0; byte < 256; ++byte)
    EXPECT_EQ(std::lround(255 * linear_to_srgb(srgb_to_linear(float(byte) / 255))), byte);
}

}  // namespace
}  // namespace pvg::test
