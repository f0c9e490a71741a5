#include "host/robot/mjcf_actuators.hpp"

#include <algorithm>
#include <cmath>

namespace pvg::mjcf {
namespace {

// half the width of a range around zero; 0: not limited
double symmetric_limit(const Element& element, const char* range, const char* limited, bool is_automatic) {
  const std::string said = element.text(limited, "auto");
  const bool holds = said == "true" || (said == "auto" && is_automatic && element.has(range));
  if (!holds) return 0;
  const std::vector<double> ends = element.numbers(range, {0, 0}, 2);
  if (!(ends[1] > 0) || std::abs(ends[0] + ends[1]) > 1e-9 * ends[1])
    element.fail("has a " + std::string(range) + " that is not [-a, a]; efforts are limited alike in both directions");
  return ends[1];
}

void lower_limit(double& limit, double other) {
  if (other > 0) limit = limit > 0 ? std::min(limit, other) : other;
}

// force = gain u + bias[0] + bias[1] length + bias[2] d(length)/dt, the bias only where it is affine
struct Law {
  double gain = 1;
  bool is_affine = false;
  std::vector<double> bias = std::vector<double>(10, 0.0);
  bool is_filtered = false;
  double time_constant = 1;  // of the control's first-order filter [s]

  // MuJoCo's shortcuts and <general> set the same numbers; what one leaves out stays
  void read(const Element& e) {
    const std::string kind = e.xml().ValueStr();
    if (kind == "general") return read_general(e);
    is_affine = kind != "motor";
    if (kind == "motor") {
      gain = 1;
    } else if (kind == "position") {
      e.refuse({"dampratio"});
      gain = e.number("kp", gain);
      bias[1] = -gain;
      if (e.has("kv")) bias[2] = -e.number("kv", 0);
      is_filtered = is_filtered || e.number("timeconst", 0) > 0;
      time_constant = e.number("timeconst", time_constant);
    } else {
      gain = e.number("kv", gain);
      bias[1] = 0;
      bias[2] = -gain;
    }
  }

  void read_general(const Element& e) {
    if (e.text("gaintype", "fixed") != "fixed") e.fail("has a gaintype that is not supported; use fixed");
    const std::string bias_type = e.text("biastype", is_affine ? "affine" : "none");
    if (bias_type != "affine" && bias_type != "none")
      e.fail("has a biastype that is not supported; use affine or none");
    const std::string dynamics = e.text("dyntype", is_filtered ? "filter" : "none");
    if (dynamics != "none" && dynamics != "filter" && dynamics != "filterexact")
      e.fail("has a dyntype that is not supported; use none, filter or filterexact");
    is_affine = bias_type == "affine";
    is_filtered = dynamics != "none";
    std::vector<double> numbers(10, 0.0);
    numbers[0] = gain;
    gain = e.numbers("gainprm", numbers, 1)[0];
    bias = e.numbers("biasprm", bias, 1);
    numbers[0] = time_constant;
    time_constant = e.numbers("dynprm", numbers, 1)[0];
  }
};

bool is_close(double a, double b) { return std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b)); }

void set_drive(const Element& e, const Law& law, const Compiler& compiler, MultibodyJoint& driven) {
  Drive& drive = driven.joint.drive;
  drive = {};
  drive.compensates_gravity = false;
  const double gear = std::abs(e.numbers("gear", {1, 0, 0, 0, 0, 0}, 1)[0]);
  if (!(gear > 0)) e.fail("has a gear of zero; take the actuator out");
  drive.effort_limit = gear * symmetric_limit(e, "forcerange", "forcelimited", compiler.has_automatic_limits);
  driven.actuator_lag = law.is_filtered ? law.time_constant : 0;
  const std::vector<double> bias = law.is_affine ? law.bias : std::vector<double>{0, 0, 0};
  if (bias[0] != 0) e.fail("has a constant force in biasprm, which is not supported; make it zero");
  if (bias[1] != 0) {
    if (!is_close(law.gain, -bias[1])) e.fail("has kp in gainprm that is not that in biasprm; make them alike");
    drive.mode = Drive::Mode::position;
    drive.stiffness = law.gain * gear * gear;
    drive.damping = -bias[2] * gear * gear;
  } else if (bias[2] != 0) {
    if (!is_close(law.gain, -bias[2])) e.fail("has kv in gainprm that is not that in biasprm; make them alike");
    drive.mode = Drive::Mode::velocity;
    drive.damping = law.gain * gear * gear;
  } else {
    drive.mode = Drive::Mode::torque;
    lower_limit(drive.effort_limit, gear * std::abs(law.gain) *
                                        symmetric_limit(e, "ctrlrange", "ctrllimited", compiler.has_automatic_limits));
  }
  if (drive.stiffness < 0 || drive.damping < 0) e.fail("pushes away from its target; its gains must not be negative");
}

}  // namespace

