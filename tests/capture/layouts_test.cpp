// One camera in the words of each layout: at (1, 2, 3), turned by a right angle about z, looking along z at 1.5 m.
#include <gtest/gtest.h>

#include "host/base/error.hpp"
#include "host/capture/frames.hpp"
#include "host/formats/picture_files.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

constexpr int WALL_WIDTH = 8, WALL_HEIGHT = 6;

DepthPicture wall() { return {WALL_WIDTH, WALL_HEIGHT, std::vector<float>(WALL_WIDTH * WALL_HEIGHT, 1.5f)}; }

void write_photo(const std::filesystem::path& file) {
  std::filesystem::create_directories(file.parent_path());
  write_picture(file, {WALL_WIDTH, WALL_HEIGHT, std::vector<std::uint8_t>(3 * WALL_WIDTH * WALL_HEIGHT, 90)});
}

// fx 10, fy 11, the principal point where OpenCV's (3.5, 2.5) is
void expect_the_camera(const Capture& capture) {
  ASSERT_EQ(capture.frames.size(), 1u);
  const CaptureFrame& frame = capture.frames[0];
  EXPECT_FALSE(frame.color.empty());
  const Camera& camera = frame.depth_camera;
  EXPECT_EQ(camera.fx, 10);
  EXPECT_EQ(camera.fy, 11);
  EXPECT_EQ(camera.cx, 3.5);
  EXPECT_EQ(camera.cy, 2.5);
  EXPECT_TRUE((camera.pose * Vec3(0, 0, 1.5)).isApprox(Vec3(1, 2, 4.5), 1e-6));
  EXPECT_TRUE((camera.pose * Vec3(1, 0, 0)).isApprox(Vec3(1, 3, 3), 1e-6));  // x to the right is the world's y
  EXPECT_NEAR(depth_of(capture, frame).depth[13], 1.5, 1e-3);
}

TEST(Layouts, TumGivesCameraToWorldAndFifthsOfMillimetres) {
  const TestFolder folder;
  folder.write("camera.txt", "10 11 3.5 2.5\n");
  folder.write("depth.txt", "# time file\n10.000 d.png\n99.0 e.png\n");
  folder.write("rgb.txt", "10.015 c.png\n");
  folder.write("groundtruth.txt", "9.99 1 2 3 0 0 0.70710678 0.70710678\n");
  write_depth_picture(folder.path / "d.png", wall(), 1 / 5000.0);
  write_photo(folder.path / "c.png");
  expect_the_camera(read_capture(folder.path));
  folder.write("groundtruth.txt", "9.99 1 2 3 0 0 0.7 0\n");
  expect_error<UsageError>([&] { read_capture(folder.path); }, {"groundtruth.txt", "quaternion"});
}

TEST(Layouts, NerfstudioLooksBackwardAndCountsFromThePixelsCorner) {
  const TestFolder folder;
  const std::string optics = R"("fl_x": 10, "fl_y": 11, "cx": 4, "cy": 3, "w": 8, "h": 6)";
  const auto file = [&](const std::string& matrix) {
    return "{" + optics + R"(, "frames": [{"file_path": "c.png", "depth_file_path": "d.png", "transform_matrix": )" +
           matrix + "}]}";
  };
  folder.write("transforms.json", file("[[0, 1, 0, 1], [1, 0, 0, 2], [0, 0, -1, 3], [0, 0, 0, 1]]"));
  write_depth_picture(folder.path / "d.png", wall(), 1e-3);
  write_photo(folder.path / "c.png");
  expect_the_camera(read_capture(folder.path));
  folder.write("transforms.json", file(R"([[0, "a"]])"));
  expect_error<UsageError>([&] { read_capture(folder.path); }, {"transforms.json", "transform_matrix"});
}

TEST(Layouts, ColmapGivesWorldToCameraAndCountsFromThePixelsCorner) {
  const TestFolder folder;
  folder.write("sparse/cameras.txt", "# id model\n1 PINHOLE 8 6 10 11 4 3\n");
  folder.write("sparse/images.txt", "# id q t\n1 0.70710678 0 0 -0.70710678 -2 1 -3 1 c.png\n\n");
  write_photo(folder.path / "images" / "c.png");
  std::string depth = "8&6&1&";
  const std::vector<float> values = wall().depth;
  depth.append(reinterpret_cast<const char*>(values.data()), 4 * values.size());
  folder.write("stereo/depth_maps/c.png.geometric.bin", depth);
  expect_the_camera(read_capture(folder.path));
  folder.write("sparse/images.txt", "1 0.70710678 0 0 -0.70710678 -2 1 -3 7 c.png\n\n");
  expect_error<UsageError>([&] { read_capture(folder.path); }, {"c.png", "camera that is not there"});
}

}  // namespace
}  // namespace pvg
