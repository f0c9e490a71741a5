// The command `render`: pictures of scenes that were made for physics alone, of recorded motions, and its complaints.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "host/io/image_files.hpp"
#include "host/io/states_reader.hpp"
#include "host/scene/scene_file.hpp"
#include "pipeline/shown_scene.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

// a red cube falls past the camera, on white ground
const char* const falling = R"(schema: 1
name: falling
time_step: 10 ms
duration: 0.1 s
bodies:
  - {name: cube, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, density: 1000, pose: {position: [0, 0, 1]}}
environment: [1, 1, 1]
cameras:
  - {name: a, width: 32, height: 32, vertical_field_of_view: 30 deg, position: [0, -1, 1], look_at: [0, 0, 1]}
  - {name: b, width: 32, height: 16, vertical_field_of_view: 30 deg, position: [0, 1, 1], look_at: [0, 0, 1]}
)";

struct Render : testing::Test {
  TestFolder folder;
  std::string message;  // what stood on stderr

  int run(const std::string& arguments) {
    const fs::path err = folder.path / "stderr";
    const std::string command =
        "cd " + folder.path.string() + " && " + PVG_PROGRAM + " " + arguments + " >/dev/null 2>" + err.string();
    const int status = std::system(command.c_str());
    std::ifstream in(err);
    message = {std::istreambuf_iterator<char>(in), {}};
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::size_t n_files(const std::string& name) const {
    return std::size_t(std::distance(fs::directory_iterator(folder.path / name), fs::directory_iterator()));
  }
};

TEST_F(Render, ASceneWithoutLooksIsShownAndSaysWhatWasAdded) {
  folder.write("bare.yaml", R"({schema: 1, name: bare, time_step: 10 ms,
    bodies: [{name: cube, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, density: 1000},
             {name: floor, kind: half_space, point: [0, 0, -0.05], normal: [0, 0, 1]}]})");
  ASSERT_EQ(run("render bare.yaml -o bare.png --width 64 --height 36 --samples 4"), 0) << message;
  for (const char* missing : {"no visuals", "no cameras", "no light"})
    EXPECT_NE(message.find(missing), std::string::npos) << message;
  const Image8 picture = read_image(folder.path / "bare.png");
  ASSERT_EQ(picture.width, 64);
  // neither black nor blank
  const auto [low, high] = std::minmax_element(picture.rgb.begin(), picture.rgb.end());
  EXPECT_GT(*high - *low, 40);
  EXPECT_GT(*low, 5);
}

TEST_F(Render, ARecordedMotionGivesOnePicturePerCameraAndFrameThatShowIt) {
  folder.write("falling.yaml", falling);
  ASSERT_EQ(run("simulate falling.yaml -o falling.h5"), 0) << message;
  ASSERT_EQ(run("render falling.yaml --states falling.h5 --fps 50 --samples 2 -o all"), 0) << message;
  EXPECT_EQ(n_files("all"), 2u * 5);  // steps at 0.01 to 0.1 s
  ASSERT_EQ(run("render falling.yaml --states falling.h5 --fps 50 --frames 1:3 --camera b --samples 2 -o some"), 0);
  EXPECT_EQ(n_files("some"), 2u);
  EXPECT_TRUE(fs::exists(folder.path / "some/b_000002.png"));
  const Image8 first = read_image(folder.path / "all/a_000000.png"),
               last = read_image(folder.path / "all/a_000004.png");
  EXPECT_NE(first.rgb, last.rgb);
  ASSERT_EQ(run("render falling.yaml --states falling.h5 --fps 50 --camera a --samples 2 -o a.mp4"), 0) << message;
  EXPECT_GT(fs::file_size(folder.path / "a.mp4"), 500u);
  // linear light
  ASSERT_EQ(run("render falling.yaml --camera a --samples 1 -o a.exr"), 0) << message;
  EXPECT_GT(fs::file_size(folder.path / "a.exr"), 500u);

  // what is between the steps: half of the way fallen from step to step
  const Scene scene = load_scene_run(folder.path / "falling.yaml").scene;
  const Frames frames(scene, (folder.path / "falling.h5").string(), 50);
  const StatesReader reader(folder.path / "falling.h5", scene);
  const double z = reader.state(2).rigid[0](2, 3), below = reader.state(3).rigid[0](2, 3);
  EXPECT_LT(below, z - 1e-4);
  EXPECT_NEAR(frames.at(0.035).rigid[0](2, 3), (z + below) / 2, 1e-12);
  EXPECT_EQ(frames.at(-1).rigid[0](2, 3), reader.state(0).rigid[0](2, 3));
}

TEST_F(Render, WrongUseIsOneSentence) {
  folder.write("falling.yaml", falling);
  folder.write("other.yaml", R"({schema: 1, name: other, time_step: 10 ms, duration: 20 ms,
    bodies: [{name: ball, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, density: 1000}]})");
  ASSERT_EQ(run("simulate other.yaml -o other.h5"), 0) << message;
  const std::vector<std::array<std::string, 2>> cases = {
      {"render", "needs a scene"},
      {"render falling.yaml", "needs an output"},
      {"render none.yaml -o a.png", "none.yaml"},
      {"render falling.yaml -o a.txt", ".mp4"},
      {"render falling.yaml -o none/a.png", "none"},
      {"render falling.yaml -o a.png", "2 cameras"},
      {"render falling.yaml -o a.mp4", "--camera"},
      {"render falling.yaml --camera c -o a.png", "a, b"},
      {"render falling.yaml --frames 1:2 -o x", "--frames 1:2"},
      {"render falling.yaml --frames x -o x", "A:B"},
      {"render falling.yaml --states other.h5 -o x", "cube"},
      {"render falling.yaml --states falling.yaml -o x", "falling.yaml"},
      {"render falling.yaml --states none.h5 -o x", "none.h5"}};
  for (const auto& [arguments, names] : cases) {
    const int code = run(arguments);
    EXPECT_TRUE(code == 1 || code == 2) << arguments << ": " << code;
    EXPECT_NE(message.find(names), std::string::npos) << arguments << ": " << message;
    EXPECT_NE(message.find("phyvisgen: "), std::string::npos) << message;
  }
}

TEST(Frames, RangesAreHalfOpenAndChecked) {
  EXPECT_EQ(parse_frames("", 7).end, 7u);
  EXPECT_EQ(parse_frames("2:", 7).begin, 2u);
  EXPECT_EQ(parse_frames(":3", 7).end, 3u);
  EXPECT_EQ(parse_frames("4", 7).end, 5u);
  for (const char* bad : {"3:3", "5:2", "0:8", "7", "-1:2", "a:b", "1:2:3"})
    EXPECT_THROW(parse_frames(bad, 7), UsageError) << bad;
}

}  // namespace
}  // namespace pvg
