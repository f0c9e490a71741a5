#include "host/identify/sensing/rollout.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <unordered_map>

#include "host/base/error.hpp"
#include "host/base/stop_signal.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/sensing/forked.hpp"
#include "host/identify/sensing/journal.hpp"
#include "host/identify/sensing/known_predictions.hpp"
#include "host/identify/sensing/mask_sight.hpp"
#include "host/identify/sensing/prediction_bytes.hpp"
#include "host/identify/sensing/question.hpp"
#include "host/identify/sensing/sensor.hpp"
#include "host/identify/sensing/step_order.hpp"
#include "host/identify/sensing/support.hpp"
#include "host/identify/sensing/video_sight.hpp"
#include "host/identify/sensing/window_worlds.hpp"
#include "host/identify/sensing/world.hpp"

namespace pvg::diagnose {
namespace {

constexpr std::size_t MOST_WORLDS = 256;   // of one solve
constexpr std::size_t MOST_NODES = 20000;  // likewise

std::size_t steps_of(const Window& window, double h) {
  return std::size_t(std::ceil((window.end - window.start + criteria().late_clock_most) / h)) + 1;
}

// The steps that its samples need: a cubic takes two beyond the time of the last one. Phases and contacts are told of
// all that a window may need.
std::size_t steps_of(const Problem& problem, const Job& job, double h) {
  const std::size_t most = steps_of(*job.window, h);
  if (job.wants_phases) return most;
  double last = 0;
  for (const Datum& datum : job.window->data)
    last = std::max(
        last, time_of_sample(problem, job.variant->sensing, *job.window, std::size_t(datum.channel), datum.sample));
  return std::min(most, std::size_t(std::max(last / h, 1.0)) + 2);
}

void go_on_before(Clock::time_point deadline) {
  if (stop_on_signals()) throw TryAgain("stopped; what the finished stages found is kept, call again to continue");
  if (Clock::now() > deadline) throw OutOfTime();
}

using Sharing = std::vector<std::size_t>;  // the jobs that share a world: they differ in what is measured alone
using WorkPacket = std::vector<Sharing>;   // the worlds of one process

// Worlds in the order of the first of their jobs.
std::vector<Sharing> worlds_of(std::span<const Question> questions) {
  std::unordered_map<std::uint64_t, std::size_t> number;
  std::vector<Sharing> worlds;
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const auto [at, is_new] = number.try_emplace(questions[i].motion, worlds.size());
    if (is_new) worlds.emplace_back();
    worlds[at->second].push_back(i);
  }
  return worlds;
}

// Neighbours in the order, which take as many steps, go to one process each.
std::vector<WorkPacket> work_packets(std::span<const Sharing> order, std::size_t n_processes) {
  std::vector<WorkPacket> packets(std::min(n_processes, order.size()));
  for (std::size_t i = 0; i < order.size(); ++i) packets[i % packets.size()].push_back(order[i]);
  return packets;
}

std::vector<std::size_t> jobs_of(std::span<const Sharing> worlds) {
  std::vector<std::size_t> jobs;
  for (const Sharing& world : worlds) jobs.insert(jobs.end(), world.begin(), world.end());
  return jobs;
}

std::vector<Prediction> picked(std::span<const Prediction> all, std::span<const std::size_t> which) {
  std::vector<Prediction> some;
  for (const std::size_t i : which) some.push_back(all[i]);
  return some;
}

}  // namespace

const char* phase_name(Phase phase) {
  constexpr const char* NAMES[] = {"free", "driven", "impact", "stick", "slide", "roll", "rest"};
  return NAMES[int(phase)];
}

Predictor::Predictor(Device& device, const Problem& problem, std::size_t n_processes)
    : device_(device), problem_(problem), n_processes_(n_processes), known_(std::make_unique<KnownPredictions>()) {}
Predictor::~Predictor() = default;

MaskSight* Predictor::sight() {
  if (!sight_ && !problem_.recording.mask_sources.empty()) sight_ = std::make_unique<MaskSight>(device_, problem_);
  return sight_.get();
}

VideoSight* Predictor::video() {
  if (!video_ && !problem_.recording.video_sources.empty()) video_ = std::make_unique<VideoSight>(device_, problem_);
  return video_.get();
}

void Predictor::settle(const Variant& variant, std::vector<Window>& windows) {
  for (Window& window : windows) {
    if (!window.is_settled) settle_on_support(device_, problem_, variant.scene, window);
    window.is_settled = true;
  }
}

// A solve assembles all of its worlds until the slowest one has converged. Where a launch costs little beside that, as
// on the host's own processor, large worlds are simulated one after the other.
bool Predictor::is_large() const {
  return device_.info().runs_host_functions && diagnose::is_large(problem_.scene.scene);
}

const Predictor::Expected* Predictor::expected_of(const Job& job) const {
  const SolverSettings& solver = job.variant->scene.solver;
  for (const Expected& one : expected_)
    if (one.window.run == job.window->run && one.window.start == job.window->start &&
        one.integrator == solver.integrator && one.time_step == solver.time_step)
      return &one;
  return nullptr;
}

