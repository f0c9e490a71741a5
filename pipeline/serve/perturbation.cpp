#include "pipeline/serve/perturbation.hpp"

#include <stdexcept>

#include "host/base/error.hpp"
#include "host/base/names.hpp"
#include "host/base/numbers.hpp"
#include "host/load/build_scene.hpp"

namespace pvg {
namespace {

template <class Do>
void for_each_finger(Task& task, Do act) {
  const auto fingers_of = [&](std::optional<GripperSection>& gripper) {
    if (!gripper) return;
    for (FingerSection& finger : gripper->fingers) act(finger);
  };
  fingers_of(task.gripper);
  for (RobotCell& robot : task.more_robots) fingers_of(robot.gripper);
}

void scale_light(Task& task, double factor) {
  if (task.lights.empty() && task.sphere_lights.empty() && task.environment.isZero())
    throw UsageError("it has no lights");
  for (RectangleLight& light : task.lights) light.radiance *= float(factor);
  for (SphereLight& light : task.sphere_lights) light.radiance *= float(factor);
  task.environment *= float(factor);
}

void shift_cameras(Task& task, double distance) {
  if (task.cameras.empty()) throw UsageError("it has no cameras");
  for (CameraSection& camera : task.cameras) camera.pose.translation() += distance * camera.pose.linear().col(0);
}

// of every body alike, so that the mean of two, which holds for pairs that are not named, is scaled by it, too
void scale_friction(Task& task, double factor) {
  for (ObjectSection& object : task.objects) object.friction *= factor;
  for (ClothSection& section : task.cloths) section.cloth.friction *= factor;
  for (PairFriction& pair : task.pair_friction) pair.coefficient *= factor;
  for_each_finger(task, [&](FingerSection& finger) { finger.friction *= factor; });
  task.robot.friction *= factor;
  for (RobotCell& robot : task.more_robots) robot.robot.friction *= factor;
}

void scale_mass(Task& task, double factor) {
  for (ObjectSection& object : task.objects) object.mass *= factor, object.density *= factor;
  for (ClothSection& section : task.cloths) section.cloth.material.area_density *= factor;
}

void scale_stiffness(Task& task, double factor) {
  bool is_any_soft = !task.cloths.empty();
  for (const RobotCell& robot : robots_of(task))
    is_any_soft = is_any_soft || (robot.gripper && !robot.gripper->fingers.empty() && !robot.gripper->is_rigid);
  if (!is_any_soft) throw UsageError("nothing in it is soft");
  for_each_finger(task, [&](FingerSection& finger) { finger.material.youngs_modulus *= factor; });
  for (ClothSection& section : task.cloths) {
    ClothMaterial& m = section.cloth.material;
    for (double* modulus : {&m.stretch_warp, &m.stretch_weft, &m.shear, &m.bending_warp, &m.bending_weft})
      *modulus *= factor;
  }
}

void scale_colors(Task& task, double factor) {
  if (task.materials.empty()) throw UsageError("it has no materials");
  for (VisualMaterial& material : task.materials) material.color = (material.color * float(factor)).cwiseMin(1.0f);
}

void shift_background(Task& task, double shift) {
  if (task.background.mesh.empty()) throw UsageError("it has no background");
  task.background.pose.translation() += shift * Vec3::UnitY();
}

// The effect on every driven joint of such a type.
void add_to_drives(Task& task, const std::string& effect, double amount, bool revolute_only) {
  bool is_any = false;
  for (const Joint& joint : build_scene_at_middle(task).scene.joints) {
    if (!is_driven(joint) || (revolute_only && joint.type != Joint::Type::revolute)) continue;
    is_any = true;
    if (amount > 0) task.effects.push_back({effect, joint.name, {amount}});
  }
  if (!is_any) throw UsageError("it has no such drives");
}

void delay_drives(Task& task, double delay) { add_to_drives(task, "actuator_delay", delay, false); }
void loosen_drives(Task& task, double play) { add_to_drives(task, "backlash", play, true); }

}  // namespace

const std::vector<PerturbationKind>& perturbation_kinds() {
  static const std::vector<PerturbationKind> KINDS = {
      {"light", "", "factor of the radiance of all lights", 0.001, 1000, scale_light},
      {"camera", "m", "shift of all cameras to their right", -1, 1, shift_cameras},
      {"friction", "", "factor of all coefficients of friction", 0.001, 1000, scale_friction},
      {"mass", "", "factor of the mass of all objects and cloths", 0.001, 1000, scale_mass},
      {"stiffness", "", "factor of the moduli of all fingers and cloths", 0.001, 1000, scale_stiffness},
      {"texture", "", "factor of the colour of all materials", 0.001, 1000, scale_colors},
      {"background", "m", "shift of the background along the world's y", -10, 10, shift_background},
      {"latency", "s", "delay of all drives (effect actuator_delay)", 0, 1, delay_drives},
      {"backlash", "rad", "play of all revolute drives (effect backlash)", 0, 0.5, loosen_drives},
  };
  return KINDS;
}

Perturbation read_perturbation(const std::string& text) {
  const std::size_t equals = text.find('=');
  const PerturbationKind* kind = find_named(perturbation_kinds(), text.substr(0, equals));
  if (!kind) {
    std::string names;
    for (const PerturbationKind& each : perturbation_kinds())
      names += (names.empty() ? "" : ", ") + std::string(each.name);
    throw UsageError("--perturb " + text + " must be NAME=NUMBER, where NAME is one of " + names);
  }
  try {
    return {kind, parse_real(equals == std::string::npos ? "" : text.substr(equals + 1), kind->low, kind->high)};
  } catch (const std::invalid_argument& error) {
    throw UsageError("--perturb " + text + ": the number of `" + kind->name + "` " + error.what());
  }
}

void perturb(Task& task, const Perturbation& perturbation) {
  try {
    perturbation.kind->apply(task, perturbation.amount);
  } catch (const UsageError& error) {
    throw UsageError(task.file.string() + " cannot be perturbed in `" + perturbation.kind->name + "`: " + error.what());
  }
}

}  // namespace pvg
