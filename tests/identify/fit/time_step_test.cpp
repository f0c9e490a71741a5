// Which step the workflow takes
#include "host/identify/fit/time_step.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/identify/fit/spinning_plate.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

// A cube of 1 kg on a rail along x, drawn to x = 0 by 400 N/m, let go at 50 mm, where its rail counts from:
// x = 50 mm cos(20 t / s)
Problem swinging(const TestFolder& folder, const std::string& channel) {
  folder.write("scene.yaml", R"(schema: 1
name: rail
time_step: 10 ms
gravity: [0, 0, 0]
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.1, 0.1, 0.1]}}, collides: false}
  - {name: cube, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, mass: 1, pose: {position: [0.05, 0, 0]}, collides: false}
joints:
  - {name: rail, type: prismatic, parent: base, child: cube, axis: [1, 0, 0]}
effects:
  - {effect: joint_spring, target: rail, stiffness: 400, preload: -20}
)");
  std::string run = "t,x,y,z\n";
  for (int i = 0; i < 100; ++i)
    run += std::to_string(0.01 * i) + "," + std::to_string(0.05 * std::cos(0.2 * i)) + ",0,0\n";
  folder.write("a.csv", run);
  folder.write("recording.yaml",
               "schema: 1\nscene: scene.yaml\nruns:\n  - {file: a.csv, role: fit}\nchannels:\n  - " + channel + "\n");
  return make_problem(folder.path / "recording.yaml");
}

double step_of(const Problem& problem) {
  Device device;
  Predictor predictor(device, problem);
  Variant base{problem.scene.scene, {}};
  Fitter fitter(predictor, base);
  std::printf("%s\n", choose_time_step(fitter, predictor, problem, base).c_str());
  return base.scene.solver.time_step;
}

// The step that is chosen, of which two lengths are extrapolated: a tenth of its own error is left, or less [s].
double extrapolated_step(const Problem& problem) {
  Device device;
  Predictor predictor(device, problem);
  Variant base{problem.scene.scene, {}};
  Fitter fitter(predictor, base);
  const std::string text = choose_time_step(fitter, predictor, problem, base);
  EXPECT_TRUE(base.extrapolates) << text;
  const std::vector<Window> windows = make_windows(problem, false, 0, 1);
  const auto error_of = [&](const Variant& variant) {
    const Job job{&variant, &windows[0], windows[0].initial, false};
    return rms({predictor.predict({&job, 1})[0].residual});
  };
  Variant as_stepped = base;
  as_stepped.extrapolates = false;
  EXPECT_LT(error_of(base), 0.1 * error_of(as_stepped));
  return base.scene.solver.time_step;
}

// BDF2 turns slower by (w h)^2 / 3: at 10 ms 1.3 %, after 20 rad 270 mrad of 50 mm. Steps of 10 and 5 ms together are
// of third order.
TEST(TimeStep, IsNotCoarserForColumnsInWhichNothingHappens) {
  const TestFolder folder, other;
  const double one =
      step_of(swinging(folder, "{column: x, kind: position, body: cube, axis: [1, 0, 0], unit: m, noise: 0.0003}"));
  const double three =
      step_of(swinging(other, "{columns: [x, y, z], kind: position, body: cube, unit: m, noise: 0.0003}"));
  EXPECT_DOUBLE_EQ(one, 0.01);
  EXPECT_DOUBLE_EQ(three, one);
}

TEST(TimeStep, ErrorOfFirstOrderIsTwiceTheChangeByHalfTheStepAndOfSecondFourThirds) {
  EXPECT_DOUBLE_EQ(measured_richardson_factor(2, 4), 2);
  EXPECT_DOUBLE_EQ(measured_richardson_factor(4, 4), 4.0 / 3);
  EXPECT_DOUBLE_EQ(measured_richardson_factor(1, 4), 2);  // no order below the first
  EXPECT_DOUBLE_EQ(measured_richardson_factor(16, 4), 4.0 / 3);
}

TEST(TimeStep, OfThirdOrderTheErrorIsEightSeventhsOfTheChangeWhereThatOrderIsReached) {
  EXPECT_DOUBLE_EQ(measured_richardson_factor(9, 8), 8.0 / 7);
  EXPECT_DOUBLE_EQ(measured_richardson_factor(3.7, 8), 3.7 / 2.7);
}

// A cube of 1 kg that a drive of 1 N/m and 2 N s/m leads along its rail after T = 2 m/s^2 t^2 / 2: it lags by e,
// e'' = 2 - 2 e' - e, e = 2 (1 - (1 + t) exp(-t)). The command's rate is the mean over a step, half a step late: an
// error of first order.
TEST(TimeStep, ErrorOfADampedCommandIsExtrapolatedAwayAtTheScenesStep) {
  const TestFolder folder;
  folder.write("scene.yaml", R"(schema: 1
name: rail
time_step: 10 ms
gravity: [0, 0, 0]
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.1, 0.1, 0.1]}}, collides: false}
  - {name: cube, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, mass: 1, collides: false}
