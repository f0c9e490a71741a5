// Windows simulated, many at a time as worlds of one solve, and what the sensors would have said: the residual of each
// measured number in units of its noise. The whole workflow is built on this.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/device/device.hpp"
#include "host/identify/channels/sensing.hpp"
#include "host/identify/data/window.hpp"
#include "host/identify/sensing/deadline.hpp"

namespace pvg::diagnose {

struct Variant {
  PhysicalScene scene;  // what is seen does not vary: Problem::seen
  Sensing sensing;
  bool extrapolates = false;  // predictions are those of vanishing steps: see step_order.hpp
};

enum class Phase { free, driven, impact, stick, slide, roll, rest };
const char* phase_name(Phase phase);

struct Job {
  const Variant* variant = nullptr;
  const Window* window = nullptr;
  InitialState initial;
  bool wants_phases = false;
};

struct Prediction {
  Eigen::VectorXd residual;           // [n_data of the window] (measured - predicted) / sigma
  std::vector<Phase> phase;           // [n_data] if asked for
  std::vector<std::string> touching;  // pairs of bodies FIRST/SECOND that touched, if phases were asked for
  double mask_overlap = 0;            // as SensorTrace has it
  bool succeeded = true;  // false: the simulation failed before the window's end, residuals are NaN from there
};

class Journal;
class KnownPredictions;
struct Question;
class MaskSight;
class VideoSight;

class Predictor {
 public:
  // Worlds are independent, so they are split into work packets for `n_processes`, this one among them; the results
  // have the same bits whatever their number is. More than one needs a device that works in the calling thread (`basic`
  // of PoCL).
  Predictor(Device& device, const Problem& problem, std::size_t n_processes = 1);
  ~Predictor();
  // Throws TryAgain where the user stopped it, and OutOfTime at the deadline.
  std::vector<Prediction> predict(std::span<const Job> jobs);
  // What rests on something starts on it, where that has not been seen to yet.
  void settle(const Variant& variant, std::vector<Window>& windows);
  void keep_in(Journal* journal) { journal_ = journal; }  // results are read from there as far as they go
  std::size_t n_simulations() const { return n_simulations_; }
  Clock::time_point& deadline() { return deadline_; }  // never, unless it is set
  VideoSight* video();                                 // null: no video was measured

 private:
  // Node motions of each step of a window as the scene stands, [n_steps][n_nodes x 3, m]: where Newton's method starts
  // in worlds that differ from it a little.
  struct Expected {
    Window window;
    SolverSettings::Integrator integrator;
    double time_step;
    std::vector<std::vector<double>> motion;
  };
  std::vector<Prediction> predict_as_stepped(std::span<const Job> jobs);
  // By the journal or by simulating; questions: of the jobs, all of which differ.
  std::vector<Prediction> simulated(std::span<const Job> jobs, std::span<const Question> questions);
  bool is_large() const;  // a world is simulated by itself
  const Expected* expected_of(const Job& job) const;
  void expect(std::span<const Job> jobs);
  // which: the jobs of each world; they differ in what is measured alone.
  void predict_batch(std::span<const Job> jobs, std::span<const std::vector<std::size_t>> which,
                     std::vector<Prediction>& out);
  // The same of worlds that cannot be simulated together: each half alone. A world by itself has no prediction.
  void predict_halves(std::span<const Job> jobs, std::span<const std::vector<std::size_t>> which,
                      std::vector<Prediction>& out);
  MaskSight* sight();
  Device& device_;
  const Problem& problem_;
  std::size_t n_processes_;
  std::unique_ptr<MaskSight> sight_;   // made when first needed
  std::unique_ptr<VideoSight> video_;  // likewise
  std::vector<Expected> expected_;
  Journal* journal_ = nullptr;
  std::unique_ptr<KnownPredictions> known_;
  std::size_t n_simulations_ = 0;
  Clock::time_point deadline_ = Clock::time_point::max();
};

}  // namespace pvg::diagnose
