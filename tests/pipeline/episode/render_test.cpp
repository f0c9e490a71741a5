// The command `render`: pictures of scenes that were made for physics alone, of recorded motions, and its complaints.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "host/dataset/states_reader.hpp"
#include "host/formats/picture_files.hpp"
#include "host/load/scene_file.hpp"
#include "pipeline/episode/shown_scene.hpp"
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
  const Picture8 picture = read_picture(folder.path / "bare.png");
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
  const Picture8 first = read_picture(folder.path / "all/a_000000.png"),
                 last = read_picture(folder.path / "all/a_000004.png");
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

TEST_F(Render, GroundTruthIsWrittenBesideThePictures) {
  folder.write("falling.yaml", falling);
  ASSERT_EQ(run("simulate falling.yaml -o falling.h5"), 0) << message;
  ASSERT_EQ(run("render falling.yaml --states falling.h5 --fps 50 --camera a --samples 1 --ground-truth -o out"), 0)
      << message;
  const hdf5::File truth = hdf5::File::open(folder.path / "out/a_truth.h5");
  ASSERT_EQ(truth.shape("/depth"), (hdf5::Shape{5, 32, 32}));
  EXPECT_EQ(truth.texts_attribute("/instance", "names"), (std::vector<std::string>{"nothing", "cube"}));
  const auto depth = truth.read<float>("/depth").values;
  const auto instance = truth.read<std::uint16_t>("/instance").values;
  const auto flow = truth.read<float>("/flow_forward").values, back = truth.read<float>("/flow_backward").values;
  const auto state = truth.read<std::uint8_t>("/flow_forward_state").values;
  const auto box = truth.read<std::int32_t>("/box").values;
  const auto pose = truth.read<double>("/pose").values;
  const std::size_t middle = 16 * 32 + 16, n = 32 * 32;
  EXPECT_EQ(instance[middle], 1);
  EXPECT_NEAR(depth[middle], 0.95, 1e-4);  // the cube's front
  const double focal = 16 / std::tan(M_PI / 12);
  // it falls: downward in the picture, by focal / depth pixels per metre
  const double fallen = pose[11] - pose[12 + 11];
  EXPECT_GT(fallen, 1e-4);
  EXPECT_NEAR(flow[2 * middle + 1], focal * fallen / 0.95, 1e-3);
  EXPECT_NEAR(back[2 * (n + middle) + 1], -focal * fallen / 0.95, 1e-3);
  EXPECT_EQ(state[middle], 0);
  EXPECT_EQ(state[4 * n + middle], 2);  // there is no picture after the last
  // the front is 0.1 m wide: focal 0.05 / 0.95 pixels to both sides of 15.5
  EXPECT_EQ(box[0], int(std::ceil(15.5 - focal * 0.05 / 0.95)));
  EXPECT_EQ(box[2], int(std::floor(15.5 + focal * 0.05 / 0.95)));
}

TEST_F(Render, AnEpisodeWithRigidFingersIsShownWithThem) {
  const std::string task = PVG_DATA_FOLDER "/../tests/pipeline/small_task/push_beaker.yaml";
  ASSERT_EQ(run("generate " + task + " -n 1 --gripper rigid --width 32 --height 18 --fps 5 -o set"), 0) << message;
  const std::string render = "render " + task + " --states set/episode_000000/states.h5 --camera front --frames 0 " +
                             "--width 32 --height 18 --samples 1 -o front.png";
  EXPECT_EQ(run(render), 2);
  EXPECT_NE(message.find("or with --gripper rigid"), std::string::npos) << message;
  EXPECT_EQ(run(render + " --gripper rigid"), 0) << message;
  EXPECT_TRUE(fs::exists(folder.path / "front.png"));
  // its frames are 5 per second, whatever the task says: a video of another rate would show another speed
  EXPECT_EQ(run(render + " --gripper rigid --fps 10"), 2);
  EXPECT_NE(message.find("states.h5 has frames of its own, 5 per second"), std::string::npos) << message;
  folder.write("falling.yaml", falling);
  EXPECT_EQ(run("render falling.yaml --gripper rigid --camera a -o a.png"), 2);
  EXPECT_NE(message.find("falling.yaml is no task"), std::string::npos) << message;
}

