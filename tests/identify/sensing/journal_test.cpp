#include "host/identify/sensing/journal.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <type_traits>

#include "host/identify/sensing/question.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

std::vector<Prediction> result(double value, const std::string& pair) {
  Prediction p;
  p.residual = Eigen::VectorXd::LinSpaced(5, 0, value);
  p.phase = {Phase::slide, Phase::rest};
  p.touching = {pair};
  return {p, Prediction{}};
}

void write_two(const std::filesystem::path& file, std::uint64_t key) {
  Journal journal(file, key);
  journal.add(11, result(1.0 / 3, "floor/block"));
  journal.add(12, result(2, ""));
}

TEST(Journal, AResultIsReadBackToTheBit) {
  const TestFolder folder;
  const std::filesystem::path file = folder.path / "simulated.bin";
  write_two(file, 7);
  Journal again(file, 7);
  const auto first = again.result_for(11);
  ASSERT_TRUE(first);
  ASSERT_EQ(first->size(), 2u);
  EXPECT_EQ((*first)[0].residual, Eigen::VectorXd::LinSpaced(5, 0, 1.0 / 3));
  EXPECT_EQ((*first)[0].phase, (std::vector<Phase>{Phase::slide, Phase::rest}));
  EXPECT_EQ((*first)[0].touching, std::vector<std::string>{"floor/block"});
  EXPECT_EQ((*first)[1].residual.size(), 0);
  EXPECT_TRUE(again.result_for(12));
  EXPECT_FALSE(again.result_for(13));
  again.add(13, result(3, "x"));
  Journal third(file, 7);
  for (const std::uint64_t question : {11, 12, 13}) EXPECT_TRUE(third.result_for(question)) << question;
}

TEST(Journal, AnotherKeyOrAnotherQuestionVoidsWhatFollows) {
  const TestFolder folder;
  const std::filesystem::path file = folder.path / "simulated.bin";
  write_two(file, 7);
  Journal other(file, 8);
  EXPECT_FALSE(other.result_for(11));
  write_two(file, 7);
  Journal strays(file, 7);
  EXPECT_TRUE(strays.result_for(11));
  EXPECT_FALSE(strays.result_for(99));
  strays.add(99, result(1, "y"));
  Journal after(file, 7);
  EXPECT_TRUE(after.result_for(11));
  EXPECT_TRUE(after.result_for(99));
  EXPECT_FALSE(after.result_for(12));
}

TEST(Journal, AResultThatWasCutShortIsForgotten) {
  const TestFolder folder;
  const std::filesystem::path file = folder.path / "simulated.bin";
  write_two(file, 7);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 3);
  Journal journal(file, 7);
  EXPECT_TRUE(journal.result_for(11));
  EXPECT_FALSE(journal.result_for(12));
}

// Two results must not be confused: whatever a simulation or a sensor depends on is part of the question, and jobs
// share a world only where what is measured of it alone differs.
TEST(Journal, AQuestionHoldsSceneSensingStartsAndNoise) {
  Problem problem;
  problem.channels.resize(1);
  problem.channels[0].sigma = 0.1;
  problem.runs.resize(1);
  problem.runs[0].noise_scale = {1};
  Variant variant;
  variant.scene.rigid_bodies.resize(1);
  variant.scene.joints.resize(1);
  variant.scene.pair_friction = {{"floor", "block", 0.3}};
  variant.scene.effects = {{"linear_drag", "ball", {0.1}}};
  variant.sensing.latency = {0};
  variant.sensing.bias = {Vec3::Zero()};
  variant.sensing.marker_offset = {Vec3::Zero()};
  variant.sensing.camera = {{}};
  Window window;
  window.data = {{0, 3, 0}};
  window.correction = Eigen::VectorXd::Zero(1);
  InitialState start{{0}, {0}, {Pose::Identity()}, {Vec3::Zero()}, {Vec3::Zero()}};
  std::map<std::uint64_t, int> seen, moved;
  int number = 0;
  const auto ask = [&](bool moves_otherwise) {
    const Job job{&variant, &window, start, false};
    const Question question = questions_of(problem, std::span(&job, 1)).at(0);
    EXPECT_TRUE(seen.emplace(question.all, number).second) << number << " is as " << seen[question.all];
    EXPECT_EQ(moved.emplace(question.motion, number).second, moves_otherwise) << number;
    ++number;
  };
  ask(true);
  bool moves_otherwise = true;
  const auto changed = [&](double& value) {
    const double before = value;
    value += 0.01;
    ask(moves_otherwise);
    value = before;
  };
  changed(start.spin[0].z());  // 1
  changed(start.velocity[0].x());
  changed(variant.scene.gravity.z());  // 3
  changed(variant.scene.rigid_bodies[0].mass);
  changed(variant.scene.rigid_bodies[0].inertia(0, 1));
  changed(variant.scene.rigid_bodies[0].center_of_mass.y());
  changed(variant.scene.pair_friction[0].coefficient);
  changed(variant.scene.joints[0].damping);
  changed(variant.scene.joints[0].drive.stiffness);
  changed(variant.scene.contact.stiffness);  // 10
  changed(variant.scene.solver.time_step);
  changed(variant.scene.effects[0].parameters[0]);
  changed(window.start);  // 13
  changed(window.end);    // known pushes act until then
  moves_otherwise = false;
  changed(variant.sensing.clock_rate);
  changed(variant.sensing.clock_offset);
  changed(variant.sensing.length_scale);
  changed(variant.sensing.frame_rotation.x());
  changed(variant.sensing.latency[0]);
  changed(variant.sensing.bias[0].x());
  changed(variant.sensing.marker_offset[0].x());
  changed(variant.sensing.camera[0].gain);
  changed(window.correction[0]);
  changed(problem.channels[0].sigma);
  changed(problem.runs[0].noise_scale[0]);
  window.data[0].sample = 4;
  ask(false);
}

