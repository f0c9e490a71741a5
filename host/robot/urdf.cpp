#include <console_bridge/console.h>
#include <tinyxml.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

#include "host/base/error.hpp"
#include "host/base/files.hpp"
#include "host/base/numbers.hpp"
#include "host/base/outputs.hpp"
#include "host/geometry/primitive_visuals.hpp"
#include "host/pictures/srgb.hpp"
#include "host/robot/link_mesh.hpp"
#include "host/robot/robot.hpp"
#include "host/robot/xml_text.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

// what urdfdom has to say goes into our message instead of onto the terminal
class CollectLog : public console_bridge::OutputHandler {
 public:
  CollectLog() { console_bridge::useOutputHandler(this); }
  ~CollectLog() override { console_bridge::restorePreviousOutputHandler(); }
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && first_.empty()) first_ = text;
  }
  const std::string& first() const { return first_; }

 private:
  std::string first_;
};

// ---- what is checked in the XML itself, because urdfdom would say it less well or not at all

void demand_identifier(const std::string& name, const std::string& owner) {
  if (!is_identifier(name)) throw UsageError(owner + " '" + name.substr(0, 80) + "': its name " + IDENTIFIER_RULE);
}

std::string attribute(const TiXmlElement& element, const char* name, const std::string& owner) {
  const char* text = element.Attribute(name);
  if (!text) throw UsageError(owner + ": <" + element.ValueStr() + "> lacks the attribute " + name + "; add it");
  return text;
}

double number(const std::string& text, const std::string& what) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || *end != 0 || !std::isfinite(value))
    throw UsageError(what + " is '" + text + "'; give a finite number");
  return value;
}

void check_joint(const TiXmlElement& joint, const std::set<std::string>& links, std::set<std::string>& children,
                 const std::string& file) {
  const std::string owner = file + ": joint '" + attribute(joint, "name", file) + "'";
  const std::string type = attribute(joint, "type", owner);
  if (type != "fixed" && type != "revolute" && type != "prismatic" && type != "continuous")
    throw UsageError(owner + " has the type '" + type + "'; use fixed, revolute, continuous or prismatic");
  if (joint.FirstChildElement("mimic"))
    throw UsageError(owner + " mimics another joint, which is not supported; drive each joint on its own");
  for (const char* end : {"parent", "child"}) {
    const TiXmlElement* element = joint.FirstChildElement(end);
    if (!element) throw UsageError(owner + " has no <" + end + ">; add it");
    const std::string link = attribute(*element, "link", owner);
    if (!links.count(link))
      throw UsageError(owner + " names the " + end + " link '" + link + "', which does not exist; correct the name");
    if (std::string(end) == "child" && !children.insert(link).second)
      throw UsageError(owner + " is the second joint whose child is link '" + link +
                       "'; a robot must be a tree, so cut the loop");
  }
  if (type == "fixed") return;
  const TiXmlElement* limit = joint.FirstChildElement("limit");
  const bool has_ends = type != "continuous";
  const char* const wanted = has_ends ? "lower, upper, velocity and effort" : "velocity and effort";
  if (!limit) throw UsageError(owner + " has no limits; add <limit> with " + wanted);
  for (const char* name : {"lower", "upper", "velocity", "effort"}) {
    if (!has_ends && (std::string(name) == "lower" || std::string(name) == "upper")) continue;
    if (!limit->Attribute(name))
      throw UsageError(owner + " has no limit '" + name + "'; give <limit> all of " + wanted);
    number(limit->Attribute(name), owner + ": limit '" + name + "'");
  }
}

