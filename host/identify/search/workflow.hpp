// What the stages of a diagnosis share, and the search for effects, one after the other (stages 4 to 6).
#pragma once
#include <chrono>
#include <string>
#include <vector>

#include "host/identify/search/choose_windows.hpp"
#include "host/identify/search/diagnosis.hpp"
#include "host/identify/search/screen.hpp"
#include "host/identify/search/stage_files.hpp"

namespace pvg::diagnose {

struct Workflow {
  Workflow(Device& device, Problem& problem, const Settings& settings)
      : problem(problem), settings(settings), predictor(device, problem, settings.n_processes) {}
  Problem& problem;
  const Settings& settings;
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  Predictor predictor;
  Variant base;
  Fitter fitter{predictor, base};
  Diagnosis out;
  StageFiles files;

  double seconds() const {  // since it began
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  // Whether there is time to look for something further, which takes about so many seconds; else a note says that it
  // was not looked for.
  bool has_time(const std::string& something, double expected_seconds = 0);
  void report_progress(int stage, double share,
                       const std::string& text) const;  // how far it is, and how long it will take
};

RankedModel ranked(const Judged& judged);

// Adds one effect after the other, each beside those before. Returns the fits, one effect more each.
std::vector<Fit> forward_selection(Workflow& flow, const FitData& data, const Fit& base);

}  // namespace pvg::diagnose
