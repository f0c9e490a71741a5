// Names that are withheld, by whole diagnoses of a plate on a spindle
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "host/identify/search/workflow.hpp"
#include "tests/identify/spindle.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

constexpr double NOISE = 2e-3;  // [rad]

// I q'' = -k q - c q^3 with I = 2 / 300 kg m^2, k = 1 N m/rad and c = 2 N m/rad^3, let go at rest from q, by Runge and
// Kutta's fourth order.
std::vector<double> on_a_stiffening_spring(double q, std::size_t n_samples) {
  constexpr double INERTIA = 2.0 / 300, H = 1e-3;
  const auto acceleration = [](double at) { return -(at + 2 * at * at * at) / INERTIA; };
  std::vector<double> samples;
  double w = 0;
  for (std::size_t i = 0; i < 10 * n_samples; ++i) {
    if (i % 10 == 0) samples.push_back(q);
    const double a1 = acceleration(q), a2 = acceleration(q + H / 2 * w),
                 a3 = acceleration(q + H / 2 * w + H * H / 4 * a1), a4 = acceleration(q + H * w + H * H / 2 * a2);
    q += H * w + H * H / 6 * (a1 + a2 + a3);
    w += H / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  return samples;
}

// Of samples 10 ms apart, with noise; `order` of the rows.
std::string table(std::vector<double> samples, unsigned seed, bool is_shuffled) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> noise(0, NOISE);
  if (is_shuffled) std::shuffle(samples.begin(), samples.end(), engine);
  std::string text = "t,q\n";
  for (std::size_t i = 0; i < samples.size(); ++i)
    text += std::to_string(0.01 * double(i)) + "," + std::to_string(samples[i] + noise(engine)) + "\n";
  return text;
}

Diagnosis diagnosed(bool is_shuffled) {
  const TestFolder folder;
  std::string scene = plate_on_a_spindle("5 ms");  // with the linear part of the spring
  scene.insert(scene.rfind('}'), ", drive: {stiffness: 1, target: 0}");
  folder.write("scene.yaml", scene);
  const std::vector<double> starts = {0.3, 0.34, 0.36};
  for (std::size_t i = 0; i < starts.size(); ++i)
    folder.write("run_" + std::to_string(i) + ".csv",
                 table(on_a_stiffening_spring(starts[i], is_shuffled ? 31 : 61), unsigned(i), is_shuffled));
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: run_0.csv, role: fit}
  - {file: run_1.csv, role: fit}
  - {file: run_2.csv, role: held_out}
channels:
  - {column: q, kind: position, joint: spindle, unit: rad, noise: 0.002}
)");
  Problem problem = make_problem(folder.path / "recording.yaml");
  Device device;
  Settings settings;
  settings.max_effects = 1;
  settings.n_fitted = 2;
  return diagnose(device, problem, settings, {});
}

bool any_says(const std::vector<std::string>& notes, const std::string& words) {
  return std::any_of(notes.begin(), notes.end(),
                     [&](const std::string& note) { return note.find(words) != std::string::npos; });
}

// Another stiffness closes most of the gap and leaves 4.7 times the noise, a cube of the angle leaves the noise.
TEST(WithheldName, IsOneThatALawBeats) {
  const Diagnosis found = diagnosed(false);
  EXPECT_EQ(found.verdict, Verdict::none);
  ASSERT_FALSE(found.effects.empty());
  EXPECT_GT(found.gap_closed, criteria().gap_closed_least) << "the stiffness would have been named";
  EXPECT_TRUE(any_says(found.notes, "the name is withheld"));
  ASSERT_TRUE(found.regressed.has_value());
  EXPECT_LT(found.regressed->after, 1.3 * found.regressed->floor);
}

// Rows in any order are followed by nothing, so there is no name, no pair and no law.
TEST(WithheldName, IsAnyWhereNothingFollows) {
  const Diagnosis found = diagnosed(true);
  EXPECT_EQ(found.verdict, Verdict::none);
  EXPECT_FALSE(found.regressed.has_value());
  EXPECT_TRUE(any_says(found.notes, "are inputs and rows those of their run?"));
}

}  // namespace
}  // namespace pvg::diagnose
