#include "pipeline/diagnose/fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pvg::diagnose {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;
constexpr double FREEDOM = 4;          // degrees of, of Student's distribution
constexpr int START_STEPS = 4;         // where only the windows' starts are fitted
constexpr double SMALL_CHANGE = 1e-3;  // of the cost, relative: the fit has converged

const std::vector<double> DAMPINGS = {1e-6, 10};      // of a step, relative
const std::vector<double> START_DAMPINGS = {0, 0.1};  // likewise of the starts

constexpr double NEAR_NOISE = 1.1;     // of residuals: the starts are good enough as measured
constexpr double MOST_CORRECTION = 5;  // rms in units of noise; more is no small error of the integration

VectorXd weights_of(const VectorXd& r, double s) {
  return (1.0 / (1.0 + r.array().square() / (FREEDOM * s * s))).matrix() * ((FREEDOM + 1) / FREEDOM);
}

double start_cost(const std::vector<VectorXd>& delta) {
  double sum = 0;
  for (const VectorXd& d : delta) sum += 0.5 * d.squaredNorm();
  return sum;
}

// One standard deviation of what is believed of a parameter, at most its bounds: what nothing in the data answers to
// stays where it is.
double believed_of(const Parameter& p) { return p.believed > 0 ? p.believed : p.high - p.low; }

double belief_cost(const Model& model) {
  const std::vector<const Parameter*> parameters = model.parameters();
  double sum = 0;
  for (Eigen::Index i = 0; i < model.x.size(); ++i) {
    const Parameter& p = *parameters[std::size_t(i)];
    sum += 0.5 * std::pow((model.x[i] - p.off) / believed_of(p), 2);
  }
  return sum;
}

double cost_of(const Fit& fit) {
  return robust_cost(fit.residual, fit.scale) + start_cost(fit.delta) + belief_cost(fit.model);
}

VectorXd clamped(const Model& model, VectorXd x) {
  const std::vector<const Parameter*> parameters = model.parameters();
  for (Eigen::Index i = 0; i < x.size(); ++i)
    x[i] = std::clamp(x[i], parameters[std::size_t(i)]->low, parameters[std::size_t(i)]->high);
  return x;
}

// the system of one window's start
struct StartSystem {
  MatrixXd weighted;             // W U
  Eigen::LDLT<MatrixXd> factor;  // of U^T W U + 1
};

StartSystem start_system(const FitData& data, const Fit& fit, std::size_t w, double damping = 0) {
  const MatrixXd& u = data.of_start[w];
  StartSystem system;
  system.weighted = weights_of(fit.residual[w], fit.scale).asDiagonal() * u;
  MatrixXd a = u.transpose() * system.weighted + MatrixXd::Identity(u.cols(), u.cols());
  a.diagonal() *= 1 + damping;
  system.factor.compute(a);
  return system;
}

// sandwich: scores gathered by window, so that residuals that hang together within a window do not count as many; at
// least what independent noise gives
MatrixXd covariance_of(const FitData& data, const Fit& fit) {
  const Reduced reduced = reduce(data, fit);
  const Eigen::Index p = fit.model.x.size();
  const MatrixXd inverse =
      (reduced.sum_a() + 1e-12 * MatrixXd::Identity(p, p)).completeOrthogonalDecomposition().pseudoInverse();
  MatrixXd scores = MatrixXd::Zero(p, p);
  const VectorXd mean = reduced.sum_g() / double(reduced.g.size());
  for (const VectorXd& g : reduced.g) scores += (g - mean) * (g - mean).transpose();
  const double n = double(reduced.g.size());
  const MatrixXd noise = inverse * fit.scale * fit.scale;
  if (n < 3) return noise;
  const MatrixXd sandwich = inverse * scores * inverse * (n / (n - 1));
  MatrixXd both = noise;
  for (Eigen::Index i = 0; i < p; ++i) both(i, i) = std::max(noise(i, i), sandwich(i, i));
  return both;
}

}  // namespace

std::vector<const Parameter*> Model::parameters() const {
  std::vector<const Parameter*> all;
  for (const Candidate* part : parts)
    for (const Parameter& p : part->parameters) all.push_back(&p);
  return all;
}

