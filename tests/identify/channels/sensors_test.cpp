// What sensors say of motions that a hand calculates: measured columns hold the calculation, residuals are the
// difference
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>

#include "host/base/error.hpp"
#include "host/identify/channels/prediction.hpp"
#include "host/identify/sensing/rollout.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

using Columns = std::map<std::string, std::function<double(double)>>;

// 40 rows over 0.2 s, each column a function of time, and 2e-6 more in the end: what never changes is refused
std::string table(const Columns& columns) {
  std::string text = "t";
  for (const auto& [name, value] : columns) text += "," + name;
  for (int i = 0; i < 40; ++i) {
    const double t = 0.005 * i;
    text += "\n" + std::to_string(t);
    for (const auto& [name, value] : columns)
      text += "," + (std::isnan(value(t)) ? "" : std::to_string(value(t) + 1e-5 * t));
  }
  return text + "\n";
}

Problem problem_of(const TestFolder& folder, const std::string& scene, const Columns& columns,
                   const std::string& channels, const std::string& inputs = "",
                   const std::string& run = "{file: a.csv, role: fit}") {
  folder.write("scene.yaml", "schema: 1\nname: sensors\ntime_step: 1 ms\n" + scene);
  folder.write("a.csv", table(columns));
  folder.write("recording.yaml", "schema: 1\nscene: scene.yaml\nruns:\n  - " + run + "\n" + inputs + "channels:\n" +
                                     channels + "initial: {}\n");
  return make_problem(folder.path / "recording.yaml");
}

// The largest residual of each channel, in its unit, from this sample on.
std::vector<double> errors_of(const Problem& problem, std::size_t first = 0) {
  Device device;
  Predictor predictor(device, problem);
  const Variant as_it_is{problem.scene.scene, {}};
  const Window window = make_windows(problem, false, 0, 1).at(0);
  const Job job{&as_it_is, &window, window.initial};
  const Prediction prediction = predictor.predict({&job, 1}).at(0);
  EXPECT_TRUE(prediction.succeeded);
  std::vector<double> errors(problem.channels.size(), 0);
  for (std::size_t i = 0; i < window.data.size(); ++i) {
    const std::size_t c = std::size_t(window.data[i].channel);
    if (window.data[i].sample < first) continue;
    errors[c] = std::max(errors[c], std::abs(prediction.residual[Eigen::Index(i)]) * problem.channels[c].sigma);
  }
  return errors;
}

const std::string THROWN = R"(
bodies:
  - {name: pole, kind: static, shape: {box: {size: [0.01, 0.01, 0.01]}}, pose: {position: [0, 5, 0]}}
  - {name: die, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, mass: 0.2, velocity: [1, 0, 2],
     angular_velocity: [0, 0, 3]}
)";

