// simulate through the program: a resumed run equals the uninterrupted one bit for bit, contact and friction included;
// a step that fails leaves what was done and the last state that was well.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "host/hdf5/file.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

// a rod on a hinge sweeps a box over a plane
const char* const SWEEP = R"(schema: 1
name: sweep
time_step: 10 ms
duration: 0.3 s
bodies:
  - {name: ground, kind: half_space}
  - {name: post, kind: static, shape: {box: {size: [0.02, 0.02, 0.02]}}, pose: {position: [0, 0, 0.05]}, collides: false}
  - {name: rod, kind: rigid, shape: {box: {size: [0.3, 0.02, 0.02]}}, density: 1000, pose: {position: [0.15, 0, 0.05]}}
  - {name: box, kind: rigid, shape: {box: {size: [0.06, 0.06, 0.06]}}, density: 500, pose: {position: [0.25, 0.045, 0.0304]}}
joints:
  - {name: hinge, type: revolute, parent: post, child: rod, axis: [0, 0, 1], damping: 0.01, limits: [-1, 0.25], drive: {mode: velocity, damping: 20, effort_limit: 5, target: 1.5}}
solver: {integrator: bdf2}
)";

// a box falls freely, which takes a Newton iteration or two, then meets the ground, which takes more than it is given
const char* const UNSOLVED = R"(schema: 1
name: unsolved
time_step: 10 ms
duration: 0.3 s
bodies:
  - {name: ground, kind: half_space}
  - {name: box, kind: rigid, shape: {box: {size: [0.06, 0.06, 0.06]}}, density: 500, pose: {position: [0, 0, 0.13]}}
solver: {max_newton: 2, max_step_halvings: 1}
)";

struct Simulate : testing::Test {
  fs::path root = fs::temp_directory_path() / ("pvg_resume_" + std::to_string(getpid()));
  Simulate() { fs::create_directories(root); }
  ~Simulate() override { fs::remove_all(root); }

  std::string message;
  int simulate(const std::string& scene, const std::string& file, const std::string& options) {
    std::ofstream(root / "scene.yaml") << scene;
    const fs::path err = root / "stderr";
    const std::string command = std::string(PVG_PROGRAM) + " simulate " + (root / "scene.yaml").string() + " -o " +
                                (root / file).string() + " " + options + " >/dev/null 2>" + err.string();
    const int status = std::system(command.c_str());
    std::ifstream in(err);
    message = {std::istreambuf_iterator<char>(in), {}};
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
};

TEST_F(Simulate, ResumedEqualsUninterruptedBitForBit) {
  ASSERT_EQ(simulate(SWEEP, "through.h5", ""), 0) << message;
  ASSERT_EQ(simulate(SWEEP, "first.h5", "--duration 0.15 --checkpoint-every 0.15"), 0) << message;
  const std::string checkpoint = (root / "first.h5.checkpoint.h5").string();
  ASSERT_EQ(simulate(SWEEP, "second.h5", "--resume " + checkpoint), 0) << message;
  const hdf5::File through = hdf5::File::open(root / "through.h5"), second = hdf5::File::open(root / "second.h5");
  ASSERT_EQ(through.shape("/time")[0], 30u);
  ASSERT_EQ(second.shape("/time")[0], 15u);
  for (const char* name :
       {"/time", "/T_link", "/T_rigid", "/q", "/torque", "/joint/stop", "/force/net", "/force/torque"}) {
    const std::vector<double> whole = through.read<double>(name).values, end = second.read<double>(name).values;
    ASSERT_EQ(2 * end.size(), whole.size()) << name;
    EXPECT_TRUE(std::equal(end.begin(), end.end(), whole.begin() + std::ptrdiff_t(end.size()))) << name;
  }
  // the rod did push the box, and the stop held it
  const std::vector<double> friction = second.read<double>("/contact/friction_force").values;
  EXPECT_GT(*std::max_element(friction.begin(), friction.end()), 0.1);
  EXPECT_LT(second.read<double>("/joint/stop").values.back(), -1);
}

TEST_F(Simulate, ACheckpointOfAnotherSceneIsRefused) {
  ASSERT_EQ(simulate(SWEEP, "first.h5", "--duration 0.02 --checkpoint-every 0.02"), 0) << message;
  std::string other = SWEEP;
  other.replace(other.find("1.5}"), 4, "1.6}");
  EXPECT_EQ(simulate(other, "second.h5", "--resume " + (root / "first.h5.checkpoint.h5").string()), 2) << message;
  EXPECT_NE(message.find("first.h5.checkpoint.h5"), std::string::npos) << message;
}

TEST_F(Simulate, AFailedStepLeavesWhatWasDoneAndTheLastState) {
  EXPECT_EQ(simulate(UNSOLVED, "unsolved.h5", ""), 1) << message;
  for (const char* name : {"stalled", "box", "unsolved.h5.checkpoint.h5"})
    EXPECT_NE(message.find(name), std::string::npos) << message;
  const hdf5::File states = hdf5::File::open(root / "unsolved.h5");
  // it falls 0.1 m in sqrt(2 0.1 / 9.81) = 0.143 s
  EXPECT_NEAR(states.read<double>("/time").values.back(), 0.143, 0.02);
  const hdf5::File saved = hdf5::File::open(root / "unsolved.h5.checkpoint.h5");
  EXPECT_NEAR(saved.read<double>("/time").values.at(0), 0.143, 0.02);
}

}  // namespace
}  // namespace pvg
