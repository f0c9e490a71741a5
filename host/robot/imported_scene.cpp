#include "host/robot/imported_scene.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <cmath>

#include "host/base/error.hpp"
#include "host/base/files.hpp"
#include "host/base/numbers.hpp"
#include "host/geometry/mass_properties.hpp"
#include "host/robot/multibody.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
const char* const WORLD = "world";      // holds the joints of what stands on it
constexpr double ANCHOR_SIZE = 0.01;    // of that body, which touches nothing [m]
constexpr double SMALLEST_BALL = 1e-4;  // in place of a body without a shape [m]

// The model's name as one that may name files: other characters become _.
std::string identifier_of(std::string name) {
  for (char& c : name)
    if (!is_identifier(std::string(1, c))) c = '_';
  return name.empty() ? "model" : name.substr(0, 64);
}

// the shortest text that is read as this number
std::string text(double number) { return fmt::format("{}", number); }

YAML::Node flow(const std::vector<double>& numbers) {
  YAML::Node node;
  for (const double number : numbers) node.push_back(text(number));
  node.SetStyle(YAML::EmitterStyle::Flow);
  return node;
}

YAML::Node flow(const Vec3& v) { return flow(std::vector<double>(v.begin(), v.end())); }

// roll, pitch, yaw about the fixed axes x, y, z
Vec3 roll_pitch_yaw(const Mat3& r) {
  const double pitch = std::atan2(-r(2, 0), std::hypot(r(0, 0), r(1, 0)));
  if (std::hypot(r(0, 0), r(1, 0)) < 1e-12)  // roll and yaw turn about one axis: all of it is yaw
    return {0, pitch, std::atan2(-r(0, 1), r(1, 1))};
  return {std::atan2(r(2, 1), r(2, 2)), pitch, std::atan2(r(1, 0), r(0, 0))};
}

// `position` and `rotation` where they are not zero
void add_pose(YAML::Node node, const Pose& pose) {
  if (!pose.translation().isZero(0)) node["position"] = flow(Vec3(pose.translation()));
  if (!pose.linear().isApprox(Mat3::Identity(), 1e-15)) node["rotation"] = flow(roll_pitch_yaw(pose.linear()));
}

void add_pose(YAML::Node node, const char* key, const Pose& pose) {
  YAML::Node inner(YAML::NodeType::Map);
  add_pose(inner, pose);
  inner.SetStyle(YAML::EmitterStyle::Flow);
  if (inner.size() > 0) node[key] = inner;
}

YAML::Node shape_node(const MultibodyShape& shape, const fs::path& folder) {
  using Kind = MultibodyShape::Kind;
  YAML::Node node;
  const auto relative = [&](const fs::path& file) {
    return fs::absolute(file).lexically_normal().lexically_relative(folder).generic_string();
  };
  switch (shape.kind) {
    case Kind::box:
      node["box"]["size"] = flow(Vec3(2 * shape.size));
      break;
    case Kind::sphere:
      node["sphere"]["radius"] = text(shape.size[0]);
      break;
    case Kind::ellipsoid:
      node["ellipsoid"]["radii"] = flow(shape.size);
      break;
    case Kind::cylinder:
    case Kind::capsule: {
      YAML::Node round;
      round["radius"] = text(shape.size[0]);
      round["length"] = text(2 * shape.size[1]);
      node[shape.kind == Kind::cylinder ? "cylinder" : "capsule"] = round;
      break;
    }
    case Kind::mesh:
      node["mesh"] = relative(shape.file);
      break;
    case Kind::link:
      node["link"]["urdf"] = relative(shape.file);
      node["link"]["name"] = shape.link;
  }
  node.SetStyle(YAML::EmitterStyle::Flow);
  return node;
}

// the ball of the same mass and mean moment, which a body without a shape is
double radius_of_ball(const MultibodyBody& body) {
  const double mean = body.inertia.trace() / 3;
  return body.mass > 0 ? std::max(SMALLEST_BALL, std::sqrt(2.5 * mean / body.mass)) : ANCHOR_SIZE;
}

void add_shape(YAML::Node node, const MultibodyBody& body, const fs::path& folder) {
  const std::vector<MultibodyShape>& shapes = body.shapes;
  if (shapes.empty()) {
    MultibodyShape ball;
    ball.kind = MultibodyShape::Kind::sphere;
    ball.size[0] = radius_of_ball(body);
    node["shape"] = shape_node(ball, folder);
    node["collides"] = false;
  } else if (shapes.size() == 1 && shapes[0].scale == 1 && shapes[0].pose.matrix().isIdentity(0)) {
    node["shape"] = shape_node(shapes[0], folder);
  } else {
    for (const MultibodyShape& shape : shapes) {
      YAML::Node part;
      part["shape"] = shape_node(shape, folder);
      if (shape.scale != 1) part["size"] = text(shape.scale);
      add_pose(part, shape.pose);
      node["shape"]["parts"].push_back(part);
    }
  }
}