// Thrown with 1 m/s along x and 2 m/s upwards, turning with 3 rad/s about z: a cube's inertia is the same about all
// axes, so the spin stays. A point of it 0.1 m from the centre along its own x is weightless but for -w^2 r = -0.9
// m/s^2.
TEST(Sensors, OnAThrownBodySayWhatItsFlightIs) {
  const TestFolder folder;
  const auto constant = [](double value) { return [value](double) { return value; }; };
  const Columns columns = {{"vx", constant(1)},
                           {"vy", constant(0)},
                           {"vz", [](double t) { return 2 - 9.81 * t; }},
                           {"wx", constant(0)},
                           {"wz", constant(3)},
                           {"ax", constant(-0.9)},
                           {"zero", constant(0)},
                           {"d", [](double t) { return std::hypot(t, 5, 2 * t - 0.5 * 9.81 * t * t); }}};
  const std::vector<double> errors = errors_of(problem_of(folder, THROWN, columns, R"(
  - {columns: [vx, vy, vz], kind: rate, body: die, noise: 1}
  - {column: vz, kind: rate, body: die, axis: [0, 0, 1], unit: m/s, noise: 1}
  - {columns: [wx, zero, wz], kind: angular_velocity, body: die, noise: 1}
  - {columns: [wx, zero, wz], kind: gyroscope, body: die, unit: rad/s, noise: 1}
  - {columns: [ax, zero, zero], kind: accelerometer, body: die, point: [0.1, 0, 0], noise: 1}
  - {column: d, kind: distance, body: die, to: {body: pole}, noise: 1}
)"));
  const std::vector<double> most = {0.01, 0.01, 0.01, 0.01, 0.02, 1e-3};  // first order of 1 ms: g h / 2, ..
  ASSERT_EQ(errors.size(), most.size());
  for (std::size_t c = 0; c < most.size(); ++c) EXPECT_LT(errors[c], most[c]) << c;
}

// On a table a die feels its support: 9.81 m/s^2 upwards, whatever way it is turned.
TEST(Sensors, AnAccelerometerAtRestFeelsItsSupport) {
  const TestFolder folder;
  const Columns columns = {{"x", [](double) { return 9.81; }}, {"zero", [](double) { return 0; }}};
  const std::vector<double> errors = errors_of(problem_of(folder, R"(
bodies:
  - {name: table, kind: static, shape: {box: {size: [1, 1, 0.1]}}}
  - {name: die, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, mass: 0.2,
     pose: {position: [0, 0, 0.2], rotation: [0, -90 deg, 0]}}
joints:
  - {name: glue, type: fixed, parent: table, child: die, parent_frame: {position: [0, 0, 0.2], rotation: [0, -90 deg, 0]}}
)",
                                                          columns, R"(
  - {columns: [x, zero, zero], kind: accelerometer, body: die, noise: 1}
)"));
  EXPECT_LT(errors[0], 0.01);
}

// 0.2 N m over 0.05 N m/A are 4 A, from the first step on.
TEST(Sensors, ACurrentIsAnEffortOverItsConstant) {
  const TestFolder folder;
  const std::string scene = R"(
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.1, 0.1, 0.1]}}}
  - {name: arm, kind: rigid, shape: {box: {size: [0.2, 0.02, 0.02]}}, mass: 0.2, pose: {position: [0, 0, 1]}}
joints:
  - {name: shaft, type: revolute, parent: base, child: arm, parent_frame: {position: [0, 0, 1]}, axis: [0, 0, 1]}
)";
  const Columns columns = {{"tau", [](double) { return 0.2; }},
                           {"i", [](double t) { return t < 0.004 ? std::nan("") : 4000; }}};
  const std::string inputs = "inputs:\n  - {column: tau, target: joint/shaft/torque}\n";
  const auto problem = [&](const std::string& keys) {
    return problem_of(folder, scene, columns, "  - {column: i, kind: current, joint: shaft, noise: 1" + keys + "}\n",
                      inputs);
  };
  EXPECT_LT(errors_of(problem(", unit: mA, constant: 0.05 N m/A"))[0], 1e-4);  // the column of torques rises, too
  expect_error<UsageError>([&] { problem(", constant: 0.05"); }, {"channels[0]", "constant", "0.05 N m/A"});
  expect_error<UsageError>([&] { problem(", constant: 1 N m/A, unit: N m"); }, {"channels[0]", "A or mA"});
}

// A block of 0.4 kg that is pressed on a plate 50 mm beside its middle: 3.924 N down, 0.1962 N m about y.
TEST(Sensors, APlateFeelsForceTorqueAndThatItIsTouched) {
  const TestFolder folder;
  const auto late = [](double value) { return [value](double t) { return t < 0.15 ? std::nan("") : value; }; };
  const std::vector<double> errors =
      errors_of(problem_of(folder, R"(
contact: {activation_distance: 1 mm, stiffness: 1 MPa}
bodies:
  - {name: plate, kind: static, shape: {box: {size: [1, 1, 0.1]}}}
  - {name: block, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.04]}}, mass: 0.4, pose: {position: [0.05, 0, 0.0705]}}
)",
                           {{"f", late(-3.924)}, {"m", late(0.1962)}, {"zero", late(0)}, {"one", late(1)}},
                           R"(
  - {columns: [zero, zero, f], kind: force, body: plate, noise: 1}
  - {columns: [zero, m, zero], kind: torque, body: plate, noise: 1}
  - {column: one, kind: contact, body: block, with: plate, noise: 0.2}
  - {column: zero, kind: position, body: block, axis: [0, 1, 0], noise: 1}
)"));
  EXPECT_LT(errors[0], 0.04);
  EXPECT_LT(errors[1], 0.004);
  EXPECT_LT(errors[2], 1e-5);
}

