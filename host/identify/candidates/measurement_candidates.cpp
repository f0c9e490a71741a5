// What the measurement may have wrong; the simulation stays as it is.
#include <algorithm>

#include "host/identify/candidates/candidate.hpp"

namespace pvg::diagnose {
namespace {

using Kind = RecordedChannel::Kind;

const std::vector<CandidateKind>& kinds() {
  static const std::vector<CandidateKind> KINDS = {
      {"clock_offset",
       "clock",
       "shift",
       "the recording's clock is ahead or behind",
       Family::measurement,
       {{"offset", "s", -0.5, 0.5, 0, 2e-3, 0.05}}},
      {"clock_rate",
       "clock",
       "scale",
       "the recording's clock runs fast or slow",
       Family::measurement,
       {{"rate", "1", -0.05, 0.05, 0, 2e-3, 0.005}}},
      {"latency",
       "channel",
       "shift",
       "this channel is recorded late",
       Family::measurement,
       {{"latency", "s", 0, 0.5, 0, 5e-3, 0.05}}},
      {"length_scale",
       "channels",
       "scale",
       "all lengths are measured too long or too short",
       Family::measurement,
       {{"scale", "1", -0.1, 0.1, 0, 5e-3, 0.03}}},
      {"frame_misalignment",
       "channels",
       "rotation",
       "the measurement's frame is turned against the world",
       Family::measurement,
       {{"x", "rad", -0.5, 0.5, 0, 5e-3}, {"y", "rad", -0.5, 0.5, 0, 5e-3}, {"z", "rad", -0.5, 0.5, 0, 5e-3}}},
      {"marker_offset",
       "marker",
       "shift",
       "the marker sits elsewhere on its body",
       Family::measurement,
       {{"x", "m", -0.2, 0.2, 0, 1e-3}, {"y", "m", -0.2, 0.2, 0, 1e-3}, {"z", "m", -0.2, 0.2, 0, 1e-3}}},
      {"bias",
       "channel",
       "constant",
       "a constant is added to what is measured",
       Family::measurement,
       {{"x", "channel's", -10, 10, 0, 0}, {"y", "channel's", -10, 10, 0, 0}, {"z", "channel's", -10, 10, 0, 0}}},
      {"lens_distortion",
       "camera",
       "radial",
       "the camera's lens bends straight lines more or less than its k1 says",
       Family::measurement,
       {{"k1", "1", -0.5, 0.5, 0, 0.02, 0.2}}},
      {"exposure",
       "camera",
       "scale",
       "the camera's pictures are brighter or darker than its exposure says",
       Family::measurement,
       {{"gain", "1", 0.2, 5, 1, 0.02, 0.5}}},
      {"vignetting",
       "camera",
       "radial",
       "the camera's pictures fall off to their corners by 1 + v1 r^2, r = 1 there, beside what the scene says",
       Family::measurement,
       {{"v1", "1", -1, 1, 0, 0.05, 0.3}}},
  };
  return KINDS;
}

const CandidateKind& kind_named(const std::string& name) {
  return *std::find_if(kinds().begin(), kinds().end(), [&](const CandidateKind& kind) { return kind.name == name; });
}

Candidate begin(const std::string& name, const std::string& target) {
  const CandidateKind& kind = kind_named(name);
  return {name,
          target,
          Family::measurement,
          kind.site,
          kind.law,
          kind.meaning,
          "",
          "the same motion seen by a second sensor",
          kind.parameters,
          {},
          0};
}

std::vector<Vec3>& sized(std::vector<Vec3>& list, std::size_t n) {
  if (list.size() < n) list.resize(n, Vec3::Zero());
  return list;
}

Vec3 vector_of(std::span<const double> values) {
  Vec3 v = Vec3::Zero();
  for (std::size_t k = 0; k < values.size(); ++k) v[Eigen::Index(k)] = values[k];
  return v;
}

bool is_length(const Channel& channel) {
  return channel.joint < 0 && (channel.kind == Kind::position || channel.kind == Kind::marker);
}

bool has_time_input(const Problem& problem) {
  // without commands or prescribed motions only the start tells the time, and that is fitted
  return !problem.recording.inputs.empty() || !problem.can_restart ||
         std::any_of(problem.scene.targets.begin(), problem.scene.targets.end(),
                     [](const TargetTable& t) { return t.time.size() > 1; });
}

// of every camera whose masks or videos were measured
void add_cameras(const Problem& problem, std::vector<Candidate>& out) {
  const std::size_t n = problem.seen.cameras.size();
  for (std::size_t c = 0; c < n; ++c) {
    const std::string& name = problem.seen.cameras[c].name;
    const auto is_its = [&](const auto& source) { return source.camera == name; };
    const Recording& recording = problem.recording;
    const bool has_video = std::any_of(recording.video_sources.begin(), recording.video_sources.end(), is_its);
    if (!has_video && std::none_of(recording.mask_sources.begin(), recording.mask_sources.end(), is_its)) continue;
    const auto add = [&](const char* kind, auto change) {
      out.push_back(begin(kind, name));
      out.back().apply = [c, n, change](Variant& v, std::span<const double> x) {
        v.sensing.camera.resize(n);
        change(v.sensing.camera[c], x[0]);
      };
    };
    add("lens_distortion", [](CameraError& error, double k1) { error.k1 += k1; });
    if (!has_video) continue;
    add("exposure", [](CameraError& error, double gain) { error.gain *= gain; });
    add("vignetting", [](CameraError& error, double v1) { error.v1 += v1; });
  }
}

}  // namespace

std::vector<CandidateKind> measurement_kinds() { return kinds(); }

void add_measurement(const Problem& problem, std::vector<Candidate>& out) {
  const std::size_t n = problem.channels.size();
  if (has_time_input(problem)) {
    out.push_back(begin("clock_offset", "recording"));
    out.back().apply = [](Variant& v, std::span<const double> x) { v.sensing.clock_offset += x[0]; };
  }
  out.push_back(begin("clock_rate", "recording"));
  out.back().apply = [](Variant& v, std::span<const double> x) { v.sensing.clock_rate += x[0]; };
  if (std::any_of(problem.channels.begin(), problem.channels.end(), is_length)) {
    out.push_back(begin("length_scale", "recording"));
    out.back().apply = [](Variant& v, std::span<const double> x) { v.sensing.length_scale += x[0]; };
    const bool has_directions = std::any_of(problem.channels.begin(), problem.channels.end(),
                                            [](const Channel& c) { return c.n == 3 && c.joint < 0; });
    if (has_directions) {
      out.push_back(begin("frame_misalignment", "recording"));
      out.back().apply = [](Variant& v, std::span<const double> x) { v.sensing.frame_rotation += vector_of(x); };
    }
  }
  add_cameras(problem, out);
  for (std::size_t c = 0; c < n; ++c) {
    const Channel& channel = problem.channels[c];
    if (channel.kind == Kind::mask || channel.kind == Kind::video) continue;
    if (n > 1) {
      out.push_back(begin("latency", channel.name));
      out.back().apply = [c, n](Variant& v, std::span<const double> x) {
        if (v.sensing.latency.size() < n) v.sensing.latency.resize(n, 0);
        v.sensing.latency[c] += x[0];
      };
    }
    if (channel.kind == Kind::marker) {
      out.push_back(begin("marker_offset", channel.name));
      out.back().apply = [c, n](Variant& v, std::span<const double> x) {
        sized(v.sensing.marker_offset, n)[c] += vector_of(x);
      };
    }
    if (channel.kind != Kind::orientation) {
      out.push_back(begin("bias", channel.name));
      Candidate& bias = out.back();
      bias.parameters.resize(std::size_t(channel.n));
      for (Parameter& p : bias.parameters) {
        p.unit = channel.unit;
        p.scale = 3 * channel.sigma;
        p.low = -1e4 * channel.sigma;
        p.high = 1e4 * channel.sigma;
      }
      bias.apply = [c, n](Variant& v, std::span<const double> x) { sized(v.sensing.bias, n)[c] += vector_of(x); };
    }
  }
}

}  // namespace pvg::diagnose
