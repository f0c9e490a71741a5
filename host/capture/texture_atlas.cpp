// 1. Each triangle takes its photo by choose_photos; a photo whose colours differ from the mean of all is trusted less.
// 2. Connected triangles of one photo are a chart; its rectangle of the photo goes into the texture as it is, texel by
//    pixel, so that nothing is resampled.
// 3. level_seams tells what is added at each corner; inside a triangle the additions are interpolated.
#include "host/capture/texture_atlas.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "host/capture/photo_choice.hpp"
#include "host/capture/seam_levels.hpp"
#include "host/capture/surface.hpp"
#include "host/pictures/pack_rectangles.hpp"
#include "host/pictures/srgb.hpp"
#include "host/render/camera.hpp"

namespace pvg {
namespace {

constexpr int MOST_PIXELS = 16384;  // along an edge; what graphics cards take
constexpr int BORDER = 2;           // painted around a chart, for the filter of textures [texels]
constexpr int BLUR = 1;             // of photos whose colours are compared
constexpr float SPREAD = 0.1f;      // of linear light; as in capture/colors.cl

struct Chart {
  int photo = -1;
  std::size_t first = 0, n = 0;            // of its triangles in Charts::triangles
  std::array<int, 2> low = {}, size = {};  // its rectangle in the photo [pixels]
  std::array<int, 2> place = {};           // of the rectangle in the texture
};

struct Charts {
  std::vector<Chart> charts;
  std::vector<Triangle> triangles;   // of corners, chart by chart
  std::vector<ChartCorner> corners;  // colours in sRGB, of charts with a photo
  std::vector<Vec2f> pixels;         // [n_corners] in the chart's photo
  std::vector<std::uint32_t> chart_of_corner;
};

std::vector<Candidates> see_triangles(Device& device, const Photos& photos, const VisualMesh& mesh, double tolerance) {
  std::vector<Candidates> candidates(mesh.triangles.size());
  const std::vector<Vec3f> normals = point_normals(mesh.points, mesh.triangles);
  see_points(device, photos, mesh.points, normals, tolerance, BLUR,
             [&](std::size_t photo, const std::vector<SeenColor>& seen) {
               const auto quality = [&](std::uint32_t i) {
                 return seen[i].weight / (1 + (seen[i].color - mesh.colors[i]).squaredNorm() / (SPREAD * SPREAD));
               };
               for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
                 const auto& [a, b, c] = mesh.triangles[f];
                 add_candidate(candidates[f], {int(photo), std::min({quality(a), quality(b), quality(c)})});
               }
             });
  return candidates;
}

Charts cut_charts(const VisualMesh& mesh, std::span<const int> photos) {
  const std::vector<std::uint32_t> number = find_charts(mesh.triangles, photos);
  Charts out;
  std::vector<std::vector<std::uint32_t>> members;
  for (std::uint32_t f = 0; f < number.size(); ++f) {
    if (number[f] >= members.size()) members.resize(number[f] + 1);
    members[number[f]].push_back(f);
  }
  std::unordered_map<std::uint32_t, std::uint32_t> corner_of_point;
  for (const std::vector<std::uint32_t>& triangles : members) {
    corner_of_point.clear();
    Chart chart;
    chart.photo = photos[triangles.front()];
    chart.first = out.triangles.size();
    chart.n = triangles.size();
    for (const std::uint32_t f : triangles) {
      Triangle corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t point = mesh.triangles[f][k];
        const auto [found, is_new] = corner_of_point.try_emplace(point, std::uint32_t(out.corners.size()));
        if (is_new) {
          out.corners.push_back({point, Vec3f::Zero(), chart.photo >= 0});
          out.chart_of_corner.push_back(std::uint32_t(out.charts.size()));
        }
        corners[k] = found->second;
      }
      out.triangles.push_back(corners);
    }
    out.charts.push_back(chart);
  }
  out.pixels.assign(out.corners.size(), Vec2f::Zero());
  return out;
}

// A photo in sRGB with its gain applied, in [0, 1].
struct EqualPhoto {
  Picture8 picture;
  std::array<std::array<float, 256>, 3> value;