// A tool of 0.5 kg hangs 0.1 m below its sensor and 0.02 m beside it, along the sensor's y, which points down, and its
// x: m g along y, and 0.02 m g about z.
TEST(Sensors, AFixedJointFeelsWhatHangsOnIt) {
  const TestFolder folder;
  const double weight = 0.5 * 9.81;
  const auto constant = [](double value) { return [value](double) { return value; }; };
  const Columns columns = {{"weight", constant(weight)}, {"turn", constant(0.02 * weight)}, {"zero", constant(0)}};
  const Problem problem = problem_of(folder, R"(
bodies:
  - {name: hand, kind: static, shape: {box: {size: [0.05, 0.05, 0.05]}}}
  - {name: tool, kind: rigid, shape: {box: {size: [0.02, 0.02, 0.02]}}, mass: 0.5, pose: {position: [0.02, 0, -0.1]}}
joints:
  - {name: sensor, type: fixed, parent: hand, child: tool, parent_frame: {rotation: [-90 deg, 0, 0]}}
)",
                                     columns, R"(
  - {columns: [zero, weight, zero], kind: force, joint: sensor, unit: N, noise: 1}
  - {columns: [zero, zero, turn], kind: torque, joint: sensor, unit: N m, noise: 1}
  - {columns: [weight], kind: force, joint: sensor, axis: [0, 1, 0], noise: 1}
)");
  const std::vector<double> at_start = errors_of(problem), errors = errors_of(problem, 2);
  EXPECT_LT(at_start[0], 0.02 * weight) << "the first sample too, while the joint's springs take up the load";
  EXPECT_LT(errors[0], 1e-3 * weight);
  EXPECT_LT(errors[1], 1e-3 * 0.02 * weight);
  EXPECT_LT(errors[2], 1e-3 * weight);
}

TEST(Sensors, ATurningJointHasNoTorqueInThreeAxes) {
  const TestFolder folder;
  const std::string scene = R"(
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.05, 0.05, 0.05]}}, collides: false}
  - {name: arm, kind: rigid, shape: {box: {size: [0.02, 0.02, 0.2]}}, mass: 0.5, pose: {position: [0, 0, -0.1]}, collides: false}
joints:
  - {name: hinge, type: revolute, parent: base, child: arm, axis: [0, 1, 0]}
)";
  const Columns columns = {{"weight", [](double) { return -0.5 * 9.81; }}, {"zero", [](double) { return 0; }}};
  expect_error<UsageError>(
      [&] {
        problem_of(folder, scene, columns, "  - {columns: [zero, zero, zero], kind: torque, joint: hinge, noise: 1}\n");
      },
      {"the joint `hinge` turns, so its torque in three axes cannot be predicted; divide the body where the sensor "
       "sits"});
  const Problem problem =
      problem_of(folder, scene, columns, "  - {columns: [zero, zero, weight], kind: force, joint: hinge, noise: 1}\n");
  EXPECT_LT(errors_of(problem)[0], 0.02 * 0.5 * 9.81);
  EXPECT_LT(errors_of(problem, 2)[0], 1e-3);
}

// A plate under a block of 2 kg that rests on it: its force is all that is measured.
TEST(Sensors, AForcePlateAloneIsEnough) {
  const TestFolder folder;
  const Columns columns = {{"weight", [](double) { return -2 * 9.81; }}, {"zero", [](double) { return 0; }}};
  const std::string channel = "  - {columns: [zero, zero, weight], kind: force, body: plate, unit: N, noise: 1}\n";
  const std::string plate = "\nbodies:\n  - {name: plate, kind: static, shape: {square: {size: 1}}}\n";
  const Problem problem = problem_of(folder,
                                     plate +
                                         "  - {name: block, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, mass: "
                                         "2, pose: {position: [0, 0, 0.0505]}}\n",
                                     columns, channel);
  EXPECT_EQ(problem.channels.size(), 1u);
  expect_error<UsageError>([&] { problem_of(folder, plate, columns, channel); }, {"nothing is measured that can move"});
}