Variant variant_of(const Variant& base, const Model& model) {
  Variant variant = base;
  std::size_t first = 0;
  for (const Candidate* part : model.parts) {
    part->apply(variant, std::span<const double>(model.x.data() + first, part->parameters.size()));
    first += part->parameters.size();
  }
  return variant;
}

VectorXd beside_starts(const MatrixXd& u, const VectorXd& change) {
  if (u.cols() == 0) return change;
  const MatrixXd a = u.transpose() * u + MatrixXd::Identity(u.cols(), u.cols());
  return change - u * a.ldlt().solve(u.transpose() * change);
}

Variant refined(const Variant& variant) {
  Variant fine = variant;
  fine.scene.solver.time_step /= 2;
  return fine;
}

bool dissipates(const Scene& scene) {
  return std::any_of(scene.joints.begin(), scene.joints.end(), [](const Joint& joint) {
    return joint.damping > 0 || (is_driven(joint) && joint.drive.damping > 0);
  });
}

double richardson_factor(const Scene& scene) {
  const bool is_second_order = scene.solver.integrator == SolverSettings::Integrator::bdf2 && !dissipates(scene);
  return is_second_order ? 4.0 / 3 : 2;
}

double robust_scale(const std::vector<VectorXd>& residual) {
  std::vector<double> all;
  for (const VectorXd& r : residual)
    for (const double value : r)
      if (std::isfinite(value)) all.push_back(std::abs(value));
  if (all.empty()) return 1;
  std::nth_element(all.begin(), all.begin() + std::ptrdiff_t(all.size() / 2), all.end());
  return std::max(1.0, 1.4826 * all[all.size() / 2]);
}

