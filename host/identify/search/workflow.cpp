#include "host/identify/search/workflow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "host/identify/criteria.hpp"
#include "host/identify/fit/time_step.hpp"
#include "host/identify/sensing/world.hpp"

namespace pvg::diagnose {

void Workflow::report_progress(int stage, double share, const std::string& text) const {
  const double since = seconds();
  std::fprintf(stderr, "diagnose %d/7: %s  (%.0f s%s)\n", stage, text.c_str(), since,
               share > 0.02 && share < 1
                   ? (", about " + std::to_string(int(since * (1 - share) / share) + 1) + " s left").c_str()
                   : "");
}

bool Workflow::is_costly() const { return n_nodes(problem.scene.scene) > criteria().large_world; }

double Workflow::by_the_clock(double processor_seconds) const {
  const double used = double(std::clock() - processor_start) / CLOCKS_PER_SEC;
  return processor_seconds * std::max(used > 0 ? -seconds_until(clock_start) / used : 1.0, 1.0);
}

Clock::time_point Workflow::end_of(double share) const {
  return start +
         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(60 * settings.minutes * share));
}

bool Workflow::has_time(const std::string& something, double expected_seconds, double share) {
  if (expected_seconds < seconds_until(end_of(share))) return true;
  left_out.push_back(
      fmt::format("{} was not looked for: {:.0f} s were over and it takes some {:.0f} s more; "
                  "`--minutes`, which is {:g}, gives it more",
                  something, seconds(), expected_seconds, settings.minutes));
  return false;
}

void Workflow::note_left_out(const std::string& what) {
  left_out.push_back(
      fmt::format("{}, after {:.0f} s; `--minutes`, which is {:g}, gives it more", what, seconds(), settings.minutes));
}

bool Workflow::refine_step(const Model& model) {
  if (!may_refine_step) return false;
  may_refine_step = false;
  Variant at_model = variant_of(base, model);
  std::string note;
  if (!ends_in_time(criteria().time_search, "the comparison with finer time steps at what was found",
                    [&] { note = choose_time_step(fitter, predictor, problem, at_model); }))
    return false;
  const SolverSettings& finer = at_model.scene.solver;
  SolverSettings& solver = base.scene.solver;
  if (finer.time_step >= solver.time_step && finer.integrator == solver.integrator &&
      at_model.extrapolates <= base.extrapolates)
    return false;
  base.extrapolates = at_model.extrapolates;
  solver.time_step = finer.time_step;
  solver.integrator = finer.integrator;
  notes.push_back("done again with another time step, which what was found needs: " + note);
  return true;
}

// The physical ones are printed, since these are looked for first.
void Workflow::show(std::vector<Showable> rows) {
  std::size_t n_shown = 0;
  for (const Showable& row : rows)
    if (row.candidate->family == Family::physical && n_shown++ < criteria().n_showable_printed)
      std::fprintf(stderr, "  could show %s\n", text_of(row).c_str());
  files.write_showable(rows);
  showable = std::move(rows);
}

}  // namespace pvg::diagnose
