#include "host/capture/objects/splats.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "host/base/error.hpp"
#include "host/capture/objects/ply_table.hpp"
#include "host/pictures/srgb.hpp"
#include "host/render/camera.hpp"

namespace pvg {
namespace {

constexpr float HARMONIC_0 = 0.28209479f;  // Y_00 = 1 / (2 sqrt(pi))
constexpr float FLATNESS = 0.01f;          // thinnest scale over the longest: of 2DGS, whose splats are flat

float logistic(float x) { return 1 / (1 + std::exp(-x)); }

const std::vector<float>& column(const PlyTable& table, const std::string& name, const std::filesystem::path& file) {
  const auto at = table.column.find(name);
  if (at == table.column.end())
    throw UsageError(file.string() + ": the splats have no property `" + name +
                     "`; 3DGS, PGSR, 2DGS and TSGS write it, so export the file again");
  for (std::size_t i = 0; i < at->second.size(); ++i)
    if (!std::isfinite(at->second[i]))
      throw UsageError(file.string() + ": `" + name + "` of splat " + std::to_string(i) +
                       " is not a finite number; export the file again");
  return at->second;
}

struct Tiles {
  std::vector<u32> first, order;
};

// The splats that touch each tile of the picture, from near to far.
Tiles tiles_of(const Splats& splats, const Camera& camera) {
  const int columns = (camera.width + int(SPLAT_TILE) - 1) / int(SPLAT_TILE),
            rows = (camera.height + int(SPLAT_TILE) - 1) / int(SPLAT_TILE);
  const Eigen::Isometry3f to_camera = camera.pose.inverse().cast<float>();
  std::vector<std::pair<float, u32>> by_depth;
  for (u32 i = 0; i < splats.splats.size(); ++i) {
    const Splat& s = splats.splats[i];
    const float z = (to_camera * Vec3f(s.center[0], s.center[1], s.center[2])).z();
    if (z > s.radius) by_depth.emplace_back(z, i);
  }
  std::sort(by_depth.begin(), by_depth.end());
  std::vector<std::vector<u32>> in(std::size_t(columns) * std::size_t(rows));
  for (const auto& [z, i] : by_depth) {
    const Splat& s = splats.splats[i];
    const Vec3f p = to_camera * Vec3f(s.center[0], s.center[1], s.center[2]);
    // of the ball around it, also seen from aside
    const double reach = std::max(camera.fx, camera.fy) * double(s.radius / (z - s.radius)) *
                         (1 + double(std::max(std::abs(p.x()), std::abs(p.y())) / z));
    const double u = camera.fx * double(p.x() / z) + camera.cx, v = camera.fy * double(p.y() / z) + camera.cy;
    const int left = std::max(0, int(std::floor((u - reach) / SPLAT_TILE))),
              right = std::min(columns - 1, int(std::floor((u + reach) / SPLAT_TILE))),
              top = std::max(0, int(std::floor((v - reach) / SPLAT_TILE))),
              bottom = std::min(rows - 1, int(std::floor((v + reach) / SPLAT_TILE)));
    for (int y = top; y <= bottom; ++y)
      for (int x = left; x <= right; ++x) in[std::size_t(y * columns + x)].push_back(i);
  }
  Tiles out;
  for (const std::vector<u32>& tile : in) {
    out.first.push_back(u32(out.order.size()));
    out.order.insert(out.order.end(), tile.begin(), tile.end());
  }
  out.first.push_back(u32(out.order.size()));
  return out;
}

}  // namespace

bool is_splat_file(const std::filesystem::path& file) {
  const std::vector<std::string> names = ply_properties(file);
  const auto has = [&](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  return has("scale_0") || has("rot_0") || has("f_dc_0");
}

Splats read_splats(const std::filesystem::path& file, double scale) {
  const PlyTable table = read_ply_table(file);
  const bool is_flat = table.column.count("scale_2") == 0;
  Splats out;
  out.format = table.column.count("transparency") ? "TSGS" : is_flat ? "2DGS" : "3DGS";
  const auto get = [&](const std::string& name) -> const std::vector<float>& { return column(table, name, file); };
  const std::vector<float>*position[3] = {&get("x"), &get("y"), &get("z")},
        *color[3] = {&get("f_dc_0"), &get("f_dc_1"), &get("f_dc_2")},
        *rotation[4] = {&get("rot_0"), &get("rot_1"), &get("rot_2"), &get("rot_3")},
        *sizes[2] = {&get("scale_0"), &get("scale_1")};
  const std::vector<float>& opacity = get("opacity");
  const std::vector<float>* thickness = is_flat ? nullptr : &get("scale_2");
  for (std::size_t i = 0; i < table.n; ++i) {
    Eigen::Quaternionf q((*rotation[0])[i], (*rotation[1])[i], (*rotation[2])[i], (*rotation[3])[i]);
    if (!(q.norm() > 0))
      throw UsageError(file.string() + ": the quaternion of splat " + std::to_string(i) + " is zero; export it again");
    const Eigen::Matrix3f axes = q.normalized().toRotationMatrix();
    Vec3f size(std::exp((*sizes[0])[i]), std::exp((*sizes[1])[i]), thickness ? std::exp((*thickness)[i]) : 0.0f);
    size *= float(scale);
    const float longest = size.maxCoeff();
    size = size.cwiseMax(FLATNESS * longest);
    if (!(longest > 0 && std::isfinite(longest)))
      throw UsageError(file.string() + ": the scale of splat " + std::to_string(i) +
                       " is out of range; scales must be logarithms");
    Splat splat{};
    Vec3f seen;
    for (int k = 0; k < 3; ++k) {
      splat.center[k] = float(scale) * (*position[k])[i];
      for (int c = 0; c < 3; ++c) splat.whiten[3 * k + c] = axes(c, k) / size[k];
      seen[k] = srgb_to_linear(std::clamp(0.5f + HARMONIC_0 * (*color[k])[i], 0.0f, 1.0f));
    }
    splat.opacity = logistic(opacity[i]);
    splat.radius = 3 * longest;
    out.splats.push_back(splat);
    out.colors.push_back(seen);
  }
  return out;
}

DepthPicture splat_depth(Device& device, const Splats& splats, const Camera& camera, float share) {
  Program program(device, "capture/splats.cl");
  Kernel blend = program.kernel("blend_splats");
  const Tiles tiles = tiles_of(splats, camera);
  const std::size_t n = std::size_t(camera.width) * std::size_t(camera.height);
  Buffer<Splat> splat_buffer(device, splats.splats, "splats");
  Buffer<u32> first(device, tiles.first, "first"), order(device, tiles.order, "order");
  Buffer<float> depth(device, n, "depth");
  blend(n, u32(n), pinhole_camera(camera, camera.pose.matrix()), share, splat_buffer, first, order, depth);
  return {camera.width, camera.height, depth.read()};
}

}  // namespace pvg
