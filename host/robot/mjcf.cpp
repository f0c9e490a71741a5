// The tree of bodies of an MJCF file.
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <set>

#include "host/base/error.hpp"
#include "host/base/numbers.hpp"
#include "host/robot/mjcf_actuators.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
using mjcf::Element;

struct ReadBody {
  MultibodyBody body;
  int parent = -1;  // index; -1: the world
  std::vector<MultibodyJoint> joints;
  bool is_free = false;
  bool has_inertial = false;
  std::vector<mjcf::Geom> geoms;
  int n_children = 0;
  std::string place;
};

struct Reader {
  std::string file;
  mjcf::Defaults defaults;
  mjcf::Compiler compiler;
  mjcf::Meshes meshes;
  std::vector<ReadBody> bodies;  // parents before children
  std::set<std::string> joint_names;

  Element element(const TiXmlElement& xml, const std::string& child_class) const {
    const char* given = xml.Attribute("class");
    const auto found = defaults.find(given ? given : child_class);
    std::vector<const TiXmlElement*> inherited;
    if (found != defaults.end())
      for (const TiXmlElement* e : found->second)
        if (e->ValueStr() == xml.ValueStr() || (xml.ValueStr() == "freejoint" && e->ValueStr() == "joint"))
          inherited.push_back(e);
    const Element result(xml, inherited, file);
    if (found == defaults.end()) result.fail("has a class that no <default> has; correct it");
    return result;
  }

  void read_inertial(const Element& e, ReadBody& body) const;
  void read_joint(const Element& e, const Pose& in_parent, ReadBody& body);
  void read_children(const TiXmlElement& xml, int body, const Pose& offset, const std::string& child_class);
  void read_body(const TiXmlElement& xml, int parent, const Pose& offset, const std::string& child_class);
};

std::string checked_name(const Element& e, const std::string& otherwise) {
  const std::string name = e.text("name", otherwise);
  if (!is_identifier(name)) e.fail("has a name that " + std::string(IDENTIFIER_RULE));
  return name;
}

void Reader::read_inertial(const Element& e, ReadBody& body) const {
  const Pose pose = mjcf::read_pose(e, compiler);
  body.has_inertial = true;
  body.body.mass = e.number("mass", 0);
  body.body.center_of_mass = pose.translation();
  Mat3 inertia = e.vector("diaginertia", Vec3::Zero()).asDiagonal();
  if (e.has("fullinertia")) {
    const std::vector<double> m = e.numbers("fullinertia", std::vector<double>(6, 0.0), 6);
    inertia << m[0], m[3], m[4], m[3], m[1], m[5], m[4], m[5], m[2];
  }
  body.body.inertia = pose.linear() * inertia * pose.linear().transpose();
}

void Reader::read_joint(const Element& e, const Pose& in_parent, ReadBody& body) {
  if (e.xml().ValueStr() == "freejoint" || e.text("type") == "free") {
    if (body.parent >= 0) e.fail("is free, but its body lies in another one; move the body to <worldbody>");
    if (e.xml().ValueStr() == "joint") e.refuse_nonzero({"damping", "stiffness", "frictionloss", "armature"});
    body.is_free = true;
    return;
  }
  MultibodyJoint joint = mjcf::read_joint(e, compiler, in_parent);
  joint.joint.name = checked_name(e, body.body.name + "_joint");
  if (!joint_names.insert(joint.joint.name).second)
    e.fail("has the name `" + joint.joint.name + "`, which is there twice; rename one");
  body.joints.push_back(joint);
}

void Reader::read_body(const TiXmlElement& xml, int parent, const Pose& offset, const std::string& child_class) {
  const Element e(xml, {}, file);
  e.refuse_nonzero({"gravcomp"});
  if (e.flag("mocap", false)) e.fail("is mocap, which is not supported; take it out");
  const Pose in_parent = offset * mjcf::read_pose(e, compiler);
  const int index = int(bodies.size());
  ReadBody& body = bodies.emplace_back();
  body.place = e.place();
  body.parent = parent;
  body.body.name = checked_name(e, fmt::format("body_{}", index + 1));
  const Pose holder = parent < 0 ? Pose::Identity() : bodies[std::size_t(parent)].body.pose;
  body.body.pose = holder * in_parent;
  if (parent >= 0) ++bodies[std::size_t(parent)].n_children;
  const std::string inner = e.text("childclass", child_class);
  for (const TiXmlElement* j = xml.FirstChildElement(); j; j = j->NextSiblingElement())
    if (j->ValueStr() == "joint" || j->ValueStr() == "freejoint")
      read_joint(element(*j, inner), in_parent, bodies[std::size_t(index)]);
  ReadBody& read = bodies[std::size_t(index)];
  if (read.joints.size() == 1) read.body.pose = holder * start_of_child(read.joints[0].joint);
  read_children(xml, index, Pose::Identity(), inner);
}

