#include "host/load/read_cloth.hpp"

#include <algorithm>

#include "host/load/read_sections.hpp"
#include "host/load/read_shapes.hpp"

namespace pvg {
namespace {

constexpr double STIFFEST = 1e9;  // [N/m], [N m]

// `key` for both thread directions, or `key`_warp and `key`_weft; nothing where none is given
std::optional<std::array<double, 2>> read_both(YamlSection& section, const std::string& key, Unit unit, double low) {
  const std::string warp = key + "_warp", weft = key + "_weft";
  if (section.has(key)) {
    if (section.has(warp) || section.has(weft))
      section.fail(key, "stands for both directions: leave `" + warp + "` and `" + weft + "` out, or this");
    const double value = section.number(key, unit, low, STIFFEST);
    return {{value, value}};
  }
  if (!section.has(warp) && !section.has(weft)) return std::nullopt;
  return {{section.number(warp, unit, low, STIFFEST), section.number(weft, unit, low, STIFFEST)}};
}

ClothMaterial read_material(YamlSection section) {
  ClothMaterial m;
  m.thickness = section.number("thickness", Unit::length, 0, 0.1, m.thickness);
  if (section.has("area_density") == section.has("density"))
    section.fail("", "must have either `area_density` or, for a sheet of a uniform stuff, `density`");
  m.area_density = section.has("density") ? m.thickness * section.number("density", Unit::density, 1e-3, 1e5)
                                          : section.number("area_density", Unit::area_density, 1e-6, 1e4);
  if (!(m.area_density > 0)) section.fail("density", "needs a `thickness` above 0");
  m.poisson_ratio = section.number("poisson_ratio", Unit::none, 0, 0.99, 0);

  const auto stretch = read_both(section, "stretch", Unit::stiffness, 1e-3);
  if (stretch.has_value() == section.has("youngs_modulus"))
    section.fail("", "must have either `stretch` (Young's modulus times thickness) or `youngs_modulus`");
  m.stretch_warp = m.stretch_weft =
      stretch ? 0 : section.number("youngs_modulus", Unit::pressure, 1, 1e12) * m.thickness;
  if (stretch) m.stretch_warp = (*stretch)[0], m.stretch_weft = (*stretch)[1];
  if (!(m.stretch_warp > 0)) section.fail("youngs_modulus", "needs a `thickness` above 0");
  const double mean = std::sqrt(m.stretch_warp * m.stretch_weft);
  m.shear = section.number("shear", Unit::stiffness, 1e-3, STIFFEST, mean / (2 * (1 + m.poisson_ratio)));

  const auto bending = read_both(section, "bending", Unit::torque, 0);
  if (!bending && stretch) section.fail("", "lacks the key `bending`: the flexural rigidity [N m]");
  // of a uniform plate: E t^3 / (12 (1 - nu^2))
  const double plate = mean * m.thickness * m.thickness / (12 * (1 - m.poisson_ratio * m.poisson_ratio));
  m.bending_warp = bending ? (*bending)[0] : plate;
  m.bending_weft = bending ? (*bending)[1] : plate;
  m.limit_strain = section.number("limit_strain", Unit::none, 0, 10, m.limit_strain);
  m.stiffening = section.number("stiffening", Unit::none, 0, 1e6, m.stiffening);
  section.done();
  return m;
}

std::vector<std::uint32_t> read_pinned(YamlSection& section, const Cloth& cloth) {
  std::vector<std::uint32_t> pinned;
  for (YamlSection& box : section.sections("pinned")) {
    const std::vector<std::uint32_t> points = read_points_within(box, cloth.mesh.points, "cloth");
    box.done();
    pinned.insert(pinned.end(), points.begin(), points.end());
  }
  std::sort(pinned.begin(), pinned.end());
  pinned.erase(std::unique(pinned.begin(), pinned.end()), pinned.end());
  return pinned;
}

}  // namespace

ClothSection read_cloth(YamlSection& section) {
  ClothSection read;
  Cloth& cloth = read.cloth;
  cloth.name = section.text("name");
  YamlSection shape = section.section("shape");
  if (shape.has("mesh")) read.mesh = shape.file("mesh");
  cloth.mesh = read_sheet_shape(shape);
  cloth.material = read_material(section.section("material"));
  cloth.rest_is_flat = section.choice("rest_angles", {"flat", "mesh"}, 0) == 0;
  cloth.warp_direction = section.vector("warp", Unit::none, -1e6, 1e6, cloth.warp_direction);
  if (!(cloth.warp_direction.norm() > 1e-9)) section.fail("warp", "must not have the length zero");
  cloth.pinned = read_pinned(section, cloth);
  cloth.friction = section.number("friction", Unit::none, 0, 10, cloth.friction);
  cloth.velocity = section.vector("velocity", Unit::speed, -1e3, 1e3, Vec3::Zero());
  read.pose = read_sampled_pose(section);
  read.look = section.text("look", "");
  read.subdivision_levels = section.integer("subdivision_levels", 0, 4, read.subdivision_levels);
  section.done();
  return read;
}

std::vector<std::uint32_t> read_points_within(YamlSection& section, const std::vector<Vec3>& points,
                                              const std::string& body) {
  const Vec3 low = section.vector("low", Unit::length, -2 * REACH, 2 * REACH);
  const Vec3 high = section.vector("high", Unit::length, -2 * REACH, 2 * REACH);
  std::vector<std::uint32_t> within;
  for (std::size_t i = 0; i < points.size(); ++i)
    if ((points[i].array() >= low.array()).all() && (points[i].array() <= high.array()).all())
      within.push_back(std::uint32_t(i));
  if (within.empty()) section.fail("low", "and `high` hold no node of the " + body + " (in its own frame)");
  return within;
}

}  // namespace pvg