TEST(Sensors, AnEarlyBlockIsNotFelt) {
  const TestFolder folder;
  const std::vector<double> errors =
      errors_of(problem_of(folder, THROWN, {{"zero", [](double) { return 0; }}, {"vx", [](double) { return 1; }}}, R"(
  - {column: zero, kind: contact, body: die, noise: 0.2}
  - {column: vx, kind: rate, body: die, axis: [1, 0, 0], noise: 1}
)"));
  EXPECT_LT(errors[0], 1e-5);
}

// A gyroscope of 2 rad/s reads 2 where the body turns with 3; a hundredfold slower sensor than the motion lags by tau.
TEST(Sensors, SaturateAndLagAsTheirMakersSay) {
  const TestFolder folder;
  const double tau = 1 / (2 * M_PI * 20);
  const Columns columns = {
      {"zero", [](double) { return 0; }}, {"two", [](double) { return 2; }}, {"x", [&](double t) { return t - tau; }}};
  const std::vector<double> errors = errors_of(problem_of(folder, THROWN, columns, R"(
  - {columns: [zero, zero, two], kind: gyroscope, body: die, noise: 1, saturation: [-2, 2]}
  - {column: x, kind: position, body: die, axis: [1, 0, 0], noise: 1, filter: {low_pass: 20 Hz}}
)"));
  EXPECT_LT(errors[0], 0.01);
  EXPECT_LT(errors[1], 1e-5);
}

// What a maker rounds to 0.01 has a noise of 0.01 / sqrt(12) beside its own.
TEST(Sensors, AStatedResolutionIsNoise) {
  const TestFolder folder;
  const Problem problem = problem_of(folder, THROWN, {{"x", [](double t) { return t; }}},
                                     "  - {column: x, kind: position, body: die, axis: [1, 0, 0], unit: mm, noise: 3, "
                                     "resolution: 10}\n");
  EXPECT_NEAR(problem.channels[0].sigma, 1e-3 * std::hypot(3, 10 / std::sqrt(12.0)), 1e-12);
}

TEST(LowPass, FollowsALineLateAndAStepExponentially) {
  std::vector<double> line, bend;
  for (int i = 0; i < 200; ++i) line.push_back(0.01 * i), bend.push_back(i < 100 ? 0 : 1);
  const double cut_off = 3, tau = 1 / (2 * M_PI * cut_off), h = 0.01;
  low_pass(line, 1, h, cut_off);
  EXPECT_NEAR(line[150], 1.5 - tau, 1e-12);
  low_pass(bend, 1, h, cut_off);
  EXPECT_EQ(bend[99], 0);
  // a rise over one step, then 1: y = 1 - (1 - y1) exp(-t / tau), y1 = 1 - tau / h (1 - exp(-h / tau))
  const double first = 1 - tau / h * (1 - std::exp(-h / tau));
  EXPECT_NEAR(bend[100], first, 1e-12);
  EXPECT_NEAR(bend[120], 1 - (1 - first) * std::exp(-0.2 / tau), 1e-12);
}

TEST(Sensors, TwoColumnsOfATrackerAreTwoDirections) {
  const TestFolder folder;
  const Problem problem =
      problem_of(folder, THROWN, {{"a", [](double t) { return t; }}, {"b", [](double t) { return 2 * t; }}},
                 "  - {columns: [a, b], kind: marker, body: die, point: [0, 0, 0], axes: [x, z], noise: 1}\n");
  ASSERT_EQ(problem.channels.size(), 2u);
  EXPECT_EQ(problem.channels[1].axis, Vec3(Vec3::UnitZ()));
}

TEST(Sensors, OfABodyThatTheSceneDoesNotHaveAreRefused) {
  const TestFolder folder;
  const auto refused = [&](const std::string& channel, std::initializer_list<const char*> words) {
    expect_error<UsageError>(
        [&] {
          problem_of(folder, THROWN, {{"x", [](double t) { return t; }}}, "  - {column: x, " + channel + "}\n");
        },
        words);
  };
  refused("kind: distance, body: die, to: {body: tower}", {"channels[0]", "tower"});
  refused("kind: contact, body: die, with: tower, noise: 0.1", {"channels[0]", "tower"});
  refused("kind: contact, body: die", {"noise", "0.2"});
  refused("kind: gyroscope, body: die", {"3 columns"});
  refused("kind: gyroscope, body: die, axes: [x, w]", {"axes", "[x, z]"});
}

}  // namespace
}  // namespace pvg::diagnose
