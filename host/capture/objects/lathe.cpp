#include "host/capture/objects/lathe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/base/error.hpp"
#include "host/formats/table.hpp"

namespace pvg {
namespace {

using Vec2 = Eigen::Vector2d;

constexpr double PI = 3.14159265358979323846;
constexpr std::uint32_t SECTORS = 96;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

// twice the area that the points enclose with the axis; positive: counter-clockwise, radius to the right
double twice_area(const Profile& points) {
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) sum += cross(points[i], points[(i + 1) % points.size()]);
  return sum;
}

bool cross_each_other(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double s = cross(b - a, c - a), t = cross(b - a, d - a), u = cross(d - c, a - c), v = cross(d - c, b - c);
  return s * t <= 0 && u * v <= 0;
}

void demand_no_crossing(const Profile& outline) {
  const std::size_t n = outline.size() - 1;  // the axis closes it and is no line of its own
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j)
      if (cross_each_other(outline[i], outline[i + 1], outline[j], outline[j + 1]))
        throw UsageError(
            fmt::format("the outline crosses itself near radius {:.4g}, height {:.4g} m: is the wall too thick there?",
                        outline[j].x(), outline[j].y()));
}

// where the lines through a and b, with these directions, meet; b where they are parallel
Vec2 meeting(const Vec2& a, const Vec2& along_a, const Vec2& b, const Vec2& along_b) {
  const double area = cross(along_a, along_b);
  if (std::abs(area) < 1e-9) return b;
  return a + along_a * (cross(b - a, along_b) / area);
}

}  // namespace

Profile read_profile(const std::filesystem::path& file, double scale) {
  const MeasuredTable table = read_table(file);
  for (const char* name : {"radius", "height"})
    if (!table.has(name)) throw UsageError(file.string() + ": the column `" + name + "` is missing");
  Profile profile;
  for (std::size_t i = 0; i < table.n_rows; ++i) {
    const Vec2 p = scale * Vec2(table["radius"][i], table["height"][i]);
    const auto fail = [&](const std::string& what) {
      throw UsageError(fmt::format("{}: row {}: {}", file.string(), i + 1, what));
    };
    if (!p.allFinite()) fail("radius and height must be numbers");
    if (p.x() < 0) fail("the radius is negative");
    if (i == 0 && p.x() != 0) fail("the outline begins on the axis, at radius 0");
    if (i > 0 && i + 1 < table.n_rows && p.x() == 0) fail("only the first and the last row may lie on the axis");
    if (i > 0 && p == profile.back()) fail("is the row above once more");
    profile.push_back(p);
  }
  if (profile.size() < 3) throw UsageError(file.string() + ": an outline has three rows or more");
  return profile;
}

Profile closed_outline(const Profile& profile, double wall) {
  Profile outline = profile;
  const bool is_whole = profile.back().x() == 0;
  if (is_whole && wall > 0)
    throw UsageError("the profile ends on the axis and is a whole outline; leave --wall out, or end it at the rim");
  if (!is_whole && !(wall > 0))
    throw UsageError(
        "the profile ends at a rim; say how thick the wall is by --wall, or go on along the inside to the axis");
  if (!is_whole) {
    Profile around = profile;
    around.emplace_back(0, profile.back().y());
    const double side = twice_area(around) > 0 ? 1 : -1;  // of the inside
    std::vector<Vec2> along, on;                          // each line, moved inside
    for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
      along.push_back((profile[i + 1] - profile[i]).normalized());
      on.push_back(profile[i] + side * wall * Vec2(-along[i].y(), along[i].x()));
    }
    Profile inside = {meeting(on[0], along[0], Vec2(0, on[0].y()), Vec2(0, 1))};
    inside[0].x() = 0;
    for (std::size_t i = 1; i < on.size(); ++i) inside.push_back(meeting(on[i - 1], along[i - 1], on[i], along[i]));
    inside.push_back(on.back() + (profile.back() - profile[profile.size() - 2]));
    for (std::size_t i = 1; i < inside.size(); ++i)
      if (!(inside[i].x() > 0))
        throw UsageError(fmt::format("a wall of {:.4g} m is too thick at height {:.4g} m", wall, inside[i].y()));
    outline.insert(outline.end(), inside.rbegin(), inside.rend());
  }
  demand_no_crossing(outline);
  if (twice_area(outline) < 0) std::reverse(outline.begin(), outline.end());
  return outline;
}

TriangleMesh revolved(const Profile& outline, std::uint32_t sectors) {
  TriangleMesh mesh;
  const double angle = 2 * PI / sectors, larger = std::sqrt(angle / std::sin(angle));
  const std::uint32_t rings = std::uint32_t(outline.size()) - 2, last = 1 + rings * sectors;
  mesh.points.emplace_back(0, 0, outline.front().y());
  for (std::uint32_t ring = 1; ring <= rings; ++ring)
    for (std::uint32_t k = 0; k < sectors; ++k)
      mesh.points.emplace_back(larger * outline[ring].x() * std::cos(k * angle),
                               larger * outline[ring].x() * std::sin(k * angle), outline[ring].y());
  mesh.points.emplace_back(0, 0, outline.back().y());
  for (std::uint32_t k = 0; k < sectors; ++k) {
    const std::uint32_t next = (k + 1) % sectors;
    mesh.triangles.push_back({0, 1 + next, 1 + k});
    for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
      const std::uint32_t a = 1 + ring * sectors + k, b = 1 + ring * sectors + next;
      mesh.triangles.push_back({a, b, b + sectors});
      mesh.triangles.push_back({a, b + sectors, a + sectors});
    }
    mesh.triangles.push_back({last, last - sectors + k, last - sectors + next});
  }
  return mesh;
}

ObjectSource turned_object(const std::string& name, const Profile& profile, double wall) {
  ObjectSource source;
  source.name = name;
  try {
    source.mesh = revolved(closed_outline(profile, wall), SECTORS);
  } catch (const UsageError& error) {
    throw UsageError(name + ": " + error.what());
  }
  for (const Vec3& p : source.mesh.points) source.visual.points.push_back(p.cast<float>());
  source.visual.triangles = source.mesh.triangles;
  return source;
}

ObjectSource read_lathe_object(const std::filesystem::path& file, double wall, double scale) {
  return turned_object(file.string(), read_profile(file, scale), wall);
}

}  // namespace pvg
