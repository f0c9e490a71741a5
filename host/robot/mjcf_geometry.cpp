#include "host/robot/mjcf_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/base/outputs.hpp"
#include "host/formats/mesh_files.hpp"
#include "host/geometry/mass_properties.hpp"

namespace pvg::mjcf {
namespace {

namespace fs = std::filesystem;
using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Kind = MultibodyShape::Kind;
constexpr double PI = std::numbers::pi;

Mat3 euler_rotation(const Element& element, const Compiler& compiler) {
  const Vec3 angles = element.vector("euler", Vec3::Zero());
  Mat3 rotation = Mat3::Identity();
  for (int i = 0; i < 3; ++i) {
    const char axis = compiler.euler_sequence[std::size_t(i)];
    const bool is_fixed = axis < 'a';  // upper case: about the fixed axes
    const Mat3 turn = AngleAxisd(compiler.angle(angles[i]), Vec3::Unit((axis | 0x20) - 'x')).toRotationMatrix();
    rotation = is_fixed ? Mat3(turn * rotation) : Mat3(rotation * turn);
  }
  return rotation;
}

Vec3 direction(const Element& element, const char* key, const Vec3& v) {
  if (!(v.norm() > 1e-12)) element.fail("has " + std::string(key) + " without a direction; give another one");
  return v.normalized();
}

Mat3 read_rotation(const Element& element, const Compiler& compiler) {
  if (element.has("quat")) {
    const std::vector<double> q = element.numbers("quat", {1, 0, 0, 0}, 4);
    const Quaterniond rotation(q[0], q[1], q[2], q[3]);
    if (!(rotation.norm() > 1e-12)) element.fail("has quat=\"0 0 0 0\"; give a rotation");
    return rotation.normalized().toRotationMatrix();
  }
  if (element.has("euler")) return euler_rotation(element, compiler);
  if (element.has("axisangle")) {
    const std::vector<double> a = element.numbers("axisangle", {0, 0, 1, 0}, 4);
    return AngleAxisd(compiler.angle(a[3]), direction(element, "axisangle", Vec3(a[0], a[1], a[2]))).toRotationMatrix();
  }
  if (element.has("xyaxes")) {
    const std::vector<double> a = element.numbers("xyaxes", {1, 0, 0, 0, 1, 0}, 6);
    Mat3 rotation;
    const Vec3 x = direction(element, "xyaxes", Vec3(a[0], a[1], a[2])), y(a[3], a[4], a[5]);
    rotation.col(0) = x;
    rotation.col(1) = direction(element, "xyaxes", y - x.dot(y) * x);
    rotation.col(2) = x.cross(rotation.col(1));
    return rotation;
  }
  if (!element.has("zaxis")) return Mat3::Identity();
  const Vec3 z = direction(element, "zaxis", element.vector("zaxis", Vec3::UnitZ()));
  return Quaterniond::FromTwoVectors(Vec3::UnitZ(), z).toRotationMatrix();
}

// `fromto`: the shape's z axis runs between two points
void read_ends(const Element& element, Geom& geom) {
  const std::vector<double> ends = element.numbers("fromto", std::vector<double>(6, 0.0), 6);
  const Vec3 from(ends[0], ends[1], ends[2]), to(ends[3], ends[4], ends[5]);
  MultibodyShape& shape = geom.shape;
  const double half = (from - to).norm() / 2;
  const Vec3 z = direction(element, "fromto", from - to);
  shape.pose.translation() = (from + to) / 2;
  shape.pose.linear() = Quaterniond::FromTwoVectors(Vec3::UnitZ(), z).toRotationMatrix();
  if (shape.kind == Kind::capsule || shape.kind == Kind::cylinder)
    shape.size[1] = half;
  else if (shape.kind == Kind::box || shape.kind == Kind::ellipsoid)
    shape.size = Vec3(shape.size[0], shape.size[0], half);
  else
    element.fail("has fromto, which only a capsule, cylinder, ellipsoid or box may have; give pos and size");
}

// Of the shape filled with `density` 1 [m^3, m^5], about its centre.
MassProperties filled(const MultibodyShape& shape) {
  const Vec3& s = shape.size;
  MassProperties p;
  const auto set = [&](double mass, const Vec3& moments_per_mass) {
    p.mass = p.volume = mass;
    p.inertia = (mass * moments_per_mass).asDiagonal();
  };
  const double r2 = s[0] * s[0], length = 2 * s[1];
  switch (shape.kind) {
    case Kind::box: {
      const Vec3 q = s.cwiseProduct(s);
      set(8 * s.prod(), Vec3(q[1] + q[2], q[0] + q[2], q[0] + q[1]) / 3);
      break;
    }
    case Kind::ellipsoid: {
      const Vec3 q = s.cwiseProduct(s);
      set(4 * PI / 3 * s.prod(), Vec3(q[1] + q[2], q[0] + q[2], q[0] + q[1]) / 5);
      break;
    }
    case Kind::sphere:
      set(4 * PI / 3 * r2 * s[0], Vec3::Constant(0.4 * r2));
      break;
    case Kind::cylinder: {
      const double across = (3 * r2 + length * length) / 12;
      set(PI * r2 * length, Vec3(across, across, r2 / 2));
      break;
    }
    case Kind::capsule: {  // a cylinder and two half balls, whose centres are 3/8 of the radius off their flat sides
      const double tube = PI * r2 * length, ball = 4 * PI / 3 * r2 * s[0];
      const double across =
          tube * (3 * r2 + length * length) / 12 + ball * (0.4 * r2 + length * length / 4 + 3 * length * s[0] / 8);
      const double along = tube * r2 / 2 + ball * 0.4 * r2;
      set(tube + ball, Vec3(across, across, along) / (tube + ball));
      break;
    }
    case Kind::mesh: {
      TriangleMesh mesh = read_closed_surface(shape.file);
      for (Vec3& point : mesh.points) point *= shape.scale;
      return mass_properties(mesh, 1);
    }
    case Kind::link:
      break;
  }
  return p;
}

void read_mass(const Element& element, Geom& geom) {
  const bool has_mass = element.has("mass");
  const double given = has_mass ? element.number("mass", 0) : element.number("density", 1000);
  if (given < 0) element.fail("has a negative mass or density; correct it");
  if (given == 0) return;
  const MassProperties p = filled(geom.shape);
  if (!(p.volume > 0)) element.fail("has a size of zero; give `size`");
  const double density = has_mass ? given / p.volume : given;
  const Mat3 rotation = geom.shape.pose.linear();
  geom.mass = density * p.volume;
  geom.center = geom.shape.pose * p.center;
  geom.inertia = density * rotation * p.inertia * rotation.transpose();
}

}  // namespace

double Compiler::angle(double number) const { return counts_degrees ? number * PI / 180 : number; }

Compiler read_compiler(const TiXmlElement& root, const fs::path& file) {
  Compiler compiler;
  compiler.mesh_folder = file.parent_path();
  for (const TiXmlElement* e = root.FirstChildElement("compiler"); e; e = e->NextSiblingElement("compiler")) {
    const Element element(*e, {}, file.string());
    element.refuse_nonzero({"boundmass", "boundinertia"});
    if (element.number("settotalmass", -1) > 0) element.fail("has settotalmass, which is not supported; take it out");
    if (element.text("coordinate", "local") != "local")
      element.fail("has coordinates that are not local; convert them");
    if (element.flag("balanceinertia", false)) element.fail("has balanceinertia, which is not supported; take it out");
    const std::string angle = element.text("angle", compiler.counts_degrees ? "degree" : "radian");
    if (angle != "degree" && angle != "radian") element.fail("has angle=\"" + angle + "\"; write degree or radian");
    compiler.counts_degrees = angle == "degree";
    compiler.has_automatic_limits = element.flag("autolimits", compiler.has_automatic_limits);
    compiler.euler_sequence = element.text("eulerseq", compiler.euler_sequence);
    if (compiler.euler_sequence.size() != 3 || compiler.euler_sequence.find_first_not_of("xyzXYZ") != std::string::npos)
      element.fail("has an eulerseq that is not three of x, y, z, X, Y, Z; correct it");
    compiler.inertia_from_geoms = element.text("inertiafromgeom", compiler.inertia_from_geoms);
    for (const char* key : {"assetdir", "meshdir"})
      if (element.has(key)) compiler.mesh_folder = file.parent_path() / element.text(key);
  }
  return compiler;
}

Pose read_pose(const Element& element, const Compiler& compiler) {
  Pose pose = Pose::Identity();
  pose.translation() = element.vector("pos", Vec3::Zero());
  pose.linear() = read_rotation(element, compiler);
  return pose;
}

Meshes read_meshes(const TiXmlElement& root, const Defaults& defaults, const Compiler& compiler,
                   const std::string& file) {
  Meshes meshes;
  for (const TiXmlElement* asset = root.FirstChildElement("asset"); asset; asset = asset->NextSiblingElement("asset"))
    for (const TiXmlElement* e = asset->FirstChildElement("mesh"); e; e = e->NextSiblingElement("mesh")) {
      const char* given = e->Attribute("class");
      const auto chain = defaults.find(given ? given : "");
      if (chain == defaults.end()) Element(*e, {}, file).fail("has a class that no <default> has; correct it");
      std::vector<const TiXmlElement*> inherited;
      for (const TiXmlElement* d : chain->second)
        if (d->ValueStr() == "mesh") inherited.push_back(d);
      const Element element(*e, inherited, file);
      if (!element.has("file")) continue;  // its geoms are refused
      const fs::path mesh = compiler.mesh_folder / element.text("file");
      const Vec3 scale = element.vector("scale", Vec3::Ones());
      if (!(scale[0] > 0) || scale[1] != scale[0] || scale[2] != scale[0])
        element.fail("has a scale that differs between the axes or mirrors; scale the file itself");
      element.refuse({"refpos", "refquat"});
      meshes[element.text("name", mesh.stem().string())] = {mesh, scale[0]};
    }
  return meshes;
}

Geom read_geom(const Element& element, const Compiler& compiler, const Meshes& meshes, bool has_mass) {
  Geom geom;
  MultibodyShape& shape = geom.shape;
  const std::string type = element.text("type", "sphere");
  const std::map<std::string, std::pair<Kind, std::size_t>> kinds = {
      {"box", {Kind::box, 3}},           {"sphere", {Kind::sphere, 1}},       {"capsule", {Kind::capsule, 2}},
      {"cylinder", {Kind::cylinder, 2}}, {"ellipsoid", {Kind::ellipsoid, 3}}, {"mesh", {Kind::mesh, 0}},
      {"plane", {Kind::box, 0}}};
  const auto kind = kinds.find(type);
  if (kind == kinds.end()) element.fail("is of the type " + type + ", which is not supported; give it another shape");
  shape.kind = kind->second.first;
  geom.is_plane = type == "plane";
  element.refuse({"fluidshape"});
  if (element.flag("shellinertia", false)) element.fail("has shellinertia, which is not supported; give <inertial>");
  geom.type_bits = int(element.number("contype", 1));
  geom.affinity_bits = int(element.number("conaffinity", 1));
  geom.friction = element.number("condim", 3) == 1 ? 0 : element.numbers("friction", {1, 0.005, 0.0001}, 1)[0];
  shape.pose = read_pose(element, compiler);
  if (shape.kind == Kind::mesh) {
    const auto mesh = meshes.find(element.text("mesh"));
    if (mesh == meshes.end())
      element.fail("has the mesh `" + element.text("mesh") + "`, which no <mesh> with a file has; add it to <asset>");
    shape.file = mesh->second.file;
    shape.scale = mesh->second.scale;
    const bool is_needed = has_mass || geom.type_bits || geom.affinity_bits;
    if (is_needed && !is_file(shape.file))
      element.fail("has the mesh " + shape.file.string() + ", which does not exist; correct the path");
  } else {
    if (element.has("mesh")) element.fail("fits a primitive to a mesh, which is not supported; give its size");
    const bool has_ends = element.has("fromto");
    const std::size_t n = has_ends ? 1 : kind->second.second;
    const std::vector<double> size = element.numbers("size", {0, 0, 0}, n);
    shape.size = Vec3(size[0], size[1], size[2]);
    if (has_ends) read_ends(element, geom);
    for (std::size_t i = 0; i < kind->second.second; ++i)
      if (!(shape.size[Eigen::Index(i)] > 0)) element.fail("needs sizes above zero; give `size`");
  }
  if (has_mass && !geom.is_plane) read_mass(element, geom);
  return geom;
}

}  // namespace pvg::mjcf
