#include "host/capture/objects/standing_object.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "host/base/error.hpp"
#include "host/geometry/mesh_checks.hpp"

namespace pvg {
namespace {

constexpr double LEAST_AREA = 5e-4;        // of a thing's surface; smaller pieces are dirt [m^2]
constexpr double LEAST_TABLE = 0.02;       // of the plane, which pictures from near show in part [m^2]
constexpr double BORDER = 0.02;            // of the plane, where walls and edges begin [m]
constexpr double CLEARANCE_IN_VOXELS = 3;  // the truncated distances of plane and thing blend over so much
constexpr double CLEARANCE_IN_ROUGHNESS = 4;

// the points and triangles of `mesh` that `keep` says, renumbered
template <class Keep>
VisualMesh part_of(const VisualMesh& mesh, const Keep& keep) {
  VisualMesh out;
  std::vector<std::int64_t> number(mesh.points.size(), -1);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!keep(i)) continue;
    Triangle kept;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[i][k];
      if (number[v] < 0) {
        number[v] = std::int64_t(out.points.size());
        out.points.push_back(mesh.points[v]);
        if (!mesh.colors.empty()) out.colors.push_back(mesh.colors[v]);
      }
      kept[k] = std::uint32_t(number[v]);
    }
    out.triangles.push_back(kept);
  }
  return out;
}

// edges of one triangle only, as that triangle runs along them
std::vector<std::array<std::uint32_t, 2>> boundary_edges(const std::vector<Triangle>& triangles) {
  std::map<std::array<std::uint32_t, 2>, int> uses;
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) ++uses[{std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])}];
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (uses[{std::min(a, b), std::max(a, b)}] == 1) edges.push_back({a, b});
    }
  return edges;
}

// of points in the plane, counterclockwise (Andrew's monotone chain)
std::vector<std::uint32_t> convex_hull(const std::vector<Vec3f>& points, std::vector<std::uint32_t> order) {
  const auto turns_left = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const Vec3f u = points[b] - points[a], v = points[c] - points[a];
    return u.x() * v.y() - u.y() * v.x() > 0;
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(points[a].x(), points[a].y()) < std::pair(points[b].x(), points[b].y());
  });
  std::vector<std::uint32_t> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = hull.size();
    for (const std::uint32_t i : order) {
      while (hull.size() >= first + 2 && !turns_left(hull[hull.size() - 2], hull.back(), i)) hull.pop_back();
      hull.push_back(i);
    }
    hull.pop_back();  // begins the other side
    std::reverse(order.begin(), order.end());
  }
  return hull;
}

// the strip from the cut down to the plane, and the foot
void add_foot(VisualMesh& mesh, double clearance) {
  std::vector<std::int64_t> below(mesh.points.size(), -1);
  std::vector<std::uint32_t> outline;
  const auto foot_of = [&](std::uint32_t v) {
    if (below[v] < 0) {
      below[v] = std::int64_t(mesh.points.size());
      outline.push_back(std::uint32_t(mesh.points.size()));
      const Vec3f p = mesh.points[v];
      mesh.points.emplace_back(p.x(), p.y(), 0.0f);
      if (!mesh.colors.empty()) mesh.colors.push_back(Vec3f(mesh.colors[v]));
    }
    return std::uint32_t(below[v]);
  };
  for (const auto& [a, b] : boundary_edges(mesh.triangles)) {
    if (double(std::max(mesh.points[a].z(), mesh.points[b].z())) > 2 * clearance) continue;  // a hole further up
    const std::uint32_t c = foot_of(a), d = foot_of(b);
    mesh.triangles.push_back({b, a, c});
    mesh.triangles.push_back({b, c, d});
  }
  if (outline.size() < 3) return;
  const std::vector<std::uint32_t> hull = convex_hull(mesh.points, outline);
  for (std::size_t i = 2; i < hull.size(); ++i) mesh.triangles.push_back({hull[0], hull[i], hull[i - 1]});
}

}  // namespace

