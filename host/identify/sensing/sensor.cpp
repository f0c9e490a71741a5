#include "host/identify/sensing/sensor.hpp"

#include <algorithm>
#include <cmath>

#include "host/identify/channels/prediction.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/data/jitter.hpp"
#include "host/physics/energies/system.hpp"

namespace pvg::diagnose {
SensorTrace::SensorTrace(const Problem& problem, const Job& job, MaskSight* sight, VideoSight* video)
    : problem_(&problem), job_(&job), sight_(sight), video_(video), h_(job.variant->scene.solver.time_step) {
  values_.resize(problem.channels.size());
  phase_.resize(problem.channels.size());
}

void SensorTrace::add(const PhysicalScene& world, const WorldState& state) {
  state_ = &state;
  const RecordedRun& recorded = problem_->recording.runs[std::size_t(job_->window->run)];
  moments_.assign(recorded.masks.size(), std::nullopt);
  cells_.assign(recorded.videos.size(), std::nullopt);
  for (std::size_t c = 0; c < values_.size(); ++c) {
    const Channel& channel = problem_->channels[c];
    if (job_->wants_phases) phase_[c].push_back(phase_of(world, state, channel));
    const std::vector<double> value =
        channel.sensor->predict(channel, {world, state, job_->variant->sensing, c, *this});
    if (n_steps_ == 1 && channel.sensor->is_known_after_a_step) values_[c] = value;
    values_[c].insert(values_[c].end(), value.begin(), value.end());
  }
  ++n_steps_;
  if (!job_->wants_phases) return;
  before_.assign(state.rigid.begin(), state.rigid.end());
  for (const PairForce& pair : state.pair_force)
    touching_.insert(body_name(world, std::size_t(pair.first)) + "/" + body_name(world, std::size_t(pair.second)));
}

// Pictures cost more than steps: only those at the times of samples are taken.
int SensorTrace::picture_near(const std::vector<int>& frame_of_row, double time) const {
  int frame = -1;
  double nearest = (1 - 1e-6) * h_;
  for (std::size_t row = 0; row < frame_of_row.size(); ++row) {
    // before the start everything is at its start, as in value_at
    const double apart = std::abs(std::max(time_of(0, row), 0.0) - time);
    if (frame_of_row[row] < 0 || apart >= nearest) continue;
    nearest = apart;
    frame = frame_of_row[row];
  }
  return frame;
}

double SensorTrace::mask_moment(std::size_t source, std::size_t moment) {
  if (!moments_[source]) moments_[source] = moments_of(source);
  return (*moments_[source])[moment];
}

std::array<double, N_MASK_MOMENTS> SensorTrace::moments_of(std::size_t source) {
  const double time = double(n_steps_) * h_;
  const RecordedMasks& measured = problem_->recording.runs[std::size_t(job_->window->run)].masks[source];
  std::array<double, N_MASK_MOMENTS> moments;
  moments.fill(std::nan(""));
  if (picture_near(measured.frame_of_row, time) < 0) return moments;
  const std::vector<std::uint8_t> mask = sight_->look(source, *state_, error_of(sight_->camera(source)).k1);
  moments = mask_moments(mask, measured.masks.width, measured.masks.height);
  for (std::size_t row = 0; row < measured.frame_of_row.size(); ++row) {
    const double apart = time_of(0, row) - time;
    if (measured.frame_of_row[row] < 0 || apart > 0.5 * h_ || apart <= -0.5 * h_) continue;
    overlap_sum_ += pvg::mask_overlap(mask, measured.masks.pixels[std::size_t(measured.frame_of_row[row])]);
    ++n_overlaps_;
  }
  return moments;
}

CameraError SensorTrace::error_of(int camera) const {
  const std::vector<CameraError>& errors = job_->variant->sensing.camera;
  return errors.empty() ? CameraError{} : errors[std::size_t(camera)];
}

double SensorTrace::luminance(std::size_t source, std::size_t cell) {
  if (!cells_[source]) cells_[source] = cells_of(source);
  return (*cells_[source])[cell];
}

PictureCells SensorTrace::cells_of(std::size_t source) {
  const RecordedVideo& measured = problem_->recording.runs[std::size_t(job_->window->run)].videos[source];
  if (const int frame = picture_near(measured.frame_of_row, double(n_steps_) * h_); frame >= 0)
    return video_->look(source, *state_, frame, error_of(video_->camera(source)));
  PictureCells cells;
  cells.fill(std::nan(""));
  return cells;
}

double time_of_sample(const Problem& problem, const Sensing& sensing, const Window& window, std::size_t channel,
                      std::size_t sample) {
  const Run& run = problem.runs[std::size_t(window.run)];
  const double latency = sensing.latency.empty() ? 0 : sensing.latency[channel];
  const double since = run.t[sample] - run.t.front();
  return since * (1 + sensing.clock_rate) + sensing.clock_offset - latency - (window.start - run.t.front());
}

double SensorTrace::time_of(std::size_t channel, std::size_t sample) const {
  return time_of_sample(*problem_, job_->variant->sensing, *job_->window, channel, sample);
}

std::vector<double> SensorTrace::value_at(std::size_t channel, const std::vector<double>& trace, double time) const {
  const Channel& c = problem_->channels[channel];
  const Steps steps{trace, std::size_t(c.trace_width), h_};
  if (steps.n() < 4 || std::max(time / h_, 0.0) > double(steps.n() - 1) + 1e-6) return {};
  std::vector<double> value = c.sensor->interpolate(c, steps, time);
  for (double& number : value) number = std::clamp(number, c.readout.lowest, c.readout.highest);
  return value;
}

std::vector<std::vector<double>> SensorTrace::filtered() const {
  std::vector<std::vector<double>> traces = values_;
  for (std::size_t c = 0; c < traces.size(); ++c)
    if (const Channel& channel = problem_->channels[c]; channel.readout.low_pass > 0)
      low_pass(traces[c], std::size_t(channel.trace_width), h_, channel.readout.low_pass);
  return traces;
}

Eigen::VectorXd SensorTrace::residual() const {
  const Window& window = *job_->window;
  const Run& run = problem_->runs[std::size_t(window.run)];
  const std::vector<std::vector<double>> traces = filtered();
  Eigen::VectorXd residual(window.data.size());
  std::vector<double> seen;
  Vec3 difference = Vec3::Zero();
  for (std::size_t i = 0; i < window.data.size(); ++i) {
    const Datum& datum = window.data[i];  // those of one sample follow each other
    const std::size_t c = std::size_t(datum.channel);
    const Channel& channel = problem_->channels[c];
    if (datum.component == 0) {
      seen = value_at(c, traces[c], time_of(c, datum.sample));
      const double* measured = &run.values[c][datum.sample * std::size_t(channel.width)];
      if (!seen.empty()) difference = channel.sensor->difference(measured, seen.data(), channel.n);
    }
    residual[Eigen::Index(i)] =
        seen.empty() ? std::nan("")
                     : difference[datum.component] / noise_of_number(*problem_, run, c, datum.sample, datum.component);
  }
  if (window.correction.size() > 0) residual += window.correction;
  return residual;
}

Phase SensorTrace::phase_of(const PhysicalScene& world, const WorldState& state, const Channel& channel) const {
  const int body = channel.joint >= 0 ? world.joints[std::size_t(channel.joint)].child : channel.rigid;
  bool is_driven_body = false;
  for (const Joint& joint : world.joints) is_driven_body = is_driven_body || (joint.child == body && is_driven(joint));
  const Phase without = is_driven_body ? Phase::driven : Phase::free;
  if (body < 0) return state.contacts.empty() ? without : Phase::stick;
  if (before_.empty()) return without;
  const auto velocity = [&](int b, const Vec3& at) -> Vec3 {
    if (b < 0 || b >= int(state.rigid.size())) return Vec3::Zero();
    const AffineMap &now = state.rigid[std::size_t(b)], &then = before_[std::size_t(b)];
    const Vec3 local = now.leftCols<3>().transpose() * (at - now.col(3));
    return (at - then.leftCols<3>() * local - then.col(3)) / h_;
  };
  const AffineMap &now = state.rigid[std::size_t(body)], &then = before_[std::size_t(body)];
  const double spin = Eigen::AngleAxisd(Mat3(now.leftCols<3>() * then.leftCols<3>().transpose())).angle() / h_;
  const double speed = (now.col(3) - then.col(3)).norm() / h_;
  bool touches = false, hits = false, slips = false;
  for (const ContactForce& contact : state.contacts) {
    if (contact.first != body && contact.second != body) continue;
    const Vec3 apart = velocity(contact.first, contact.point) - velocity(contact.second, contact.point);
    const double along = apart.dot(contact.normal);
    touches = true;
    hits = hits || std::abs(along) > criteria().impact_speed;
    slips = slips || (apart - along * contact.normal).norm() > criteria().slip_speed;
  }
  if (hits) return Phase::impact;
  if (speed < criteria().rest_speed && spin < criteria().rest_spin) return Phase::rest;
  if (!touches) return without;
  if (slips) return Phase::slide;
  return spin > criteria().roll_spin ? Phase::roll : Phase::stick;
}

std::vector<Phase> SensorTrace::phases() const {
  std::vector<Phase> phases;
  for (const Datum& datum : job_->window->data) {
    const std::vector<Phase>& all = phase_[std::size_t(datum.channel)];
    const double place = time_of(std::size_t(datum.channel), datum.sample) / h_;
    const long last = long(all.size()) - 1;  // the start has no step behind it, so it is in the phase of the first step
    phases.push_back(all.empty() ? Phase::free
                                 : all[std::size_t(std::clamp(std::lround(place), std::min(1l, last), last))]);
  }
  return phases;
}

}  // namespace pvg::diagnose
