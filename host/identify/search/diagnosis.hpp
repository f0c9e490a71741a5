// The workflow from a recording to a diagnosis: measure the noise, simulate, find where, screen, fit, decide, write.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/identify/criteria.hpp"
#include "host/identify/fit/held_out.hpp"
#include "host/identify/search/decide.hpp"
#include "host/identify/search/identifiability.hpp"
#include "host/identify/search/localise.hpp"
#include "host/identify/search/motion_family.hpp"
#include "host/identify/sensing/deadline.hpp"

namespace pvg::diagnose {

// How to choose: as the workflow does, or as simpler methods would, for comparison. retune: existing numbers only, the
// lowest training error; lowest: the lowest training error of all candidates; weak: sparse regression of the residuals
// on the candidates' signatures, nothing is fitted in the simulator.
enum class Decide { workflow, retune, lowest, weak };

struct Settings {
  Decide decide = Decide::workflow;
  int max_effects = 2;
  double minutes = 5;                                       // after which the report is written, whatever is left out
  Clock::time_point began = Clock::now();                   // from when they count
  std::size_t n_fitted = criteria().n_fitted;               // candidates that are fitted, of those screened
  double simulated_seconds = criteria().simulated_seconds;  // of all windows of one evaluation, about
  std::size_t n_processes = 1;                              // that simulate, as Predictor has them
  bool halves_step = false;        // half the time step that would be used: no verdict should depend on it
  bool plans_next = false;         // the next experiment is computed whether names are confused or not
  bool keeps_simulations = false;  // the journal is left for the next diagnosis in the same folder
  bool simulates = true;           // false: a Failure where the journal does not hold a result
};

enum class Verdict { effect, retune, measurement, none, agrees };
const char* verdict_name(Verdict verdict);

// A parameter of a named effect with its interval of two standard deviations.
struct NamedParameter {
  std::string name, unit;
  double value = 0, low = 0, high = 0;
};
struct NamedEffect {
  const Candidate* candidate = nullptr;
  std::vector<NamedParameter> parameters;
};

// A number that the recording states with a standard deviation, as it fits best beside what is named.
struct AdjustedNumber {
  std::string name, target, unit;   // name: the row, such as retune_mass
  double stated = 0, sigma = 0;     // [unit]
  double value = 0, deviation = 0;  // what is left of sigma after the data
};

// What is missing where no known effect explains it, as a law without a name (regress.hpp).
struct RegressedLaw {
  std::string effect, target, unit;  // regressed_effort or regressed_force; of the effort or force
  std::string shown;                 // with its numbers, for people
  Effect amended;                    // as a scene has it
  double before = 0, after = 0, floor = 0, gap_closed = 0;  // held-out error, as in Diagnosis
  double error = 0;                                         // of the fitting runs, left out [noise]
};

struct RankedModel {
  std::vector<const Candidate*> parts;
  double error = 0;  // left out, in units of noise
  double evidence = 0, probability = 0;
  std::vector<double> values, deviations;  // of all parameters; one standard deviation each, by the fit's covariance
  bool fails_held_out = false;             // it explains the fitting runs but not those that were held out
};

struct Diagnosis {
  Verdict verdict = Verdict::agrees;
  // Where runs agree because of a noise that nobody knows: what was supposed instead, and what the verdict then is.
  std::string supposed_noise;
  Verdict supposed_verdict = Verdict::agrees;
  std::string sentence, next_experiment;
  std::string undecided;                     // why the verdict is none although the fitting runs agree
  std::optional<PlannedMotion> next_motion;  // that experiment
  std::vector<NamedEffect> effects;
  std::vector<AdjustedNumber> adjusted;
  std::vector<RankedModel> ranking;
  std::vector<std::vector<std::string>> inseparable;
  std::vector<Showable> showable;  // what these recordings could show
  std::vector<Cell> where;
  std::vector<std::string> notes;                           // what the reader should know: noise, step, windows
  std::vector<std::string> left_out;                        // for want of time
  double before = 0, after = 0, floor = 0, gap_closed = 0;  // held-out error [unit]
  double fit_before = 0, fit_after = 0;                     // of the fitting runs, left out [noise]
  WholeRuns whole;                                          // of the named model, or of the scene as it stands
  bool holds_on_whole_runs = true;
  std::string unit;
  double mask_gap_before = NAN, mask_gap_after = NAN;  // as HeldOut has them
  std::vector<Curve> curves;
  std::optional<RegressedLaw> regressed;  // where the verdict is none
  double seconds = 0;
  std::size_t simulations = 0;
  PhysicalScene used;            // the base scene with the solver as chosen, and with adjusted numbers
  bool is_extrapolated = false;  // to steps of no length, from its step and half of it
  Variant base;                  // what the models of the ranking change
  std::shared_ptr<std::vector<Candidate>> candidates;  // owns what the pointers above point to
};

// folder: of the stages' files; empty: none are written. The next experiment is not planned yet (plan_next.hpp).
Diagnosis diagnose(Device& device, Problem& problem, const Settings& settings, const std::filesystem::path& folder);

}  // namespace pvg::diagnose