double robust_cost(const std::vector<VectorXd>& residual, double s) {
  double sum = 0;
  for (const VectorXd& r : residual)
    sum += 0.5 * (FREEDOM + 1) * s * s * (1.0 + r.array().square() / (FREEDOM * s * s)).log().sum();
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

double rms(const std::vector<VectorXd>& residual) {
  double sum = 0, n = 0;
  for (const VectorXd& r : residual) {
    sum += r.squaredNorm();
    n += double(r.size());
  }
  return n > 0 ? std::sqrt(sum / n) : 0;
}

MatrixXd Reduced::sum_a() const {
  MatrixXd sum = MatrixXd::Zero(a[0].rows(), a[0].cols());
  for (const MatrixXd& one : a) sum += one;
  return sum;
}
VectorXd Reduced::sum_g() const {
  VectorXd sum = VectorXd::Zero(g[0].size());
  for (const VectorXd& one : g) sum += one;
  return sum;
}

Reduced reduce(const FitData& data, const Fit& fit) {
  Reduced reduced;
  for (std::size_t w = 0; w < data.windows.size(); ++w) {
    const MatrixXd& j = fit.slope[w];
    const StartSystem start = start_system(data, fit, w);
    const MatrixXd wj = weights_of(fit.residual[w], fit.scale).asDiagonal() * j;
    const MatrixXd cross = start.weighted.transpose() * j;
    MatrixXd a = j.transpose() * wj;
    VectorXd g = wj.transpose() * fit.residual[w];
    if (cross.rows() > 0) {
      a -= cross.transpose() * start.factor.solve(cross);
      g -= cross.transpose() * start.factor.solve(start.weighted.transpose() * fit.residual[w] + fit.delta[w]);
    }
    reduced.a.push_back(a);
    reduced.g.push_back(g);
  }
  return reduced;
}

VectorXd best_start(const FitData& data, const Fit& fit, std::size_t w, const VectorXd& dx, double damping) {
  if (data.of_start[w].cols() == 0) return VectorXd();
  const StartSystem start = start_system(data, fit, w, damping);
  VectorXd r = fit.residual[w];
  if (dx.size() > 0) r += fit.slope[w] * dx;
  return -start.factor.solve(start.weighted.transpose() * r + fit.delta[w]);
}

std::vector<std::vector<Prediction>> Fitter::evaluate(const FitData& data, const std::vector<Model>& models,
                                                      const std::vector<std::vector<VectorXd>>& delta,
                                                      bool wants_phases) {
  std::vector<Variant> variants;
  for (const Model& model : models) variants.push_back(variant_of(base_, model));
  std::vector<Job> jobs;
  for (std::size_t m = 0; m < models.size(); ++m)
    for (std::size_t w = 0; w < data.windows.size(); ++w) {
      Job job{&variants[m], &data.windows[w], data.windows[w].initial, wants_phases};
      if (!delta.empty())
        for (std::size_t k = 0; k < job.window->unknowns.size(); ++k)
          move(job.initial, job.window->unknowns[k], delta[m][w][Eigen::Index(k)] * job.window->unknowns[k].sigma);
      jobs.push_back(std::move(job));
    }
  std::vector<Prediction> flat = predictor_.predict(jobs);
  std::vector<std::vector<Prediction>> out(models.size());
  for (std::size_t i = 0; i < flat.size(); ++i) out[i / data.windows.size()].push_back(std::move(flat[i]));
  return out;
}

FitData Fitter::prepare(std::vector<Window> windows, const Model& at, bool corrects) {
  FitData data{std::move(windows), {}};
  const Variant variant = variant_of(base_, at);
  std::vector<Job> jobs;
  for (const Window& window : data.windows) {
    jobs.push_back({&variant, &window, window.initial, false});
    for (const Unknown& unknown : window.unknowns) {
      jobs.push_back(jobs.back());
      jobs.back().initial = window.initial;
      // a step of which the answer is seen, yet small
      move(jobs.back().initial, unknown, 0.05 * unknown.sigma);
    }
  }
  const std::vector<Prediction> found = predictor_.predict(jobs);
  const Variant fine = refined(variant);
  std::vector<Job> fine_jobs;
  if (corrects)
    for (const Window& window : data.windows) fine_jobs.push_back({&fine, &window, window.initial, false});
  const std::vector<Prediction> finer = predictor_.predict(fine_jobs);
  std::vector<Window> well;
  std::size_t at_job = 0, at_window = 0;
  for (const Window& window : data.windows) {
    const Prediction* better = corrects ? &finer[at_window++] : nullptr;
    const Prediction& here = found[at_job++];
    MatrixXd u(Eigen::Index(window.data.size()), Eigen::Index(window.unknowns.size()));
    bool is_well = here.is_well;
    for (std::size_t k = 0; k < window.unknowns.size(); ++k, ++at_job) {
      is_well = is_well && found[at_job].is_well;
      u.col(Eigen::Index(k)) = (found[at_job].residual - here.residual) / 0.05;
    }
    if (!is_well) continue;
    well.push_back(window);
    if (better && better->is_well) {
      const VectorXd change = richardson_factor(base_.scene) * (better->residual - here.residual),
                     left = beside_starts(u, change);
      if (left.norm() < MOST_CORRECTION * std::sqrt(double(left.size()))) well.back().correction = left;
    }
    data.of_start.push_back(std::move(u));
  }
  data.windows = std::move(well);
  return data;
}

FitData Fitter::prepare_near(std::vector<Window> windows, const Model& at) {
  FitData data = prepare(std::move(windows), at);
  if (data.windows.empty()) return data;
  const Fit fit = this->fit(data, {at}, 0).front();
  if (!fit.is_well || rms(fit.residual) < NEAR_NOISE) return data;
  for (std::size_t w = 0; w < data.windows.size(); ++w)
    for (std::size_t k = 0; k < data.windows[w].unknowns.size(); ++k) {
      const Unknown& unknown = data.windows[w].unknowns[k];
      move(data.windows[w].initial, unknown, fit.delta[w][Eigen::Index(k)] * unknown.sigma);
    }
  return prepare(std::move(data.windows), at);
}

void Fitter::differentiate(const FitData& data, std::vector<Fit>& fits, bool also_converged) {
  const auto is_wanted = [&](const Fit& fit) {
    return fit.is_well && fit.is_stale && (also_converged || !fit.has_converged);
  };
  std::vector<Model> moved;
  std::vector<std::vector<VectorXd>> delta;
  std::vector<double> step;
  for (std::size_t m = 0; m < fits.size(); ++m) {
    if (!is_wanted(fits[m])) continue;
    const std::vector<const Parameter*> parameters = fits[m].model.parameters();
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const Parameter& p = *parameters[i];
      const double x = fits[m].model.x[Eigen::Index(i)];
      double by = 0.03 * std::max(std::abs(x - p.off), fits[m].model.scale[Eigen::Index(i)]);
      if (x + by > p.high) by = -by;
      moved.push_back(fits[m].model);
      moved.back().x[Eigen::Index(i)] += by;
      delta.push_back(fits[m].delta);
      step.push_back(by);
    }
  }
  const std::vector<std::vector<Prediction>> found = evaluate(data, moved, delta);
  std::size_t at = 0;
  for (std::size_t m = 0; m < fits.size(); ++m) {
    if (!is_wanted(fits[m])) continue;
    fits[m].is_stale = false;
    fits[m].slope.assign(data.windows.size(), {});
    for (std::size_t w = 0; w < data.windows.size(); ++w)
      fits[m].slope[w].resize(fits[m].residual[w].size(), fits[m].model.x.size());
    for (Eigen::Index i = 0; i < fits[m].model.x.size(); ++i, ++at)
      for (std::size_t w = 0; w < data.windows.size(); ++w) {
        fits[m].slope[w].col(i) = (found[at][w].residual - fits[m].residual[w]) / step[at];
        if (!fits[m].slope[w].col(i).allFinite()) fits[m].slope[w].col(i).setZero();
      }
  }
}

