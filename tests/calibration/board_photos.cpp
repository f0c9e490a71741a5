#include "tests/calibration/board_photos.hpp"

#include <cmath>
#include <string>

#include "host/render/renderer.hpp"

namespace pvg {

Camera real_camera() {
  Camera camera;
  camera.name = "camera";
  camera.width = 640;
  camera.height = 480;
  camera.fx = 612.4;
  camera.fy = 610.9;
  camera.cx = 327.3;
  camera.cy = 233.8;
  camera.distortion = {-0.28, 0.09, 0.0008, -0.0005, 0};
  camera.lens_radius = 0.4e-3;
  camera.focus_distance = 0.3;
  camera.full_well = 8000;
  camera.read_noise = 8;
  return camera;
}

Pose looking(const Vec3& eye, const Vec3& at, double roll) {
  const Vec3 z = (at - eye).normalized(), x = z.cross(Vec3::UnitY()).normalized();
  Pose pose = Pose::Identity();
  pose.linear().col(0) = -x;
  pose.linear().col(1) = -z.cross(x);
  pose.linear().col(2) = z;
  pose.linear() = pose.linear() * Eigen::AngleAxisd(M_PI + roll, Vec3::UnitZ()).toRotationMatrix();
  pose.translation() = eye;
  return pose;
}

std::vector<Pose> poses_around_board(int n) {
  std::vector<Pose> poses;
  const Vec3 middle(0.11, 0.08, 0);
  for (int i = 0; i < n; ++i) {
    const double angle = 2.4 * i, tilt = 0.15 + 0.045 * i, distance = 0.25 + 0.015 * (i % 5);
    const Vec3 from(std::sin(tilt) * std::cos(angle), std::sin(tilt) * std::sin(angle), std::cos(tilt));
    const Vec3 aside(0.035 * std::cos(1.7 * i), 0.03 * std::sin(1.7 * i), 0);
    poses.push_back(looking(middle + distance * from, middle + aside, 0.2 * (i % 3 - 1)));
  }
  return poses;
}

Scene board_scene(const Board& board) {
  Scene scene;
  const Vec2f size = board_size(board);
  VisualMaterial paper, print;
  paper.name = "paper";
  paper.color = Vec3f::Constant(0.8f);
  print = paper;
  print.name = "print";
  print.color = Vec3f::Constant(0.8f);
  print.texture = 0;
  scene.textures.push_back(board_picture(board, 12000));
  scene.materials = {paper, print};
  const auto add = [&](float x, float y, float w, float h, float z, int material) {
    VisualMesh mesh;
    mesh.points = {{x, y, z}, {x + w, y, z}, {x + w, y + h, z}, {x, y + h, z}};
    mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    Visual visual;
    visual.name = "board";
    visual.mesh = int(scene.visual_meshes.size());
    visual.material = material;
    scene.visual_meshes.push_back(mesh);
    scene.visuals.push_back(visual);
  };
  add(0, 0, size.x(), size.y(), 0, 1);
  add(-0.03f, -0.03f, size.x() + 0.06f, size.y() + 0.06f, -1e-4f, 0);
  scene.environment = Vec3f::Ones();
  return scene;
}

namespace {

// a picture of each camera that `render` makes
template <class Render>
std::vector<Picture8> pictures(Scene& scene, const Camera& optics, const std::vector<Pose>& poses, int samples,
                               const Render& render) {
  for (const Pose& pose : poses) {
    scene.cameras.push_back(optics);
    scene.cameras.back().pose = pose;
  }
  Device device;
  RenderSettings settings;
  settings.samples = samples;
  settings.max_depth = 2;
  Renderer renderer(device, scene, settings);
  renderer.set_state(initial_state(scene));
  std::vector<Picture8> out;
  for (int i = 0; i < int(poses.size()); ++i) {
    const RenderedFrame frame = render(renderer, i);
    out.push_back(encode_srgb8(frame.rgb, frame.width, frame.height));
  }
  return out;
}

}  // namespace

std::vector<Picture8> photos(Scene scene, const Camera& optics, const std::vector<Pose>& poses, int samples) {
  return pictures(scene, optics, poses, samples,
                  [](Renderer& renderer, int i) { return renderer.render(i, std::uint32_t(i)); });
}

std::vector<Picture8> photos_in_motion(Scene scene, const Camera& optics, const std::vector<Pose>& poses,
                                       const std::vector<Vec3>& velocity, int samples) {
  scene.rigid_bodies.emplace_back();
  for (Visual& visual : scene.visuals) visual.rigid = 0;
  return pictures(scene, optics, poses, samples, [&](Renderer& renderer, int i) {
    const Vec3 in_world = poses[std::size_t(i)].linear() * velocity[std::size_t(i)];
    const auto at = [&](double time) {
      SceneState state;
      state.time = time;
      state.rigid = {AffineMap::Zero()};
      state.rigid[0].leftCols<3>() = Eigen::Matrix3d::Identity();
      state.rigid[0].col(3) = time * in_world;
      return state;
    };
    return renderer.render(i, std::uint32_t(i), at, 0);
  });
}

CameraCalibration calibration_from(const std::vector<Picture8>& pictures, const Board& board) {
  std::vector<BoardPhoto> seen;
  for (std::size_t i = 0; i < pictures.size(); ++i)
    seen.push_back({"photo " + std::to_string(i), find_board(pictures[i], board), 0, true, "", {}});
  CalibrationSettings settings;
  settings.n_distortion = 4;
  return calibrate_camera(seen, pictures.front().width, pictures.front().height, settings);
}

}  // namespace pvg