Vec3 where_cameras_look(std::span<const CaptureFrame> frames) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  Vec3 right = Vec3::Zero();
  for (const CaptureFrame& frame : frames) {
    const Vec3 axis = frame.depth_camera.pose.linear().col(2);
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - axis * axis.transpose();
    sum += across;
    right += across * frame.depth_camera.pose.translation();
  }
  return sum.completeOrthogonalDecomposition().solve(right);
}

StandingThing standing_thing(const VisualMesh& surface, double width, double height, double clearance,
                             const Vec3& middle) {
  const auto is_above = [&](const Vec3f& p) {
    return double(p.z()) > clearance && std::abs(double(p.x())) < 0.5 * width - BORDER &&
           std::abs(double(p.y())) < 0.5 * height - BORDER;
  };
  const VisualMesh above = part_of(surface, [&](std::size_t i) {
    const Triangle& t = surface.triangles[i];
    return is_above(surface.points[t[0]]) && is_above(surface.points[t[1]]) && is_above(surface.points[t[2]]);
  });
  TriangleMesh mesh;
  for (const Vec3f& p : above.points) mesh.points.push_back(p.cast<double>());
  mesh.triangles = above.triangles;
  const std::vector<int> piece = triangle_components(mesh);
  struct Piece {
    double area = 0;
    Vec3 moment = Vec3::Zero();
  };
  std::vector<Piece> pieces(piece.empty() ? 0 : std::size_t(*std::max_element(piece.begin(), piece.end())) + 1);
  for (std::size_t i = 0; i < piece.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    const Vec3 a = mesh.points[t[0]], b = mesh.points[t[1]], c = mesh.points[t[2]];
    const double area = 0.5 * (b - a).cross(c - a).norm();
    pieces[std::size_t(piece[i])].area += area;
    pieces[std::size_t(piece[i])].moment += area / 3 * (a + b + c);
  }
  StandingThing out;
  int taken = -1;
  double nearest = INFINITY;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (pieces[i].area < LEAST_AREA) continue;
    ++out.n_things;
    const double distance = (pieces[i].moment / pieces[i].area - middle).head<2>().norm();
    if (distance < nearest) {
      nearest = distance;
      taken = int(i);
    }
  }
  if (taken < 0)
    throw Failure(
        fmt::format("nothing stands on the plane of {:.2f} x {:.2f} m that was found: nothing rises above it "
                    "by more than {:.0f} mm",
                    width, height, 1e3 * clearance));
  out.mesh = part_of(above, [&](std::size_t i) { return piece[i] == taken; });
  add_foot(out.mesh, clearance);
  return out;
}

ObjectSource read_standing_object(Device& device, const Capture& capture, const StandingSettings& settings,
                                  const std::function<void(const std::string&)>& say) {
  RoomSettings room_settings;
  room_settings.fusion.voxel = settings.voxel;
  room_settings.fusion.max_depth = settings.max_depth;
  room_settings.planes.least_area = LEAST_TABLE;
  room_settings.least_piece = LEAST_AREA;
  room_settings.guesses_background = false;
  room_settings.aligns_colors = capture.colors_are_apart;
  const Room room = capture_room(device, capture, room_settings, say);
  if (room.ground < 0)
    throw Failure(
        "no plane that faces up was found for the thing to stand on: take pictures that show more of the table");
  const CapturedPlane& ground = room.planes[std::size_t(room.ground)];
  const double clearance = std::max(CLEARANCE_IN_VOXELS * settings.voxel, CLEARANCE_IN_ROUGHNESS * ground.roughness);
  const Vec3 middle = room.room_from_capture * where_cameras_look(capture.frames);
  StandingThing thing = standing_thing(room.mesh, ground.width, ground.height, clearance, middle);
  if (thing.n_things > 1)
    say(fmt::format("{} things stand there; the one where the cameras look is taken", thing.n_things));
  ObjectSource source;
  source.stands = true;
  for (const Vec3f& p : thing.mesh.points) source.mesh.points.push_back(p.cast<double>());
  source.mesh.triangles = thing.mesh.triangles;
  source.visual = std::move(thing.mesh);
  return source;
}

}  // namespace pvg
