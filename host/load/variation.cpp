#include "host/load/variation.hpp"

#include <cmath>

#include "host/base/error.hpp"

namespace pvg {
namespace {

using Quantity = Variation::Quantity;

template <class Do>
void for_each_gripper(Task& task, Do act) {
  if (task.gripper) act(*task.gripper, std::string());
  for (RobotCell& cell : task.more_robots)
    if (cell.gripper) act(*cell.gripper, cell.name + "/");
}

// Names of the quantity's numbers: of one number, or of three.
const char* name_of(Quantity quantity) {
  constexpr const char* NAMES[] = {"size",  "mass",     "friction",        "stiffness",      "color",
                                   "light", "exposure", "camera_position", "camera_rotation"};
  return NAMES[int(quantity)];
}

// True where the task holds what the variation is of.
bool apply_factor(Task& task, const Variation& variation, double factor) {
  bool is_there = false;
  const auto is_meant = [&](const std::string& name) {
    is_there = is_there || name == variation.of;
    return name == variation.of;
  };
  switch (variation.quantity) {
    case Quantity::size:
      for (ObjectSection& object : task.objects)
        if (is_meant(object.name)) object.size *= factor;
      break;
    case Quantity::mass:
      for (ObjectSection& object : task.objects)
        if (is_meant(object.name)) object.mass *= factor, object.density *= factor;
      for (ClothSection& section : task.cloths)
        if (is_meant(section.cloth.name)) section.cloth.material.area_density *= factor;
      break;
    case Quantity::friction:
      for (ObjectSection& object : task.objects)
        if (is_meant(object.name)) object.friction *= factor;
      for (ClothSection& section : task.cloths)
        if (is_meant(section.cloth.name)) section.cloth.friction *= factor;
      for (PairFriction& pair : task.pair_friction)
        if (is_meant(pair.first) || is_meant(pair.second)) pair.coefficient *= factor;
      break;
    case Quantity::stiffness:
      for_each_gripper(task, [&](GripperSection& gripper, const std::string& prefix) {
        for (FingerSection& finger : gripper.fingers)
          if (is_meant(prefix + finger.name)) finger.material.youngs_modulus *= factor;
      });
      for (ClothSection& section : task.cloths)
        if (is_meant(section.cloth.name)) {
          ClothMaterial& m = section.cloth.material;
          for (double* modulus : {&m.stretch_warp, &m.stretch_weft, &m.shear, &m.bending_warp, &m.bending_weft})
            *modulus *= factor;
        }
      break;
    case Quantity::light:
      for (RectangleLight& light : task.lights)
        if (is_meant(light.name)) light.radiance *= float(factor);
      for (SphereLight& light : task.sphere_lights)
        if (is_meant(light.name)) light.radiance *= float(factor);
      break;
    case Quantity::exposure:
      for (CameraSection& camera : task.cameras)
        if (is_meant(camera.name)) camera.exposure *= float(factor);
      break;
    default:
      break;
  }
  return is_there;
}

bool apply_color(Task& task, const std::string& name, const Vec3& factor) {
  bool is_there = false;
  for (VisualMaterial& material : task.materials) {
    if (material.name != name) continue;
    is_there = true;
    material.color = (material.color.cast<double>().cwiseProduct(factor)).cwiseMin(1.0).cast<float>();
  }
  return is_there;
}

bool apply_to_camera(Task& task, const Variation& variation, const Vec3& by) {
  for (CameraSection& camera : task.cameras) {
    if (camera.name != variation.of) continue;
    if (variation.quantity == Quantity::camera_position)
      camera.pose.translation() += camera.pose.linear() * by;
    else if (by.norm() > 0)
      camera.pose.linear() = camera.pose.linear() * Eigen::AngleAxisd(by.norm(), by.normalized()).toRotationMatrix();
    return true;
  }
  return false;
}

}  // namespace

Task varied(Task task, const DrawNumber& draw) {
  for (const Variation& variation : task.variations) {
    const std::string name = variation.of + "/" + name_of(variation.quantity);
    const auto three = [&](const std::array<const char*, 3>& parts) {
      Vec3 drawn;
      for (int k = 0; k < 3; ++k) drawn[k] = draw(name + "/" + parts[std::size_t(k)], variation.range);
      return drawn;
    };
    bool is_there = false;
    if (variation.quantity == Quantity::color)
      is_there = apply_color(task, variation.of, three({"red", "green", "blue"}));
    else if (variation.quantity == Quantity::camera_position || variation.quantity == Quantity::camera_rotation)
      is_there = apply_to_camera(task, variation, three({"x", "y", "z"}));
    else
      is_there = apply_factor(task, variation, draw(name, variation.range));
    if (!is_there)
      throw UsageError(task.file.string() + ": `vary` names `" + variation.of + "`, which has no " +
                       name_of(variation.quantity) + " in this task; correct `of`");
  }
  return task;
}

}  // namespace pvg
