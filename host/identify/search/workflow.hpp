// What the stages of a diagnosis work with, and the search for effects, one after the other (stages 4 to 6). Results
// travel as values: each stage returns its own.
#pragma once
#include <ctime>
#include <string>
#include <vector>

#include "host/identify/fit/choose_windows.hpp"
#include "host/identify/search/diagnosis.hpp"
#include "host/identify/search/identifiability.hpp"
#include "host/identify/search/screen.hpp"
#include "host/identify/search/stage_files.hpp"

namespace pvg::diagnose {

struct Workflow {
  Workflow(Device& device, Problem& problem, const Settings& settings)
      : problem(problem), settings(settings), predictor(device, problem, settings.n_processes) {}
  Problem& problem;
  const Settings& settings;
  Clock::time_point start = settings.began;
  // what shows how busy the machine is is counted from here
  Clock::time_point clock_start = Clock::now();
  std::clock_t processor_start = std::clock();
  Predictor predictor;
  Variant base;
  std::vector<Candidate> nuisances = nuisances_of(problem);
  Fitter fitter{predictor, base};
  StageFiles files;
  std::vector<std::string> notes;  // for the reader, as Diagnosis has them

  std::vector<std::string> left_out;  // for want of time, likewise

  double seconds() const { return -seconds_until(start); }  // since it began
  bool is_costly() const;  // a simulation takes seconds: candidates are screened once, and few are fitted
  // How long so many seconds of the processor take by the clock, as busy as the machine has been since it began.
  double by_the_clock(double processor_seconds) const;
  // When a stage has to end: a share of the time given.
  Clock::time_point end_of(double share) const;
  // Whether there is time to look for something further, which takes about so many seconds, before this share of the
  // time is over; else a note says that it was not looked for.
  bool has_time(const std::string& something, double expected_seconds, double share = criteria().time_search);
  // Whether `work` came to its end before this share of the time was over; else a note says what was left out.
  template <class Work>
  bool ends_in_time(double share, const std::string& what, const Work& work) {
    if (ends_by(predictor.deadline(), end_of(share), work)) return true;
    note_left_out(what);
    return false;
  }
  void note_left_out(const std::string& what);
  // Compares the time step with finer ones at a model, once: a drive that the scene has much too stiff hides its error.
  // Whether a finer one is needed, which is the base's from then on.
  bool refine_step(const Model& model);
  bool may_refine_step = true;
  std::vector<Showable> showable;  // what these recordings could show, once that is known
  void show(std::vector<Showable> rows);
  void report_progress(int stage, double share,
                       const std::string& text) const;  // how far it is, and how long it will take
};

RankedModel ranked(const Judged& judged);

// What stages 4 to 6 select.
struct Selection {
  std::vector<Fit> fits;             // one effect more each; empty: none is better than the scene as it is
  std::vector<RankedModel> ranking;  // best first
  std::vector<std::vector<std::string>> inseparable, inseparable_of_one;  // of_one: of the first of several fits
  double error = 0;                                                       // of the last fit [noise]
  std::vector<Window> windows;      // of the last fit: those that were chosen, made ready for it, or whole runs
  std::vector<Model> alternatives;  // fitted beside those before the last effect, and told from what was chosen
  std::string better_at_bound;      // as Decision has it, of the last effect that was added; empty: none
  // What was found needs a finer time step: nothing else is told but where the fits of the first round ended.
  bool asks_for_new_step = false;
  bool follows = true;  // with some single effect the scene is near the recorded motion; else that is all
  std::vector<Model> ends;
};

// A model of two effects that another search than forward selection found.
struct FoundPair {
  Fit fit;
  RankedModel model;
  std::vector<std::string> inseparable;  // what fits as well; of alternatives: beside the first effect
};

// Adds one effect after the other, each beside those before. Where the time is over, what was found by then.
// ends: of the same first round with another time step.
Selection forward_selection(Workflow& flow, const std::vector<Candidate>& candidates, const ChosenWindows& chosen,
                            const std::vector<Model>& ends = {});

}  // namespace pvg::diagnose
