// Where the misfit is, and what is screened first
#include "host/identify/search/localise.hpp"

#include <gtest/gtest.h>

#include "tests/identify/driven_arm.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

Candidate acting_on(const std::string& target) {
  Candidate candidate;
  candidate.name = "any";
  candidate.target = target;
  return candidate;
}

TEST(OrderByPlace, BodiesJointsAndContactsComeByTheirShareOfTheMisfit) {
  const TestFolder folder;
  folder.write("scene.yaml", driven_arm("2 ms", "{stiffness: 20, target: 0.3}", ""));
  std::string run = "t,q\n";
  for (int i = 0; i < 10; ++i) run += std::to_string(0.1 * i) + "," + std::to_string(0.1 * i) + "\n";
  folder.write("a.csv", run);
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
channels:
  - {column: q, kind: position, joint: shoulder, unit: rad, noise: 0.001}
)");
  const Problem problem = make_problem(folder.path / "recording.yaml");
  const std::string arm = "arm";
  std::vector<Cell> where(3);
  where[0].body = arm, where[0].share = 0.5;
  where[1].body = "cup", where[1].share = 0.3;
  where[2].body = arm, where[2].share = 0.2;  // in another phase
  std::vector<Candidate> candidates;
  const std::string channel = problem.channels.at(0).name;
  for (const std::string& target : {std::string("scene"), std::string("cup"), std::string("shoulder"),
                                    std::string("cup/table"), std::string("table"), arm, channel})
    candidates.push_back(acting_on(target));
  order_by_place(problem, where, candidates);
  candidates[0].family = Family::parameter;  // "shoulder" by now
  candidates.push_back(acting_on("cup"));
  candidates.back().family = Family::parameter;
  order_by_place(problem, where, candidates);
  std::vector<std::string> order;
  for (const Candidate& candidate : candidates) order.push_back(candidate.target);
  const std::vector<std::string> expected = {"shoulder", arm, "cup", channel, "cup", "cup/table", "scene", "table"};
  EXPECT_EQ(order, expected);
  EXPECT_EQ(candidates[2].family, Family::parameter);  // it does not wait for the effects at the arm
}

}  // namespace
}  // namespace pvg::diagnose
