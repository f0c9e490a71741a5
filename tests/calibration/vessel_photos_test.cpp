// A flask's profile from photos of a real camera, whose poses are known by the tags that it stands on: distortion, blur
// and noise are in the masks as in the poses.
#include <gtest/gtest.h>

#include <cmath>

#include "host/calibration/calibration.hpp"
#include "host/capture/objects/vessel.hpp"
#include "host/formats/picture_files.hpp"
#include "host/pictures/srgb.hpp"
#include "tests/calibration/board_photos.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

const Board TAG_GRID = parse_board("tags,4x3,80,64");
const Profile FLASK = {{0, 0}, {0.032, 0}, {0.034, 0.004}, {0.013, 0.07}, {0.013, 0.1}};  // [m]
const Eigen::Vector2d AXIS(0.155, 0.11);
constexpr float RED = 0.6f;  // of the flask, and of nothing else

Scene flask_on_tags() {
  Scene scene = board_scene(TAG_GRID);
  const TriangleMesh flask = revolved(closed_outline(FLASK, 2e-3), 96);
  VisualMesh mesh;
  for (const Vec3& p : flask.points) mesh.points.push_back((p + Vec3(AXIS.x(), AXIS.y(), 0)).cast<float>());
  mesh.triangles = flask.triangles;
  VisualMaterial red;
  red.name = "red";
  red.kind = VisualMaterial::Kind::emissive;
  red.emission = Vec3f(RED, 0, 0);
  Visual visual;
  visual.name = "flask";
  visual.mesh = int(scene.visual_meshes.size());
  visual.material = int(scene.materials.size());
  scene.materials.push_back(red);
  scene.visual_meshes.push_back(mesh);
  scene.visuals.push_back(visual);
  return scene;
}

// white where more than half of the light is the flask's
Picture8 mask_of(const Picture8& photo) {
  Picture8 mask = photo;
  const auto light = [&](std::size_t i) { return srgb_to_linear(float(photo.rgb[i]) / 255); };
  for (std::size_t i = 0; i < photo.rgb.size(); i += 3)
    for (std::size_t k = 0; k < 3; ++k) mask.rgb[i + k] = light(i) - light(i + 1) > 0.5f * RED ? 255 : 0;
  return mask;
}

std::vector<PlacedTag> placed_tags() {
  std::vector<PlacedTag> tags;
  for (int id = 0; id < 12; ++id) {
    PlacedTag tag{id, 0.064, Pose::Identity()};
    tag.pose.translation() = Vec3(id % 4 * 0.08 + 0.032, (2 - id / 4) * 0.08 + 0.032, 0);
    tags.push_back(tag);
  }
  return tags;
}

double radius_of_flask(double height) {
  for (std::size_t i = 1; i < FLASK.size(); ++i)
    if (FLASK[i].y() >= height && FLASK[i].y() > FLASK[i - 1].y())
      return FLASK[i - 1].x() +
             (FLASK[i].x() - FLASK[i - 1].x()) * (height - FLASK[i - 1].y()) / (FLASK[i].y() - FLASK[i - 1].y());
  return FLASK.back().x();
}

// largest error of the radii above the foot's corner [m]
double tell(const char* what, const Vessel& vessel) {
  double worst = 0, sum = 0, n = 0;
  for (const Eigen::Vector2d& p : vessel.outside())
    if (p.y() > 0.006) {
      const double off = std::abs(p.x() - radius_of_flask(p.y()));
      worst = std::max(worst, off);
      sum += off;
      n += 1;
    }
  std::printf(
      "%s: axis off by %.3f mm, height by %.3f mm, radii by %.3f mm on the mean, %.3f mm at most; outlines by "
      "%.2f pixels\n",
      what, 1e3 * (vessel.axis - AXIS).norm(), 1e3 * (vessel.height - 0.1), 1e3 * sum / n, 1e3 * worst,
      vessel.residual);
  return worst;
}

TEST(VesselPhotos, AFlaskOnTagsHasItsProfileWithinAMillimetre) {
  Camera optics = real_camera();
  optics.focus_distance = 0.5;
  std::vector<Pose> poses;
  for (int i = 0; i < 8; ++i) {
    const double turn = 0.8 * i, height = i % 2 ? 0.2 : 0.4;
    poses.push_back(looking({AXIS.x() + 0.45 * std::cos(turn), AXIS.y() + 0.45 * std::sin(turn), height},
                            {AXIS.x(), AXIS.y(), 0.03}, 0.1));
  }
  const std::vector<Picture8> pictures = photos(flask_on_tags(), optics, poses, 8);
  const TestFolder folder;
  std::vector<MaskedView> known, by_tags;
  double shift = 0;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    MaskedView view{"photo " + std::to_string(i), folder.path / ("mask_" + std::to_string(i) + ".png"), optics};
    write_picture(view.mask, mask_of(pictures[i]));
    view.camera.pose = poses[i];
    known.push_back(view);
    const CameraPlace place = place_camera(find_tags_finely(pictures[i]), placed_tags(), optics);
    view.camera.pose = place.pose;
    by_tags.push_back(view);
    shift = std::max(shift, (place.pose.translation() - poses[i].translation()).norm());
    std::printf("photo %zu: %zu tags, off by %.2f mm\n", i, place.used.size(),
                1e3 * (place.pose.translation() - poses[i].translation()).norm());
  }
  Device device("", Purpose::rendering);
  EXPECT_LE(tell("true poses", vessel_of_masks(device, known, 1)), 0.6e-3);  // a pixel is 0.8 mm
  EXPECT_LE(tell("poses by tags", vessel_of_masks(device, by_tags, 1)), 1e-3);
}

}  // namespace
}  // namespace pvg
