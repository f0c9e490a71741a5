// A texture that is cut from photos, and its parts: the choice of photos, rectangles, seams.
#include "host/capture/texture_atlas.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "host/capture/photo_choice.hpp"
#include "host/capture/seam_levels.hpp"
#include "host/formats/picture_files.hpp"
#include "host/pictures/pack_rectangles.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

TEST(PackRectangles, NoneMeetsAnother) {
  std::mt19937 random(5);
  std::vector<std::array<int, 2>> sizes = {{300, 2}};
  for (int i = 0; i < 200; ++i) sizes.push_back({1 + int(random() % 40), 1 + int(random() % 30)});
  const PackedRectangles packed = pack_rectangles(sizes, 4096);
  std::vector<int> taken(std::size_t(packed.width * packed.height), 0);
  double area = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    area += sizes[i][0] * sizes[i][1];
    ASSERT_LE(packed.corners[i][0] + sizes[i][0], packed.width);
    ASSERT_LE(packed.corners[i][1] + sizes[i][1], packed.height);
    for (int y = 0; y < sizes[i][1]; ++y)
      for (int x = 0; x < sizes[i][0]; ++x)
        ++taken[std::size_t((packed.corners[i][1] + y) * packed.width + packed.corners[i][0] + x)];
  }
  EXPECT_EQ(*std::max_element(taken.begin(), taken.end()), 1);
  EXPECT_LE(packed.width * packed.height, 1.3 * area);
  EXPECT_THROW(pack_rectangles(sizes, 64), std::exception);
}

// a strip of triangles side by side
std::vector<Triangle> strip(std::uint32_t n) {
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i < n; ++i)
    triangles.push_back(i % 2 ? Triangle{i + 1, i, i + 2} : Triangle{i, i + 1, i + 2});
  return triangles;
}

TEST(ChoosePhotos, NeighboursTakeOnePhotoWhereAnotherIsHardlyBetter) {
  const std::vector<Triangle> triangles = strip(40);
  std::vector<Candidates> candidates(40);
  for (std::size_t f = 0; f < 40; ++f) {
    const float noise = f % 2 ? 0.05f : -0.05f;  // alone, every second triangle of the middle would change
    add_candidate(candidates[f], {0, std::max(0.0f, 1 - float(f) / 40 + noise)});
    add_candidate(candidates[f], {1, float(f) / 40});
  }
  candidates[39] = {};
  const std::vector<int> photos = choose_photos(triangles, candidates);
  int changes = 0;
  for (std::size_t f = 1; f < 39; ++f) changes += photos[f] != photos[f - 1];
  EXPECT_EQ(changes, 1);
  EXPECT_EQ(photos[0], 0);
  EXPECT_EQ(photos[38], 1);
  EXPECT_EQ(photos[39], -1);
  const std::vector<std::uint32_t> charts = find_charts(triangles, photos);
  EXPECT_EQ(std::set<std::uint32_t>(charts.begin(), charts.end()).size(), 3u);
}

TEST(ChoosePhotos, TheBestFourAreKept) {
  Candidates candidates;
  for (const float quality : {3.0f, 1.0f, 5.0f, 0.0f, 4.0f, 2.0f}) add_candidate(candidates, {int(quality), quality});
  EXPECT_EQ(candidates[0].photo, 5);
  EXPECT_EQ(candidates[1].photo, 4);
  EXPECT_EQ(candidates[2].photo, 3);
  EXPECT_EQ(candidates[3].photo, 2);
}

// Two charts of one strip, one of them brighter by 0.2: half of the step is taken from each, and it fades away.
TEST(LevelSeams, AStepBetweenTwoChartsIsGone) {
  std::vector<ChartCorner> corners;
  std::vector<Triangle> triangles;
  for (const std::uint32_t chart : {0u, 1u}) {
    const std::uint32_t first = std::uint32_t(corners.size());
    for (std::uint32_t i = 0; i < 82; ++i)
      corners.push_back({80 * chart + i, Vec3f::Constant(0.4f + 0.2f * float(chart)), true});
    for (Triangle t : strip(80)) {
      for (std::uint32_t& i : t) i += first;
      triangles.push_back(t);
    }
  }
  const std::vector<Vec3f> g = level_seams(corners, triangles);
  for (const std::uint32_t seam : {80u, 81u}) {
    EXPECT_NEAR(g[seam].x(), 0.1f, 0.01f);
    EXPECT_NEAR(g[seam].x() - g[seam + 2].x(), 0.2f, 0.01f);
  }
  EXPECT_LT(std::abs(g[0].x()), 0.01f);
  for (ChartCorner& corner : corners) corner.is_seen = corner.point < 80;
  for (const Vec3f& none : level_seams(corners, triangles)) EXPECT_EQ(none, Vec3f::Zero());
}

