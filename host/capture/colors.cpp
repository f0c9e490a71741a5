#include "host/capture/colors.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/base/error.hpp"
#include "host/pictures/srgb.hpp"
#include "host/render/camera.hpp"

namespace pvg {
namespace {

using F32x4Array = std::array<float, 4>;
using Bytes4 = std::array<std::uint8_t, 4>;

constexpr int FILL_ROUNDS = 64;  // neighbours' colours spread so far into what no photo sees

std::vector<float> packed(const std::vector<Vec3f>& v) {
  std::vector<float> out;
  out.reserve(3 * v.size());
  for (const Vec3f& p : v) out.insert(out.end(), {p.x(), p.y(), p.z()});
  return out;
}

std::vector<Bytes4> with_padding(const Picture8& picture) {
  std::vector<Bytes4> out(picture.rgb.size() / 3);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = {picture.rgb[3 * i], picture.rgb[3 * i + 1], picture.rgb[3 * i + 2], 255};
  return out;
}

// what nobody saw takes the mean of its neighbours, again and again
void fill_unseen(std::vector<Vec3f>& colors, std::vector<bool> is_known, const std::vector<Triangle>& triangles) {
  Vec3f mean = Vec3f::Zero();
  std::size_t n_known = 0;
  for (std::size_t i = 0; i < colors.size(); ++i)
    if (is_known[i]) {
      mean += colors[i];
      ++n_known;
    }
  mean /= float(std::max<std::size_t>(1, n_known));
  for (int round = 0; round < FILL_ROUNDS && n_known < colors.size(); ++round) {
    std::vector<Vec3f> sum(colors.size(), Vec3f::Zero());
    std::vector<float> n(colors.size(), 0.0f);
    for (const Triangle& t : triangles)
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t a = t[k], b = t[(k + 1) % 3];
        for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, a}})
          if (is_known[from] && !is_known[to]) {
            sum[to] += colors[from];
            n[to] += 1;
          }
      }
    std::size_t n_new = 0;
    for (std::size_t i = 0; i < colors.size(); ++i)
      if (n[i] > 0) {
        colors[i] = sum[i] / n[i];
        is_known[i] = true;
        ++n_new;
      }
    n_known += n_new;
    if (n_new == 0) break;
  }
  for (std::size_t i = 0; i < colors.size(); ++i)
    if (!is_known[i]) colors[i] = mean;
}

}  // namespace

SurfaceColors color_surface(Device& device, const Capture& capture, std::span<const CaptureFrame> frames,
                            const std::vector<Vec3f>& points, const std::vector<Vec3f>& normals,
                            const std::vector<Triangle>& triangles, double voxel) {
  Program program(device, "capture/colors.cl");
  Kernel add = program.kernel("add_colors"), mean = program.kernel("mean_colors");
  const std::size_t n = points.size();
  Buffer<float> point_buffer(device, packed(points), "points"), normal_buffer(device, packed(normals), "normals");
  std::vector<float> decode(256);
  for (int i = 0; i < 256; ++i) decode[std::size_t(i)] = srgb_to_linear(float(i) / 255);
  Buffer<float> decode_buffer(device, decode, "decode"), depth(device, 0, "depth");
  Buffer<Bytes4> photo(device, 0, "photo");
  Buffer<F32x4Array> before(device, n, "before"), sums(device, n, "sums");
  before.zero();
  SurfaceColors out;
  for (int pass = 0; pass < 2; ++pass) {
    sums.zero();
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const CaptureFrame& frame = frames[i];
      if (frame.color.empty()) continue;
      const DepthPicture depths = depth_of(capture, frame);
      depth.resize(depths.depth.size());
      depth.write(depths.depth);
      const std::vector<Bytes4> texels = with_padding(color_of(frame));
      photo.resize(texels.size());
      photo.write(texels);
      add(n, u32(n), pinhole_camera(frame.depth_camera, frame.depth_camera.pose.matrix()),
          pinhole_camera(frame.color_camera, frame.color_camera.pose.matrix()), float(3 * voxel), point_buffer,
          normal_buffer, depth, photo, decode_buffer, before, sums);
    }
    mean(n, u32(n), sums, before);
  }
  const std::vector<F32x4Array> result = before.read();
  std::vector<bool> is_known(n);
  for (std::size_t i = 0; i < n; ++i) {
    out.colors.emplace_back(result[i][0], result[i][1], result[i][2]);
    is_known[i] = result[i][3] > 0;
    out.n_seen += is_known[i];
  }
  fill_unseen(out.colors, is_known, triangles);
  return out;
}

void apply_color_offset(const ColorOffset& offset, std::span<CaptureFrame> frames) {
  for (CaptureFrame& frame : frames) {
    frame.color_camera.pose = frame.depth_camera.pose * offset.pose;
    frame.color_camera.fx *= offset.focal_scale;
    frame.color_camera.fy *= offset.focal_scale;
  }
}

}  // namespace pvg
