// One round of the search: all candidates are screened beside what a model has already, the best are fitted and judged.
#pragma once
#include <string>
#include <vector>

#include "host/identify/search/decide.hpp"
#include "host/identify/search/screen.hpp"
#include "host/identify/search/workflow.hpp"

namespace pvg::diagnose {

struct Round {
  std::vector<Fit> fits;
  Decision decision;           // points to them
  std::vector<Fit> refuted;    // fits to short windows that do not follow whole runs
  Signatures signatures;       // of the candidates, where the base is without any effect
  Changes changes;             // likewise, in large scenes
  double seconds_of_fits = 0;  // in large scenes: of the shortest fits of a next round that decide anything
};

// name: of the stages' files; progress: of the whole diagnosis, shown when the fits begin; ends: where fits of the same
// models ended before, with another time step: they begin there, where that is nearer to the data. known: changes of an
// earlier round; where a simulation takes seconds, and they are in these windows, nothing else is screened.
Round run_round(Workflow& flow, const std::vector<Candidate>& all, const FitData& data, const Fit& base,
                const std::string& name, double progress, const std::vector<Model>& ends = {},
                const Changes& known = {});

// What one screening may cost: less in scenes so large that a simulation takes seconds.
Effort effort_of(const Workflow& flow);

// The candidates that a model does not hold.
std::vector<const Candidate*> others_than(const std::vector<Candidate>& all, const Model& model);

// Whether these are the shortest windows, the last resort of a scene that does not follow the recording.
bool are_shortest(const FitData& data);

// Whether these residuals are so much nearer to the data than the base's that further steps, or a second effect, are
// worth it: by second_gain_least, but beside no effect in the shortest windows, whose starts take up much and which are
// the last resort of a scene that does not follow the recording, by gap_closed_least. So is all where the base is near
// the data: within far_misfit_least, and in the shortest windows following the recorded motion.
bool gets_nearer(const Problem& problem, const FitData& data, const Fit& base,
                 const std::vector<Eigen::VectorXd>& left);

// Gives up those fits that stay behind after their first steps: all but n_finalists, and what is far behind the best.
// predicted: residuals of each after a further step, since the true effect may still be far from its optimum.
void give_up_the_last(std::vector<Fit>& fits, const std::vector<std::vector<Eigen::VectorXd>>& predicted,
                      std::size_t n_finalists = criteria().n_finalists);

// The share of the time that is left which the steps of a round may take, so that sensitivities can still be found
// which take so long: without them nothing is decided, though the ranking is known.
double share_of_steps(double seconds_left, double seconds_of_sensitivities);

// The fits to the end of those that may still win, all with slopes and covariances. Where the time is over the steps
// end early, a note says so, and only finalists are there, the nearest to the data first. Steps end, too, where none of
// them gets_nearer in the first ones, as where inputs are those of another run.
std::vector<Fit> fit_best(Workflow& flow, const FitData& data, const Fit& base, const std::vector<Screened>& best);

}  // namespace pvg::diagnose