// Simulates the scene as it stands in windows and steps of which no motion is known yet. Before work is split, so that
// all processes expect the same.
void Predictor::expect(std::span<const Job> jobs) {
  for (const Job& job : jobs) {
    if (expected_of(job) != nullptr) continue;
    PhysicalScene scene = problem_.scene.scene;
    scene.solver = job.variant->scene.solver;
    const double h = scene.solver.time_step;
    Expected one{*job.window, scene.solver.integrator, h, {}};
    try {
      WindowWorlds world(device_, problem_, {world_of(problem_, scene, *job.window, job.window->initial)},
                         {job.window});
      std::vector<double> before = world.simulation().checkpoint().position;
      for (std::size_t step = 1; step <= steps_of(*job.window, h); ++step) {
        go_on_before(deadline_);
        world.step(step);
        std::vector<double> now = world.simulation().checkpoint().position, motion(now.size());
        for (std::size_t i = 0; i < now.size(); ++i) motion[i] = now[i] - before[i];
        one.motion.push_back(std::move(motion));
        before = std::move(now);
      }
    } catch (const UsageError&) {   // a start that cannot be: nothing is expected
    } catch (const StepFailure&) {  // nothing from there on
    }
    expected_.push_back(std::move(one));
  }
}

std::vector<Prediction> Predictor::predict(std::span<const Job> jobs) {
  if (jobs.empty() || !jobs[0].variant->extrapolates) return predict_as_stepped(jobs);
  const auto in_steps_of = [&](double share) {
    std::map<const Variant*, Variant> variants;
    std::vector<Job> stepped(jobs.begin(), jobs.end());
    for (Job& job : stepped) {
      const auto [at, is_new] = variants.try_emplace(job.variant, *job.variant);
      if (is_new) at->second.scene.solver.time_step *= share;
      job.variant = &at->second;
    }
    return predict_as_stepped(stepped);
  };
  Variant as_stepped = *jobs[0].variant;
  as_stepped.extrapolates = false;
  const std::vector<Prediction> coarse = in_steps_of(1);
  return extrapolated(coarse, in_steps_of(0.5), order_of_steps(as_stepped));
}

std::vector<Prediction> Predictor::predict_as_stepped(std::span<const Job> jobs) {
  const std::vector<Question> questions = questions_of(problem_, jobs);
  std::vector<Job> open;  // each of which nothing is known, once
  std::vector<Question> open_questions;
  std::unordered_map<std::uint64_t, std::size_t> place;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (known_->find(questions[i].all) != nullptr || !place.try_emplace(questions[i].all, open.size()).second) continue;
    open.push_back(jobs[i]);
    open_questions.push_back(questions[i]);
  }
  std::vector<Prediction> found, out;
  if (open.empty())
    go_on_before(deadline_);  // what is known ends with the time too
  else
    found = simulated(open, open_questions);
  for (const Question& question : questions) {
    const auto at = place.find(question.all);
    out.push_back(at == place.end() ? *known_->find(question.all) : found[at->second]);
  }
  known_->add(open_questions, std::move(found));
  return out;
}

std::vector<Prediction> Predictor::simulated(std::span<const Job> jobs, std::span<const Question> questions) {
  const std::uint64_t question = journal_ ? hash_of(questions) : 0;
  if (journal_)
    if (std::optional<std::vector<Prediction>> known = journal_->result_for(question);
        known && known->size() == jobs.size())
      return std::move(*known);
  if (journal_ && journal_->is_read_only())
    throw Failure("this diagnosis needs a simulation that simulated.bin does not hold; leave out --no-simulation");
  std::vector<Prediction> out(jobs.size());
  std::vector<Sharing> order = worlds_of(questions);
  const double h = jobs.empty() ? 1 : jobs[0].variant->scene.solver.time_step;
  // A batch waits in each step for its slowest world: worlds of one window have their impacts at the same time.
  std::stable_sort(order.begin(), order.end(), [&](const Sharing& a, const Sharing& b) {
    const auto key = [&](const Window& window) {
      return std::tuple(-double(steps_of(window, h)), window.run, window.start);
    };
    return key(*jobs[a.front()].window) < key(*jobs[b.front()].window);
  });
  const std::size_t n = std::max<std::size_t>(1, n_nodes(problem_.scene.scene));
  const std::size_t per_batch = is_large() ? 1 : std::clamp<std::size_t>(MOST_NODES / n, 1, MOST_WORLDS);
  if (is_large()) expect(jobs);
  const std::vector<WorkPacket> packets = work_packets(order, n_processes_);
  const auto work_off = [&](const WorkPacket& packet) {
    for (std::size_t i = 0; i < packet.size(); i += per_batch)
      predict_batch(jobs, std::span(packet).subspan(i, std::min(per_batch, packet.size() - i)), out);
  };
  std::vector<Forked> others;
  for (std::size_t i = 1; i < packets.size(); ++i)
    others.emplace_back([&, i] {
      deadline_ = Clock::time_point::max();  // this process ends the others at its own
      work_off(packets[i]);
      return packed(picked(out, jobs_of(packets[i])));
    });
  if (!packets.empty()) work_off(packets[0]);
  for (std::size_t i = 1; i < packets.size(); ++i) {
    std::optional<Unpacked> result = unpacked(others[i - 1].result(deadline_));
    const std::vector<std::size_t> theirs = jobs_of(packets[i]);
    if (!result || result->predictions.size() != theirs.size())
      throw Failure("what another process simulated came back cut short");
    for (std::size_t k = 0; k < theirs.size(); ++k) out[theirs[k]] = std::move(result->predictions[k]);
  }
  n_simulations_ += order.size();
  if (journal_) journal_->add(question, out);
  return out;
}

