#include "host/load/read_shapes.hpp"

#include <cstdint>
#include <functional>
#include <string>

#include "host/base/error.hpp"
#include "host/formats/mesh_files.hpp"
#include "host/formats/tetgen.hpp"
#include "host/geometry/primitive_shapes.hpp"
#include "host/load/read_sections.hpp"

namespace pvg {
namespace {

constexpr double SMALLEST = 1e-6;  // extent of a shape [m]
constexpr int MOST_DIVISIONS = 512;
constexpr double MOST_TETRAHEDRA = 1e6;  // of one body

std::array<int, 3> read_divisions(YamlSection& section, const std::array<int, 3>& otherwise) {
  if (!section.has("divisions")) return otherwise;
  const Vec3 given = section.vector("divisions", Unit::none, 1, MOST_DIVISIONS);
  for (const double value : given)
    if (value != std::floor(value)) section.fail("divisions", "must hold whole numbers");
  return {int(given.x()), int(given.y()), int(given.z())};
}

int read_nodes_per_element(YamlSection& section) {
  return section.choice("nodes_per_element", {"4", "10"}, 1) == 0 ? 4 : 10;
}

TriangleMesh read_box(YamlSection& section) {
  const Vec3 size = section.vector("size", Unit::length, SMALLEST, 2 * REACH);
  return box_surface(size, read_divisions(section, {1, 1, 1}));
}

TriangleMesh read_sphere(YamlSection& section) {
  const double radius = section.number("radius", Unit::length, SMALLEST, REACH);
  return sphere_surface(radius, section.integer("subdivisions", 0, 7, 3));
}

TriangleMesh read_cylinder(YamlSection& section) {
  const double radius = section.number("radius", Unit::length, SMALLEST, REACH);
  const double length = section.number("length", Unit::length, SMALLEST, 2 * REACH);
  return cylinder_surface(radius, length, section.integer("sides", 3, 4096, 32));
}

TriangleMesh read_hexahedron(YamlSection& section) {
  const std::vector<double> flat = section.numbers("corners", Unit::length, -REACH, REACH);
  if (flat.size() != 24) section.fail("corners", "must hold the 24 coordinates of eight points");
  std::array<Vec3, 8> corners;
  for (int i = 0; i < 8; ++i) corners[i] = Eigen::Map<const Vec3>(&flat[3 * i]);
  try {
    return hexahedron_surface(corners);
  } catch (const UsageError& e) {
    section.fail("corners", std::string("are wrong: ") + e.what());
  }
}

TriangleMesh read_square(YamlSection& section) {
  return square_surface(section.number("size", Unit::length, SMALLEST, 2 * REACH));
}

TriangleMesh read_sheet(YamlSection& section) {
  const std::vector<double> size = section.numbers("size", Unit::length, SMALLEST, 2 * REACH);
  const std::vector<double> divisions = section.numbers("divisions", Unit::none, 1, MOST_DIVISIONS);
  if (size.size() != 2) section.fail("size", "must hold two lengths");
  if (divisions.size() != 2 || divisions[0] != std::floor(divisions[0]) || divisions[1] != std::floor(divisions[1]))
    section.fail("divisions", "must hold two whole numbers");
  return sheet_surface({size[0], size[1]}, {int(divisions[0]), int(divisions[1])});
}

TriangleMesh read_disc(YamlSection& section) {
  const double radius = section.number("radius", Unit::length, SMALLEST, REACH);
  return disc_surface(radius, section.integer("rings", 1, MOST_DIVISIONS));
}

// six tetrahedra per cell
void check_size(YamlSection& section, const std::array<int, 3>& divisions) {
  const double n = 6.0 * divisions[0] * divisions[1] * divisions[2];
  if (n > MOST_TETRAHEDRA)
    section.fail("divisions", "make " + std::to_string(std::int64_t(n)) + " tetrahedra; at most a million are read");
}

TetMesh read_bar(YamlSection& section) {
  const Vec3 size = section.vector("size", Unit::length, SMALLEST, 2 * REACH);
  const std::array<int, 3> divisions = read_divisions(section, {1, 1, 1});
  check_size(section, divisions);
  return box_solid(size, divisions, read_nodes_per_element(section));
}

TetMesh read_ball_octant(YamlSection& section) {
  const double radius = section.number("radius", Unit::length, SMALLEST, REACH);
  const int n = section.integer("divisions", 1, 128, 8);
  check_size(section, {n, n, n});
  const double grading = section.number("grading", Unit::none, 1, 4, 1);
  return ball_octant_solid(radius, n, grading, read_nodes_per_element(section));
}

TetMesh read_filled(YamlSection& section) {
  TetgenOptions options;
  options.max_volume = section.number("max_tetrahedron_volume", Unit::volume, 0, 1e6, 0);
  options.radius_edge_ratio = section.number("radius_edge_ratio", Unit::none, 1.1, 10, options.radius_edge_ratio);
  options.keeps_surface = section.boolean("keeps_surface", options.keeps_surface);
  options.nodes_per_element = read_nodes_per_element(section);
  return tetrahedralize(read_surface_shape(section.section("surface"), false), options, section.path().string());
}

template <class Mesh>
using Readers = std::vector<std::pair<std::string, std::function<Mesh(YamlSection&)>>>;

// the one key of `shape` names the reader
template <class Mesh>
Mesh read_one(YamlSection& shape, const Readers<Mesh>& readers) {
  std::string names;
  for (const auto& [name, read] : readers) {
    names += (names.empty() ? "" : ", ") + name;
    if (!shape.has(name)) continue;
    YamlSection section = shape.section(name);
    Mesh mesh = read(section);
    section.done();
    shape.done();
    return mesh;
  }
  shape.done();
  shape.fail("", "must hold one of: " + names);
}

}  // namespace

TriangleMesh read_surface_shape(YamlSection shape, bool may_be_open) {
  if (shape.has("mesh")) {
    const std::filesystem::path file = shape.file("mesh");
    shape.done();
    TriangleMesh surface = may_be_open ? read_surface(file) : read_closed_surface(file);
    tell_of_size(surface, file.string());
    return surface;
  }
  Readers<TriangleMesh> readers = {
      {"box", read_box}, {"sphere", read_sphere}, {"cylinder", read_cylinder}, {"hexahedron", read_hexahedron}};
  if (may_be_open) readers.push_back({"square", read_square});
  return read_one<TriangleMesh>(shape, readers);
}

TriangleMesh read_sheet_shape(YamlSection shape) {
  if (shape.has("mesh")) {
    const std::filesystem::path file = shape.file("mesh");
    shape.done();
    return read_surface(file);
  }
  return read_one<TriangleMesh>(shape, {{"sheet", read_sheet}, {"disc", read_disc}});
}

TetMesh read_solid_shape(YamlSection shape) {
  return read_one<TetMesh>(shape, {{"bar", read_bar}, {"ball_octant", read_ball_octant}, {"filled", read_filled}});
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
