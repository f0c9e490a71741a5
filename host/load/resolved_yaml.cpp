// The configuration of an episode as text: what the files said, the defaults they left open, the numbers that were
// drawn.
#include <yaml-cpp/yaml.h>

#include "host/load/build_scene.hpp"

namespace pvg {
namespace {

using YAML::BeginMap, YAML::BeginSeq, YAML::EndMap, YAML::EndSeq, YAML::Key, YAML::Value;

struct Writer {
  YAML::Emitter out;
  std::filesystem::path folder;  // of the task file: paths are written relative to it

  Writer(const std::filesystem::path& base) : folder(base) {
    out.SetDoublePrecision(17);
    out.SetFloatPrecision(9);
  }

  template <typename T>
  void entry(const char* key, const T& value) {
    out << Key << key << Value << value;
  }
  void path(const char* key, const std::filesystem::path& file) {
    if (!file.empty()) entry(key, file.lexically_relative(folder).generic_string());
  }
  template <typename Vector>
  void vector(const char* key, const Vector& v) {
    out << Key << key << Value << YAML::Flow << BeginSeq;
    for (Eigen::Index i = 0; i < v.size(); ++i) out << v[i];
    out << EndSeq;
  }
  void range(const char* key, const Range& range) {
    if (range.low == range.high) return entry(key, range.low);
    out << Key << key << Value << YAML::Flow << BeginSeq << range.low << range.high << EndSeq;
  }
  void pose(const char* key, const Pose& pose) {
    begin(key);
    vector("position", Vec3(pose.translation()));
    vector("quaternion", Eigen::Quaterniond(pose.linear()).coeffs());  // x, y, z, w
    end();
  }
  void begin(const char* key) { out << Key << key << Value << BeginMap; }
  void end() { out << EndMap; }
  template <typename List, typename Write>
  void list(const char* key, const List& list, Write write) {
    out << Key << key << Value << BeginSeq;
    for (const auto& item : list) {
      out << BeginMap;
      write(item);
      out << EndMap;
    }
    out << EndSeq;
  }
};

void write_robot(Writer& w, const RobotSection& robot) {
  w.begin("robot");
  w.path("urdf", robot.urdf);
  w.pose("base", robot.base);
  w.out << Key << "home" << Value << YAML::Flow << robot.home;
  w.entry("flange", robot.flange);
  w.begin("drive");
  w.entry("stiffness", robot.drive_stiffness);
  w.entry("damping", robot.drive_damping);
  w.end();
  w.entry("friction", robot.friction);
  if (robot.collision_links) w.out << Key << "collision_links" << Value << YAML::Flow << *robot.collision_links;
  w.end();
}

void write_visuals(Writer& w, const std::vector<VisualSection>& visuals) {
  w.list("visuals", visuals, [&](const VisualSection& visual) {
    w.path("mesh", visual.mesh);
    w.entry("material", visual.material);
    w.entry("crease_angle", visual.crease_angle);
  });
}

void write_finger(Writer& w, const FingerSection& finger) {
  w.entry("name", finger.name);
  w.path("mesh", finger.mesh);
  w.begin("material");
  w.entry("density", finger.material.density);
  w.entry("youngs_modulus", finger.material.youngs_modulus);
  w.entry("poisson_ratio", finger.material.poisson_ratio);
  w.end();
  w.entry("friction", finger.friction);
  w.entry("carriage", finger.carriage);
  w.pose("pose", finger.pose);
  w.begin("stitch");
  w.vector("low", finger.stitch_low);
  w.vector("high", finger.stitch_high);
  w.entry("stiffness", finger.stitch_stiffness);
  w.end();
  w.begin("tetgen");
  w.entry("max_volume", finger.max_tetrahedron_volume);
  w.entry("radius_edge_ratio", finger.radius_edge_ratio);
  w.entry("keeps_surface", finger.keeps_surface);
  w.entry("nodes_per_element", finger.nodes_per_element);
  w.end();
  write_visuals(w, finger.visuals);
}

void write_gripper(Writer& w, const std::optional<GripperSection>& gripper) {
  if (!gripper) return;
  w.begin("gripper");
  w.entry("is_rigid", gripper->is_rigid);
  w.path("file", gripper->file);
  w.path("urdf", gripper->urdf);
  w.entry("base_link", gripper->base_link);
  w.pose("mount", gripper->mount);
  w.pose("tool_center", gripper->tool_center);
  w.out << Key << "joints" << Value << YAML::Flow << gripper->joints;
  w.entry("open", gripper->open);
  w.entry("closed", gripper->closed);
  if (gripper->width_at_zero) w.entry("width_at_zero", *gripper->width_at_zero);
  w.begin("drive");
  w.entry("stiffness", gripper->drive_stiffness);
  w.entry("damping", gripper->drive_damping);
  w.end();
  w.entry("finger_material", gripper->finger_material);
  w.entry("subdivision_levels", gripper->subdivision_levels);
  w.list("fingers", gripper->fingers, [&](const FingerSection& finger) { write_finger(w, finger); });
  w.end();
}

void write_sampled_pose(Writer& w, const SampledPose& pose) {
  w.begin("pose");
  if (!pose.object.empty()) w.entry("object", pose.object);
  w.range("x", pose.x);
  w.range("y", pose.y);
  w.range("z", pose.z);
  w.range("roll", pose.roll);
  w.range("pitch", pose.pitch);
  w.range("yaw", pose.yaw);
  w.end();
}

void write_object(Writer& w, const ObjectSection& object) {
  w.entry("name", object.name);
  w.path("mesh", object.mesh);
  write_visuals(w, object.visuals);
  w.entry("fixed", object.is_fixed);
  if (object.density > 0) w.entry("density", object.density);
  if (object.mass > 0) w.entry("mass", object.mass);
  w.entry("friction", object.friction);
  w.entry("affine_modulus", object.affine_modulus);
  write_sampled_pose(w, object.pose);
}

void write_cloth(Writer& w, const ClothSection& section) {
  const Cloth& cloth = section.cloth;
  const ClothMaterial& m = cloth.material;
  w.entry("name", cloth.name);
  w.path("mesh", section.mesh);
  w.entry("points", cloth.mesh.points.size());
  w.entry("triangles", cloth.mesh.triangles.size());
  w.begin("material");
  w.entry("area_density", m.area_density);
  w.entry("thickness", m.thickness);
  w.entry("stretch_warp", m.stretch_warp);
  w.entry("stretch_weft", m.stretch_weft);
  w.entry("shear", m.shear);
  w.entry("poisson_ratio", m.poisson_ratio);
  w.entry("limit_strain", m.limit_strain);
  w.entry("stiffening", m.stiffening);
  w.entry("bending_warp", m.bending_warp);
  w.entry("bending_weft", m.bending_weft);
  w.end();
  w.entry("rest_angles", cloth.rest_is_flat ? "flat" : "mesh");
  w.vector("warp", cloth.warp_direction);
  w.out << Key << "pinned_points" << Value << YAML::Flow << cloth.pinned;
  w.entry("friction", cloth.friction);
  w.vector("velocity", cloth.velocity);
  write_sampled_pose(w, section.pose);
  w.entry("look", section.look);
  w.entry("subdivision_levels", section.subdivision_levels);
}

void write_physics(Writer& w, const Task& task) {
  w.list("pair_friction", task.pair_friction, [&](const PairFriction& pair) {
    w.entry("first", pair.first);
    w.entry("second", pair.second);
    w.entry("coefficient", pair.coefficient);
  });
  w.list("effects", task.effects, [&](const Effect& effect) {
    w.entry("effect", effect.name);
    w.entry("target", effect.target);
    if (effect.formulas.size() == 1) w.entry("formula", effect.formulas[0]);
    if (effect.formulas.size() > 1) w.out << Key << "formula" << Value << YAML::Flow << effect.formulas;
    if (!effect.formulas.empty()) {
      w.out << Key << "coefficients" << Value << YAML::Flow << effect.parameters;
      return;
    }
    const std::vector<EffectParameter>& parameters = effect_kind(effect.name).parameters;
    for (std::size_t i = 0; i < parameters.size(); ++i) w.entry(parameters[i].name.c_str(), effect.parameters[i]);
  });
  w.begin("contact");
  w.entry("activation_distance", task.contact.activation_distance);
  w.entry("stiffness", task.contact.stiffness);
  w.entry("friction_velocity", task.contact.friction_velocity);
  w.entry("friction_lag_passes", task.contact.friction_lag_passes);
  w.end();
  constexpr const char* INTEGRATORS[] = {"implicit_euler", "bdf2"};
  w.begin("solver");
  w.entry("integrator", INTEGRATORS[int(task.solver.integrator)]);
  w.entry("velocity_tolerance", task.solver.velocity_tolerance);
  w.entry("max_newton", task.solver.max_newton);
  w.entry("preconditioner", PRECONDITIONER_NAMES[std::size_t(task.solver.preconditioner)]);
  w.entry("cg_tolerance", task.solver.cg_tolerance);
  w.entry("max_cg", task.solver.max_cg);
  w.entry("max_step_halvings", task.solver.max_step_halvings);
  w.end();
}

void write_joint(Writer& w, const JointSection& section) {
  constexpr const char* TYPES[] = {"fixed", "revolute", "prismatic", "spherical"};
  const Joint& joint = section.joint;
  w.entry("name", joint.name);
  w.entry("type", TYPES[int(joint.type)]);
  w.entry("parent", section.parent);
  w.entry("child", section.child);
  w.vector("axis", joint.axis);
  w.entry("lower", joint.lower);
  w.entry("upper", joint.upper);
  w.entry("damping", joint.damping);
  w.pose("parent_frame", joint.parent_frame);
}

void write_element(Writer& w, const MotionElement& element) {
  using Type = MotionElement::Type;
  w.entry("do", name_of(element.type));
  w.entry("robot", element.robot);
  w.entry("is_with_previous", element.is_with_previous);
  w.entry("object", element.object);
  w.entry("frame", element.is_in_tool_frame ? "tool" : "object");
  if (element.type == Type::follow_arc) {
    w.vector("center", element.center);
    w.vector("axis", element.axis);
    w.entry("angle", element.angle);
    w.entry("turns", element.turns_with_arc);
  } else if (element.type == Type::follow_path) {
    w.list("path", element.path, [&](const Pose& pose) { w.pose("pose", pose); });
  } else {
    w.pose("target", element.target);
  }
  w.entry("gripper", element.gripper);
  w.entry("force", element.force);
  w.entry("duration", element.duration);
  w.entry("speed", element.speed);
  w.entry("straight", element.is_straight);
  w.entry("plan", element.avoids_obstacles);
}

void write_condition(Writer& w, const Condition& condition) {
  using Quantity = Condition::Quantity;
  constexpr const char* WHEN[] = {"end", "some_time", "always"};
  w.entry("quantity", quantity_names()[std::size_t(condition.quantity)]);
  w.entry("of", condition.of);
  w.entry("when", WHEN[int(condition.when)]);
  if (condition.quantity == Quantity::position_error) {
    w.entry("target", condition.target);
    w.vector("target_position", condition.target_position);
    w.vector("point", condition.point);
  }
  if (condition.quantity == Quantity::corner_distance || condition.quantity == Quantity::edge_distance) {
    w.vector("first", condition.first);
    w.vector("second", condition.second);
  }
  if (condition.quantity == Quantity::edge_distance) {
    w.vector("first_end", condition.first_end);
    w.vector("second_end", condition.second_end);
  }
  if (condition.at_least) w.entry("at_least", *condition.at_least);
  if (condition.at_most) w.entry("at_most", *condition.at_most);
}

void write_motion(Writer& w, const Task& task) {
  w.list("motion", task.motion, [&](const MotionElement& element) { write_element(w, element); });
  w.list("success", task.success, [&](const Condition& condition) { write_condition(w, condition); });
  w.list("failure", task.failure, [&](const Condition& condition) { write_condition(w, condition); });
}

void write_looks(Writer& w, const Task& task) {
  constexpr const char* KINDS[] = {"diffuse",         "conductor",          "dielectric", "emissive",
                                   "shadow_receiver", "metallic_roughness", "cloth"};
  constexpr const char* ALPHA_MODES[] = {"opaque", "mask", "blend"};
  w.begin("background");
  w.path("mesh", task.background.mesh);
  w.path("texture", task.background.texture);
  w.pose("pose", task.background.pose);
  w.entry("shadow_strength", task.background.shadow_strength);
  w.end();
  w.list("materials", task.materials, [&](const VisualMaterial& material) {
    w.entry("name", material.name);
    w.entry("kind", KINDS[int(material.kind)]);
    w.vector("color", material.color);
    if (material.texture >= 0) w.path("texture", task.textures[material.texture]);
    w.entry("roughness", material.roughness);
    w.entry("index_of_refraction", material.index_of_refraction);
    w.vector("absorption", material.absorption);
    w.vector("emission", material.emission);
    w.entry("shadow_strength", material.shadow_strength);
    const auto texture = [&](const char* key, int index) {
      if (index >= 0) w.path(key, task.textures[std::size_t(index)]);
    };
    texture("metallic_roughness_texture", material.metallic_roughness_texture);
    texture("normal_texture", material.normal_texture);
    texture("emission_texture", material.emission_texture);
    w.entry("normal_scale", material.normal_scale);
    w.entry("metallic", material.metallic);
    w.entry("transmission", material.transmission);
    w.entry("thin", material.is_thin);
    w.entry("priority", material.priority);
    w.vector("edge_dip", material.edge_dip);
    w.vector("sheen", material.sheen);
    w.entry("sheen_roughness", material.sheen_roughness);
    w.entry("alpha_mode", ALPHA_MODES[int(material.alpha_mode)]);
    w.entry("opacity", material.opacity);
    w.entry("alpha_cutoff", material.alpha_cutoff);
  });
  w.list("lights", task.lights, [&](const RectangleLight& light) {
    w.entry("name", light.name);
    w.vector("corner", light.corner);
    w.vector("edge_u", light.edge_u);
    w.vector("edge_v", light.edge_v);
    w.vector("radiance", light.radiance);
  });
  w.list("sphere_lights", task.sphere_lights, [&](const SphereLight& light) {
    w.entry("name", light.name);
    w.vector("center", light.center);
    w.entry("radius", light.radius);
    w.vector("radiance", light.radiance);
  });
  w.vector("environment", task.environment);
  w.path("environment_map", task.environment_map);
  w.entry("environment_turn", task.environment_turn);
  w.list("cameras", task.cameras, [&](const CameraSection& camera) {
    w.entry("name", camera.name);
    w.entry("mount", camera.mount);
    w.entry("width", camera.width);
    w.entry("height", camera.height);
    if (camera.intrinsics.empty())
      w.entry("vertical_field_of_view", camera.vertical_field_of_view);
    else
      w.out << Key << "intrinsics_per_size" << Value << YAML::Flow << camera.intrinsics;
    w.entry("model", camera.optics.model == Camera::Model::fisheye ? "fisheye" : "pinhole");
    w.out << Key << "distortion" << Value << YAML::Flow << camera.optics.distortion;
    w.entry("lens_radius", camera.optics.lens_radius);
    w.entry("focus_distance", camera.optics.focus_distance);
    w.entry("exposure_time", camera.optics.exposure_time);
    w.entry("row_time", camera.optics.row_time);
    w.out << Key << "vignetting" << Value << YAML::Flow << camera.optics.vignetting;
    w.entry("full_well", camera.optics.full_well);
    w.entry("read_noise", camera.optics.read_noise);
    w.pose("pose", camera.pose);
    w.entry("exposure", camera.exposure);
    w.entry("records_gripper_mask", camera.records_gripper_mask);
  });
  w.begin("render");
  w.entry("frames_per_second", task.render.frames_per_second);
  w.entry("samples", task.render.samples);
  w.entry("max_depth", task.render.max_depth);
  w.path("lut", task.render.lut);
  w.end();
}

}  // namespace

std::string resolved_yaml(const Task& task, const TaskScene& built) {
  Writer w(task.file.parent_path());
  w.out << BeginMap;
  w.entry("schema", 1);
  w.entry("name", task.name);
  w.entry("time_step", task.solver.time_step);
  if (!task.robot.urdf.empty()) write_robot(w, task.robot);
  write_gripper(w, task.gripper);
  w.list("robots", task.more_robots, [&](const RobotCell& cell) {
    w.entry("name", cell.name);
    write_robot(w, cell.robot);
    write_gripper(w, cell.gripper);
  });
  w.list("objects", task.objects, [&](const ObjectSection& object) { write_object(w, object); });
  w.list("joints", task.joints, [&](const JointSection& joint) { write_joint(w, joint); });
  w.list("cloths", task.cloths, [&](const ClothSection& cloth) { write_cloth(w, cloth); });
  write_physics(w, task);
  write_motion(w, task);
  write_looks(w, task);
  w.begin("drawn");
  for (const SampledValue& drawn : built.sampled) w.entry(drawn.name.c_str(), drawn.value);
  w.end();
  w.out << EndMap;
  return std::string(w.out.c_str()) + "\n";
}

}  // namespace pvg
