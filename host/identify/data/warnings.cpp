#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "host/identify/data/noise.hpp"
#include "host/identify/data/problem.hpp"

namespace pvg::diagnose {

namespace {

constexpr double TURN = 2 * std::numbers::pi;  // [rad]

std::string shown(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

// Where one factor would explain what looks odd: seconds that are milliseconds, radians that are degrees.
void add_hints_of_units(const Problem& problem, std::vector<std::string>& sentences) {
  const double h = problem.scene.scene.solver.time_step, duration = problem.scene.duration;
  for (const Run& run : problem.runs) {
    const double length = run.t.back() - run.t.front(), spacing = length / double(run.t.size() - 1);
    // thousands of steps between two samples, and a run far longer than the scene's
    if (spacing > 200 * h && spacing > 0.5 && length > 100 * duration)
      sentences.push_back(run.name + " lasts " + shown(length) + " s with a sample each " + shown(spacing) +
                          " s: is its column t in milliseconds? One factor of 1000 would explain it; divide t by 1000");
  }
  for (std::size_t c = 0; c < problem.channels.size(); ++c) {
    const RecordedChannel& recorded = problem.recording.channels[c];
    if (problem.channels[c].joint < 0 || problem.channels[c].sensor->start != StartRole::place ||
        recorded.unit == "deg" ||
        problem.scene.scene.joints[std::size_t(problem.channels[c].joint)].type != Joint::Type::revolute)
      continue;
    double low = INFINITY, high = -INFINITY;
    for (const Run& run : problem.runs)
      for (const double value : run.values[c])
        if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
    if (high - low > TURN && std::max(std::abs(low), std::abs(high)) < 57.3 * TURN)
      sentences.push_back("the " + problem.channels[c].name + " goes from " + shown(low) + " to " + shown(high) +
                          " rad, more than a turn: is it in degrees? One factor of 57.3 would explain it; write `unit: "
                          "deg`");
  }
}

// Where a channel changes as much from one sample to the next as over the whole run, as rows in any order do: mean
// square successive difference over twice the variance (von Neumann 1941), which is 1 of samples that have nothing to
// do with each other. What is within ten times the noise may be noise.
void add_hints_of_order(const Problem& problem, std::vector<std::string>& sentences) {
  constexpr double UNRELATED = 0.7, MANY_NOISES = 10;
  constexpr std::size_t FEWEST = 50;
  for (std::size_t c = 0; c < problem.channels.size(); ++c) {
    const Channel& channel = problem.channels[c];
    if (channel.width != 1 || !(channel.sigma > 0)) continue;
    for (const Run& run : problem.runs) {
      std::vector<double> values = own_samples(run.t, run.values[c], 1);
      std::erase_if(values, [](double value) { return !std::isfinite(value); });
      if (values.size() < FEWEST) continue;
      double mean = 0, variance = 0, successive = 0;
      for (const double value : values) mean += value / double(values.size());
      for (const double value : values) variance += (value - mean) * (value - mean) / double(values.size());
      for (std::size_t i = 1; i < values.size(); ++i)
        successive += (values[i] - values[i - 1]) * (values[i] - values[i - 1]) / double(values.size() - 1);
      if (std::sqrt(variance) > MANY_NOISES * channel.sigma && successive > UNRELATED * 2 * variance) {
        sentences.push_back("the " + channel.name + " changes as much from one sample to the next as over all of " +
                            run.name + ": are its rows in the order of time?");
        break;
      }
    }
  }
}

}  // namespace

std::vector<std::string> warnings(const Problem& problem) {
  std::vector<std::string> sentences;
  const std::size_t n_held_out = std::size_t(
      std::count_if(problem.runs.begin(), problem.runs.end(), [](const Run& run) { return run.is_held_out; }));
  if (n_held_out == 0)
    sentences.push_back(
        "no run is held out: nothing can be proved on data that the fit has not seen, and no effect will be named; "
        "give one run, of another motion, the role `held_out`");
  if (n_held_out == problem.runs.size())
    sentences.push_back("every run is held out: there is nothing to fit; give at least one run the role `fit`");
  if (problem.runs.size() == 1)
    sentences.push_back("there is one run only; two effects that look alike in it cannot be told apart");
  for (std::size_t c = 0; c < problem.channels.size(); ++c) {
    std::size_t gaps = 0, all = 0;
    bool changes = false;
    std::string without;  // runs in which it has no sample
    for (const Run& run : problem.runs) {
      double first = std::nan("");
      bool has_sample = false;
      const std::size_t width = std::size_t(problem.channels[c].width);
      const std::vector<double> values = own_samples(run.t, run.values[c], width);
      for (std::size_t i = 0; i < values.size(); ++i, ++all) {
        if (!std::isfinite(values[i])) {
          ++gaps;
          continue;
        }
        has_sample = true;
        if (i % width == 0) {
          if (!std::isfinite(first)) first = values[i];
          changes = changes || values[i] != first;
        }
      }
      if (!has_sample) without += (without.empty() ? "" : ", ") + run.name;
    }
    if (!without.empty())
      sentences.push_back("the " + problem.channels[c].name + " has no sample in " + without +
                          ": its column is empty there, and nothing is compared with it");
    if (10 * gaps > all)
      sentences.push_back("the " + problem.channels[c].name + " has gaps in " + std::to_string(100 * gaps / all) +
                          " % of its samples");
    if (!changes && problem.channels[c].width == 1)
      sentences.push_back("the " + problem.channels[c].name + " is constant");
  }
  add_hints_of_units(problem, sentences);
  add_hints_of_order(problem, sentences);
  for (const VideoSource& video : problem.recording.video_sources)
    for (const Camera& camera : problem.seen.cameras)
      if (camera.name == video.camera && (camera.exposure_time > 0 || camera.row_time > 0))
        sentences.push_back("the camera " + camera.name +
                            " has an exposure_time or row_time: videos are compared with pictures in which "
                            "nothing moves");
  for (const Run& run : problem.runs) {
    double longest = 0, shortest = INFINITY;
    for (std::size_t i = 1; i < run.t.size(); ++i) {
      longest = std::max(longest, run.t[i] - run.t[i - 1]);
      shortest = std::min(shortest, run.t[i] - run.t[i - 1]);
    }
    if (longest > 20 * (run.t.back() - run.t.front()) / double(run.t.size()))
      sentences.push_back(run.name + " has a gap of " + std::to_string(longest) + " s in its clock");
    if (problem.scene.scene.solver.time_step > 0.25 * (run.t.back() - run.t.front()))
      sentences.push_back(run.name + " is shorter than four time steps of the scene");
  }
  return sentences;
}

}  // namespace pvg::diagnose