void check_xml(const TiXmlElement& robot, const std::string& file) {
  std::set<std::string> links, children, joints;
  for (const TiXmlElement* e = robot.FirstChildElement("link"); e; e = e->NextSiblingElement("link")) {
    demand_identifier(attribute(*e, "name", file), file + ": link");
    if (const std::string name = attribute(*e, "name", file); !links.insert(name).second)
      throw UsageError(file + ": link '" + name + "' is there twice; rename one");
  }
  if (links.empty()) throw UsageError(file + " has no links; add at least one <link>");
  for (const TiXmlElement* e = robot.FirstChildElement("joint"); e; e = e->NextSiblingElement("joint")) {
    check_joint(*e, links, children, file);
    demand_identifier(e->Attribute("name"), file + ": joint");
    if (const std::string name = e->Attribute("name"); !joints.insert(name).second)
      throw UsageError(file + ": joint '" + name + "' is there twice; rename one");
  }
  std::vector<std::string> roots;
  std::set_difference(links.begin(), links.end(), children.begin(), children.end(), std::back_inserter(roots));
  if (roots.empty())
    throw UsageError(file + ": every link is the child of a joint, so there is a loop and no base; cut the loop");
  if (roots.size() > 1)
    throw UsageError(file + ": links '" + roots[0] + "' and '" + roots[1] +
                     "' are not joined; add a joint between them");
}

// ---- conversion

