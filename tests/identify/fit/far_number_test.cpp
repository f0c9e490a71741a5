// A number of the scene that is wrong by factors, found before the time step is chosen
#include "host/identify/fit/far_number.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

constexpr double INERTIA = 0.1 * 0.1 / 6 + 0.15 * 0.15;  // of the arm about its joint [kg m^2]
constexpr double STIFFNESS = 20, DAMPING = 0.6;          // N m/rad, N m s/rad

// The arm on its drive is told to go to 0.3 rad at once:
//   q = 0.3 (1 - exp(-z t) (cos(w t) + z / w sin(w t))),  z = d / 2 I, w^2 = k / I - z^2
double driven(double t) {
  const double z = DAMPING / (2 * INERTIA), w = std::sqrt(STIFFNESS / INERTIA - z * z);
  return 0.3 * (1 - std::exp(-z * t) * (std::cos(w * t) + z / w * std::sin(w * t)));
}

// What a scene with these numbers is asked to explain: `seen` of the true angle.
template <class Seen>
Problem arm_on_drive(const TestFolder& folder, double stiffness, double damping, const Seen& seen) {
  folder.write("scene.yaml", R"(schema: 1
name: driven
time_step: 5 ms
gravity: [0, 0, 0]
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.01, 0.01, 0.01]}}, collides: false}
  - {name: arm, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, mass: 1, pose: {position: [0.15, 0, 0]}, collides: false}
joints:
  - {name: shoulder, type: revolute, parent: base, child: arm, axis: [0, 0, 1], drive: {stiffness: )" +
                                 std::to_string(stiffness) + ", damping: " + std::to_string(damping) +
                                 ", target: 0.3}}\n");
  std::string run = "t,q\n";
  for (int i = 0; i < 60; ++i) run += std::to_string(0.01 * i) + "," + std::to_string(seen(0.01 * i)) + "\n";
  folder.write("a.csv", run);
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
channels:
  - {column: q, kind: position, joint: shoulder, unit: rad, noise: 0.001}
initial: {joint/shoulder/position: 0, joint/shoulder/velocity: 0}
)");
  return make_problem(folder.path / "recording.yaml");
}

std::optional<FarNumber> found_in(const Problem& problem) {
  Device device;
  Predictor predictor(device, problem);
  Variant base{problem.scene.scene, {}};
  base.scene.solver.integrator = SolverSettings::Integrator::bdf2;
  Fitter fitter(predictor, base);
  return find_far_number(fitter, problem);
}

TEST(FarNumber, AStiffness64TimesTooLargeIsFoundWithinAFewPerCent) {
  const TestFolder folder;
  const std::optional<FarNumber> far = found_in(arm_on_drive(folder, 64 * STIFFNESS, DAMPING, driven));
  ASSERT_TRUE(far);
  EXPECT_EQ(far->number.label(), "retune_drive_stiffness at shoulder");
  EXPECT_NEAR(far->value, STIFFNESS, 0.06 * STIFFNESS);
  EXPECT_GT(far->before, 30);
  EXPECT_LT(far->after, 0.1 * far->before);
}

TEST(FarNumber, AStiffness40TimesTooSmallIsFoundAlike) {
  const TestFolder folder;
  const std::optional<FarNumber> far = found_in(arm_on_drive(folder, STIFFNESS / 40, DAMPING, driven));
  ASSERT_TRUE(far);
  EXPECT_EQ(far->number.label(), "retune_drive_stiffness at shoulder");
  EXPECT_NEAR(far->value, STIFFNESS, 0.06 * STIFFNESS);
}

TEST(FarNumber, ADampingThatIsFarOffIsFoundAlike) {
  const TestFolder folder;
  const std::optional<FarNumber> far = found_in(arm_on_drive(folder, STIFFNESS, 30 * DAMPING, driven));
  ASSERT_TRUE(far);
  EXPECT_EQ(far->number.label(), "retune_drive_damping at shoulder");
  EXPECT_NEAR(far->value, DAMPING, 0.06 * DAMPING);
}

TEST(FarNumber, ThereIsNoneWhereTheSceneIsNearlyRight) {
  const TestFolder folder;
  EXPECT_FALSE(found_in(arm_on_drive(folder, STIFFNESS, DAMPING, driven)));
  const TestFolder other;
  EXPECT_FALSE(found_in(arm_on_drive(other, 1.1 * STIFFNESS, DAMPING, driven))) << "the misfit is small";
}

// A misfit of 100 times the noise that no number explains: the arm trembles at 12 Hz.
TEST(FarNumber, ThereIsNoneWhereNoNumberExplainsNearlyAll) {
  const TestFolder folder;
  const auto trembling = [](double t) { return driven(t) + 0.14 * std::sin(2 * M_PI * 12 * t); };
  EXPECT_FALSE(found_in(arm_on_drive(folder, STIFFNESS, DAMPING, trembling)));
}

TEST(FarNumber, ValuesAreFactorsAwayWithinTheBounds) {
  const Parameter mass{"value", "kg", 0.4, 10, 2};
  EXPECT_EQ(factors_away(mass, {4, 16}), (std::vector<double>{8, 0.5}));
  const Parameter zero{"value", "N m s/rad", 0, 0, 0};
  EXPECT_EQ(factors_away(zero, {}), std::vector<double>());
}

TEST(FarNumber, ValuesBetweenHaveEqualRatios) {
  const std::vector<double> values = ratios_between(1, 8, 2);
  ASSERT_EQ(values.size(), 2u);
  EXPECT_NEAR(values[0], 2, 1e-12);
  EXPECT_NEAR(values[1], 4, 1e-12);
  EXPECT_TRUE(ratios_between(1, 8, 0).empty());
}

}  // namespace
}  // namespace pvg::diagnose
