// A served scene is the scene of `simulate`: the same bits whatever was served before, also after a step that failed.
#include "pipeline/serve/served_scene.hpp"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstring>

#include "pipeline/serve/requests.hpp"
#include "pipeline/serve/scene_server.hpp"

namespace pvg {
namespace {

SceneRun run_of(const char* name) { return load_scene_run(PVG_DATA_FOLDER "/validation/" + std::string(name)); }

struct SceneServer : testing::Test {
  Message ask(const Json& head) {
    Message request;
    request.head = head;
    return answer(scene, request);
  }
  std::string error_of(const Json& head) { return ask(head).head.value("error", ""); }

  Device device;
  ServedScene scene{run_of("drive.yaml"), {}, device, nullptr};
};

struct MemoryFile {
  explicit MemoryFile(std::size_t n) : file(memfd_create("arrays", 0)) {
    if (ftruncate(file, off_t(n)) != 0) throw Failure("no memory");
  }
  ~MemoryFile() { close(file); }
  std::string path() const { return "/proc/self/fd/" + std::to_string(file); }
  int file;
};

TEST_F(SceneServer, ASceneHasTheBitsOfASimulationAlsoAfterAStepThatFailed) {
  const SceneRun run = run_of("drive.yaml");
  Simulation simulation(device, run.scene);
  const auto expect_same = [&] {
    for (std::size_t b = 0; b < run.scene.rigid_bodies.size(); ++b)
      EXPECT_EQ(scene.state().rigid[b], simulation.state().rigid[b]) << b;
    EXPECT_EQ(scene.state().joint_position, simulation.state().joint_position);
    EXPECT_EQ(scene.state().time, simulation.state().time);
  };
  const auto simulate = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) simulation.step(run.targets_at(double(i + 1) * run.scene.solver.time_step));
  };
  scene.step({{0.5, 0.1}, {-0.5, 0.1}});  // something else before
  EXPECT_EQ(scene.n_steps(), 2u);
  scene.reset();
  scene.step(3);
  simulate(0, 3);
  expect_same();
  EXPECT_THROW(scene.step({{1e3, 0}}), StepFailure);
  EXPECT_EQ(scene.n_steps(), 3u);
  expect_same();
  scene.step(2);
  simulate(3, 5);
  expect_same();
}

TEST_F(SceneServer, WhatIsWrongWithARequestIsOneSentenceAndChangesNothing) {
  ask({{"do", "step"}, {"n", 2}});
  for (const auto& [request, part] : std::vector<std::pair<Json, std::string>>{
           {{{"do", "fly"}}, "one of reset, step, observe"},
           {{{"do", "step"}, {"n", 0}}, "`n` of a step is a whole number from 1"},
           {{{"do", "step"}, {"n", 1.5}}, "this one is 1.5"},
           {{{"do", "step"}, {"n", 1}, {"targets", {{0, 0}}}}, "leave one out"},
           {{{"do", "step"}, {"targets", {{0}}}}, "each of the 2 joints with a drive, this one has 1"},
           {{{"do", "step"}, {"targets", {{0, 1e160}}}}, "is 1e+160, it may be"},
           {{{"do", "step"}, {"targets", {0, 0}}}, "list of numbers"},
           {{{"do", "step"}, {"action", {0}}}, "no key `action`"},
           {{{"do", "reset"}, {"seed", 1}}, "no key `seed`"},
           {{{"do", "state"}, {"world", 0}}, "leave `world` out"},
           {{{"do", "state"}, {"memory", "/nowhere"}}, "cannot be opened"},
           {{{"do", "step"}, {"pictures", true}}, "makes no pictures"},
           {{{"do", "step"}, {"pictures", {"back"}}}, "no camera"},
       })
    EXPECT_NE(error_of(request).find(part), std::string::npos) << request << error_of(request);
  EXPECT_EQ(scene.n_steps(), 2u);
  const Json failed = ask({{"do", "step"}, {"targets", {{0, 0}, {1e3, 0}}}, {"id", 4}}).head;
  EXPECT_EQ(failed["id"], 4);
  EXPECT_NE(failed["error"].get<std::string>().find("drive"), std::string::npos) << failed;
  EXPECT_EQ(failed["n_steps"], 3);
}

TEST_F(SceneServer, ArraysInMemoryAreThoseOfTheAnswer) {
  ask({{"do", "step"}, {"n", 4}});
  const Message plain = ask({{"do", "state"}});
  MemoryFile small(10), large(plain.bytes.size());
  const Json refused = ask({{"do", "state"}, {"memory", small.path()}}).head;
  EXPECT_NE(refused["error"].get<std::string>().find("has 10 bytes"), std::string::npos) << refused;
  EXPECT_EQ(refused["bytes"], plain.bytes.size());
  const Message placed = ask({{"do", "state"}, {"memory", large.path()}});
  EXPECT_TRUE(placed.bytes.empty());
  std::vector<unsigned char> bytes(plain.bytes.size());
  ASSERT_EQ(pread(large.file, bytes.data(), bytes.size(), 0), ssize_t(bytes.size()));
  EXPECT_EQ(bytes, plain.bytes);
  for (std::size_t i = 0; i < plain.head["arrays"].size(); ++i)
    EXPECT_EQ(placed.head["arrays"][i]["memory_offset"], plain.head["arrays"][i]["offset"]);
}

TEST_F(SceneServer, TheGreetingSaysWhatTheSceneIs) {
  const Json head = greeting(scene, "0.0").head;
  EXPECT_EQ(head["scene"], "drive");
  EXPECT_EQ(head["bodies"][1], Json({{"name", "arm"}, {"kind", "rigid"}, {"nodes", 0}}));
  EXPECT_EQ(head["joints"][1]["type"], "prismatic");
  EXPECT_EQ(head["joints"][1]["drive"], "position");
  EXPECT_EQ(head["driven"], Json({"shoulder", "rail"}));
  EXPECT_EQ(head["cameras"][0]["name"], "overview");
}

}  // namespace
}  // namespace pvg