// What a run's table says reaches predictions by the key alone.
TEST(Journal, AKeyHoldsTimesAndWhatWasPrescribed) {
  Problem problem;
  problem.runs.resize(1);
  diagnose::Run& run = problem.runs[0];
  run.t = {0, 0.1, 0.2};
  run.values = {{1, 2, 3}};
  run.targets = {{{0, 0.1, 0.2}, {4, 5, 6}}};
  run.prescribed = {{0, {{0, Pose::Identity()}, {0.2, Pose::Identity()}}}};
  const std::uint64_t key = journal_key(problem, "");
  EXPECT_EQ(journal_key(problem, ""), key);
  for (double* number : {&run.t[1], &run.values[0][1], &run.targets[0].value[1], &run.prescribed[0].path[1].time,
                         &run.prescribed[0].path[1].pose.matrix()(0, 3)}) {
    const double before = *number;
    *number += 0.01;
    EXPECT_NE(journal_key(problem, ""), key) << before;
    *number = before;
  }
}

// The scene's file names them, and says the same whatever is in them.
TEST(Journal, AKeyHoldsWhatIsInFilesThatTheSceneNames) {
  Problem problem;
  const std::array<Vec3f, 3> corners = {Vec3f(0, 0, 0), Vec3f(1, 0, 0), Vec3f(0, 1, 0)};
  problem.seen.visual_meshes.push_back({{corners.begin(), corners.end()}, {}, {Vec2f(0, 0)}, {}, {}, {{0, 1, 2}}});
  problem.seen.textures.push_back({1, 1, {10, 20, 30, 255}});
  problem.seen.environment_map.rgb = {1, 2, 3};
  problem.seen.materials.emplace_back();
  problem.seen.visuals.emplace_back();
  problem.seen.cameras.emplace_back().distortion = {0.1};
  problem.scene.scene.rigid_bodies.emplace_back().collision.triangles = {{0, 1, 2}};
  problem.scene.scene.soft_bodies.emplace_back().mesh.elements = {0, 1, 2, 3};
  problem.scene.scene.cloths.emplace_back().mesh.triangles = {{0, 1, 2}};
  problem.lut.emplace().value = {};
  const std::uint64_t key = journal_key(problem, "");
  EXPECT_EQ(journal_key(problem, ""), key);
  Scene& seen = problem.seen;
  const auto expect_other = [&](auto& number) {
    const auto before = number;
    number = std::remove_reference_t<decltype(number)>(before + 1);
    EXPECT_NE(journal_key(problem, ""), key) << double(before);
    number = before;
  };
  expect_other(seen.visual_meshes[0].points[2].y());
  expect_other(seen.visual_meshes[0].uvs[0].x());
  expect_other(seen.visual_meshes[0].triangles[0][1]);
  expect_other(seen.textures[0].rgba[1]);
  expect_other(seen.environment_map.rgb[2]);
  expect_other(seen.materials[0].color.y());
  expect_other(seen.materials[0].sheen_roughness);
  expect_other(seen.visuals[0].material);
  expect_other(seen.cameras[0].distortion[0]);
  expect_other(seen.cameras[0].fx);
  expect_other(problem.scene.scene.rigid_bodies[0].collision.triangles[0][2]);
  expect_other(problem.scene.scene.soft_bodies[0].mesh.elements[3]);
  expect_other(problem.scene.scene.cloths[0].mesh.triangles[0][0]);
  expect_other(problem.lut->value[7][1]);
  problem.lut.reset();
  EXPECT_NE(journal_key(problem, ""), key);
}

}  // namespace
}  // namespace pvg::diagnose