// offset: of a <frame>, in the body
void Reader::read_children(const TiXmlElement& xml, int body, const Pose& offset, const std::string& child_class) {
  for (const TiXmlElement* child = xml.FirstChildElement(); child; child = child->NextSiblingElement()) {
    const std::string& kind = child->ValueStr();
    if (kind == "body") {
      read_body(*child, body, offset, child_class);
    } else if (kind == "frame") {
      const Element e(*child, {}, file);
      read_children(*child, body, offset * mjcf::read_pose(e, compiler), e.text("childclass", child_class));
    } else if (kind == "geom") {
      const Element e = element(*child, child_class);
      const bool has_inertial = xml.FirstChildElement("inertial") && compiler.inertia_from_geoms != "true";
      mjcf::Geom geom =
          mjcf::read_geom(e, compiler, meshes, body >= 0 && !has_inertial && compiler.inertia_from_geoms != "false");
      geom.shape.pose = offset * geom.shape.pose;
      geom.center = offset * geom.center;
      geom.inertia = offset.linear() * geom.inertia * offset.linear().transpose();
      if (body >= 0 && geom.is_plane)
        e.fail("is a plane of a body; planes belong to the world: move it to <worldbody>");
      if (body >= 0) {
        bodies[std::size_t(body)].geoms.push_back(geom);
        continue;
      }
      ReadBody& fixed = bodies.emplace_back();  // what belongs to the world
      fixed.place = e.place();
      fixed.body.name = checked_name(e, fmt::format("geom_{}", bodies.size()));
      fixed.geoms.push_back(geom);
    } else if (kind == "inertial") {
      if (body >= 0 && compiler.inertia_from_geoms != "true")
        read_inertial(Element(*child, {}, file), bodies[std::size_t(body)]);
    } else if (kind != "joint" && kind != "freejoint" && kind != "site" && kind != "camera" && kind != "light") {
      Element(*child, {}, file).fail("is not supported in a body; take it out");
    } else if ((kind == "joint" || kind == "freejoint") && xml.ValueStr() != "body") {
      Element(*child, {}, file).fail("lies outside of a body; move it into one");
    }
  }
}

// ---- from what was read to bodies, joints and pairs

bool collides(const mjcf::Geom& geom) { return geom.type_bits != 0 || geom.affinity_bits != 0; }

void add_geoms(ReadBody& read) {
  MultibodyBody& body = read.body;
  bool is_first = true;
  for (const mjcf::Geom& geom : read.geoms) {
    if (!collides(geom)) continue;
    body.friction = is_first ? geom.friction : std::max(body.friction, geom.friction);
    is_first = false;
    if (geom.is_plane) {
      body.kind = MultibodyBody::Kind::half_space;
      body.pose = geom.shape.pose;
    } else {
      body.shapes.push_back(geom.shape);
    }
  }
  if (read.has_inertial) return;
  for (const mjcf::Geom& geom : read.geoms) {
    body.mass += geom.mass;
    body.center_of_mass += geom.mass * geom.center;
  }
  if (!(body.mass > 0)) return;
  body.center_of_mass /= body.mass;
  for (const mjcf::Geom& geom : read.geoms) {  // Steiner's theorem
    const Vec3 arm = geom.center - body.center_of_mass;
    body.inertia += geom.inertia + geom.mass * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
  }
}

bool may_meet(const ReadBody& a, const ReadBody& b) {
  for (const mjcf::Geom& x : a.geoms)
    for (const mjcf::Geom& y : b.geoms)
      if ((x.type_bits & y.affinity_bits) || (y.type_bits & x.affinity_bits)) return true;
  return false;
}

struct Builder {
  const std::string& file;
  std::vector<ReadBody>& read;
  Multibody& model;
  std::vector<int> index;  // in the model; of a frame without mass that of the body that holds it
  std::vector<int> group;  // bodies without a joint between them: the first of them; -1: the world