Vec3 vector(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

Pose pose(const urdf::Pose& p) {
  Pose result = Pose::Identity();
  result.linear() = Eigen::Quaterniond(p.rotation.w, p.rotation.x, p.rotation.y, p.rotation.z).toRotationMatrix();
  result.translation() = vector(p.position);
  return result;
}

Vec3f linear_color(const Vec3f& c) { return {srgb_to_linear(c[0]), srgb_to_linear(c[1]), srgb_to_linear(c[2])}; }

fs::path find_mesh(const std::string& name, const fs::path& folder, const std::string& owner) {
  if (name.starts_with("file://")) return name.substr(7);
  if (!name.starts_with("package://")) return fs::path(name).is_absolute() ? fs::path(name) : folder / name;
  const std::string with_package = name.substr(10);
  const std::size_t slash = with_package.find('/');
  const std::string within = slash == std::string::npos ? with_package : with_package.substr(slash + 1);
  for (fs::path above = fs::absolute(folder);; above = above.parent_path()) {
    for (const std::string& tail : {with_package, within})
      if (is_file(above / tail)) return above / tail;
    if (above == above.root_path()) break;
  }
  throw UsageError(owner + ": mesh " + name + " was found neither in " + fs::absolute(folder).string() +
                   " nor in a folder above it; put the package there or correct the path");
}

// the parts of one <geometry>, in the link's frame
std::vector<MeshPart> shape(const urdf::Geometry& geometry, const Pose& origin, const fs::path& folder,
                            const std::string& owner) {
  std::vector<MeshPart> parts;
  if (geometry.type == urdf::Geometry::MESH) {
    const auto& mesh = static_cast<const urdf::Mesh&>(geometry);
    parts = load_mesh_parts(find_mesh(mesh.filename, folder, owner), vector(mesh.scale), owner);
  } else if (geometry.type == urdf::Geometry::BOX) {
    parts.push_back({box_visual(vector(static_cast<const urdf::Box&>(geometry).dim))});
  } else if (geometry.type == urdf::Geometry::CYLINDER) {
    const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
    parts.push_back({cylinder_visual(cylinder.radius, cylinder.length)});
  } else {
    parts.push_back({sphere_visual(static_cast<const urdf::Sphere&>(geometry).radius)});
  }
  for (MeshPart& part : parts) part.mesh = moved(part.mesh, origin);
  return parts;
}

std::string shape_name(const urdf::Geometry& geometry) {
  if (geometry.type == urdf::Geometry::MESH) return fs::path(static_cast<const urdf::Mesh&>(geometry).filename).stem();
  return geometry.type == urdf::Geometry::BOX        ? "box"
         : geometry.type == urdf::Geometry::CYLINDER ? "cylinder"
                                                     : "sphere";
}

void read_inertial(RobotLink& link, const urdf::Inertial& inertial, const std::string& owner) {
  const Pose origin = pose(inertial.origin);
  Mat3 inertia;
  inertia << inertial.ixx, inertial.ixy, inertial.ixz, inertial.ixy, inertial.iyy, inertial.iyz, inertial.ixz,
      inertial.iyz, inertial.izz;
  if (!std::isfinite(inertial.mass) || inertial.mass <= 0)
    throw UsageError(owner + " has a mass that is not a positive number; correct <mass>, or leave <inertial> out");
  if (!inertia.allFinite() || !origin.matrix().allFinite())
    throw UsageError(owner + " has an inertia that is not a finite number; correct <inertial>");
  // principal moments of a real body are positive, and none exceeds the sum of the other two
  const Vec3 moments = Eigen::SelfAdjointEigenSolver<Mat3>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
  if (moments[0] <= 0 || moments[2] > (moments[0] + moments[1]) * (1 + 1e-9))
    throw UsageError(owner + " has an inertia that no body can have (principal moments " + std::to_string(moments[0]) +
                     ", " + std::to_string(moments[1]) + ", " + std::to_string(moments[2]) +
                     " kg m^2: all must be positive, none above the sum of the others); correct <inertia>");
  link.mass = inertial.mass;
  link.center_of_mass = origin.translation();
  link.inertia = origin.linear() * inertia * origin.linear().transpose();
}

RobotLink convert_link(const urdf::Link& link, const fs::path& file) {
  const std::string owner = file.string() + ": link '" + link.name + "'";
  RobotLink result;
  result.name = link.name;
  if (link.inertial) read_inertial(result, *link.inertial, owner);
  for (const auto& collision : link.collision_array)
    for (const MeshPart& part : shape(*collision->geometry, pose(collision->origin), file.parent_path(), owner))
      add_to_collision(result.collision, part.mesh);
  for (const auto& visual : link.visual_array)
    for (const MeshPart& part : shape(*visual->geometry, pose(visual->origin), file.parent_path(), owner)) {
      const auto& m = visual->material;
      const Vec3f color = m ? Vec3f(m->color.r, m->color.g, m->color.b) : part.color;
      result.visuals.push_back({shape_name(*visual->geometry), part.mesh, visual->material_name, linear_color(color)});
    }
  return result;
}

void check_limits(const RobotJoint& joint, const std::string& owner) {
  if (joint.lower > joint.upper) throw UsageError(owner + " has its lower limit above its upper one; exchange them");
  if (joint.velocity <= 0 || joint.effort <= 0)
    throw UsageError(owner + " has a limit of velocity or effort that is not positive; correct <limit>");
}

RobotJoint convert_joint(const urdf::Joint& joint, const TiXmlElement& xml, const std::string& file) {
  const std::string owner = file + ": joint '" + joint.name + "'";
  RobotJoint result;
  result.name = joint.name;
  result.origin = pose(joint.parent_to_joint_origin_transform);
  if (!result.origin.matrix().allFinite())
    throw UsageError(owner + " has an origin that is not a finite number; correct <origin>");
  if (joint.type == urdf::Joint::FIXED) return result;
  result.type = joint.type == urdf::Joint::PRISMATIC ? Joint::Type::prismatic : Joint::Type::revolute;
  result.axis = vector(joint.axis);
  if (!(result.axis.norm() > 1e-9) || !result.axis.allFinite())
    throw UsageError(owner + " has an axis without direction; give three numbers that are not all zero");
  result.axis.normalize();
  const TiXmlElement& limit = *xml.FirstChildElement("limit");
  const auto limit_of = [&](const char* name) {
    return limit.Attribute(name) ? number(limit.Attribute(name), owner + ": limit '" + name + "'") : 0.0;
  };
  if (joint.type != urdf::Joint::CONTINUOUS) {
    result.lower = limit_of("lower");
    result.upper = limit_of("upper");
  }
  result.velocity = limit_of("velocity");
  result.effort = limit_of("effort");
  result.acceleration = limit_of("acceleration");
  result.jerk = limit_of("jerk");
  if (const TiXmlElement* e = xml.FirstChildElement("velocity_envelope")) {
    const auto of = [&](const char* name) { return number(attribute(*e, name, owner), owner + ": " + name); };
    result.envelope = VelocityEnvelope{of("offset"), of("slope"), of("upper"), of("lower")};
  }
  check_limits(result, owner);
  return result;
}

std::string read_text(const fs::path& file) {
  const std::optional<std::string> text = read_whole_file(file);
  if (!text) throw UsageError(file.string() + " does not exist or cannot be read; correct the path");
  return *text;
}

using XmlJoints = std::map<std::string, const TiXmlElement*>;

// depth first, parents before children, children in the order of their names: the same for every run
void add_link(RobotModel& model, const urdf::Link& link, const XmlJoints& xml, const fs::path& file) {
  const int index = int(model.links.size());
  model.links.push_back(convert_link(link, file));
  for (const auto& joint : link.child_joints) {
    const auto child = std::find_if(link.child_links.begin(), link.child_links.end(),
                                    [&](const auto& l) { return l->name == joint->child_link_name; });
    RobotJoint converted = convert_joint(*joint, *xml.at(joint->name), file.string());
    converted.parent = index;
    converted.child = int(model.links.size());
    if (converted.type != Joint::Type::fixed) model.actuated.push_back(int(model.joints.size()));
    model.joints.push_back(converted);
    add_link(model, **child, xml, file);
  }
}

void read_noncolliding(RobotModel& model, const TiXmlElement& robot, const std::string& file) {
  for (const TiXmlElement* e = robot.FirstChildElement("disable_collisions"); e;
       e = e->NextSiblingElement("disable_collisions")) {
    std::array<int, 2> pair;
    for (int k = 0; k < 2; ++k) {
      const std::string name = attribute(*e, k == 0 ? "link1" : "link2", file);
      const auto found = std::find_if(model.links.begin(), model.links.end(), [&](auto& l) { return l.name == name; });
      if (found == model.links.end())
        throw UsageError(file + ": <disable_collisions> names the link '" + name +
                         "', which does not exist; correct it");
      pair[k] = int(found - model.links.begin());
    }
    model.noncolliding.push_back(pair);
  }
}

}  // namespace

