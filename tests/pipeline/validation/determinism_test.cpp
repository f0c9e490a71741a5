// The scenes that are hard on contact, the first steps of each twice: the same bits. The whole of each is run twice by
// `phyvisgen validate`; the task: end_to_end_test.cpp.
#include <gtest/gtest.h>

#include "host/load/scene_file.hpp"
#include "host/physics/step/simulation.hpp"
#include "pipeline/validation/state_hash.hpp"

namespace pvg {
namespace {

struct Case {
  const char* scene;
  int steps;
  double haste = 1;  // how much faster than in the scene the drives are told to go, so that bodies meet soon
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.scene; }

class Determinism : public testing::TestWithParam<Case> {};

TEST_P(Determinism, TwoRunsGiveTheSameBits) {
  const SceneRun run = load_scene_run(std::string(PVG_DATA_FOLDER "/validation/") + GetParam().scene + ".yaml");
  std::size_t n_contacts = 0;
  StateHash start, hash[2];
  for (StateHash& each : hash) {
    Device device;
    Simulation simulation(device, run.scene);
    start = {};
    start.add(simulation.state());
    for (int step = 1; step <= GetParam().steps; ++step) {
      simulation.step(run.targets_at(GetParam().haste * step * run.scene.solver.time_step));
      each.add(simulation.state());
      n_contacts += simulation.state().contacts.size();
    }
  }
  EXPECT_EQ(hash[0].value(), hash[1].value());
  EXPECT_NE(hash[0].value(), start.value());
  EXPECT_GT(n_contacts, 0u) << "take more steps, the bodies have not met yet";
}

INSTANTIATE_TEST_SUITE_P(Scenes, Determinism,
                         testing::Values(Case{"squeeze_out", 2, 3}, Case{"knives", 3}, Case{"slots", 4},
                                         Case{"twist", 6, 10}, Case{"touching", 2}),
                         [](const auto& info) { return info.param.scene; });

}  // namespace
}  // namespace pvg