// One Gauss-Newton step of one fit under several dampings, as trials: each with the windows' starts moved along, in
// full and damped. A body on the floor can be thrown into it and along it so that little changes: a full step goes far
// that way.
void Fitter::add_trials(const FitData& data, const Fit& fit, std::size_t owner, bool only_starts,
                        Trials& trials) const {
  MatrixXd a;
  VectorXd g;
  if (fit.model.x.size() > 0 && !only_starts) {
    const Reduced reduced = reduce(data, fit);
    a = reduced.sum_a();
    g = reduced.sum_g();
    const std::vector<const Parameter*> parameters = fit.model.parameters();
    for (Eigen::Index i = 0; i < g.size(); ++i) {
      const Parameter& p = *parameters[std::size_t(i)];
      const double weight = 1 / (believed_of(p) * believed_of(p));
      a(i, i) += weight;
      g[i] += weight * (fit.model.x[i] - p.off);
    }
  }
  for (const double damping : a.size() > 0 ? DAMPINGS : std::vector<double>{0}) {
    Model model = fit.model;
    VectorXd dx;
    if (a.size() > 0) {
      MatrixXd damped = a;
      damped.diagonal() += damping * a.diagonal() + VectorXd::Constant(a.rows(), 1e-12 * a.trace());
      dx = -damped.ldlt().solve(g);
      if (!dx.allFinite()) continue;
      model.x = clamped(model, fit.model.x + dx);
      dx = model.x - fit.model.x;
    }
    for (const double start_damping : START_DAMPINGS) {
      std::vector<VectorXd> delta = fit.delta;
      bool any_moves = false;
      for (std::size_t w = 0; w < delta.size(); ++w)
        if (delta[w].size() > 0) {
          delta[w] += best_start(data, fit, w, dx, start_damping);
          any_moves = true;
        }
      if (start_damping == 0 || any_moves) trials.add(model, std::move(delta), owner);
    }
  }
}

