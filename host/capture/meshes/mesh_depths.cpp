// Where a mesh lies among photos: of the ways that programs write it, the one in which the points of the photos' model
// are nearest to the mesh, in the median. Distances are those to points spread over the mesh, as many by area.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/base/error.hpp"
#include "host/base/statistics.hpp"
#include "host/capture/meshes/room_mesh.hpp"
#include "host/capture/surface.hpp"
#include "host/capture/surface_views.hpp"

namespace pvg {
namespace {

constexpr std::size_t MESH_POINTS = 20000, MODEL_POINTS = 1000;
constexpr double NEAR = 0.02;  // of the extent of the model's points

// as many by area, at the places that the golden ratio's and the plastic number's multiples give
std::vector<Vec3f> spread_points(const std::vector<CapturedSurface>& surfaces) {
  double area = 0;
  for (const CapturedSurface& s : surfaces) area += surface_area(s.mesh.points, s.mesh.triangles);
  std::vector<Vec3f> out;
  double due = 0;
  for (const CapturedSurface& s : surfaces)
    for (const Triangle& t : s.mesh.triangles) {
      due += surface_area(s.mesh.points, {t}) / area * double(MESH_POINTS);
      for (; due >= 1; due -= 1) {
        double u = std::fmod(0.7548776662 * double(out.size()), 1), v = std::fmod(0.5698402910 * double(out.size()), 1);
        if (u + v > 1) {
          u = 1 - u;
          v = 1 - v;
        }
        const Vec3f &a = s.mesh.points[t[0]], &b = s.mesh.points[t[1]], &c = s.mesh.points[t[2]];
        out.push_back(a + float(u) * (b - a) + float(v) * (c - a));
      }
    }
  return out;
}

double median_distance(const std::vector<Vec3>& points, const std::vector<Vec3f>& mesh, const Eigen::Matrix3d& turn) {
  std::vector<Vec3f> turned;
  for (const Vec3f& p : mesh) turned.push_back((turn * p.cast<double>()).cast<float>());
  std::vector<double> nearest;
  const std::size_t step = std::max<std::size_t>(1, points.size() / MODEL_POINTS);
  for (std::size_t i = 0; i < points.size(); i += step) {
    const Vec3f p = points[i].cast<float>();
    float least = INFINITY;
    for (const Vec3f& q : turned) least = std::min(least, (p - q).squaredNorm());
    nearest.push_back(std::sqrt(double(least)));
  }
  return upper_median(std::move(nearest));
}

// the capture's frame from the mesh's, as it was read: with z up
Eigen::Matrix3d turn_to_capture(const Capture& capture, const std::vector<CapturedSurface>& surfaces) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : capture.points) box.extend(p);
  if (capture.points.empty() || !box.sizes().allFinite())
    throw UsageError(capture.mesh.string() +
                     ": the model beside it has no points, which tell how it lies among the "
                     "photos");
  Eigen::Matrix3d ways[3];
  ways[0] << 1, 0, 0, 0, 0, -1, 0, 1, 0;  // Map-Anything: turned about x for a viewer with y up
  ways[1] << 1, 0, 0, 0, 0, 1, 0, -1, 0;  // the file's numbers are the capture's
  ways[2].setIdentity();                  // written y up from a capture with z up
  const std::vector<Vec3f> mesh = spread_points(surfaces);
  double least = INFINITY;
  Eigen::Matrix3d best = ways[0];
  for (const Eigen::Matrix3d& way : ways)
    if (const double distance = median_distance(capture.points, mesh, way); distance < least) {
      least = distance;
      best = way;
    }
  if (!(least < NEAR * box.sizes().maxCoeff()))
    throw UsageError(
        fmt::format("{}: half of the model's points are more than {:.3g} m off the mesh; take the mesh that "
                    "was made with these photos, unscaled and unturned",
                    capture.mesh.string(), least));
  return best;
}

}  // namespace

void draw_depths(Device& device, Capture& capture) {
  const std::vector<CapturedSurface> surfaces = read_room_mesh(capture.mesh);
  const Eigen::Matrix3f turn = turn_to_capture(capture, surfaces).cast<float>();
  std::vector<VisualMesh> meshes;
  for (const CapturedSurface& surface : surfaces) {
    VisualMesh& mesh = meshes.emplace_back();
    for (const Vec3f& p : surface.mesh.points) mesh.points.push_back(turn * p);
    mesh.triangles = surface.mesh.triangles;
  }
  std::vector<Camera> cameras;
  for (const CaptureFrame& frame : capture.frames) cameras.push_back(frame.depth_camera);
  SurfaceViews views(device, meshes, cameras);
  for (std::size_t i = 0; i < capture.frames.size(); ++i)
    capture.frames[i].drawn_depth = std::make_shared<const DepthPicture>(views.depth(i));
}

}  // namespace pvg