constexpr int WIDTH = 320, HEIGHT = 240;
constexpr double FOCAL = 300;

// in sRGB; finer than the points of the surface
Vec3f pattern(double x, double y) {
  const float wave = float(std::sin(2 * M_PI * x / 0.06) * std::sin(2 * M_PI * y / 0.05));
  return {0.5f + 0.25f * wave, 0.5f - 0.2f * wave, 0.4f};
}

// A floor of 1 x 0.6 m with a point every 5 cm, seen from a metre above by three cameras that look straight down; what
// is red went through the second one's picture.
TEST(TextureAtlas, AFloorIsSeenFinerThanItsPoints) {
  const TestFolder folder;
  CapturedSurface floor;
  for (int j = 0; j <= 12; ++j)
    for (int i = 0; i <= 20; ++i) {
      floor.mesh.points.emplace_back(0.05f * float(i), 0.05f * float(j), 0.0f);
      floor.mesh.colors.emplace_back(0.2f, 0.2f, 0.13f);  // linear, of the pattern's middle
    }
  for (std::uint32_t j = 0; j < 12; ++j)
    for (std::uint32_t i = 0; i < 20; ++i) {
      const std::uint32_t a = 21 * j + i;
      floor.mesh.triangles.push_back({a, a + 1, a + 22});
      floor.mesh.triangles.push_back({a, a + 22, a + 21});
    }
  std::vector<CaptureFrame> frames;
  std::vector<DepthPicture> depths;
  for (int k = 0; k < 3; ++k) {
    CaptureFrame frame;
    Camera& camera = frame.color_camera;
    camera.width = WIDTH;
    camera.height = HEIGHT;
    camera.fx = camera.fy = FOCAL;
    camera.cx = 0.5 * (WIDTH - 1);
    camera.cy = 0.5 * (HEIGHT - 1);
    camera.pose.linear() = Vec3(1, -1, -1).asDiagonal();  // straight down
    camera.pose.translation() = Vec3(0.35 + 0.15 * k, 0.3, 1);
    frame.color = folder.path / ("photo" + std::to_string(k) + ".png");
    Picture8 photo{WIDTH, HEIGHT, {}};
    for (int y = 0; y < HEIGHT; ++y)
      for (int x = 0; x < WIDTH; ++x) {
        const Vec3f color = pattern(camera.pose.translation().x() + (x - camera.cx) / FOCAL,
                                    camera.pose.translation().y() - (y - camera.cy) / FOCAL);
        const bool is_passer_by = k == 1 && x > 120 && x < 200;
        for (int channel = 0; channel < 3; ++channel)
          photo.rgb.push_back(std::uint8_t(std::lround(255 * (is_passer_by ? float(channel == 0) : color[channel]))));
      }
    write_picture(frame.color, photo);
    frames.push_back(frame);
    depths.push_back({WIDTH, HEIGHT, std::vector<float>(WIDTH * HEIGHT, 1.0f)});
  }
  Device device("", Purpose::rendering);
  const std::vector<Vec3f> gains(3, Vec3f::Ones());
  const CapturedSurface look = texture_surface(device, {frames, depths, gains}, floor.mesh, 0.01);
  ASSERT_EQ(look.mesh.triangles.size(), floor.mesh.triangles.size());
  std::size_t n_seen = 0;
  double worst = 0;
  for (const Triangle& t : look.mesh.triangles) {
    if (look.mesh.colors[t[0]] != Vec3f::Ones()) continue;  // no photo sees it
    ++n_seen;
    for (const Vec3f& shares : {Vec3f(0.4f, 0.3f, 0.3f), Vec3f(0.9f, 0.05f, 0.05f), Vec3f(0.1f, 0.1f, 0.8f)}) {
      Vec3f p = Vec3f::Zero();
      Vec2f uv = Vec2f::Zero();
      for (std::size_t k = 0; k < 3; ++k) {
        p += shares[Eigen::Index(k)] * look.mesh.points[t[k]];
        uv += shares[Eigen::Index(k)] * look.mesh.uvs[t[k]];
      }
      const int x = int(uv.x() * float(look.texture.width)), y = int(uv.y() * float(look.texture.height));
      const std::uint8_t* texel = &look.texture.rgba[4 * std::size_t(y * look.texture.width + x)];
      const Vec3f color = pattern(double(p.x()), double(p.y()));
      for (int channel = 0; channel < 3; ++channel)
        worst = std::max(worst, std::abs(double(texel[channel]) / 255 - double(color[channel])));
    }
  }
  EXPECT_GT(n_seen, 400u);
  // half a pixel of the pattern's slope: 0.25 x 2 pi / 0.05 m x 1.7 mm = 0.05
  EXPECT_LT(worst, 0.08);
}

}  // namespace
}  // namespace pvg
