#include "host/capture/colors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "host/capture/exposure.hpp"
#include "host/pictures/srgb.hpp"
#include "host/render/camera.hpp"

namespace pvg {
namespace {

using F32x4Array = std::array<float, 4>;
using Bytes4 = std::array<std::uint8_t, 4>;

constexpr int GAIN_BLUR = 8;     // rounds, so that a gain does not depend on what lies a pixel beside
constexpr int COLOR_BLUR = 1;    // points lie wider apart than pixels
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

// Photos one after another on the device, as the kernels of capture/colors.cl take them.
struct PhotoReader {
  const Photos& photos;
  std::vector<float> plain;  // [256] byte to linear light
  Buffer<float> depth, decode;
  Buffer<Bytes4> photo;

  PhotoReader(Device& device, const Photos& photos_)
      : photos(photos_), depth(device, 0, "depth"), decode(device, 3 * 256, "decode"), photo(device, 0, "photo") {
    for (int i = 0; i < 256; ++i) plain.push_back(srgb_to_linear(float(i) / 255));
  }

  PinholeCamera load(std::size_t frame, const Picture8& picture, const Vec3f& gain) {
    depth.resize(photos.depths[frame].depth.size());
    depth.write(photos.depths[frame].depth);
    const std::vector<Bytes4> texels = with_padding(picture);
    photo.resize(texels.size());
    photo.write(texels);
    std::vector<float> values;
    for (int channel = 0; channel < 3; ++channel)
      for (const float value : plain) values.push_back(gain[channel] * value);
    decode.write(values);
    const Camera& camera = photos.frames[frame].color_camera;
    return pinhole_camera(camera, camera.pose.matrix());
  }
};

// binomial filter; each round adds 1/2 to the variance [pixels^2]
Picture8 blurred(Picture8 picture, int rounds) {
  std::vector<std::uint8_t> out(picture.rgb.size());
  for (int round = 0; round < 2 * rounds; ++round) {
    const int axis = round % 2, step = axis == 0 ? 3 : 3 * picture.width;
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        const int along = axis == 0 ? x : y, last = (axis == 0 ? picture.width : picture.height) - 1;
        for (int k = 0; k < 3; ++k) {
          const int at = 3 * (y * picture.width + x) + k;
          const auto* v = picture.rgb.data();
          out[std::size_t(at)] =
              std::uint8_t((2 * v[at] + v[along > 0 ? at - step : at] + v[along < last ? at + step : at] + 2) / 4);
        }
      }
    picture.rgb.swap(out);
  }
  return picture;
}

}  // namespace

SurfaceColors color_surface(Device& device, const Photos& photos, const std::vector<Vec3f>& points,
                            const std::vector<Vec3f>& normals, const std::vector<Triangle>& triangles,
                            double tolerance) {
  Program program(device, "capture/colors.cl");
  Kernel add = program.kernel("add_colors"), mean = program.kernel("mean_colors");
  const std::size_t n = points.size();
  Buffer<float> point_buffer(device, packed(points), "points"), normal_buffer(device, packed(normals), "normals");
  PhotoReader reader(device, photos);
  Buffer<F32x4Array> before(device, n, "before"), sums(device, n, "sums");
  before.zero();
  SurfaceColors out;
  for (int pass = 0; pass < 2; ++pass) {
    sums.zero();
    for (std::size_t i = 0; i < photos.frames.size(); ++i) {
      if (photos.frames[i].color.empty()) continue;
      const PinholeCamera camera = reader.load(i, blurred(color_of(photos.frames[i]), COLOR_BLUR), photos.gains[i]);
      add(n, u32(n), camera, float(tolerance), point_buffer, normal_buffer, reader.depth, reader.photo, reader.decode,
          before, sums);
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

void see_points(Device& device, const Photos& photos, const std::vector<Vec3f>& points,
                const std::vector<Vec3f>& normals, double tolerance, int blur,
                const std::function<void(std::size_t, const std::vector<SeenColor>&)>& use) {
  const std::size_t n = points.size();
  Program program(device, "capture/colors.cl");
  Kernel see = program.kernel("see_colors");
  Buffer<float> point_buffer(device, packed(points), "points"), normal_buffer(device, packed(normals), "normals");
  Buffer<F32x4Array> seen_buffer(device, n, "seen");
  PhotoReader reader(device, photos);
  std::vector<SeenColor> seen(n);
  for (std::size_t i = 0; i < photos.frames.size(); ++i) {
    if (photos.frames[i].color.empty()) continue;
    const Vec3f gain = photos.gains.empty() ? Vec3f::Ones() : photos.gains[i];
    const PinholeCamera camera = reader.load(i, blurred(color_of(photos.frames[i]), blur), gain);
    see(n, u32(n), camera, float(tolerance), point_buffer, normal_buffer, reader.depth, reader.photo, reader.decode,
        seen_buffer);
    const std::vector<F32x4Array> colors = seen_buffer.read();
    for (std::size_t k = 0; k < n; ++k) seen[k] = {{colors[k][0], colors[k][1], colors[k][2]}, colors[k][3]};
    use(i, seen);
  }
}

std::vector<Vec3f> estimate_gains(Device& device, const Photos& photos, const std::vector<Vec3f>& points,
                                  const std::vector<Vec3f>& normals, double tolerance) {
  constexpr std::size_t MOST_POINTS = 20000;
  constexpr float DARKEST = 0.004f, BRIGHTEST = 0.85f;  // linear; beyond, a photo may be cut
  std::mt19937 random(0);
  std::vector<Vec3f> some_points, some_normals;
  for (std::size_t k = 0; k < std::min(MOST_POINTS, points.size()); ++k) {
    const std::size_t i = random() % points.size();
    some_points.push_back(points[i]);
    some_normals.push_back(normals[i]);
  }
  std::vector<ColorSample> samples;
  const Photos as_filed{photos.frames, photos.depths, {}};
  see_points(device, as_filed, some_points, some_normals, tolerance, GAIN_BLUR,
             [&](std::size_t photo, const std::vector<SeenColor>& seen) {
               for (std::size_t k = 0; k < seen.size(); ++k) {
                 const Vec3f& color = seen[k].color;
                 if (seen[k].weight > 0 && color.minCoeff() > DARKEST && color.maxCoeff() < BRIGHTEST)
                   samples.push_back({std::uint32_t(k), std::uint32_t(photo), color});
               }
             });
  return exposure_gains(samples, some_points.size(), photos.frames.size());
}

void apply_color_offset(const ColorOffset& offset, std::span<CaptureFrame> frames, bool are_aligned) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    CaptureFrame& frame = frames[i];
    frame.color_camera.pose = frame.depth_camera.pose * (are_aligned ? offset.photo_poses[i] : offset.pose);
    frame.color_camera.fx *= offset.focal_scale;
    frame.color_camera.fy *= offset.focal_scale;
    frame.color_camera.cx += offset.center[0];
    frame.color_camera.cy += offset.center[1];
  }
}

}  // namespace pvg
