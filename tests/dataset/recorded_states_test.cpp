// What a record keeps of nodes: every bit, whole steps of less than two micrometres, or frames only.
#include <gtest/gtest.h>

#include <cmath>

#include "host/base/error.hpp"
#include "host/dataset/states_file.hpp"
#include "host/dataset/states_reader.hpp"
#include "host/hdf5/file.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

constexpr std::size_t N_STEPS = 70, N_NODES = 50, STEPS_PER_FRAME = 5;  // more steps than two chunks hold

Scene sponge_scene() {
  Scene scene;
  scene.solver.time_step = 0.01;
  SoftBody body;
  body.name = "sponge";
  body.mesh.nodes_per_element = 4;
  body.mesh.points.assign(N_NODES, Vec3::Zero());
  body.mesh.elements = {0, 1, 2, 3};
  body.mesh.surface = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  scene.soft_bodies.push_back(body);
  return scene;
}

// moves, and no coordinate is a round number or like its neighbours
WorldState state_at(std::size_t step) {
  WorldState state;
  state.time = 0.01 * double(step + 1);
  state.body_force.resize(1);
  state.soft.emplace_back();
  for (std::size_t i = 0; i < N_NODES; ++i) {
    const double at = 1e3 * std::sin(12.9898 * double(step * N_NODES + i));
    state.soft[0].push_back(
        {0.1 * std::sin(at), -0.3 + 0.01 * std::sin(2 * at), 1.0 / (7 + double(i) + std::sin(3 * at))});
  }
  return state;
}

std::filesystem::path write(const std::filesystem::path& path, RecordedStates states) {
  EpisodeHeader header;
  header.states = states;
  StatesFile file(path, sponge_scene(), header, {});
  for (std::size_t step = 0; step < N_STEPS; ++step) {
    file.append_step(state_at(step), {}, std::vector<double>{});
    if ((step + 1) % STEPS_PER_FRAME == 0) file.keep_nodes();
  }
  file.close();
  return path;
}

double farthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).cwiseAbs().maxCoeff());
  return most;
}

TEST(RecordedStates, FullKeepsEveryBit) {
  const TestFolder folder;
  const StatesReader reader(write(folder.path / "full.h5", RecordedStates::full), sponge_scene());
  ASSERT_EQ(reader.n_steps(), N_STEPS);
  for (std::size_t step = 0; step < N_STEPS; ++step) EXPECT_EQ(reader.state(step).soft[0], state_at(step).soft[0]);
}

TEST(RecordedStates, Float32IsWithinAMicrometreAndFitsFloat32) {
  const TestFolder folder;
  const auto path = write(folder.path / "float32.h5", RecordedStates::float32);
  const StatesReader reader(path, sponge_scene());
  ASSERT_EQ(reader.n_steps(), N_STEPS);
  double most = 0;
  for (std::size_t step = 0; step < N_STEPS; ++step)
    most = std::max(most, farthest(reader.state(step).soft[0], state_at(step).soft[0]));
  EXPECT_LE(most, 1e-6);
  EXPECT_GT(most, 0.5e-6);  // it is rounded
  const hdf5::File file = hdf5::File::open(path);
  EXPECT_EQ(file.shape("/X_deform/sponge"), (hdf5::Shape{N_STEPS, N_NODES, 3}));
  EXPECT_EQ(file.number_attribute("/X_deform/sponge", "rounded_to"), NODE_GRID);
  EXPECT_EQ(file.text_attribute("/", "states"), "float32");
  for (const double value : file.read<double>("/X_deform/sponge").values) ASSERT_EQ(value, double(float(value)));
  EXPECT_EQ(file.read<double>("/time").values[6], state_at(6).time);  // all else keeps its bits
}

TEST(RecordedStates, FramesAreReadAsTheOnlyStepsAndOthersAreNoNumbers) {
  const TestFolder folder;
  const auto path = write(folder.path / "frames.h5", RecordedStates::frames);
  const StatesReader reader(path, sponge_scene());
  ASSERT_EQ(reader.n_steps(), N_STEPS / STEPS_PER_FRAME);
  for (std::size_t frame = 0; frame < reader.n_steps(); ++frame) {
    const WorldState there = state_at(STEPS_PER_FRAME * (frame + 1) - 1);
    EXPECT_EQ(reader.time(frame), there.time);
    EXPECT_LE(farthest(reader.state(frame).soft[0], there.soft[0]), 1e-6);
  }
  const hdf5::File file = hdf5::File::open(path);
  EXPECT_EQ(file.shape("/X_deform/sponge"), (hdf5::Shape{N_STEPS, N_NODES, 3}));
  EXPECT_TRUE(std::isnan(file.read_row<double>("/X_deform/sponge", 0)[0]));
  EXPECT_EQ(StatesRecord(path).rows("/X_deform/sponge").size(), N_STEPS * N_NODES * 3);
  EXPECT_THROW(StatesRecord(path).row("/X_deform/sponge", 0), UsageError);
}

TEST(RecordedStates, EachKeepsLessThanTheOneBefore) {
  const TestFolder folder;
  const auto size = [&](RecordedStates states) {
    return std::filesystem::file_size(write(folder.path / "size.h5", states));
  };
  const auto full = size(RecordedStates::full), float32 = size(RecordedStates::float32),
             frames = size(RecordedStates::frames);
  EXPECT_LT(2 * float32, full);
  EXPECT_LT(frames, float32);
}

}  // namespace
}  // namespace pvg