  EqualPhoto(const CaptureFrame& frame, const Vec3f& gain) : picture(color_of(frame)) {
    for (int channel = 0; channel < 3; ++channel)
      for (int byte = 0; byte < 256; ++byte)
        value[std::size_t(channel)][std::size_t(byte)] =
            linear_to_srgb(std::clamp(gain[channel] * srgb_to_linear(float(byte) / 255), 0.0f, 1.0f));
  }
  Vec3f at(int x, int y) const {
    x = std::clamp(x, 0, picture.width - 1);
    y = std::clamp(y, 0, picture.height - 1);
    const std::uint8_t* p = &picture.rgb[3 * std::size_t(y * picture.width + x)];
    return {value[0][p[0]], value[1][p[1]], value[2][p[2]]};
  }
  // mean over 3 x 3 pixels, so that the noise of one does not become a level
  Vec3f around(const Vec2f& pixel) const {
    Vec3f sum = Vec3f::Zero();
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        sum += at(int(std::lround(pixel.x())) + dx, int(std::lround(pixel.y())) + dy) / 9;
    return sum;
  }
};

// pixels and colours of all corners, rectangles of all charts
void see_corners(Device& device, const Photos& photos, const VisualMesh& mesh, Charts& charts) {
  Program program(device, "capture/rays.cl");
  Kernel point_pixels = program.kernel("point_pixels");
  Buffer<float> points(device, 0, "points"), pixels(device, 0, "pixels");
  std::vector<std::vector<std::uint32_t>> corners_of_photo(photos.frames.size());
  for (std::uint32_t i = 0; i < charts.corners.size(); ++i)
    if (const int photo = charts.charts[charts.chart_of_corner[i]].photo; photo >= 0)
      corners_of_photo[std::size_t(photo)].push_back(i);
  for (std::size_t photo = 0; photo < photos.frames.size(); ++photo) {
    const std::vector<std::uint32_t>& corners = corners_of_photo[photo];
    if (corners.empty()) continue;
    std::vector<float> xyz;
    for (const std::uint32_t i : corners) {
      const Vec3f& p = mesh.points[charts.corners[i].point];
      xyz.insert(xyz.end(), {p.x(), p.y(), p.z()});
    }
    points.resize(xyz.size());
    points.write(xyz);
    pixels.resize(2 * corners.size());
    const Camera& camera = photos.frames[photo].color_camera;
    point_pixels(corners.size(), u32(corners.size()), pinhole_camera(camera, camera.pose.matrix()), points, pixels);
    const std::vector<float> seen = pixels.read();
    const EqualPhoto shown(photos.frames[photo], photos.gains[photo]);
    for (std::size_t k = 0; k < corners.size(); ++k) {
      charts.pixels[corners[k]] = {seen[2 * k], seen[2 * k + 1]};
      charts.corners[corners[k]].color = shown.around(charts.pixels[corners[k]]);
    }
  }
  for (Chart& chart : charts.charts) {
    if (chart.photo < 0) continue;
    Vec2f low = Vec2f::Constant(INFINITY), high = -low;
    for (std::size_t f = chart.first; f < chart.first + chart.n; ++f)
      for (const std::uint32_t i : charts.triangles[f]) {
        low = low.cwiseMin(charts.pixels[i]);
        high = high.cwiseMax(charts.pixels[i]);
      }
    for (int axis = 0; axis < 2; ++axis) {
      chart.low[std::size_t(axis)] = int(std::floor(low[axis])) - BORDER;
      chart.size[std::size_t(axis)] = int(std::ceil(high[axis])) + BORDER + 1 - chart.low[std::size_t(axis)];
    }
  }
}

float cross(const Vec2f& a, const Vec2f& b) { return a.x() * b.y() - a.y() * b.x(); }

enum class Texel : std::uint8_t { empty, border, inside };