namespace {

// What the sensors of a job have seen of its world so far.
struct Seen {
  std::size_t job, world, n_steps;
  SensorTrace trace;
  bool succeeded = true;
};

void take_prediction(Seen& seen, bool wants_phases, Prediction& prediction) {
  prediction.residual = seen.trace.residual();
  prediction.mask_overlap = seen.trace.mask_overlap();
  prediction.succeeded = seen.succeeded && prediction.residual.allFinite();
  if (!wants_phases) return;
  prediction.phase = seen.trace.phases();
  prediction.touching = seen.trace.touching();
}

// Of a job that cannot be simulated.
Prediction no_prediction(const Job& job) {
  Prediction none;
  none.residual = Eigen::VectorXd::Constant(Eigen::Index(job.window->data.size()), std::nan(""));
  none.phase.assign(job.wants_phases ? job.window->data.size() : 0, Phase::free);
  none.succeeded = false;
  return none;
}

}  // namespace

void Predictor::predict_halves(std::span<const Job> jobs, std::span<const std::vector<std::size_t>> which,
                               std::vector<Prediction>& out) {
  const std::size_t n = which.size();
  if (n > 1) {
    predict_batch(jobs, which.subspan(0, n / 2), out);
    predict_batch(jobs, which.subspan(n / 2), out);
    return;
  }
  for (const std::size_t i : which[0]) out[i] = no_prediction(jobs[i]);
}

void Predictor::predict_batch(std::span<const Job> jobs, std::span<const std::vector<std::size_t>> which,
                              std::vector<Prediction>& out) {
  std::vector<PhysicalScene> scenes;
  std::vector<const Window*> windows;
  std::vector<Seen> seen;
  const double h = jobs[which[0].front()].variant->scene.solver.time_step;
  std::vector<std::size_t> n_steps(which.size(), 0);  // of each world
  for (std::size_t w = 0; w < which.size(); ++w) {
    const Job& first = jobs[which[w].front()];
    scenes.push_back(world_of(problem_, first.variant->scene, *first.window, first.initial));
    windows.push_back(first.window);
    for (const std::size_t i : which[w]) {
      seen.push_back({i, w, steps_of(problem_, jobs[i], h), SensorTrace(problem_, jobs[i], sight(), video())});
      n_steps[w] = std::max(n_steps[w], seen.back().n_steps);
    }
  }
  std::unique_ptr<WindowWorlds> made;
  try {
    made = std::make_unique<WindowWorlds>(device_, problem_, std::move(scenes), std::move(windows));
  } catch (const UsageError& refused) {  // a start that cannot be
    return predict_halves(jobs, which, out);
  }
  WindowWorlds& worlds = *made;
  Simulation& simulation = worlds.simulation();
  const Expected* expected = is_large() ? expected_of(jobs[which[0].front()]) : nullptr;
  std::vector<char> goes_on(which.size(), true);
  const auto look = [&](std::size_t step) {
    for (Seen& one : seen)
      if (one.succeeded && step <= one.n_steps) one.trace.add(worlds.scene(one.world), simulation.state(one.world));
  };
  look(0);
  const std::size_t n_all = *std::max_element(n_steps.begin(), n_steps.end());
  for (std::size_t step = 1; step <= n_all; ++step) {
    go_on_before(deadline_);
    if (expected != nullptr && step <= expected->motion.size()) simulation.expect(0, expected->motion[step - 1]);
    try {
      worlds.step(step);
    } catch (const StepFailure& failure) {
      for (const StepEvent& event : failure.events) {
        goes_on[event.world] = false;
        simulation.retire(event.world);
      }
      for (Seen& one : seen) one.succeeded = one.succeeded && (goes_on[one.world] || step > one.n_steps);
      if (std::none_of(goes_on.begin(), goes_on.end(), [](char well) { return well; })) break;
    } catch (const OutOfDeviceMemory&) {  // numbers with which so much comes near so much
      device_.finish();                   // reads that were started write to what is made here
      made.reset();
      return predict_halves(jobs, which, out);
    }
    look(step);
    for (std::size_t w = 0; w < which.size(); ++w)
      if (step == n_steps[w]) simulation.retire(w);
  }
  for (Seen& one : seen) take_prediction(one, jobs[one.job].wants_phases, out[one.job]);
}

}  // namespace pvg::diagnose
