#include "host/load/variation.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/error.hpp"
#include "host/base/names.hpp"

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
  constexpr const char* NAMES[] = {"size",    "mass",     "friction",        "stiffness",       "color",
                                   "light",   "exposure", "camera_position", "camera_rotation", "focal_length",
                                   "texture", "presence", "disturbance"};
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
    case Quantity::focal_length:
      for (CameraSection& camera : task.cameras)
        if (is_meant(camera.name)) {
          double& angle = camera.vertical_field_of_view;
          angle = 2 * std::atan(std::tan(angle / 2) / factor);
          for (std::size_t k = 0; k < std::min<std::size_t>(2, camera.intrinsics.size()); ++k)
            camera.intrinsics[k] *= factor;
        }
      break;
    default:
      break;
  }
  return is_there;
}

bool apply_texture(Task& task, const std::string& name, const std::filesystem::path& file) {
  if (name == "background" && !task.background.texture.empty()) {
    task.background.texture = file;
    return true;
  }
  if (name == "environment" && !task.environment_map.empty()) {
    task.environment_map = file;
    return true;
  }
  bool is_there = false;
  for (VisualMaterial& material : task.materials) {
    if (material.name != name) continue;
    is_there = true;
    material.texture = int(task.textures.size());
    task.textures.push_back(file);
  }
  return is_there;
}

// what of the task cannot do without the object; empty: nothing
std::string user_of(const Task& task, const std::string& object) {
  for (const JointSection& joint : task.joints)
    if (joint.child == object || joint.parent == object) return "a joint holds";
  for (const MotionElement& element : task.motion)
    if (element.object == object) return "`motion` names";
  for (const std::vector<Condition>* conditions : {&task.success, &task.failure})
    for (const Condition& condition : *conditions)
      if (condition.of == object || condition.target == object) return "a condition names";
  for (const ObjectSection& other : task.objects)
    if (other.pose.object == object) return "the pose of `" + other.name + "` names";
  return "";
}

bool may_be_absent(const Task& task, const std::string& name) {
  if (!find_named(task.objects, name)) return false;
  if (const std::string user = user_of(task, name); !user.empty())
    throw UsageError(task.file.string() + ": `vary` draws the presence of `" + name + "`, which " + user +
                     "; only what the task can do without may be absent");
  return true;
}

// Alone, or where it touches another body.
bool acts_on(const Effect& effect, const std::string& object) {
  switch (effect_kind(effect.name).target) {
    case EffectTarget::joint:
    case EffectTarget::driven_joint:
    case EffectTarget::scene:
      return false;
    case EffectTarget::contact:
      return effect.target.starts_with(object + "/") || effect.target.ends_with("/" + object);
    default:
      return effect.target == object;
  }
}

// An object that is not there leaves with all that is said of it.
void remove_object(Task& task, const std::string& name) {
  const auto is_of = [&](const auto& pair) { return pair.first == name || pair.second == name; };
  std::erase_if(task.objects, [&](const ObjectSection& object) { return object.name == name; });
  std::erase_if(task.pair_friction, is_of);
  std::erase_if(task.pair_restitution, is_of);
  std::erase_if(task.effects, [&](const Effect& effect) { return acts_on(effect, name); });
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

// Every push of an episode; draw_three: of a name and a range.
template <class DrawThree>
bool apply_disturbance(Task& task, const Variation& variation, const std::string& name, const DrawNumber& draw,
                       const DrawThree& draw_three) {
  const std::vector<RobotCell> robots = robots_of(task);
  const auto is_meant = [&](const RobotCell& robot) { return robot.gripper && hand_name(robot.name) == variation.of; };
  if (std::none_of(robots.begin(), robots.end(), is_meant)) return false;
  if (std::any_of(task.disturbances.begin(), task.disturbances.end(),
                  [&](const Disturbance& other) { return other.of == variation.of; }))
    throw UsageError(task.file.string() + ": `vary` draws disturbances of `" + variation.of +
                     "` twice; give one entry more `times`");
  for (int k = 1; k <= variation.times; ++k) {
    const std::string one = name + "/" + std::to_string(k);
    Disturbance& drawn = task.disturbances.emplace_back();
    drawn.of = variation.of;
    drawn.during = variation.during;
    drawn.when = draw(one + "/when", {0, 1});
    drawn.duration = draw(one + "/duration", variation.duration);
    drawn.by = draw_three(one + "/by", variation.range);
    drawn.turn = draw_three(one + "/turn", variation.turn);
  }
  return true;
}

// u in [0, 1) as an index of the list
std::size_t drawn_index(double u, const std::vector<std::filesystem::path>& list) {
  return std::min(std::size_t(u * double(list.size())), list.size() - 1);
}

}  // namespace

Task varied(Task task, const DrawNumber& draw) {
  std::vector<std::string> absent;
  for (const Variation& variation : task.variations) {
    const std::string name = variation.of + "/" + name_of(variation.quantity);
    const auto three = [&](const std::array<const char*, 3>& parts, const std::string& of, const Range& range) {
      Vec3 drawn;
      for (int k = 0; k < 3; ++k) drawn[k] = draw(of + "/" + parts[std::size_t(k)], range);
      return drawn;
    };
    const auto of_axes = [&](const std::string& of, const Range& range) { return three({"x", "y", "z"}, of, range); };
    bool is_there = false;
    if (variation.quantity == Quantity::color)
      is_there = apply_color(task, variation.of, three({"red", "green", "blue"}, name, variation.range));
    else if (variation.quantity == Quantity::camera_position || variation.quantity == Quantity::camera_rotation)
      is_there = apply_to_camera(task, variation, of_axes(name, variation.range));
    else if (variation.quantity == Quantity::texture)
      is_there = apply_texture(task, variation.of, variation.files[drawn_index(draw(name, {0, 1}), variation.files)]);
    else if (variation.quantity == Quantity::presence) {
      if (!(draw(name, {0, 1}) < variation.probability)) absent.push_back(variation.of);
      is_there = may_be_absent(task, variation.of);
    } else if (variation.quantity == Quantity::disturbance)
      is_there = apply_disturbance(task, variation, name, draw, of_axes);
    else
      is_there = apply_factor(task, variation, draw(name, variation.range));
    if (!is_there)
      throw UsageError(task.file.string() + ": `vary` names `" + variation.of + "`, which has no " +
                       name_of(variation.quantity) + " in this task; correct `of`");
  }
  // last: other entries may be of an object that is not there this time
  for (const std::string& name : absent) remove_object(task, name);
  return task;
}

}  // namespace pvg
