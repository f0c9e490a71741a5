#include "pipeline/diagnose/time_step.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pvg::diagnose {
namespace {

constexpr double SEEN = 0.3;     // rms of a difference in units of noise that counts as an error
constexpr double SOLVED = 1e-6;  // Newton's tolerance, so that answers to small changes are exact [m/s]

struct Choice {
  SolverSettings::Integrator integrator;
  double time_step;
};

// rms of the difference of two predictions of the same windows [noise]
double apart(const std::vector<Prediction>& a, const std::vector<Prediction>& b) {
  double sum = 0, n = 0;
  for (std::size_t w = 0; w < a.size(); ++w) {
    if (!a[w].is_well || !b[w].is_well) continue;
    // the median over a window of squares: an impact a step earlier is no error of the motion
    Eigen::VectorXd d = (a[w].residual - b[w].residual).cwiseAbs2();
    std::sort(d.begin(), d.end());
    sum += d.head(std::max<Eigen::Index>(1, 9 * d.size() / 10)).sum();
    n += 0.9 * double(d.size());
  }
  return n > 0 ? std::sqrt(sum / n) : INFINITY;
}

}  // namespace

std::string choose_time_step(Predictor& predictor, const Problem& problem, Variant& base) {
  SolverSettings& solver = base.scene.solver;
  solver.velocity_tolerance = std::min(solver.velocity_tolerance, SOLVED);
  solver.cg_tolerance = std::min(solver.cg_tolerance, 1e-8);
  const double h = solver.time_step;
  std::vector<Window> windows = make_windows(problem, false, problem.can_restart ? 1 : 0, 3);
  const auto predict = [&](const Choice& choice) {
    Variant variant = base;
    variant.scene.solver.integrator = choice.integrator;
    variant.scene.solver.time_step = choice.time_step;
    std::vector<Job> jobs;
    for (const Window& window : windows) jobs.push_back({&variant, &window, window.initial, false});
    return predictor.predict(jobs);
  };
  const auto bdf2 = SolverSettings::Integrator::bdf2;
  const std::vector<Choice> choices = {{solver.integrator, h}, {bdf2, h}, {bdf2, h / 2}, {bdf2, h / 4}, {bdf2, h / 8}};
  std::vector<Prediction> fine = predict(choices[2]);
  std::size_t chosen = choices.size() - 1;
  double error = 0;
  std::vector<std::vector<Prediction>> tried = {predict(choices[0]), predict(choices[1]), fine};
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (i >= 2 && i + 1 < choices.size()) tried.push_back(predict(choices[i + 1]));
    const std::vector<Prediction>& better = i < 2 ? fine : tried[std::min(i + 1, tried.size() - 1)];
    error = apart(tried[i], better) * (i == 0 ? 1 : 4.0 / 3);
    if (error < SEEN || i + 1 == choices.size()) {
      chosen = i;
      break;
    }
  }
  solver.integrator = choices[chosen].integrator;
  solver.time_step = choices[chosen].time_step;
  char text[240];
  std::snprintf(text, sizeof text,
                "simulated with steps of %.4g ms, %s%s (what the step changes: %.2g times the noise)",
                1e3 * solver.time_step, solver.integrator == bdf2 ? "BDF2" : "implicit Euler",
                chosen == 0 ? ", as the scene says" : ", because the scene's own would show beside the noise", error);
  return text;
}

}  // namespace pvg::diagnose
