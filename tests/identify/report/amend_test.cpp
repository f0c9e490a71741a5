// scene_amended.yaml: what is written is read back as what was found.
#include <gtest/gtest.h>

#include "host/identify/candidates/candidate.hpp"
#include "host/identify/report/report.hpp"
#include "host/load/scene_file.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

// A hinge whose angle is measured, beside a strip of cloth.
std::filesystem::path recording(const TestFolder& folder, const std::string& mass = "mass: 2") {
  folder.write("scene.yaml", R"(schema: 1
name: two
time_step: 5 ms
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.1, 0.1, 0.1]}}, collides: false}
  - {name: arm, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, )" +
                                 mass +
                                 R"(, pose: {position: [0.3, 0, 0]}, collides: false}
joints:
  - {name: hinge, type: revolute, parent: base, child: arm, axis: [0, 0, 1]}
cloths:
  - name: strip
    shape: {sheet: {size: [0.3, 0.04], divisions: [4, 1]}}
    pose: {x: 1}
    material: {area_density: 0.3, thickness: 1 mm, stretch: 2 kN/m, shear: 200, bending_warp: 2e-5, bending_weft: 1e-5}
)");
  std::string rows = "t,q\n";
  for (int i = 0; i <= 20; ++i) rows += std::to_string(0.01 * i) + "," + std::to_string(0.02 * i) + "\n";
  folder.write("run.csv", rows);
  folder.write("other.csv", rows + "0.21,0.42\n");  // a copy of the fitted run would be refused
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: run.csv, role: fit}
  - {file: other.csv, role: held_out}
channels:
  - {column: q, kind: position, joint: hinge, unit: rad, noise: 0.001}
initial: first_sample
)");
  return folder.path;
}

Scene read_back(const TestFolder& folder, const Problem& problem, const Diagnosis& diagnosis) {
  return load_scene_run(folder.write("amended.yaml", amended_scene(problem, diagnosis, folder.path))).scene;
}

TEST(AmendedScene, HasTheLawWithoutANameThatWasFound) {
  const TestFolder folder;
  const Problem problem = make_problem(recording(folder));
  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::none;
  diagnosis.used = problem.scene.scene;
  diagnosis.regressed.emplace();
  diagnosis.regressed->amended = {"regressed_effort", "hinge", {0.25, -0.3125}, {"c0 + c1 * sin(3 * q)"}};
  const Scene amended = read_back(folder, problem, diagnosis);
  ASSERT_EQ(amended.effects.size(), 1u);
  EXPECT_EQ(amended.effects[0].name, "regressed_effort");
  EXPECT_EQ(amended.effects[0].target, "hinge");
  EXPECT_EQ(amended.effects[0].formulas, (std::vector<std::string>{"c0 + c1 * sin(3 * q)"}));
  EXPECT_EQ(amended.effects[0].parameters, (std::vector<double>{0.25, -0.3125}));
}

// Each number that may be corrected is written where it is read: corrected by 5 % it is found again, 5 % larger.
TEST(AmendedScene, HasEveryCorrectedNumberOfTheScene) {
  const TestFolder folder;
  const Problem problem = make_problem(recording(folder));
  std::size_t n_written = 0;
  const std::vector<std::string> touching = {"base/arm"};
  for (const Candidate& candidate : make_candidates(problem, touching)) {
    if (candidate.family != Family::parameter) continue;
    const double value = 1.05 * candidate.parameters[0].off;
    Diagnosis diagnosis;
    diagnosis.verdict = Verdict::retune;
    diagnosis.effects = {{&candidate, {{"value", candidate.parameters[0].unit, value, value, value}}}};
    diagnosis.used = problem.scene.scene;
    const std::string text = amended_scene(problem, diagnosis, folder.path);
    if (text.find("# to set by hand") != std::string::npos) continue;
    ++n_written;
    Problem amended = problem;
    amended.scene.scene = load_scene_run(folder.write("amended.yaml", text)).scene;
    for (const Candidate& again : make_candidates(amended, touching)) {
      if (again.label() != candidate.label()) continue;
      EXPECT_NEAR(again.parameters[0].off, value, 1e-9 * value) << candidate.label();
    }
  }
  EXPECT_GE(n_written, 6u);
}

