// Masks as a recording's cameras would have seen them in the simulation
#include "pipeline/diagnose/mask_sight.hpp"

#include <gtest/gtest.h>

#include "host/io/hdf5.hpp"
#include "host/render/renderer.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

constexpr int WIDTH = 64, HEIGHT = 48;

// A plate whose front of 0.2 x 0.1 m is 1 m from a pinhole of 100 pixels, and a blind before the left half of it; 8
// masks of this size and part.
std::filesystem::path plate(const TestFolder& folder, std::uint64_t height, const std::string& part) {
  folder.write("scene.yaml", R"(schema: 1
name: plate
time_step: 5 ms
duration: 0.1 s
bodies:
  - {name: plate, kind: rigid, shape: {box: {size: [0.2, 0.02, 0.1]}}, mass: 1, pose: {position: [0, 0.01, 0]}}
  - {name: blind, kind: static, shape: {box: {size: [0.5, 0.001, 0.5]}}, pose: {position: [-0.25, -0.1, 0]}}
cameras:
  - {name: wrist, width: 64, height: 48, intrinsics: [100, 100, 31.5, 23.5], position: [0, -1, 0], look_at: [0, 0, 0], up: [0, 0, 1]}
)");
  std::string run = "t,x,y,z\n";
  for (int i = 0; i < 8; ++i) run += std::to_string(0.01 * i) + ",0," + std::to_string(0.01 + 0.001 * i) + ",0\n";
  folder.write("a.csv", run);
  hdf5::File file = hdf5::File::create(folder.path / "masks.h5");
  file.write<std::uint8_t>("/part", {8, height, WIDTH}, std::vector<std::uint8_t>(8 * height * WIDTH, 1));
  file.attribute("/part", "names", std::vector<std::string>{"nothing", part});
  file.close();
  return folder.write("recording.yaml",
                      "schema: 1\nscene: scene.yaml\nruns:\n  - {file: a.csv, role: fit}\nchannels:\n"
                      "  - {columns: [x, y, z], kind: position, body: plate, unit: m}\n"
                      "  - {file: masks.h5, kind: mask, camera: wrist, part: " +
                          part + "}\n");
}

TEST(MaskSight, APlateBehindABlindIsSeenByItsFreeHalf) {
  const TestFolder folder;
  const Problem problem = make_problem(plate(folder, HEIGHT, "plate"));
  Device device;
  MaskSight sight(device, problem);
  const std::vector<std::uint8_t> mask = sight.look(0, initial_state(problem.seen));
  // 20 x 10 pixels in the middle, of which the right 10 x 10 are free
  ASSERT_EQ(mask.size(), std::size_t(WIDTH * HEIGHT));
  for (int row = 0; row < HEIGHT; ++row)
    for (int column = 0; column < WIDTH; ++column)
      EXPECT_EQ(int(mask[std::size_t(row * WIDTH + column)]), int(column >= 32 && column < 42 && row >= 19 && row < 29))
          << row << " " << column;
}

TEST(MaskSight, MasksThatDoNotFitTheirCameraOrSceneAreRefused) {
  const TestFolder folder;
  expect_error<UsageError>([&] { make_problem(plate(folder, HEIGHT - 8, "plate")); },
                           {"a.csv", "64 x 40", "`wrist`", "64 x 48"});
  expect_error<UsageError>([&] { make_problem(plate(folder, HEIGHT, "gripper")); }, {"`gripper`", "plate, blind"});
}

}  // namespace
}  // namespace pvg::diagnose