joints:
  - {name: rail, type: prismatic, parent: base, child: cube, axis: [1, 0, 0], drive: {stiffness: 1, damping: 2, target: 0}}
)");
  std::string run = "t,c,x\n";
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.01 * i;
    run += std::to_string(t) + "," + std::to_string(t * t) + "," +
           std::to_string(t * t - 2 * (1 - (1 + t) * std::exp(-t))) + "\n";
  }
  folder.write("a.csv", run);
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit, initial: {joint/rail/position: 0, joint/rail/velocity: 0}}
inputs:
  - {column: c, target: joint/rail/position, unit: m}
channels:
  - {column: x, kind: position, joint: rail, unit: m, noise: 0.0004}
)");
  const Problem problem = make_problem(folder.path / "recording.yaml");
  EXPECT_DOUBLE_EQ(extrapolated_step(problem), 0.01);
}

// The axes of a body go along chords of their circle, so that BDF2 takes its inertia for (w h)^2 4/9 larger: of 5 ms at
// 30 rad/s for 1 %. An error of second order, which needs steps of a sixteenth, and which two coarse steps extrapolate
// away.
TEST(TimeStep, ErrorOfAFastSpinIsExtrapolatedAwayAtCoarseSteps) {
  const TestFolder folder;
  const Problem problem = spinning_plate(folder);
  EXPECT_GE(extrapolated_step(problem), 0.0025);
}

TEST(TimeStep, OfAFastRunIsNotCoarserAmongSlowOnes) {
  const TestFolder alone, among;
  EXPECT_LE(extrapolated_step(spinning_plate(among, 8)), extrapolated_step(spinning_plate(alone)));
}

// A cube of 1 kg that is pushed along its rail by 1 N/s t: x = t^3 / 6, 0.17 m after a second, then at 0.5 m/s. A push
// that is half a step of 10 ms late would leave it 2.5 mm behind.
TEST(TimeStep, OfSecondOrderTakesTheEffortOfItsEnd) {
  const TestFolder folder;
  folder.write("scene.yaml", R"(schema: 1
name: rail
time_step: 10 ms
gravity: [0, 0, 0]
solver: {integrator: bdf2}
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.1, 0.1, 0.1]}}, collides: false}
  - {name: cube, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, mass: 1, collides: false}
joints:
  - {name: rail, type: prismatic, parent: base, child: cube, axis: [1, 0, 0]}
)");
  std::string run = "t,x,push\n";
  for (int i = 0; i <= 100; ++i)
    run += std::to_string(0.01 * i) + "," + std::to_string(std::pow(0.01 * i, 3) / 6) + "," + std::to_string(0.01 * i) +
           "\n";
  folder.write("a.csv", run);
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit, initial: {joint/rail/position: 0, joint/rail/velocity: 0}}
inputs:
  - {column: push, target: joint/rail/torque, unit: N}
channels:
  - {column: x, kind: position, joint: rail, unit: m, noise: 0.0001}
)");
  const Problem problem = make_problem(folder.path / "recording.yaml");
  Device device;
  Predictor predictor(device, problem);
  const Variant base{problem.scene.scene, {}};
  const std::vector<Window> windows = make_windows(problem, false, 0, 1);
  const Job job{&base, &windows[0], windows[0].initial, false};
  EXPECT_LT(predictor.predict({&job, 1})[0].residual.cwiseAbs().maxCoeff(), 2.0);  // 0.2 mm
}

// How much of a hard impact comes back is decided by the step, finer ones included: there is nothing to go near to.
TEST(TimeStep, OfHardImpactsIsTheScenes) {
  const TestFolder folder;
  folder.write("scene.yaml", R"(schema: 1
name: dropped_on_a_corner
time_step: 2 ms
contact: {activation_distance: 0.5 mm, stiffness: 1 MPa, friction_velocity: 1e-3}
bodies:
  - {name: floor, kind: half_space, normal: [0, 0, 1]}
  - {name: cube, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, mass: 0.4, pose: {position: [0, 0, 0.15], rotation: [0.6, 0.5, 0]}}
)");
  std::string run = "t,x,y,z,qx,qy,qz,qw\n";  // as it falls; the impact is at 0.12 s
  for (int i = 0; i < 40; ++i)
    run += std::to_string(0.01 * i) + ",0,0," + std::to_string(std::max(0.15 - 4.905e-4 * i * i, 0.05)) +
           ",0.286328,0.236358,-0.073112,0.925648\n";
  folder.write("a.csv", run);
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
channels:
  - {columns: [x, y, z], kind: position, body: cube, unit: m, noise: 0.001}
  - {columns: [qx, qy, qz, qw], kind: orientation, body: cube, noise: 0.01}
)");
  const Problem problem = make_problem(folder.path / "recording.yaml");
  Device device;
  Predictor predictor(device, problem);
  Variant base{problem.scene.scene, {}};
  Fitter fitter(predictor, base);
  const std::string text = choose_time_step(fitter, predictor, problem, base);
  EXPECT_DOUBLE_EQ(base.scene.solver.time_step, 2e-3) << text;
  EXPECT_EQ(base.scene.solver.integrator, SolverSettings::Integrator::implicit_euler) << text;
  EXPECT_NE(text.find("do not come nearer to each other"), std::string::npos) << text;
  for (const Window& window : fitter.prepare(make_windows(problem, false, 0, 1), {{}, {}, {}}).windows)
    EXPECT_EQ(window.correction.size(), 0);
}

}  // namespace
}  // namespace pvg::diagnose