YAML::Node body_node(const MultibodyBody& body, const fs::path& folder) {
  using Kind = MultibodyBody::Kind;
  YAML::Node node;
  node["name"] = body.name;
  node["kind"] = body.kind == Kind::moving ? "rigid" : body.kind == Kind::fixed ? "static" : "half_space";
  node["friction"] = text(body.friction);
  if (body.kind == Kind::half_space) {
    node["point"] = flow(Vec3(body.pose.translation()));
    node["normal"] = flow(Vec3(body.pose.linear().col(2)));
    return node;
  }
  add_shape(node, body, folder);
  add_pose(node, "pose", body.pose);
  if (body.kind == Kind::fixed) return node;
  node["mass"] = text(body.mass);
  node["center_of_mass"] = flow(body.center_of_mass);
  node["inertia"] = flow(moments_and_products(body.inertia));
  return node;
}

YAML::Node drive_node(const Drive& drive) {
  YAML::Node node;
  const bool holds_position = drive.mode == Drive::Mode::position;
  node["mode"] = holds_position ? "position" : drive.mode == Drive::Mode::velocity ? "velocity" : "torque";
  if (holds_position) node["stiffness"] = text(drive.stiffness);
  if (drive.damping > 0) node["damping"] = text(drive.damping);
  if (holds_position && drive.damping > 0) node["damped_rate"] = "joint";
  if (drive.effort_limit > 0) node["effort_limit"] = text(drive.effort_limit);
  node.SetStyle(YAML::EmitterStyle::Flow);
  return node;
}

YAML::Node joint_node(const MultibodyJoint& read, const Multibody& model) {
  const Joint& joint = read.joint;
  const bool turns = joint.type == Joint::Type::revolute, slides = joint.type == Joint::Type::prismatic;
  YAML::Node node;
  node["name"] = joint.name;
  node["type"] = turns ? "revolute" : slides ? "prismatic" : joint.type == Joint::Type::fixed ? "fixed" : "spherical";
  node["parent"] = joint.parent < 0 ? WORLD : model.bodies[std::size_t(joint.parent)].name;
  node["child"] = model.bodies[std::size_t(joint.child)].name;
  add_pose(node, "parent_frame", joint.parent_frame);
  if (!turns && !slides) return node;
  node["axis"] = flow(joint.axis);
  if (joint.initial != 0) node["initial"] = text(joint.initial);
  if (joint.lower < joint.upper) node["limits"] = flow(std::vector<double>{joint.lower, joint.upper});
  if (joint.damping > 0) node["damping"] = text(joint.damping);
  if (read.armature > 0) node["armature"] = text(read.armature);
  if (is_driven(joint)) node["drive"] = drive_node(joint.drive);
  return node;
}

void add_effects(YAML::Node root, const MultibodyJoint& read) {
  const auto add = [&](const char* effect, const std::vector<std::pair<const char*, double>>& parameters) {
    YAML::Node node;
    node["effect"] = effect;
    node["target"] = read.joint.name;
    for (const auto& [name, value] : parameters) node[name] = text(value);
    node.SetStyle(YAML::EmitterStyle::Flow);
    root["effects"].push_back(node);
  };
  if (read.coulomb > 0) add("joint_coulomb_friction", {{"effort", read.coulomb}});
  if (read.spring > 0) add("joint_spring", {{"stiffness", read.spring}, {"preload", read.spring_preload}});
  if (read.actuator_lag > 0) add("actuator_lag", {{"time_constant", read.actuator_lag}});
}

}  // namespace

bool is_robot_description(const fs::path& file) {
  const std::string ending = file.extension().string();
  return ending == ".xml" || ending == ".mjcf" || ending == ".urdf";
}

std::string imported_scene(const fs::path& file, const fs::path& given_folder) {
  const fs::path folder =
      fs::absolute(given_folder.empty() ? fs::absolute(file).parent_path() : given_folder).lexically_normal();
  const Multibody model = file.extension() == ".urdf" ? read_urdf_multibody(file) : read_mjcf(file);
  YAML::Node root;
  root["schema"] = 1;
  root["name"] = identifier_of(model.name);
  root["time_step"] = text(model.time_step);
  root["gravity"] = flow(model.gravity);
  root["solver"]["integrator"] = "bdf2";
  bool is_held = false;
  for (const MultibodyBody& body : model.bodies) {
    if (body.name == WORLD)
      throw UsageError(file.string() + ": a body has the name `" + WORLD + "`, which is that of the world; rename it");
    root["bodies"].push_back(body_node(body, folder));
  }
  for (const MultibodyJoint& joint : model.joints) {
    is_held = is_held || joint.joint.parent < 0;
    root["joints"].push_back(joint_node(joint, model));
    add_effects(root, joint);
  }
  if (is_held) {
    MultibodyBody world;
    world.name = WORLD;
    world.kind = MultibodyBody::Kind::fixed;
    root["bodies"].push_back(body_node(world, folder));
  }
  for (const auto& [first, second] : model.noncolliding) {
    YAML::Node pair;
    pair["first"] = model.bodies[std::size_t(first)].name;
    pair["second"] = model.bodies[std::size_t(second)].name;
    pair.SetStyle(YAML::EmitterStyle::Flow);
    root["noncolliding"].push_back(pair);
  }
  YAML::Emitter out;
  out << root;
  return fmt::format("# from {}\n{}\n", file.filename().string(), out.c_str());
}

std::string scene_text(const fs::path& file) {
  return is_robot_description(file) ? imported_scene(file) : read_whole_file(file).value_or("");
}

}  // namespace pvg
