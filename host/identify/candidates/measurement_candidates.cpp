// What the measurement may have wrong; the simulation stays as it is. One row per error.
#include <yaml-cpp/yaml.h>

#include <algorithm>

#include "host/identify/candidates/candidate.hpp"
#include "host/identify/criteria.hpp"
#include "host/render/camera.hpp"

namespace pvg::diagnose {
namespace {

// where such an error acts
enum class Of { recording, camera, channel };

// A place where an error acts, and how many there are of its sort.
struct At {
  std::size_t number, n;
};

struct MeasurementError {
  CandidateKind kind;
  Of of;
  bool (*is_possible)(const Problem&, std::size_t number);
  void (*apply)(Sensing&, const At&, std::span<const double>);
  void (*scale)(const Channel&, std::vector<Parameter>&) = nullptr;  // parameters in the channel's unit
  bool (*amend)(const SceneFile&, const std::string& target, std::span<const double>) = nullptr;  // of the scene, too
};

std::vector<Vec3>& sized(std::vector<Vec3>& list, std::size_t n) {
  if (list.size() < n) list.resize(n, Vec3::Zero());
  return list;
}

CameraError& error_of(Sensing& sensing, const At& at) {
  sensing.camera.resize(at.n);
  return sensing.camera[at.number];
}

Vec3 vector_of(std::span<const double> values) {
  Vec3 v = Vec3::Zero();
  for (std::size_t k = 0; k < values.size(); ++k) v[Eigen::Index(k)] = values[k];
  return v;
}

bool is_length(const Channel& channel) { return channel.joint < 0 && channel.sensor->is_length; }

bool has_time_input(const Problem& problem, std::size_t) {
  // without commands or prescribed motions only the start fixes the time, and starts are fitted
  return !problem.recording.inputs.empty() || !problem.can_restart ||
         std::any_of(problem.scene.targets.begin(), problem.scene.targets.end(),
                     [](const TargetTable& t) { return t.time.size() > 1; });
}

bool has_length(const Problem& problem, std::size_t) {
  return std::any_of(problem.channels.begin(), problem.channels.end(), is_length);
}

bool has_directions(const Problem& problem, std::size_t) {
  return has_length(problem, 0) && std::any_of(problem.channels.begin(), problem.channels.end(),
                                               [](const Channel& c) { return c.n == 3 && c.joint < 0; });
}

bool has_video(const Problem& problem, std::size_t camera) {
  const std::vector<VideoSource>& sources = problem.recording.video_sources;
  return std::any_of(sources.begin(), sources.end(),
                     [&](const VideoSource& source) { return source.camera == problem.seen.cameras[camera].name; });
}

bool is_used(const Problem& problem, std::size_t camera) {
  const std::vector<MaskSource>& sources = problem.recording.mask_sources;
  return has_video(problem, camera) || std::any_of(sources.begin(), sources.end(), [&](const MaskSource& source) {
           return source.camera == problem.seen.cameras[camera].name;
         });
}

bool can_be_late(const Problem& problem, std::size_t channel) {
  return problem.channels.size() > 1 && !problem.channels[channel].sensor->is_of_pictures;
}

bool may_sit_elsewhere(const Problem& problem, std::size_t channel) {
  return problem.channels[channel].sensor->has_mounting_place;
}

bool takes_bias(const Problem& problem, std::size_t channel) { return problem.channels[channel].sensor->takes_bias; }

void scale_bias(const Channel& channel, std::vector<Parameter>& parameters) {
  parameters.resize(std::size_t(channel.n));
  for (Parameter& p : parameters) {
    p.unit = channel.unit;
    p.scale = criteria().change_bias * channel.sigma;
    p.low = -criteria().bias_most * channel.sigma;
    p.high = criteria().bias_most * channel.sigma;
  }
}

// where the file itself says this camera
bool amend_lens(const SceneFile& file, const std::string& target, std::span<const double> k1) {
  YAML::Node camera = entry_named(file.root["cameras"], target);
  if (!camera.IsDefined() || !camera.IsMap()) return false;
  for (const Camera& seen : file.problem.seen.cameras)
    if (seen.name == target) camera["distortion"] = distortion_with(seen, k1[0]);
  return true;
}

const std::vector<MeasurementError>& errors() {
  using Values = std::span<const double>;
  constexpr Family SENSOR = Family::measurement;
  static const std::vector<MeasurementError> ERRORS = {
      {{"clock_offset",
        "clock",
        "shift",
        "the recording's clock is ahead or behind",
        SENSOR,
        {{"offset", "s", -0.5, 0.5, 0, 2e-3, 0.05}}},
       Of::recording,
       has_time_input,
       [](Sensing& s, const At&, Values x) { s.clock_offset += x[0]; }},
      {{"clock_rate",
        "clock",
        "scale",
        "the recording's clock runs fast or slow",
        SENSOR,
        {{"rate", "1", -0.05, 0.05, 0, 2e-3, 0.005}}},
       Of::recording,
       nullptr,
       [](Sensing& s, const At&, Values x) { s.clock_rate += x[0]; }},
      {{"latency",
        "channel",
        "shift",
        "this channel is recorded late",
        SENSOR,
        {{"latency", "s", 0, 0.5, 0, 5e-3, 0.05}}},
       Of::channel,
       can_be_late,
       [](Sensing& s, const At& at, Values x) {
         if (s.latency.size() < at.n) s.latency.resize(at.n, 0);
         s.latency[at.number] += x[0];
       }},
      {{"length_scale",
        "channels",
        "scale",
        "all lengths are measured too long or too short",
        SENSOR,
        {{"scale", "1", -0.1, 0.1, 0, 5e-3, 0.03}}},
       Of::recording,
       has_length,
       [](Sensing& s, const At&, Values x) { s.length_scale += x[0]; }},
      {{"frame_misalignment",
        "channels",
        "rotation",
        "the measurement's frame is turned against the world",
        SENSOR,
        {{"x", "rad", -0.5, 0.5, 0, 5e-3}, {"y", "rad", -0.5, 0.5, 0, 5e-3}, {"z", "rad", -0.5, 0.5, 0, 5e-3}}},
       Of::recording,
       has_directions,
       [](Sensing& s, const At&, Values x) { s.frame_rotation += vector_of(x); }},
      {{"marker_offset",
        "marker",
        "shift",
        "the marker sits elsewhere on its body",
        SENSOR,
        {{"x", "m", -0.2, 0.2, 0, 1e-3}, {"y", "m", -0.2, 0.2, 0, 1e-3}, {"z", "m", -0.2, 0.2, 0, 1e-3}}},
       Of::channel,
       may_sit_elsewhere,
       [](Sensing& s, const At& at, Values x) { sized(s.marker_offset, at.n)[at.number] += vector_of(x); }},
      {{"bias",
        "channel",
        "constant",
        "a constant is added to what is measured",
        SENSOR,
        {{"x", "channel's", -10, 10, 0, 0}, {"y", "channel's", -10, 10, 0, 0}, {"z", "channel's", -10, 10, 0, 0}}},
       Of::channel,
       takes_bias,
       [](Sensing& s, const At& at, Values x) { sized(s.bias, at.n)[at.number] += vector_of(x); },
       scale_bias},
      {{"lens_distortion",
        "camera",
        "radial",
        "the camera's lens bends straight lines more or less than its k1 says",
        SENSOR,
        {{"k1", "1", -0.5, 0.5, 0, 0.02, 0.2}}},
       Of::camera,
       is_used,
       [](Sensing& s, const At& at, Values x) { error_of(s, at).k1 += x[0]; },
       nullptr,
       amend_lens},
      {{"exposure",
        "camera",
        "scale",
        "the camera's pictures are brighter or darker than its exposure says",
        SENSOR,
        {{"gain", "1", 0.2, 5, 1, 0.02, 0.5}}},
       Of::camera,
       has_video,
       [](Sensing& s, const At& at, Values x) { error_of(s, at).gain *= x[0]; }},
      {{"vignetting",
        "camera",
        "radial",
        "the camera's pictures fall off to their corners by 1 + v1 r^2, r = 1 there, beside what the scene says",
        SENSOR,
        {{"v1", "1", -1, 1, 0, 0.05, 0.3}}},
       Of::camera,
       has_video,
       [](Sensing& s, const At& at, Values x) { error_of(s, at).v1 += x[0]; }},
  };
  return ERRORS;
}

Candidate candidate_of(const MeasurementError& error, const std::string& target, const At& at) {
  Candidate candidate{error.kind.name,
                      target,
                      Family::measurement,
                      error.kind.site,
                      error.kind.law,
                      error.kind.meaning,
                      "",
                      "the same motion seen by a second sensor",
                      error.kind.parameters,
                      {},
                      0};
  candidate.apply = [apply = error.apply, at](Variant& v, std::span<const double> x) { apply(v.sensing, at, x); };
  candidate.amend = [amend = error.amend, target](const SceneFile& file, std::span<const double> x) {
    return amend != nullptr && amend(file, target, x);
  };
  return candidate;
}

void add_at(const Problem& problem, Of of, const std::string& target, const At& at, std::vector<Candidate>& out) {
  for (const MeasurementError& error : errors()) {
    if (error.of != of || (error.is_possible != nullptr && !error.is_possible(problem, at.number))) continue;
    out.push_back(candidate_of(error, target, at));
    if (error.scale != nullptr) error.scale(problem.channels[at.number], out.back().parameters);
  }
}

}  // namespace

std::vector<CandidateKind> measurement_kinds() {
  std::vector<CandidateKind> kinds;
  for (const MeasurementError& error : errors()) kinds.push_back(error.kind);
  return kinds;
}

void add_measurement(const Problem& problem, std::vector<Candidate>& out) {
  add_at(problem, Of::recording, "recording", {0, 1}, out);
  const std::vector<Camera>& cameras = problem.seen.cameras;
  for (std::size_t c = 0; c < cameras.size(); ++c)
    add_at(problem, Of::camera, cameras[c].name, {c, cameras.size()}, out);
  for (std::size_t c = 0; c < problem.channels.size(); ++c)
    add_at(problem, Of::channel, problem.channels[c].name, {c, problem.channels.size()}, out);
}

}  // namespace pvg::diagnose