// Takes the best trial of each fit that is better than where it is; which got better. Where models are the same the
// windows have nothing to do with each other: each takes the start that is best for it.
std::vector<char> Fitter::take_best(const FitData& data, const Trials& trials, std::vector<Fit>& fits) {
  std::vector<std::vector<Prediction>> found = evaluate(data, trials.models, trials.delta);
  std::vector<char> is_better(fits.size(), false);
  const std::size_t n_windows = data.windows.size();
  for (std::size_t first = 0, last = 0; first < found.size(); first = last) {
    Fit& fit = fits[trials.owner[first]];
    while (last < found.size() && trials.owner[last] == trials.owner[first] &&
           trials.models[last].x == trials.models[first].x)
      ++last;
    const bool is_same_model = trials.models[first].x == fit.model.x;
    double cost = belief_cost(trials.models[first]);
    std::vector<VectorXd> residual(n_windows), delta(n_windows);
    for (std::size_t w = 0; w < n_windows; ++w) {
      double best = std::numeric_limits<double>::infinity();
      const auto take = [&](const VectorXd& r, const VectorXd& d) {
        const double one = robust_cost({r}, fit.scale) + start_cost({d});
        if (!(one < best)) return;
        best = one;
        residual[w] = r;
        delta[w] = d;
      };
      if (is_same_model) take(fit.residual[w], fit.delta[w]);
      for (std::size_t t = first; t < last; ++t)
        if (found[t][w].is_well) take(found[t][w].residual, trials.delta[t][w]);
      cost += best;
    }
    if (!(cost < fit.cost)) continue;
    is_better[trials.owner[first]] = true;
    fit.cost = cost;
    fit.model = trials.models[first];
    fit.delta = std::move(delta);
    fit.residual = std::move(residual);
  }
  return is_better;
}

std::vector<Fit> Fitter::begin(const FitData& data, std::vector<Model> models) {
  std::vector<Fit> fits(models.size());
  std::vector<VectorXd> zeros;
  for (const Window& window : data.windows) zeros.push_back(VectorXd::Zero(Eigen::Index(window.unknowns.size())));
  std::vector<std::vector<Prediction>> found = evaluate(data, models, std::vector(models.size(), zeros));
  for (std::size_t m = 0; m < models.size(); ++m) {
    fits[m].model = std::move(models[m]);
    fits[m].delta = zeros;
    fits[m].is_well = true;
    for (Prediction& p : found[m]) {
      fits[m].is_well = fits[m].is_well && p.is_well;
      fits[m].residual.push_back(std::move(p.residual));
    }
  }
  return fits;
}

void Fitter::improve(const FitData& data, std::vector<Fit>& fits, int n_steps, bool only_starts) {
  for (int step = 0; step < n_steps; ++step) {
    if (!only_starts) differentiate(data, fits, false);
    Trials trials;
    std::vector<double> before(fits.size());
    for (std::size_t m = 0; m < fits.size(); ++m) {
      Fit& fit = fits[m];
      if (!fit.is_well || fit.has_converged) continue;
      fit.scale = robust_scale(fit.residual);
      before[m] = fit.cost = cost_of(fit);
      add_trials(data, fit, m, only_starts, trials);
    }
    if (trials.models.empty()) return;
    const std::vector<char> is_better = take_best(data, trials, fits);
    for (std::size_t m = 0; m < fits.size(); ++m) {
      Fit& fit = fits[m];
      if (!fit.is_well || fit.has_converged) continue;
      fit.is_stale = fit.is_stale || is_better[m];
      fit.has_converged = !is_better[m] || before[m] - fit.cost <= SMALL_CHANGE * before[m];
    }
  }
}

void Fitter::conclude(const FitData& data, std::vector<Fit>& fits) {
  differentiate(data, fits, true);
  for (Fit& fit : fits) {
    if (!fit.is_well) continue;
    fit.scale = robust_scale(fit.residual);
    fit.cost = cost_of(fit);
    fit.covariance = covariance_of(data, fit);
  }
}

std::vector<Fit> Fitter::fit(const FitData& data, std::vector<Model> models, int n_steps) {
  std::vector<Fit> fits = begin(data, std::move(models));
  const bool any_unknown = std::any_of(data.windows.begin(), data.windows.end(),
                                       [](const Window& window) { return !window.unknowns.empty(); });
  if (n_steps == 0) {
    if (any_unknown) improve(data, fits, START_STEPS, true);
    return fits;
  }
  improve(data, fits, n_steps);
  conclude(data, fits);
  return fits;
}

}  // namespace pvg::diagnose
