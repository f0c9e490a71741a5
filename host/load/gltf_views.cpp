#include "host/load/gltf_views.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/base/error.hpp"

namespace pvg {
namespace {

constexpr int HEIGHT = 360;  // of pictures [pixels]
constexpr double USUAL_ASPECT = 16.0 / 9;
constexpr double SMALL = 1e-3;  // radius of a point light, in sizes of what it lights
constexpr double FAR = 100;     // distance of a sun, likewise
// A sun is a spot that lights all of that and little more, so that it is not chosen for what it wastes: half the size
// and its own disc, seen from there [rad]
constexpr double SUN_INNER = 0.010, SUN_OUTER = 0.012;
constexpr double SUN_RADIUS = 0.00465;  // angle that the sun's disc fills, half of it [rad]

// the axes of a node without its scale
Mat3 rotation_of(const Eigen::Affine3d& to_world) {
  Mat3 axes = to_world.linear();
  axes.col(2).normalize();
  axes.col(1) = axes.col(2).cross(axes.col(0)).normalized();
  axes.col(0) = axes.col(1).cross(axes.col(2));
  return axes;
}

}  // namespace

Camera read_gltf_camera(const tinygltf::Camera& from, const Eigen::Affine3d& to_world, const std::string& name,
                        const std::string& file) {
  const double field_of_view = from.perspective.yfov;
  const double aspect = from.perspective.aspectRatio > 0 ? from.perspective.aspectRatio : USUAL_ASPECT;
  if (!(field_of_view > 1e-4 && field_of_view < std::numbers::pi) || !(aspect > 0.02 && aspect < 50))
    throw UsageError(file + ": camera `" + name + "` has no usable field of view: yfov " +
                     std::to_string(field_of_view) + ", aspectRatio " + std::to_string(aspect) + ".");
  Camera camera;
  camera.name = name;
  camera.height = HEIGHT;
  camera.width = 2 * std::max(8, int(std::lround(HEIGHT * aspect / 2)));  // even, for videos
  camera.fx = camera.fy = HEIGHT / 2.0 / std::tan(field_of_view / 2);
  camera.cx = (camera.width - 1) / 2.0;
  camera.cy = (camera.height - 1) / 2.0;
  // glTF's cameras look along -z with y up
  camera.pose.linear() = rotation_of(to_world) * Vec3(1, -1, -1).asDiagonal();
  camera.pose.translation() = to_world.translation();
  if (!camera.pose.matrix().allFinite())
    throw UsageError(file + ": the node of camera `" + name + "` has no usable transform.");
  return camera;
}

SphereLight read_gltf_light(const tinygltf::Light& from, const Eigen::Affine3d& to_world, const Vec3& center,
                            double size, const std::string& name, const std::string& file) {
  Vec3f color = Vec3f::Ones();
  for (std::size_t c = 0; c < 3 && c < from.color.size(); ++c) color[Eigen::Index(c)] = float(from.color[c]);
  SphereLight light;
  light.name = name;
  light.direction = -rotation_of(to_world).col(2);  // along -z, too
  light.center = to_world.translation();
  light.radius = SMALL * size;
  double radiance = from.intensity / (std::numbers::pi * light.radius * light.radius);
  if (from.type == "directional") {
    light.center = center - FAR * size * light.direction;
    light.radius = FAR * size * std::sin(SUN_RADIUS);
    light.inner_angle = SUN_INNER;
    light.outer_angle = SUN_OUTER;
    radiance = from.intensity / (std::numbers::pi * std::sin(SUN_RADIUS) * std::sin(SUN_RADIUS));
  } else if (from.type == "spot") {
    light.inner_angle = from.spot.innerConeAngle;
    light.outer_angle = from.spot.outerConeAngle;
    if (!(light.inner_angle >= 0 && light.inner_angle < light.outer_angle &&
          light.outer_angle <= std::numbers::pi / 2 + 1e-6))
      throw UsageError(file + ": spot light `" + name +
                       "` needs innerConeAngle < outerConeAngle, both between 0 and pi / 2.");
  } else if (from.type != "point") {
    throw UsageError(file + ": light `" + name + "` is of type `" + from.type + "`, not point, spot or directional.");
  }
  light.radiance = float(radiance) * color;
  if (!light.radiance.allFinite() || light.radiance.minCoeff() < 0 || !light.center.allFinite())
    throw UsageError(file + ": light `" + name + "` has a colour, intensity or place that is not usable.");
  return light;
}

}  // namespace pvg
