// The graph of `render`: what leaves it is what a plain loop makes, in order, and errors and stops come out as they
// are.
#include "pipeline/episode/motion_pictures.hpp"

#include <gtest/gtest.h>

#include "host/base/error.hpp"
#include "host/load/scene_file.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

// The pictures of `large` take long to encode and those of `small` nothing, so that these would overtake them; a cube
// falls, so that no two frames look alike.
struct MotionPictures : testing::Test {
  static constexpr std::size_t N_FRAMES = 4;
  TestFolder folder;
  Device device{"cpu", Purpose::rendering};
  Scene scene;
  MotionSettings settings{{0, N_FRAMES}, {0, 1}, {}, {}, true};
  std::atomic<bool> stop = false;

  MotionPictures() {
    folder.write("falling.yaml", R"(schema: 1
name: falling
time_step: 10 ms
duration: 80 ms
bodies: [{name: cube, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, density: 1000}]
environment: [1, 1, 1]
cameras:
  - {name: large, width: 1500, height: 1500, vertical_field_of_view: 30 deg, position: [0, -1, 0], look_at: [0, 0, 0]}
  - {name: small, width: 16, height: 16, vertical_field_of_view: 12 deg, position: [0, 1, 0], look_at: [0, 0, 0]}
)");
    const std::string here = "cd " + folder.path.string() + " && ", quietly = " >/dev/null 2>&1";
    if (std::system((here + PVG_PROGRAM + " simulate falling.yaml -o states.h5" + quietly).c_str()) != 0)
      throw Failure("the motion could not be simulated");
    scene = load_scene_run(folder.path / "falling.yaml").scene;
    settings.pictures.samples = 1;
  }
  Frames frames() const { return Frames(scene, (folder.path / "states.h5").string(), 50); }
};

TEST_F(MotionPictures, LeaveInOrderAndEqualThoseOfAPlainLoop) {
  const Frames moving = frames();
  Renderer renderer(device, scene, settings.pictures);
  std::size_t next = 0;
  render_motion(
      device, scene, moving, settings,
      [&](const MotionPicture& picture) {
        const std::size_t frame = next / 2;
        ASSERT_EQ(picture.frame, frame);
        ASSERT_EQ(picture.camera, int(next % 2));
        ++next;
        if (picture.camera == 0) return;  // those below would take long
        const SceneState state = moving.state(frame);
        renderer.set_state(state);
        const RenderedFrame alone = renderer.render(1, std::uint32_t(frame));
        EXPECT_EQ(picture.linear.rgb, alone.rgb);
        EXPECT_EQ(picture.linear.instance, alone.instance);
        EXPECT_EQ(picture.encoded.rgb, encode_srgb8(alone.rgb, 16, 16).rgb);
        EXPECT_EQ(picture.state.time, state.time);
        EXPECT_EQ(picture.forward.flow.empty(), frame + 1 == moving.size());
        EXPECT_EQ(picture.backward.flow.empty(), frame == 0);
      },
      stop);
  EXPECT_EQ(next, 2 * N_FRAMES);
}

TEST_F(MotionPictures, AnErrorOfTheWriterComesOutAsItIsAndEndsTheRun) {
  settings.cameras = {1};
  std::size_t written = 0;
  const auto write = [&](const MotionPicture&) {
    if (++written == 2) throw UsageError("the disk is full");
  };
  try {
    render_motion(device, scene, frames(), settings, write, stop);
    FAIL() << "nothing was thrown";
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "the disk is full");
  }
  EXPECT_EQ(written, 2u);
}

TEST_F(MotionPictures, AStopEndsTheRunBeforeItsLastPicture) {
  settings.cameras = {0};
  std::size_t written = 0;
  const auto write = [&](const MotionPicture&) {
    ++written;
    stop = true;
  };
  EXPECT_THROW(render_motion(device, scene, frames(), settings, write, stop), TryAgain);
  EXPECT_EQ(written, 1u);
}

}  // namespace
}  // namespace pvg