int RobotModel::link(const std::string& link_name) const {
  for (std::size_t i = 0; i < links.size(); ++i)
    if (links[i].name == link_name) return int(i);
  throw UsageError("robot '" + name + "' has no link '" + link_name + "'; correct the name");
}

RobotModel load_urdf(const fs::path& file) {
  const std::string text = xml_with_end(read_text(file));
  check_xml_depth(text, file.string());
  TiXmlDocument document;
  document.Parse(text.c_str());
  if (document.Error())
    throw UsageError(file.string() + ", line " + std::to_string(document.ErrorRow()) + " is no valid XML (" +
                     document.ErrorDesc() + "); correct it");
  const TiXmlElement* robot = document.FirstChildElement("robot");
  if (!robot) throw UsageError(file.string() + " has no <robot>; give a URDF file");
  check_xml(*robot, file.string());
  const CollectLog log;
  urdf::ModelInterfaceSharedPtr parsed;
  try {
    parsed = urdf::parseURDF(text);
  } catch (const std::exception& error) {  // of a number that it cannot read
    throw UsageError(file.string() + " was refused by the URDF parser (" + error.what() + "); correct it");
  }
  if (!parsed) throw UsageError(file.string() + " was refused by the URDF parser (" + log.first() + "); correct it");

  RobotModel model;
  model.name = parsed->getName();
  XmlJoints joints;
  for (const TiXmlElement* e = robot->FirstChildElement("joint"); e; e = e->NextSiblingElement("joint"))
    joints[e->Attribute("name")] = e;
  add_link(model, *parsed->getRoot(), joints, file);
  read_noncolliding(model, *robot, file.string());
  for (const RobotJoint& joint : model.joints)
    if (joint.type != Joint::Type::fixed && model.links[joint.child].mass == 0)
      throw UsageError(file.string() + ": link '" + model.links[joint.child].name + "' is moved by joint '" +
                       joint.name + "' but has no mass; add <inertial>");
  return model;
}

}  // namespace pvg
