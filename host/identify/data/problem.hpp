// A recording and its scene, resolved against each other: which numbers were measured, of what, with which noise, and
// the commands of drives and prescribed bodies in each run. SI units throughout; what was not measured is NaN.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/identify/channels/channel.hpp"
#include "host/identify/data/disturbances.hpp"
#include "host/identify/data/start.hpp"
#include "host/identify/data/stated_numbers.hpp"
#include "host/load/scene_file.hpp"
#include "host/pictures/lut.hpp"

namespace pvg::diagnose {

struct PrescribedPath {
  int rigid = -1;
  std::vector<PathPoint> path;  // times as in the run
};

struct Run {
  std::string name;
  bool is_held_out = false;
  std::vector<double> t;                          // [n_samples, s]
  std::vector<std::vector<double>> values;        // [n_channels][n_samples x width]
  std::vector<double> noise_scale;                // [n_channels] the noise of this run over the channel's, at least 1
  std::vector<std::vector<double>> jitter_noise;  // [n_channels], by jitter.hpp; empty: nothing
  std::vector<TargetTable> targets;               // [n_driven], times as in the run
  std::vector<PrescribedPath> prescribed;
  std::vector<SceneChange> changes;  // what the scene, or a variant of it, has otherwise in this run
  std::vector<GivenStart> given;     // what is known of its start
  std::vector<KnownPush> pushes;     // disturbances that are known
};

struct Problem {
  Recording recording;
  SceneRun scene;          // drives as the inputs ask for them
  Scene seen;              // the same with all that a picture needs, where masks or videos were measured
  RenderSection render;    // what the scene says of its pictures
  std::optional<Lut> lut;  // likewise
  std::vector<Channel> channels;
  std::vector<Run> runs;
  std::vector<int> coordinates;  // joints of open chains whose position may change, parents first
  std::vector<int> free_bodies;  // rigid bodies that no joint carries
  std::vector<NumberPrior> priors;
  bool can_restart = false;  // the state at any time is measured: windows may begin anywhere
};

// One standard deviation of a channel's noise in a run, its jitter apart [the channel's unit].
inline double noise_in(const Problem& problem, const Run& run, std::size_t channel) {
  return problem.channels[channel].sigma * run.noise_scale[channel];
}

// The scene of a run: with what it has otherwise.
PhysicalScene scene_of(const Problem& problem, const Run& run);

// Whether forces can move a body: one that is fixed, prescribed or a half space does not.
inline bool can_move(const RigidBody& body) { return !body.is_fixed && !body.is_prescribed && !body.is_half_space; }

// Throws a UsageError that names the file, the key, the body or joint, and what to do.
Problem make_problem(const std::filesystem::path& recording);

Problem make_problem(Recording recording);

// Weaknesses of data that can still be used, as sentences.
std::vector<std::string> warnings(const Problem& problem);

}  // namespace pvg::diagnose