TEST_F(Render, ATableFoundByCalibrateIsAppliedByRender) {
  folder.write("falling.yaml", std::string(falling) + R"(
materials: [{name: plain, kind: metallic_roughness, color: [0.2, 0.5, 0.8], roughness: 0.6}]
objects: [{name: slope, visuals: [{mesh: slope.obj, material: plain}]}]
lights: [{name: ball, kind: sphere, center: [0.3, -0.6, 1.4], radius: 5 cm, radiance: [60, 60, 60]}]
)");
  folder.write("slope.obj", "v -2 0.3 0\nv 2 0.3 0\nv 2 0.5 3\nv -2 0.5 3\nf 1 2 3\nf 1 3 4\n");
  ASSERT_EQ(run("render falling.yaml --samples 64 --width 96 --height 96 -o rendered"), 0) << message;
  fs::create_directories(folder.path / "real");
  // the real camera has a gamma of its own
  for (const char* camera : {"a", "b"}) {
    const std::string name = std::string(camera) + "_000000.png";
    Picture8 picture = read_picture(folder.path / "rendered" / name);
    for (std::uint8_t& byte : picture.rgb) byte = std::uint8_t(std::lround(255 * std::pow(byte / 255.0, 1.2)));
    write_picture(folder.path / "real" / name, picture);
  }
  ASSERT_EQ(run("calibrate lut --render rendered --real real -o lut.csv"), 0) << message;
  ASSERT_EQ(run("render falling.yaml --samples 64 --width 96 --height 96 --lut lut.csv -o mapped"), 0) << message;
  const Picture8 real = read_picture(folder.path / "real/a_000000.png"),
                 mapped = read_picture(folder.path / "mapped/a_000000.png"),
                 rendered = read_picture(folder.path / "rendered/a_000000.png");
  double before = 0, after = 0;
  for (std::size_t i = 0; i < real.rgb.size(); ++i) {
    before += std::abs(int(real.rgb[i]) - rendered.rgb[i]);
    after += std::abs(int(real.rgb[i]) - mapped.rgb[i]);
  }
  EXPECT_GT(before / double(real.rgb.size()), 8);
  EXPECT_LT(after, 0.15 * before);
  EXPECT_EQ(run("calibrate lut --render rendered --real none -o lut.csv"), 2);
  fs::create_directories(folder.path / "empty");
  EXPECT_EQ(run("calibrate lut --render rendered --real empty -o lut.csv"), 2);
  EXPECT_NE(message.find("name"), std::string::npos) << message;
  folder.write("bad.csv", "input,red,green,blue\n0,0,0,2\n");
  EXPECT_EQ(run("render falling.yaml --camera a --lut bad.csv -o x.png"), 2);
  EXPECT_NE(message.find("bad.csv:2"), std::string::npos) << message;
}

