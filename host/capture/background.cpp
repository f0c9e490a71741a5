#include "host/capture/background.hpp"

#include <algorithm>
#include <cmath>

#include "host/capture/fusion.hpp"
#include "host/capture/surface.hpp"
#include "host/capture/surface_views.hpp"

namespace pvg {
namespace {

constexpr int REDUCTION = 4;       // of a photo's width and height
constexpr int PHOTO_BORDER = 24;   // pixels of the reduced photo added on each side, for cameras beside this one
constexpr int MARGIN = 2;          // pixels of the reduced photo
constexpr double VOXEL = 0.025;    // [m]
constexpr double BEHIND = 0.02;    // the guess lies so far behind what was measured beside it [m]
constexpr float IN_FRONT = 0.01f;  // so much nearer than the measured surface hides it [m]
constexpr int SWEEPS = 40;         // of Gauss and Seidel, on each level of the pyramid
constexpr double FARTHEST = 3;     // a guessed depth, in largest depths of a measured one

struct Field {  // inverse depths, and which of them are given
  int width = 0, height = 0;
  std::vector<float> value;
  std::vector<bool> is_given;
  std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }
};

// means of 2 x 2, of what is given
Field halved(const Field& fine) {
  Field coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, {}, {}};
  const std::size_t n = std::size_t(coarse.width) * std::size_t(coarse.height);
  std::vector<float> count(n, 0.0f);
  coarse.value.assign(n, 0.0f);
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x)
      if (fine.is_given[fine.at(x, y)]) {
        coarse.value[coarse.at(x / 2, y / 2)] += fine.value[fine.at(x, y)];
        count[coarse.at(x / 2, y / 2)] += 1;
      }
  for (std::size_t i = 0; i < n; ++i) {
    coarse.is_given.push_back(count[i] > 0);
    if (count[i] > 0) coarse.value[i] /= count[i];
  }
  return coarse;
}

// Solves Laplace's equation where nothing is given, with slopes 0 at the picture's border.
void span_membrane(Field& field) {
  if (std::all_of(field.is_given.begin(), field.is_given.end(), [](bool is) { return is; })) return;
  if (field.width > 1 || field.height > 1) {
    Field coarse = halved(field);
    span_membrane(coarse);
    for (int y = 0; y < field.height; ++y)
      for (int x = 0; x < field.width; ++x)
        if (!field.is_given[field.at(x, y)]) field.value[field.at(x, y)] = coarse.value[coarse.at(x / 2, y / 2)];
  }
  for (int sweep = 0; sweep < SWEEPS; ++sweep)
    for (int y = 0; y < field.height; ++y)
      for (int x = 0; x < field.width; ++x) {
        if (field.is_given[field.at(x, y)]) continue;
        float sum = 0, n = 0;
        if (x > 0) sum += field.value[field.at(x - 1, y)], n += 1;
        if (y > 0) sum += field.value[field.at(x, y - 1)], n += 1;
        if (x + 1 < field.width) sum += field.value[field.at(x + 1, y)], n += 1;
        if (y + 1 < field.height) sum += field.value[field.at(x, y + 1)], n += 1;
        if (n > 0) field.value[field.at(x, y)] = sum / n;
      }
}

Camera reduced(const Camera& camera) {
  Camera out = camera;
  out.width = camera.width / REDUCTION + 2 * PHOTO_BORDER;
  out.height = camera.height / REDUCTION + 2 * PHOTO_BORDER;
  out.fx = camera.fx / REDUCTION;
  out.fy = camera.fy / REDUCTION;
  out.cx = (camera.cx + 0.5) / REDUCTION - 0.5 + PHOTO_BORDER;
  out.cy = (camera.cy + 0.5) / REDUCTION - 0.5 + PHOTO_BORDER;
  out.model = Camera::Model::pinhole;
  out.distortion.clear();  // beyond the photo's border it would mean nothing
  return out;
}

// the nearest point of a picture of depth in each pixel of another camera that has none
void add_measured(const Camera& from, const DepthPicture& picture, double max_depth, const Camera& to,
                  DepthPicture& out) {
  const Pose move = to.pose.inverse() * from.pose;
  std::vector<float> nearest(out.depth.size(), 0.0f);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const double z = double(picture.depth[std::size_t(y) * std::size_t(picture.width) + std::size_t(x)]);
      if (!(z > 0 && z < max_depth)) continue;
      const Vec3 p = move * Vec3((x - from.cx) / from.fx * z, (y - from.cy) / from.fy * z, z);
      if (!(p.z() > 0)) continue;
      const long u = std::lround(to.fx * p.x() / p.z() + to.cx), v = std::lround(to.fy * p.y() / p.z() + to.cy);
      if (u < 0 || v < 0 || u >= to.width || v >= to.height) continue;
      float& kept = nearest[std::size_t(v) * std::size_t(to.width) + std::size_t(u)];
      if (kept == 0 || p.z() < double(kept)) kept = float(p.z());
    }
  for (std::size_t i = 0; i < out.depth.size(); ++i)
    if (out.depth[i] == 0) out.depth[i] = nearest[i];
}