TEST(AmendedScene, ScalesBothStiffnessesOfAClothByWhatItsWarpShallHave) {
  const TestFolder folder;
  const Problem problem = make_problem(recording(folder));
  const std::vector<Candidate> candidates = make_candidates(problem, {});
  const auto bending = std::find_if(candidates.begin(), candidates.end(), [](const Candidate& candidate) {
    return candidate.name == "retune_bending_stiffness";
  });
  ASSERT_NE(bending, candidates.end());
  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::retune;
  diagnosis.effects = {{&*bending, {{"value", "N m", 6e-5, 5e-5, 7e-5}}}};
  diagnosis.used = problem.scene.scene;
  const Scene amended = read_back(folder, problem, diagnosis);
  EXPECT_DOUBLE_EQ(amended.cloths.at(0).material.bending_warp, 6e-5);
  EXPECT_DOUBLE_EQ(amended.cloths.at(0).material.bending_weft, 3e-5);
  EXPECT_DOUBLE_EQ(amended.cloths.at(0).material.stretch_warp, 2000);
}

TEST(AmendedScene, HasMomentsOfInertiaThatKeepTheirRatios) {
  const TestFolder folder;
  const Problem problem = make_problem(recording(folder, "mass: 2, inertia: [3e-3, 2e-3, 4e-3]"));
  const std::vector<Candidate> candidates = make_candidates(problem, {});
  const auto inertia = std::find_if(candidates.begin(), candidates.end(),
                                    [](const Candidate& candidate) { return candidate.name == "retune_inertia"; });
  ASSERT_NE(inertia, candidates.end());
  EXPECT_NEAR(inertia->parameters[0].off, 3e-3, 1e-15);
  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::retune;
  diagnosis.effects = {{&*inertia, {{"value", "kg m^2", 6e-3, 5e-3, 7e-3}}}};
  diagnosis.used = problem.scene.scene;
  const RigidBody arm = read_back(folder, problem, diagnosis).rigid_bodies.at(1);
  EXPECT_TRUE(arm.inertia.isApprox(Mat3(Vec3(6e-3, 4e-3, 8e-3).asDiagonal()), 1e-12));
  EXPECT_DOUBLE_EQ(arm.mass, 2);
}

TEST(AmendedScene, AMassTakesAStatedInertiaWithIt) {
  const TestFolder folder;
  const Problem problem = make_problem(recording(folder, "mass: 2, inertia: [3e-3, 2e-3, 4e-3, 5e-4, 0, 0]"));
  const std::vector<Candidate> candidates = make_candidates(problem, {});
  const auto mass = std::find_if(candidates.begin(), candidates.end(),
                                 [](const Candidate& candidate) { return candidate.name == "retune_mass"; });
  ASSERT_NE(mass, candidates.end());
  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::retune;
  diagnosis.effects = {{&*mass, {{"value", "kg", 3, 2.9, 3.1}}}};
  diagnosis.used = problem.scene.scene;
  const RigidBody arm = read_back(folder, problem, diagnosis).rigid_bodies.at(1);
  EXPECT_DOUBLE_EQ(arm.mass, 3);
  EXPECT_NEAR(arm.inertia(0, 0), 4.5e-3, 1e-15);
  EXPECT_NEAR(arm.inertia(0, 1), 7.5e-4, 1e-15);
}

TEST(AmendedScene, SaysWhatIsToBeSetByHandWhereANumberHasItsUnit) {
  const TestFolder folder;
  const Problem problem = make_problem(recording(folder));
  const std::vector<Candidate> candidates = make_candidates(problem, {});
  const auto stretch = std::find_if(candidates.begin(), candidates.end(), [](const Candidate& candidate) {
    return candidate.name == "retune_stretch_stiffness";
  });
  ASSERT_NE(stretch, candidates.end());
  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::retune;
  diagnosis.effects = {{&*stretch, {{"value", "N/m", 3000, 2900, 3100}}}};
  diagnosis.used = problem.scene.scene;
  const std::string text = amended_scene(problem, diagnosis, folder.path);
  EXPECT_NE(text.find("# to set by hand, where the scene's files say it: retune_stretch_stiffness at strip = 3"),
            std::string::npos)
      << text;
}

}  // namespace
}  // namespace pvg::diagnose