  bool is_frame(const ReadBody& b) const {
    return b.joints.empty() && !b.is_free && b.parent >= 0 && !(b.body.mass > 0) && b.body.shapes.empty();
  }
  void add(int i);
  bool passes_through(int i, int j) const;
};

void Builder::add(int i) {
  ReadBody& b = read[std::size_t(i)];
  add_geoms(b);
  if (b.joints.size() > 1)
    throw UsageError(b.place + " has several joints; only one is supported: put a body with a small mass between them");
  const bool moves = !b.joints.empty() || b.is_free;
  const int parent_group = b.parent < 0 ? -1 : group[std::size_t(b.parent)];
  group[std::size_t(i)] = moves ? i : parent_group;
  if (is_frame(b)) {
    index[std::size_t(i)] = index[std::size_t(b.parent)];
    return;
  }
  index[std::size_t(i)] = int(model.bodies.size());
  if (group[std::size_t(i)] < 0) {
    if (b.body.kind == MultibodyBody::Kind::moving) b.body.kind = MultibodyBody::Kind::fixed;
    model.bodies.push_back(b.body);
    return;
  }
  const Vec3 moments = Eigen::SelfAdjointEigenSolver<Mat3>(b.body.inertia, Eigen::EigenvaluesOnly).eigenvalues();
  if (!(b.body.mass > 0) || !(moments[0] > 0))
    throw UsageError(b.place + " moves, but has no mass or no inertia; add <inertial>, or geoms with a mass");
  if (moments[2] > (moments[0] + moments[1]) * (1 + 1e-9))
    throw UsageError(b.place +
                     " has an inertia that no body can have: a moment above the sum of the two others; "
                     "correct <inertial>");
  model.bodies.push_back(b.body);
  if (b.is_free) return;
  MultibodyJoint joint;
  if (moves) {
    joint = b.joints[0];
  } else {
    joint.joint.type = Joint::Type::fixed;
    joint.joint.name = b.body.name + "_weld";
    joint.joint.parent_frame = read[std::size_t(b.parent)].body.pose.inverse() * b.body.pose;
  }
  // what does not move holds joints as the world does, and collides with what they carry
  joint.joint.parent = parent_group < 0 ? -1 : index[std::size_t(b.parent)];
  const Pose parent = b.parent < 0 ? Pose::Identity() : read[std::size_t(b.parent)].body.pose;
  if (parent_group < 0)
    joint.joint.parent_frame = parent * joint.joint.parent_frame;
  else
    joint.joint.parent_frame =
        model.bodies[std::size_t(joint.joint.parent)].pose.inverse() * parent * joint.joint.parent_frame;
  joint.joint.child = index[std::size_t(i)];
  model.joints.push_back(joint);
}

// MuJoCo: geoms of one group, and of a group and the one that carries it, pass through each other; not so of the world
bool Builder::passes_through(int i, int j) const {
  const int a = group[std::size_t(i)], b = group[std::size_t(j)];
  if (a == b) return true;
  const auto carrier = [&](int g) {
    return g < 0 || read[std::size_t(g)].parent < 0 ? -1 : group[std::size_t(read[std::size_t(g)].parent)];
  };
  if ((a >= 0 && b >= 0) && (carrier(a) == b || carrier(b) == a)) return true;
  return !may_meet(read[std::size_t(i)], read[std::size_t(j)]);
}

using Exclusions = std::set<std::pair<std::string, std::string>>;

Exclusions read_exclusions(const TiXmlElement& root, const std::string& file) {
  Exclusions pairs;
  for (const TiXmlElement* contact = root.FirstChildElement("contact"); contact;
       contact = contact->NextSiblingElement("contact"))
    for (const TiXmlElement* xml = contact->FirstChildElement(); xml; xml = xml->NextSiblingElement()) {
      const Element e(*xml, {}, file);
      if (xml->ValueStr() != "exclude") e.fail("of <contact> is not supported; use contype and conaffinity");
      pairs.insert(std::minmax(e.text("body1"), e.text("body2")));
    }
  return pairs;
}