FusionSettings coarse_fusion(double max_depth) {
  FusionSettings settings;
  settings.voxel = VOXEL;
  settings.truncation = 4 * VOXEL;
  settings.max_depth = FARTHEST * max_depth;
  settings.noise = {0.4 * VOXEL, 0.004, 0.4};
  settings.least_weight = 1e-4;
  return settings;
}

// is a point nearer than all that a picture shows around its pixel?
bool hides(const Camera& camera, const DepthPicture& picture, const Vec3& point) {
  const Vec3 p = camera.pose.inverse() * point;
  if (!(p.z() > 0)) return false;
  const int u = int(std::lround(camera.fx * p.x() / p.z() + camera.cx)),
            v = int(std::lround(camera.fy * p.y() / p.z() + camera.cy));
  if (u < 1 || v < 1 || u + 1 >= camera.width || v + 1 >= camera.height) return false;
  for (int y = v - 1; y <= v + 1; ++y)
    for (int x = u - 1; x <= u + 1; ++x) {
      const float z = picture.depth[std::size_t(y) * std::size_t(picture.width) + std::size_t(x)];
      if (!(z > 0) || p.z() > double(z - IN_FRONT)) return false;
    }
  return true;
}

}  // namespace

DepthPicture without_holes(const DepthPicture& picture, int margin) {
  Field field{picture.width, picture.height, std::vector<float>(picture.depth.size(), 0.0f), {}};
  for (const float z : picture.depth) field.is_given.push_back(z > 0);
  const auto is_hole = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < field.width && y < field.height && !field.is_given[field.at(x, y)];
  };
  for (int y = 0; y < field.height; ++y)
    for (int x = 0; x < field.width; ++x) {
      if (!field.is_given[field.at(x, y)]) continue;
      float farthest = picture.depth[field.at(x, y)];
      bool is_beside = false;
      for (int dy = -margin; dy <= margin; ++dy)
        for (int dx = -margin; dx <= margin; ++dx) is_beside = is_beside || is_hole(x + dx, y + dy);
      for (int dy = -margin; is_beside && dy <= margin; ++dy)
        for (int dx = -margin; dx <= margin; ++dx)
          if (x + dx >= 0 && y + dy >= 0 && x + dx < field.width && y + dy < field.height)
            farthest = std::max(farthest, picture.depth[field.at(x + dx, y + dy)]);
      field.value[field.at(x, y)] = 1 / farthest;
    }
  if (std::none_of(field.is_given.begin(), field.is_given.end(), [](bool is) { return is; })) return picture;
  span_membrane(field);
  DepthPicture out = picture;
  for (std::size_t i = 0; i < out.depth.size(); ++i)
    if (!(out.depth[i] > 0)) out.depth[i] = 1 / field.value[i];
  return out;
}

VisualMesh guess_background(Device& device, const Capture& capture, std::span<const CaptureFrame> frames,
                            const VisualMesh& measured, double max_depth) {
  std::vector<Camera> cameras;
  for (const CaptureFrame& frame : frames) cameras.push_back(reduced(frame.color_camera));
  SurfaceViews views(device, {&measured, 1}, cameras);
  std::vector<DepthPicture> seen, completed;
  Box box;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    seen.push_back(views.depth(i));
    DepthPicture picture = seen.back();
    add_measured(frames[i].depth_camera, depth_of(capture, frames[i]), max_depth, cameras[i], picture);
    completed.push_back(without_holes(picture, MARGIN));
    box.add(seen_box(cameras[i], completed.back(), FARTHEST * max_depth));
  }
  Fusion fusion(device, coarse_fusion(max_depth), box);
  for (std::size_t i = 0; i < frames.size(); ++i) fusion.mark(cameras[i], completed[i]);
  fusion.allocate();
  for (std::size_t i = 0; i < frames.size(); ++i) fusion.integrate(cameras[i], completed[i]);
  FusedSurface surface = without_unused(fusion.surface());
  const std::vector<Vec3f> normals = point_normals(surface.points, surface.triangles);
  std::vector<bool> is_in_front(surface.points.size(), false);
  for (std::size_t k = 0; k < surface.points.size(); ++k) {
    surface.points[k] -= float(BEHIND) * normals[k];
    for (std::size_t i = 0; i < frames.size() && !is_in_front[k]; ++i)
      is_in_front[k] = hides(cameras[i], seen[i], surface.points[k].cast<double>());
  }
  std::erase_if(surface.triangles,
                [&](const Triangle& t) { return is_in_front[t[0]] || is_in_front[t[1]] || is_in_front[t[2]]; });
  surface = without_unused(surface);
  VisualMesh mesh;
  mesh.points = std::move(surface.points);
  mesh.triangles = std::move(surface.triangles);
  return mesh;
}

}  // namespace pvg
