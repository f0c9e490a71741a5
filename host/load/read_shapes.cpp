#include "host/load/read_shapes.hpp"

#include <cstdint>
#include <string>

#include "host/base/error.hpp"
#include "host/formats/mesh_files.hpp"
#include "host/formats/tet_file.hpp"
#include "host/formats/tetgen.hpp"
#include "host/geometry/primitive_shapes.hpp"
#include "host/geometry/tet_mesh.hpp"
#include "host/load/tables.hpp"
#include "host/robot/robot.hpp"

namespace pvg {
namespace {

using Section = YamlSection;
constexpr double SMALLEST = 1e-6;  // extent of a shape [m]
constexpr int MOST_DIVISIONS = 512;
constexpr double MOST_TETRAHEDRA = 1e6;  // of one body

struct Box {
  Vec3 size = Vec3::Zero();
  std::array<int, 3> divisions = {1, 1, 1};
};
struct Sphere {
  double radius = 0;
  int subdivisions = 3;
};
struct Cylinder {
  double radius = 0, length = 0;
  int sides = 32;
};
struct Ellipsoid {
  Vec3 radii = Vec3::Zero();
  int subdivisions = 3;
  TriangleMesh surface() const {
    TriangleMesh mesh = sphere_surface(1, subdivisions);
    for (Vec3& point : mesh.points) point = point.cwiseProduct(radii);
    return mesh;
  }
};
// One of several closed shapes of a body, in its frame.
struct Part {
  TriangleMesh surface;
  double size = 1;
  Pose pose = Pose::Identity();
};
// What collides of a link of a robot.
struct Link {
  std::filesystem::path urdf;
  std::string name;
  TriangleMesh surface() const {
    const RobotModel robot = load_urdf(urdf);
    return robot.links[std::size_t(robot.link(name))].collision;
  }
};
struct Hexahedron {
  std::array<double, 24> corners = {};
  TriangleMesh surface() const {
    std::array<Vec3, 8> points;
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = Eigen::Map<const Vec3>(&corners[3 * i]);
    return hexahedron_surface(points);
  }
};
struct Square {
  double size = 0;
};
struct Sheet {
  std::array<double, 2> size = {};
  std::array<int, 2> divisions = {};
};
struct Disc {
  double radius = 0;
  int rings = 0;
};
struct Bar : Box {
  int nodes_per_element = TetgenOptions{}.nodes_per_element;
};
struct BallOctant {
  double radius = 0;
  int divisions = 8;
  double grading = 1;
  int nodes_per_element = TetgenOptions{}.nodes_per_element;
};
struct Filled {
  TriangleMesh surface;
  TetgenOptions options;
  std::string file;
};

struct Tetrahedra {
  std::filesystem::path mesh;
  int nodes_per_element = TetgenOptions{}.nodes_per_element;
  TetMesh solid() const {
    const TetMesh linear = read_tetrahedra(mesh);
    return nodes_per_element == 10 ? make_quadratic(linear) : linear;
  }
};

TriangleMesh joined(const std::vector<Part>& parts) {
  TriangleMesh all;
  for (const Part& part : parts) {
    const std::uint32_t first = std::uint32_t(all.points.size());
    for (const Vec3& point : part.surface.points) all.points.push_back(part.pose * Vec3(part.size * point));
    for (const auto& t : part.surface.triangles) all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return all;
}

// six tetrahedra per cell
void check_size(const Section& section, const std::array<int, 3>& divisions) {
  const double n = 6.0 * divisions[0] * divisions[1] * divisions[2];
  if (n > MOST_TETRAHEDRA)
    section.fail("divisions", "make " + std::to_string(std::int64_t(n)) + " tetrahedra; at most a million are read");
}

void check_hexahedron(Section& section, Hexahedron& hexahedron) {
  try {
    hexahedron.surface();
  } catch (const UsageError& e) {
    section.fail("corners", std::string("are wrong: ") + e.what());
  }
}

template <class T>
Fields<T> radius_fields() {
  return Fields<T>().number("radius", &T::radius, Unit::length, SMALLEST, REACH, "half its width").required();
}

const Fields<Box>& box_fields() {
  static const Fields<Box> FIELDS =
      Fields<Box>()
          .number("size", &Box::size, Unit::length, SMALLEST, 2 * REACH, "along x, y, z")
          .required()
          .number("divisions", &Box::divisions, Unit::none, 1, MOST_DIVISIONS, "cells along x, y, z");
  return FIELDS;
}

TriangleMesh surface_of_file(const std::filesystem::path& file, bool may_be_open) {
  TriangleMesh surface = may_be_open ? read_surface(file) : read_closed_surface(file);
  tell_of_size(surface, file.string());
  return surface;
}

OneOf<TriangleMesh> surface_shapes(bool may_be_open) {
  const auto sphere = radius_fields<Sphere>().number("subdivisions", &Sphere::subdivisions, Unit::none, 0, 7,
                                                     "how often each triangle of an icosahedron is cut into four");
  const auto cylinder = radius_fields<Cylinder>()
                            .number("length", &Cylinder::length, Unit::length, SMALLEST, 2 * REACH, "along z")
                            .required()
                            .number("sides", &Cylinder::sides, Unit::none, 3, 4096, "corners of its circle");
  const auto capsule = radius_fields<Cylinder>()
                           .number("length", &Cylinder::length, Unit::length, SMALLEST, 2 * REACH,
                                   "of the cylinder between two half balls, along z")
                           .required()
                           .number("sides", &Cylinder::sides, Unit::none, 4, 4096, "corners of its circle");
  const auto ellipsoid = Fields<Ellipsoid>()
                             .number("radii", &Ellipsoid::radii, Unit::length, SMALLEST, REACH, "along x, y, z")
                             .required()
                             .number("subdivisions", &Ellipsoid::subdivisions, Unit::none, 0, 7, "as of `sphere`");
  const auto part = Fields<Part>()
                        .custom(
                            {"shape", "", "", "a closed shape", "its form"},
                            [](Section& s, Part& p) { p.surface = closed_shapes().read(s.section("shape")); }, nullptr)
                        .required()
                        .number("size", &Part::size, Unit::none, 1e-6, 1e6, "factor on the shape")
                        .own_pose(&Part::pose, "of the part in the body's frame");
  const auto link = Fields<Link>()
                        .file("urdf", &Link::urdf, "the robot")
                        .required()
                        .text("name", &Link::name, "of its link")
                        .required();
  const auto hexahedron = Fields<Hexahedron>()
                              .number("corners", &Hexahedron::corners, Unit::length, -REACH, REACH,
                                      "x, y, z of four corners, counter-clockwise seen from above, then of the four "
                                      "above them")
                              .required()
                              .check(check_hexahedron);
  return OneOf<TriangleMesh>()
      .file(
          "mesh", [=](const std::filesystem::path& file) { return surface_of_file(file, may_be_open); },
          may_be_open ? "OBJ, STL, PLY or glTF" : "OBJ, STL, PLY or glTF; a closed surface")
      .form(
          "box", box_fields(), [](const Box& b) { return box_surface(b.size, b.divisions); }, "around the origin")
      .form(
          "sphere", sphere, [](const Sphere& s) { return sphere_surface(s.radius, s.subdivisions); },
          "around the origin")
      .form(
          "cylinder", cylinder, [](const Cylinder& c) { return cylinder_surface(c.radius, c.length, c.sides); },
          "around the origin, along z")
      .form(
          "capsule", capsule, [](const Cylinder& c) { return capsule_surface(c.radius, c.length, c.sides); },
          "around the origin, along z")
      .form("ellipsoid", ellipsoid, std::mem_fn(&Ellipsoid::surface), "around the origin")
      .form("link", link, std::mem_fn(&Link::surface), "what collides of a link of a URDF")
      .list("parts", part, joined, "several; they may overlap where `mass`, `center_of_mass` and `inertia` are given")
      .form("hexahedron", hexahedron, std::mem_fn(&Hexahedron::surface), "of eight corners");
}

}  // namespace

const OneOf<TriangleMesh>& closed_shapes() {
  static const OneOf<TriangleMesh> SHAPES = surface_shapes(false);
  return SHAPES;
}

const OneOf<TriangleMesh>& open_shapes() {
  static const OneOf<TriangleMesh> SHAPES = surface_shapes(true).form(
      "square",
      Fields<Square>().number("size", &Square::size, Unit::length, SMALLEST, 2 * REACH, "of its edges").required(),
      [](const Square& s) { return square_surface(s.size); }, "in the plane z = 0");
  return SHAPES;
}

const OneOf<TriangleMesh>& sheet_shapes() {
  const auto sheet = Fields<Sheet>()
                         .number("size", &Sheet::size, Unit::length, SMALLEST, 2 * REACH, "along x, y")
                         .required()
                         .number("divisions", &Sheet::divisions, Unit::none, 1, MOST_DIVISIONS, "cells along x, y")
                         .required();
  const auto disc =
      radius_fields<Disc>().number("rings", &Disc::rings, Unit::none, 1, MOST_DIVISIONS, "of triangles").required();
  static const OneOf<TriangleMesh> SHAPES =
      OneOf<TriangleMesh>()
          .file("mesh", read_surface, "OBJ, STL, PLY or glTF")
          .form(
              "sheet", sheet, [](const Sheet& s) { return sheet_surface(s.size, s.divisions); },
              "in the plane z = 0; equal triangles, the most accurate")
          .form(
              "disc", disc, [](const Disc& d) { return disc_surface(d.radius, d.rings); }, "in the plane z = 0");
  return SHAPES;
}

const OneOf<TetMesh>& solid_shapes() {
  const auto bar = Fields<Bar>()
                       .include(box_fields(), std::identity{})
                       .include(nodes_per_element_fields(), &Bar::nodes_per_element)
                       .check([](Section& s, Bar& b) { check_size(s, b.divisions); });
  const auto octant = radius_fields<BallOctant>()
                          .number("divisions", &BallOctant::divisions, Unit::none, 1, 128, "cells along each axis")
                          .number("grading", &BallOctant::grading, Unit::none, 1, 4,
                                  "exponent of the spacing; above 1 cells crowd around the pole on z")
                          .include(nodes_per_element_fields(), &BallOctant::nodes_per_element)
                          .check([](Section& s, BallOctant& b) {
                            check_size(s, {b.divisions, b.divisions, b.divisions});
                          });
  const auto filled =
      Fields<Filled>()
          .custom(
              {"surface", "", "", "a closed shape", "as of `rigid` bodies"},
              [](Section& s, Filled& f) { f.surface = closed_shapes().read(s.section("surface")); }, nullptr)
          .required()
          .number(
              "max_tetrahedron_volume", [](auto& f) -> auto& { return f.options.max_volume; }, Unit::volume, 0, 1e6,
              "0: none")
          .number(
              "radius_edge_ratio", [](auto& f) -> auto& { return f.options.radius_edge_ratio; }, Unit::none, 1.1, 10,
              "TetGen's -q")
          .flag(
              "keeps_surface", [](auto& f) -> auto& { return f.options.keeps_surface; },
              "TetGen's -Y: adds no vertices on the surface")
          .include(
              nodes_per_element_fields(), [](auto& f) -> auto& { return f.options.nodes_per_element; })
          .reads([](Section& s, Filled& f) { f.file = s.path().string(); });
  const auto tetrahedra =
      Fields<Tetrahedra>()
          .file("mesh", &Tetrahedra::mesh, "Gmsh's MSH 2.2 as text, such as `capture object --soft` writes")
          .required()
          .include(nodes_per_element_fields(), &Tetrahedra::nodes_per_element);
  static const OneOf<TetMesh> SHAPES =
      OneOf<TetMesh>()
          .form(
              "bar", bar, [](const Bar& b) { return box_solid(b.size, b.divisions, b.nodes_per_element); },
              "a box around the origin, six tetrahedra per cell")
          .form(
              "ball_octant", octant,
              [](const BallOctant& b) {
                return ball_octant_solid(b.radius, b.divisions, b.grading, b.nodes_per_element);
              },
              "the part x, y, z >= 0 of a ball around the origin")
          .form(
              "filled", filled, [](const Filled& f) { return tetrahedralize(f.surface, f.options, f.file); },
              "the inside of a closed surface, by TetGen")
          .form("tetrahedra", tetrahedra, std::mem_fn(&Tetrahedra::solid), "of a file, as they are");
  return SHAPES;
}

std::vector<std::uint32_t> read_points_within(YamlSection& section, const std::vector<Vec3>& points,
                                              const std::string& body) {
  const Vec3 low = section.vector("low", Unit::length, -2 * REACH, 2 * REACH);
  const Vec3 high = section.vector("high", Unit::length, -2 * REACH, 2 * REACH);
  return points_within(section, low, high, points, body);
}

std::vector<std::uint32_t> points_within(const YamlSection& section, const Vec3& low, const Vec3& high,
                                         const std::vector<Vec3>& points, const std::string& body) {
  std::vector<std::uint32_t> within;
  for (std::size_t i = 0; i < points.size(); ++i)
    if ((points[i].array() >= low.array()).all() && (points[i].array() <= high.array()).all())
      within.push_back(std::uint32_t(i));
  if (within.empty()) section.fail("low", "and `high` hold no node of the " + body + " (in its own frame)");
  return within;
}

}  // namespace pvg
