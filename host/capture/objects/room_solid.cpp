#include "host/capture/objects/room_solid.hpp"

#include <fmt/format.h>

#include "host/base/error.hpp"
#include "host/capture/objects/surface_distance.hpp"
#include "host/capture/objects/wrap.hpp"
#include "host/capture/surface.hpp"
#include "host/geometry/mesh_checks.hpp"

namespace pvg {
namespace {

constexpr double OFFSET = 0.6;            // of the wrap, in details
constexpr double BRIDGE = 1.6;            // the least that the wrap takes: corners and hollows stay
constexpr double SIMPLIFICATION = 0.25;   // error, in details
constexpr double FARTHEST_SURFACE = 0.9;  // of 95 % of the room from its solid, in details; filled: 1.2
constexpr int SOLID_ATTEMPTS = 4;         // of the wrap, each with other samples

// the triangles that come near enough, without points that none of them uses
TriangleMesh within_reach(const Room& room, double reach) {
  TriangleMesh near;
  std::vector<std::uint32_t> number(room.mesh.points.size(), 0);  // 1 + of the new mesh
  for (const Triangle& t : room.mesh.triangles) {
    bool is_near = false;
    for (const std::uint32_t corner : t) is_near = is_near || double(room.mesh.points[corner].norm()) < reach;
    if (!is_near) continue;
    Triangle kept;
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& n = number[t[k]];
      if (n == 0) {
        near.points.push_back(room.mesh.points[t[k]].cast<double>());
        n = std::uint32_t(near.points.size());
      }
      kept[k] = n - 1;
    }
    near.triangles.push_back(kept);
  }
  return near;
}

TriangleMesh moved_back(const TriangleMesh& surface, double by) {
  std::vector<Vec3f> points;
  for (const Vec3& p : surface.points) points.push_back(p.cast<float>());
  const std::vector<Vec3f> normals = point_normals(points, surface.triangles);
  TriangleMesh out = surface;
  for (std::size_t i = 0; i < out.points.size(); ++i) out.points[i] -= by * normals[i].cast<double>();
  return out;
}

}  // namespace

void make_solid(const RoomSolidSettings& settings, Room& room) {
  const TriangleMesh surface = within_reach(room, settings.reach);
  if (surface.triangles.empty())
    throw UsageError(
        fmt::format("no surface is within {:.3g} m of the room's origin; give a larger --contact", settings.reach));
  double detail = settings.detail;
  for (int attempt = 0; attempt < SOLID_ATTEMPTS; ++attempt) {
    WrapSettings wrap;
    wrap.spacing = detail;
    wrap.offset = OFFSET * detail;
    wrap.bridge = BRIDGE * detail;
    const TriangleMesh shell = wrap_surface(moved_back(surface, OFFSET * detail), wrap);
    detail *= 0.93;  // samples lie elsewhere
    if (!is_sound(shell)) continue;
    room.solid = simplified_solid(shell, settings.triangles, SIMPLIFICATION * settings.detail).mesh;
    break;
  }
  if (room.solid.triangles.empty())
    throw UsageError(
        "the surface within --contact encloses a hollow, or no sound solid was found around it; give a smaller "
        "--contact, or another --detail");
  room.solid_distances = surface_distances(surface, room.solid);
  const double far = room.solid_distances[room.solid_distances.size() * 95 / 100];
  if (far > FARTHEST_SURFACE * settings.detail)
    throw UsageError(fmt::format(
        "the solid would be {:.0f} mm off the surface: what is within --contact is closed all around, or holds gaps "
        "narrower than --detail; give a smaller --contact or --detail",
        1e3 * far));
}

}  // namespace pvg