void add_noncolliding(const Builder& builder, const Exclusions& exclusions) {
  const std::vector<ReadBody>& read = builder.read;
  for (int i = 0; i < int(read.size()); ++i)
    for (int j = 0; j < i; ++j) {
      const ReadBody &a = read[std::size_t(i)], &b = read[std::size_t(j)];
      const bool can_touch = (!a.body.shapes.empty() || a.body.kind == MultibodyBody::Kind::half_space) &&
                             (!b.body.shapes.empty() || b.body.kind == MultibodyBody::Kind::half_space);
      const bool stand = builder.group[std::size_t(i)] < 0 && builder.group[std::size_t(j)] < 0;
      const std::array<int, 2> pair = {builder.index[std::size_t(j)], builder.index[std::size_t(i)]};
      const bool is_jointed = std::any_of(builder.model.joints.begin(), builder.model.joints.end(), [&](const auto& m) {
        return m.joint.parent == pair[0] && m.joint.child == pair[1];
      });
      const bool is_excluded = exclusions.count(std::minmax(a.body.name, b.body.name)) > 0;
      if (can_touch && !stand && !is_jointed && (is_excluded || builder.passes_through(i, j)))
        builder.model.noncolliding.push_back(pair);
    }
}

void read_options(const TiXmlElement& root, const std::string& file, Multibody& model, bool& has_contact) {
  for (const TiXmlElement* xml = root.FirstChildElement("option"); xml; xml = xml->NextSiblingElement("option")) {
    const Element e(*xml, {}, file);
    e.refuse_nonzero({"wind", "density", "viscosity"});
    model.time_step = e.number("timestep", model.time_step);
    if (!(model.time_step >= 1e-6 && model.time_step <= 1)) e.fail("has a timestep outside of 1e-6 to 1 s; correct it");
    model.gravity = e.vector("gravity", model.gravity);
    for (const TiXmlElement* flags = xml->FirstChildElement("flag"); flags; flags = flags->NextSiblingElement("flag")) {
      const Element flag(*flags, {}, file);
      if (flag.text("gravity") == "disable") model.gravity = Vec3::Zero();
      if (flag.text("contact") == "disable") has_contact = false;
      for (const char* key : {"constraint", "frictionloss", "limit", "passive", "spring", "damper", "actuation"})
        if (flag.text(key) == "disable") flag.fail("disables " + std::string(key) + ", which is not supported");
    }
  }
}

// What changes the motion and cannot be said here; what only shows, measures or names may stand.
void refuse_rest(const TiXmlElement& root, const std::string& file) {
  const std::set<std::string> read = {"compiler", "option", "default",   "asset",  "worldbody", "contact", "actuator",
                                      "size",     "visual", "statistic", "custom", "keyframe",  "sensor"};
  for (const TiXmlElement* e = root.FirstChildElement(); e; e = e->NextSiblingElement())
    if (!read.count(e->ValueStr()) && e->FirstChildElement())
      Element(*e->FirstChildElement(), {}, file).fail("of <" + e->ValueStr() + "> is not supported; take it out");
}

}  // namespace

Multibody read_mjcf(const fs::path& path) {
  const mjcf::Document document(path);
  const TiXmlElement& root = document.root();
  Reader reader;
  reader.file = path.string();
  refuse_rest(root, reader.file);
  reader.defaults = mjcf::read_defaults(root, reader.file);
  reader.compiler = mjcf::read_compiler(root, path);
  reader.meshes = mjcf::read_meshes(root, reader.defaults, reader.compiler, reader.file);
  for (const TiXmlElement* e = root.FirstChildElement("worldbody"); e; e = e->NextSiblingElement("worldbody"))
    reader.read_children(*e, -1, Pose::Identity(), e->Attribute("childclass") ? e->Attribute("childclass") : "");

  Multibody model;
  bool has_contact = true;
  model.name = root.Attribute("model") ? root.Attribute("model") : path.stem().string();
  read_options(root, reader.file, model, has_contact);
  const std::size_t n = reader.bodies.size();
  Builder builder{reader.file, reader.bodies, model, std::vector<int>(n, -1), std::vector<int>(n, -1)};
  for (std::size_t i = 0; i < n; ++i) {
    if (!has_contact)
      for (mjcf::Geom& geom : reader.bodies[i].geoms) geom.type_bits = geom.affinity_bits = 0;
    builder.add(int(i));
  }
  if (model.bodies.empty()) throw UsageError(reader.file + " has no bodies; add one to <worldbody>");
  add_noncolliding(builder, read_exclusions(root, reader.file));
  mjcf::read_actuators(root, reader.defaults, reader.compiler, reader.file, model);
  return model;
}

}  // namespace pvg
