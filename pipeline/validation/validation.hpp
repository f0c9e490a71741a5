// The validation cases: each a scene file of data/validation and a function that runs it, measures, and compares with a
// number that does not come from this program. The list of all stands in cases.cpp.
#pragma once
#include <atomic>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host/device/device.hpp"
#include "host/load/scene_file.hpp"
#include "host/physics/step/simulation.hpp"
#include "pipeline/validation/plot.hpp"
#include "pipeline/validation/step_check.hpp"

namespace pvg {

// One line of the table.
struct ValidationRow {
  enum class Kind { must, report };
  std::string case_name, quantity, unit;
  double expected = 0, measured = 0, tolerance = 0;  // tolerance: largest |measured - expected|
  std::string source;                                // of the expected number
  Kind kind = Kind::must;
  double seconds = 0;  // of the run that it was measured in
  double error() const { return measured - expected; }
  bool passes() const { return std::abs(error()) <= tolerance; }  // false for NaN
};

// What a case's function works with.
class Validation {
 public:
  Validation(Device& device, std::filesystem::path scenes, bool is_quick, const std::atomic<bool>& stop)
      : device(device), is_quick(is_quick), scenes_(std::move(scenes)), stop_(stop) {}

  SceneRun load(const std::string& scene) const;  // data/validation/<scene>.yaml
  std::filesystem::path data_file(const std::string& path) const { return scenes_ / ".." / path; }  // data/<path>

  // Runs to its end. observe: called after each step; false ends the run. Every step is looked at as StepCheck does.
  // Throws TryAgain once a stop is asked for.
  using Observe = std::function<bool(const WorldState&, const StepReport&)>;
  void run(const SceneRun& scene, const Observe& observe) const;

  // |measured - expected| <= tolerance; relative: as a share of |expected|
  void check(const std::string& quantity, const std::string& unit, double expected, double measured, double tolerance,
             const std::string& source);
  void check_relative(const std::string& quantity, const std::string& unit, double expected, double measured,
                      double share, const std::string& source);
  // 0 <= measured <= limit
  void check_at_most(const std::string& quantity, const std::string& unit, double measured, double limit,
                     const std::string& source);
  void check_true(const std::string& statement, bool holds, const std::string& source);
  void report(const std::string& quantity, const std::string& unit, double expected, double measured,
              const std::string& source);
  void plot(Plot plot) { plots.push_back(std::move(plot)); }

  // A case whose data are absent has no rows, and says why.
  void skip(const std::string& reason) { skipped = reason; }

  // The rows of what all steps since the last call must have kept; the command asks for them after each case.
  void add_step_rows();
  void stop_if_asked() const;  // throws TryAgain; for cases that run a Simulation of their own

  Device& device;
  const bool is_quick;  // only what is done in seconds
  std::vector<ValidationRow> rows;
  std::vector<Plot> plots;
  mutable StepCounts counts;         // of all runs of the case
  std::string skipped;               // why the case was; empty: it was not
  std::filesystem::path recordings;  // folder of measured data
  bool uses_all_recordings = false;  // not only as many as are done in a minute

 private:
  std::filesystem::path scenes_;
  const std::atomic<bool>& stop_;
};

struct ValidationCase {
  std::string name, what;
  std::function<void(Validation&)> run;
  bool is_quick;  // part of --quick
};

const std::vector<ValidationCase>& validation_cases();

// Index of the body of this name: of Scene::rigid_bodies, of Scene::soft_bodies.
int rigid_index(const Scene& scene, const std::string& name);
int soft_index(const Scene& scene, const std::string& name);

}  // namespace pvg
