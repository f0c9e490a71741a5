// A URDF as bodies and joints: its base link stands, its joints have no drives.
#include <tinyxml.h>

#include "host/base/error.hpp"
#include "host/base/files.hpp"
#include "host/robot/multibody.hpp"
#include "host/robot/robot.hpp"
#include "host/robot/xml_text.hpp"

namespace pvg {
namespace {

// <dynamics damping="" friction=""> of a joint, which robots in tasks do not have
void read_dynamics(const TiXmlElement& robot, const std::string& file, MultibodyJoint& joint) {
  for (const TiXmlElement* e = robot.FirstChildElement("joint"); e; e = e->NextSiblingElement("joint")) {
    const TiXmlElement* dynamics = e->FirstChildElement("dynamics");
    if (!dynamics || joint.joint.name != e->Attribute("name")) continue;
    const auto number = [&](const char* key, double& value) {
      const int result = dynamics->QueryDoubleAttribute(key, &value);
      if (result == TIXML_WRONG_TYPE || !(value >= 0 && value < 1e12))
        throw UsageError(file + ": joint '" + joint.joint.name + "' has a " + key +
                         " that is no number or negative; correct <dynamics>");
    };
    number("damping", joint.joint.damping);
    number("friction", joint.coulomb);
  }
}

}  // namespace

Multibody read_urdf_multibody(const std::filesystem::path& file) {
  const RobotModel robot = load_urdf(file);
  TiXmlDocument document;
  document.Parse(xml_with_end(read_whole_file(file).value_or("")).c_str());
  Multibody model;
  model.name = robot.name;
  std::vector<int> index(robot.links.size(), -1);  // of the body; of a link without mass that of the one that holds it
  std::vector<Pose> to_body(robot.links.size(), Pose::Identity());
  const auto add = [&](std::size_t l, const Pose& pose, MultibodyBody::Kind kind) {
    const RobotLink& link = robot.links[l];
    MultibodyBody body;
    body.name = link.name;
    body.kind = kind;
    body.pose = pose;
    body.mass = link.mass;
    body.center_of_mass = link.center_of_mass;
    body.inertia = link.inertia;
    if (!link.collision.points.empty()) {
      MultibodyShape& shape = body.shapes.emplace_back();
      shape.kind = MultibodyShape::Kind::link;
      shape.file = file;
      shape.link = link.name;
    }
    index[l] = int(model.bodies.size());
    model.bodies.push_back(body);
  };
  add(0, Pose::Identity(), MultibodyBody::Kind::fixed);
  for (const RobotJoint& joint : robot.joints) {
    const std::size_t parent = std::size_t(joint.parent), child = std::size_t(joint.child);
    const RobotLink& link = robot.links[child];
    const Pose frame = to_body[parent] * joint.origin;
    if (joint.type == Joint::Type::fixed && !(link.mass > 0)) {
      if (!link.collision.points.empty())
        throw UsageError(file.string() + ": link '" + link.name + "' has a shape but no mass; add <inertial>");
      index[child] = index[parent];
      to_body[child] = frame;
      continue;
    }
    const int holder = index[parent];
    MultibodyJoint added;
    added.joint.name = joint.name;
    added.joint.type = joint.type;
    added.joint.parent = holder;
    added.joint.parent_frame = frame;
    added.joint.axis = joint.axis;
    added.joint.lower = joint.lower;
    added.joint.upper = joint.upper;
    added.joint.initial = start_within(added.joint, 0);
    read_dynamics(*document.RootElement(), file.string(), added);
    add(child, model.bodies[std::size_t(holder)].pose * start_of_child(added.joint), MultibodyBody::Kind::moving);
    added.joint.child = index[child];
    model.joints.push_back(added);
  }
  for (const auto& [first, second] : robot.noncolliding)
    model.noncolliding.push_back({index[std::size_t(first)], index[std::size_t(second)]});
  return model;
}

}  // namespace pvg