// the photo's pixels in a triangle and on a border around it, with the levels of its corners
void paint(const EqualPhoto& photo, const Chart& chart, const std::array<Vec2f, 3>& pixels,
           const std::array<Vec3f, 3>& levels, Texture& texture, std::vector<Texel>& texels) {
  const float area = cross(pixels[1] - pixels[0], pixels[2] - pixels[0]);
  if (area == 0) return;
  Vec2f low = pixels[0], high = pixels[0];
  for (const Vec2f& p : pixels) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  for (int y = int(std::floor(low.y())) - BORDER; y <= int(std::ceil(high.y())) + BORDER; ++y)
    for (int x = int(std::floor(low.x())) - BORDER; x <= int(std::ceil(high.x())) + BORDER; ++x) {
      const Vec2f p{float(x), float(y)};
      float shares[3], nearest = INFINITY, sum = 0;  // nearest: to an edge, negative outside [pixels]
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec2f &a = pixels[(k + 1) % 3], &b = pixels[(k + 2) % 3];
        shares[k] = cross(b - a, p - a) / area;
        nearest = std::min(nearest, shares[k] * std::abs(area) / (b - a).norm());
        sum += shares[k] = std::max(0.0f, shares[k]);
      }
      if (nearest < -BORDER) continue;
      const int tx = x - chart.low[0] + chart.place[0], ty = y - chart.low[1] + chart.place[1];
      const std::size_t at = std::size_t(ty) * std::size_t(texture.width) + std::size_t(tx);
      const Texel kind = nearest >= 0 ? Texel::inside : Texel::border;
      if (texels[at] >= kind) continue;
      texels[at] = kind;
      Vec3f color = photo.at(x, y);
      for (std::size_t k = 0; k < 3; ++k) color += shares[k] / sum * levels[k];
      for (int channel = 0; channel < 3; ++channel)
        texture.rgba[4 * at + std::size_t(channel)] =
            std::uint8_t(std::lround(255 * std::clamp(color[channel], 0.0f, 1.0f)));
    }
}

// the charts' places in the texture; the first corner is that of a white square, for triangles that no photo sees
std::array<int, 2> place_charts(Charts& charts, Texture& texture) {
  constexpr int WHITE = 2 * BORDER + 1;
  std::vector<std::array<int, 2>> sizes = {{WHITE, WHITE}};
  for (const Chart& chart : charts.charts) sizes.push_back(chart.size);
  const PackedRectangles packed = pack_rectangles(sizes, MOST_PIXELS);
  for (std::size_t i = 0; i < charts.charts.size(); ++i) charts.charts[i].place = packed.corners[i + 1];
  texture.width = packed.width;
  texture.height = packed.height;
  texture.rgba.assign(4 * std::size_t(texture.width) * std::size_t(texture.height), 255);
  return packed.corners[0];
}

void paint_charts(const Photos& photos, const Charts& charts, const std::vector<Vec3f>& levels, Texture& texture) {
  std::vector<Texel> texels(texture.rgba.size() / 4, Texel::empty);
  std::vector<std::vector<const Chart*>> of_photo(photos.frames.size());
  for (const Chart& chart : charts.charts)
    if (chart.photo >= 0) of_photo[std::size_t(chart.photo)].push_back(&chart);
  for (std::size_t photo = 0; photo < of_photo.size(); ++photo) {
    if (of_photo[photo].empty()) continue;
    const EqualPhoto shown(photos.frames[photo], photos.gains[photo]);
    for (const Chart* chart : of_photo[photo])
      for (std::size_t f = chart->first; f < chart->first + chart->n; ++f) {
        const auto& [a, b, c] = charts.triangles[f];
        paint(shown, *chart, {charts.pixels[a], charts.pixels[b], charts.pixels[c]}, {levels[a], levels[b], levels[c]},
              texture, texels);
      }
  }
}

}  // namespace

CapturedSurface texture_surface(Device& device, const Photos& photos, const VisualMesh& mesh, double tolerance) {
  const std::vector<int> photo_of_triangle =
      choose_photos(mesh.triangles, see_triangles(device, photos, mesh, tolerance));
  Charts charts = cut_charts(mesh, photo_of_triangle);
  see_corners(device, photos, mesh, charts);
  CapturedSurface out;
  const std::array<int, 2> white = place_charts(charts, out.texture);
  paint_charts(photos, charts, level_seams(charts.corners, charts.triangles), out.texture);
  const Vec2f size{float(out.texture.width), float(out.texture.height)};
  for (std::size_t i = 0; i < charts.corners.size(); ++i) {
    const std::uint32_t point = charts.corners[i].point;
    const Chart& chart = charts.charts[charts.chart_of_corner[i]];
    const bool is_seen = chart.photo >= 0;
    const Vec2f corner{float(is_seen ? chart.place[0] - chart.low[0] : white[0] + BORDER),
                       float(is_seen ? chart.place[1] - chart.low[1] : white[1] + BORDER)};
    out.mesh.points.push_back(mesh.points[point]);
    out.mesh.colors.push_back(is_seen ? Vec3f::Ones() : mesh.colors[point]);
    out.mesh.uvs.push_back((corner + charts.pixels[i] + Vec2f::Constant(0.5f)).cwiseQuotient(size));
  }
  out.mesh.triangles = charts.triangles;
  return out;
}

}  // namespace pvg