MultibodyJoint read_joint(const Element& e, const Compiler& compiler, const Pose& frame) {
  MultibodyJoint read;
  Joint& joint = read.joint;
  const std::string type = e.text("type", "hinge");
  const bool is_hinge = type == "hinge", has_coordinate = is_hinge || type == "slide";
  if (!has_coordinate && type != "ball") e.fail("is of the type " + type + "; use hinge, slide, ball or free");
  joint.type = is_hinge ? Joint::Type::revolute : has_coordinate ? Joint::Type::prismatic : Joint::Type::spherical;
  joint.child_frame.translation() = e.vector("pos", Vec3::Zero());
  joint.parent_frame = frame * joint.child_frame;
  e.refuse_nonzero({"springdamper"});
  if (e.flag("actuatorgravcomp", false)) e.fail("has actuatorgravcomp, which is not supported; take it out");
  if (!has_coordinate) {
    e.refuse_nonzero({"damping", "stiffness", "frictionloss", "armature"});
    e.refuse({"range"});
    return read;
  }
  const auto coordinate = [&](double number) { return is_hinge ? compiler.angle(number) : number; };
  const Vec3 axis = e.vector("axis", Vec3::UnitZ());
  if (!(axis.norm() > 1e-9)) e.fail("has an axis without direction; give another one");
  joint.axis = axis.normalized();
  joint.initial = coordinate(e.number("ref", 0));
  // at q = 0 the frame is turned or moved back by `ref`
  if (is_hinge)
    joint.parent_frame.linear() =
        joint.parent_frame.linear() * Eigen::AngleAxisd(-joint.initial, joint.axis).toRotationMatrix();
  else
    joint.parent_frame.translation() -= joint.parent_frame.linear() * joint.axis * joint.initial;
  const std::string limited = e.text("limited", "auto");
  if (limited == "true" || (limited == "auto" && compiler.has_automatic_limits && e.has("range"))) {
    const std::vector<double> range = e.numbers("range", {0, 0}, 2);
    if (!(range[0] < range[1])) e.fail("has a range that is not [lowest, highest]; correct it");
    joint.lower = coordinate(range[0]);
    joint.upper = coordinate(range[1]);
  }
  joint.initial = start_within(joint, joint.initial);
  joint.damping = e.number("damping", 0);
  read.armature = e.number("armature", 0);
  read.coulomb = e.number("frictionloss", 0);
  read.spring = e.number("stiffness", 0);
  for (const double number : {joint.damping, read.armature, read.coulomb, read.spring})
    if (number < 0) e.fail("has a negative damping, armature, frictionloss or stiffness; correct it");
  read.spring_preload = read.spring * coordinate(e.number("springref", 0));
  joint.drive.effort_limit =
      symmetric_limit(e, "actuatorfrcrange", "actuatorfrclimited", compiler.has_automatic_limits);
  return read;
}

void read_actuators(const TiXmlElement& root, const Defaults& defaults, const Compiler& compiler,
                    const std::string& file, Multibody& model) {
  for (const TiXmlElement* group = root.FirstChildElement("actuator"); group;
       group = group->NextSiblingElement("actuator"))
    for (const TiXmlElement* xml = group->FirstChildElement(); xml; xml = xml->NextSiblingElement()) {
      const auto is_law = [](const TiXmlElement& e) {
        const std::string& kind = e.ValueStr();
        return kind == "motor" || kind == "position" || kind == "velocity" || kind == "general";
      };
      const char* given = xml->Attribute("class");
      const auto inherits = defaults.find(given ? given : "");
      const Element alone(*xml, {}, file);
      if (!is_law(*xml)) alone.fail("is not supported; use motor, position, velocity or general");
      if (inherits == defaults.end()) alone.fail("has a class that no <default> has; correct it");
      std::vector<const TiXmlElement*> inherited;
      Law law;
      for (const TiXmlElement* e : inherits->second)
        if (is_law(*e)) {
          inherited.push_back(e);
          law.read(Element(*e, {}, file));
        }
      law.read(alone);
      const Element element(*xml, inherited, file);
      for (const char* key : {"tendon", "site", "body", "cranksite", "slidersite", "jointinparent"})
        if (element.has(key)) element.fail("acts on a " + std::string(key) + "; only those of joints are supported");
      element.refuse_nonzero({"damping", "armature", "delay"});
      const std::string name = element.text("joint");
      const auto joint = std::find_if(model.joints.begin(), model.joints.end(),
                                      [&](const MultibodyJoint& j) { return j.joint.name == name; });
      if (joint == model.joints.end() || joint->joint.type == Joint::Type::spherical)
        element.fail("acts on the joint `" + name + "`, which is no hinge or slide; correct it");
      if (is_driven(joint->joint))
        element.fail("is the second actuator of the joint `" + name + "`; only one is supported: join their gains");
      const double of_joint = joint->joint.drive.effort_limit;
      set_drive(element, law, compiler, *joint);
      lower_limit(joint->joint.drive.effort_limit, of_joint);
    }
  for (MultibodyJoint& joint : model.joints)
    if (!is_driven(joint.joint)) joint.joint.drive = {};
}

}  // namespace pvg::mjcf