TEST_F(Render, WrongKeysOfLooksNameFileLineAndKey) {
  const std::vector<std::array<std::string, 2>> cases = {
      {"materials: [{name: m, kind: diffuse, roughness: 0.5}]", "roughness"},
      {"materials: [{name: m, kind: dielectric, thin: true, absorption: [1, 1, 1]}]", "absorption"},
      {"materials: [{name: m, kind: cloth, sheen_roughness: 0.1}]", "sheen_roughness"},
      {"materials: [{name: m, kind: metallic_roughness, metallic: 2}]", "metallic"},
      {"materials: [{name: m, kind: diffuse, texture: none.png}]", "none.png"},
      {"lights: [{name: l, kind: sphere, center: [0, 0, 1], radiance: [1, 1, 1]}]", "radius"},
      {"environment_map: {file: none.hdr}", "none.hdr"},
      {"objects: [{name: o, visuals: [{mesh: broken.gltf}]}]", "broken.gltf"},
      {"objects: [{name: o, visuals: [{mesh: missing.gltf}]}]", "missing.gltf"}};
  folder.write("broken.gltf", "{\"asset\": {\"version\": \"2.0\"}, \"scenes\": [{\"nodes\": [3]}]}");
  folder.write("missing.gltf",
               R"({"asset": {"version": "2.0"}, "buffers": [{"uri": "gone.bin", "byteLength": 12}], "scenes": [{}]})");
  for (const auto& [lines, names] : cases) {
    folder.write("scene.yaml", "schema: 1\nname: s\ntime_step: 10 ms\n" + lines + "\n");
    EXPECT_EQ(run("render scene.yaml -o x.png"), 2) << lines;
    EXPECT_NE(message.find(names), std::string::npos) << lines << ": " << message;
  }
  const std::string camera = "cameras: [{name: c, width: 32, height: 32, position: [0, -1, 0], look_at: [0, 0, 0], ";
  for (const auto& [keys, names] : std::vector<std::array<std::string, 2>>{
           {"vertical_field_of_view: 30 deg, intrinsics: [1, 1, 1, 1]", "intrinsics"},
           {"intrinsics: [0, 20, 16, 16]", "intrinsics"},
           {"intrinsics: [20, 20, 16]", "intrinsics"},
           {"vertical_field_of_view: 30 deg, distortion: [1, 2, 3]", "distortion"},
           {"vertical_field_of_view: 30 deg, model: fisheye, lens_radius: 1 cm", "lens_radius"},
           {"vertical_field_of_view: 30 deg, read_noise: 3", "read_noise"}}) {
    folder.write("scene.yaml", "schema: 1\nname: s\ntime_step: 10 ms\n" + camera + keys + "}]\n");
    EXPECT_EQ(run("render scene.yaml -o x.png"), 2) << keys;
    EXPECT_NE(message.find("scene.yaml:4"), std::string::npos) << message;
    EXPECT_NE(message.find(names), std::string::npos) << keys << ": " << message;
  }
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

TEST_F(Render, ShowsBodiesThatDoNotCollideWhereNothingHasVisuals) {
  std::string text = falling;
  folder.write("seen.yaml", text);
  const std::string mass = "density: 1000";
  folder.write("passing.yaml", text.replace(text.find(mass), mass.size(), mass + ", collides: false"));
  ASSERT_EQ(run("render seen.yaml --camera a --samples 2 -o seen.png"), 0) << message;
  ASSERT_EQ(run("render passing.yaml --camera a --samples 2 -o passing.png"), 0) << message;
  EXPECT_EQ(read_picture(folder.path / "passing.png").rgb, read_picture(folder.path / "seen.png").rgb);
}

// how bright a grey floor is, whose lamp a black lid hides where `lid` [m] is above it
struct ReceiverLook : Render {
  int brightness(double lid, const std::string& look) {
    folder.write("floor.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n");
    folder.write("room.yaml", R"({schema: 1, name: room, time_step: 10 ms,
      materials: [{name: captured, kind: shadow_receiver, color: [0.4, 0.4, 0.4]},
                  {name: black, kind: diffuse, color: [0, 0, 0]}],
      bodies: [{name: floor, kind: static, shape: {box: {size: [0.1, 0.1, 0.1]}}, collides: false,
                visuals: [{mesh: floor.obj, material: captured}]},
               {name: lid, kind: static, shape: {box: {size: [0.1, 0.1, 0.1]}}, collides: false,
                pose: {position: [0, 0, )" +
                                  std::to_string(lid) + R"(]}, visuals: [{mesh: floor.obj, material: black}]}],
      lights: [{name: lamp, kind: sphere, center: [0, 0, 4], radius: 0.2, radiance: [50, 50, 50]}],
      cameras: [{name: a, width: 16, height: 16, vertical_field_of_view: 5 deg, position: [0, -0.5, 1], look_at: [0, 0, 0]}]})");
    EXPECT_EQ(run("render room.yaml -o seen.png --samples 64 --receivers " + look), 0) << message;
    return read_picture(folder.path / "seen.png").rgb[3 * (8 * 16 + 8)];
  }
};

TEST_F(ReceiverLook, IsThatOfOtherRenderers) {
  EXPECT_LT(brightness(1.5, "kept"), 5);  // the lid takes all of the lamp's light
  EXPECT_LT(brightness(1.5, "relit"), 5);
  EXPECT_NEAR(brightness(1.5, "emissive"), 170, 1);  // sRGB of 0.4, as captured
  EXPECT_NEAR(brightness(-1.5, "kept"), 170, 1);
  EXPECT_NEAR(brightness(-1.5, "relit"), 63, 2);  // 0.4 x 50 (0.2 m / 4 m)^2 = 0.05
}

TEST_F(ReceiverLook, NeedsAReceiver) {
  folder.write("falling.yaml", falling);
  EXPECT_EQ(run("render falling.yaml --camera a -o a.png --receivers relit"), 2);
  EXPECT_NE(message.find("no shadow receiver"), std::string::npos) << message;
}

}  // namespace
}  // namespace pvg
