#include "host/identify/sensing/sensor.hpp"

#include <algorithm>
#include <cmath>

#include "host/physics/energies/system.hpp"
#include "host/pictures/mask_metrics.hpp"

namespace pvg::diagnose {
namespace {

using Kind = RecordedChannel::Kind;
constexpr double REST_SPEED = 2e-3, REST_SPIN = 2e-2;    // [m/s], [rad/s] and of a joint
constexpr double SLIP_SPEED = 5e-3, IMPACT_SPEED = 0.1;  // [m/s]

Mat3 rotation_of(const Vec3& vector) {
  const double angle = vector.norm();
  return angle > 0 ? Mat3(Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix()) : Mat3(Mat3::Identity());
}

Vec3 offset_of(const std::vector<Vec3>& list, std::size_t channel) {
  return list.empty() ? Vec3(Vec3::Zero()) : list[channel];
}

// what the channel is of, before the sensor; quaternions x, y, z, w
std::vector<double> look_at(const Channel& channel, const Vec3& marker_offset, const WorldState& state) {
  switch (channel.kind) {
    case Kind::rate:  // differentiated later
      return {state.joint_position[std::size_t(channel.joint)]};
    case Kind::torque:
      return {state.joint_effort[std::size_t(channel.joint)]};
    case Kind::orientation: {
      const Eigen::Quaterniond q(Mat3(state.rigid[std::size_t(channel.rigid)].leftCols<3>()));
      const Eigen::Vector4d x = q.normalized().coeffs();
      return {x[0], x[1], x[2], x[3]};
    }
    default:
      break;
  }
  if (channel.joint >= 0) return {state.joint_position[std::size_t(channel.joint)]};
  Vec3 x = Vec3::Zero();
  if (channel.kind == Kind::force) {
    const std::size_t body = channel.rigid >= 0  ? std::size_t(channel.rigid)
                             : channel.soft >= 0 ? state.rigid.size() + std::size_t(channel.soft)
                                                 : state.rigid.size() + state.soft.size() + std::size_t(channel.cloth);
    if (body < state.body_force.size()) x = state.body_force[body].force;
  } else if (channel.rigid >= 0) {
    const AffineMap& map = state.rigid[std::size_t(channel.rigid)];
    x = map.leftCols<3>() * (channel.point + marker_offset) + map.col(3);
  } else {
    const std::vector<Vec3>& points =
        channel.soft >= 0 ? state.soft[std::size_t(channel.soft)] : state.cloth[std::size_t(channel.cloth)];
    for (const auto& [node, weight] : channel.nodes) x += weight * points[node];
    x += marker_offset;
  }
  return {x[0], x[1], x[2]};
}

// what the sensor makes of it
void sense(const Channel& channel, const Sensing& sensing, std::size_t number, std::vector<double>& value) {
  const Vec3 bias = offset_of(sensing.bias, number);
  if (channel.kind == Kind::orientation) {
    const Eigen::Quaterniond seen(rotation_of(sensing.frame_rotation) *
                                  Eigen::Quaterniond(value[3], value[0], value[1], value[2]).toRotationMatrix());
    std::copy_n(seen.coeffs().data(), 4, value.begin());
    return;
  }
  if (value.size() == 1) {
    value[0] += bias[0];
    return;
  }
  Vec3 x(value[0], value[1], value[2]);
  if (channel.kind != Kind::force) x = (1 + sensing.length_scale) * (rotation_of(sensing.frame_rotation) * x);
  if (channel.has_axis)
    value = {channel.axis.dot(x) + bias[0]};
  else
    for (int k = 0; k < 3; ++k) value[std::size_t(k)] = x[k] + bias[k];
}

bool is_of_pictures(const Channel& channel) { return channel.kind == Kind::mask || channel.kind == Kind::video; }

}  // namespace

SensorTrace::SensorTrace(const Problem& problem, const Job& job, MaskSight* sight, VideoSight* video)
    : problem_(&problem), job_(&job), sight_(sight), video_(video), h_(job.variant->scene.solver.time_step) {
  values_.resize(problem.channels.size());
  phase_.resize(problem.channels.size());
}

void SensorTrace::add(const PhysicalScene& world, const WorldState& state) {
  for (std::size_t c = 0; c < values_.size(); ++c) {
    const Channel& channel = problem_->channels[c];
    if (job_->wants_phases) phase_[c].push_back(phase_of(world, state, channel));
    if (is_of_pictures(channel)) continue;
    const Sensing& sensing = job_->variant->sensing;
    std::vector<double> value = look_at(channel, offset_of(sensing.marker_offset, c), state);
    sense(channel, sensing, c, value);
    values_[c].insert(values_[c].end(), value.begin(), value.end());
  }
  if (sight_ != nullptr) add_masks(state);
  if (video_ != nullptr) add_videos(state);
  ++n_steps_;
  if (!job_->wants_phases) return;
  before_.assign(state.rigid.begin(), state.rigid.end());
  for (const PairForce& pair : state.pair_force)
    touching_.insert(body_name(world, std::size_t(pair.first)) + "/" + body_name(world, std::size_t(pair.second)));
}

// Pictures cost more than steps: only those are looked at that the values at their times are found from.
int SensorTrace::picture_near(const std::vector<int>& frame_of_row, double time) const {
  int frame = -1;
  double nearest = (1 - 1e-6) * h_;
  for (std::size_t row = 0; row < frame_of_row.size(); ++row) {
    // before the start everything is where it starts, as value_at has it
    const double apart = std::abs(std::max(time_of(0, row), 0.0) - time);
    if (frame_of_row[row] < 0 || apart >= nearest) continue;
    nearest = apart;
    frame = frame_of_row[row];
  }
  return frame;
}

void SensorTrace::add_masks(const WorldState& state) {
  const double time = double(n_steps_) * h_;
  const RecordedRun& recorded = problem_->recording.runs[std::size_t(job_->window->run)];
  for (std::size_t source = 0; source < recorded.masks.size(); ++source) {
    std::array<double, N_MASK_MOMENTS> moments;
    moments.fill(std::nan(""));
    if (picture_near(recorded.masks[source].frame_of_row, time) >= 0) {
      const std::vector<std::uint8_t> mask = sight_->look(source, state, error_of(sight_->camera(source)).k1);
      const RecordedMasks& measured = recorded.masks[source];
      moments = mask_moments(mask, measured.masks.width, measured.masks.height);
      for (std::size_t row = 0; row < measured.frame_of_row.size(); ++row) {
        const double apart = time_of(0, row) - time;
        if (measured.frame_of_row[row] < 0 || apart > 0.5 * h_ || apart <= -0.5 * h_) continue;
        overlap_sum_ += pvg::mask_overlap(mask, measured.masks.pixels[std::size_t(measured.frame_of_row[row])]);
        ++n_overlaps_;
      }
    }
    for (std::size_t c = 0; c < values_.size(); ++c)
      if (problem_->channels[c].mask_source == int(source))
        values_[c].push_back(moments[std::size_t(problem_->channels[c].moment)]);
  }
}

CameraError SensorTrace::error_of(int camera) const {
  const std::vector<CameraError>& errors = job_->variant->sensing.camera;
  return errors.empty() ? CameraError{} : errors[std::size_t(camera)];
}

void SensorTrace::add_videos(const WorldState& state) {
  const double time = double(n_steps_) * h_;
  const RecordedRun& recorded = problem_->recording.runs[std::size_t(job_->window->run)];
  for (std::size_t source = 0; source < recorded.videos.size(); ++source) {
    PictureCells cells;
    cells.fill(std::nan(""));
    if (const int frame = picture_near(recorded.videos[source].frame_of_row, time); frame >= 0)
      cells = video_->look(source, state, frame, error_of(video_->camera(source)));
    for (std::size_t c = 0; c < values_.size(); ++c)
      if (problem_->channels[c].video_source == int(source))
        values_[c].push_back(cells[std::size_t(problem_->channels[c].cell)]);
  }
}

double SensorTrace::time_of(std::size_t channel, std::size_t sample) const {
  const Sensing& sensing = job_->variant->sensing;
  const Run& run = problem_->runs[std::size_t(job_->window->run)];
  const double latency = sensing.latency.empty() ? 0 : sensing.latency[channel];
  const double since = run.t[sample] - run.t.front();
  return since * (1 + sensing.clock_rate) + sensing.clock_offset - latency - (job_->window->start - run.t.front());
}

// A cubic through four steps, before the start the line that touches it there: what a late channel saw first is from
// before the window, and what moves was on its way. Pictures lie between two steps, as each costs one.
std::vector<double> SensorTrace::value_at(std::size_t channel, double time) const {
  const Channel& c = problem_->channels[channel];
  const std::size_t width = c.kind == Kind::orientation ? 4 : std::size_t(c.n);
  const std::size_t n = values_[channel].size() / width;
  const double place = std::max(time / h_, 0.0), before_start = std::min(time, 0.0);
  if (n < 4 || place > double(n - 1) + 1e-6) return {};
  if (is_of_pictures(c)) {
    const std::size_t before = std::min(std::size_t(place + 1e-6), n - 1), after = std::min(before + 1, n - 1);
    const double share = std::max(place - double(before), 0.0);
    const double *a = &values_[channel][before], *b = &values_[channel][after];
    return {share > 1e-6 ? (1 - share) * *a + share * *b : *a};
  }
  const std::size_t first = std::size_t(std::clamp<double>(std::floor(place) - 1, 0, double(n - 4)));
  const double s = place - double(first);
  std::vector<double> value(width, 0);
  const double* reference = &values_[channel][width * first];
  for (std::size_t i = 0; i < 4; ++i) {
    double weight = 1, slope = 0;
    for (std::size_t j = 0; j < 4; ++j)
      if (j != i) weight *= (s - double(j)) / (double(i) - double(j));
    for (std::size_t m = 0; m < 4; ++m) {
      if (m == i) continue;
      double product = 1 / (double(i) - double(m));
      for (std::size_t j = 0; j < 4; ++j)
        if (j != i && j != m) product *= (s - double(j)) / (double(i) - double(j));
      slope += product;
    }
    const double* at = &values_[channel][width * (first + i)];
    double sign = 1;  // q and -q are the same rotation
    if (width == 4)
      sign = Eigen::Map<const Eigen::Vector4d>(at).dot(Eigen::Map<const Eigen::Vector4d>(reference)) < 0 ? -1 : 1;
    const double share = c.kind == Kind::rate ? slope / h_ : weight + before_start * slope / h_;
    for (std::size_t k = 0; k < width; ++k) value[k] += sign * at[k] * share;
  }
  return value;
}

Eigen::VectorXd SensorTrace::residual() const {
  const Window& window = *job_->window;
  const Run& run = problem_->runs[std::size_t(window.run)];
  Eigen::VectorXd residual(window.data.size());
  std::vector<double> seen;
  Vec3 turn = Vec3::Zero();
  for (std::size_t i = 0; i < window.data.size(); ++i) {
    const Datum& datum = window.data[i];
    const std::size_t c = std::size_t(datum.channel);
    const Channel& channel = problem_->channels[c];
    const double sigma = noise_in(*problem_, run, c);
    if (datum.component == 0) seen = value_at(c, time_of(c, datum.sample));
    const double* measured = &run.values[c][datum.sample * std::size_t(channel.width)];
    if (seen.empty()) {
      residual[Eigen::Index(i)] = std::nan("");
      continue;
    }
    if (channel.kind != Kind::orientation) {
      residual[Eigen::Index(i)] = (measured[datum.component] - seen[std::size_t(datum.component)]) / sigma;
      continue;
    }
    if (datum.component == 0) {
      const Eigen::Quaterniond q(measured[3], measured[0], measured[1], measured[2]),
          p(seen[3], seen[0], seen[1], seen[2]);
      const Eigen::AngleAxisd apart(p.normalized().conjugate() * q.normalized());
      turn = apart.angle() * apart.axis();
    }
    residual[Eigen::Index(i)] = turn[datum.component] / sigma;
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
    hits = hits || std::abs(along) > IMPACT_SPEED;
    slips = slips || (apart - along * contact.normal).norm() > SLIP_SPEED;
  }
  if (hits) return Phase::impact;
  if (speed < REST_SPEED && spin < REST_SPIN) return Phase::rest;
  if (!touches) return without;
  if (slips) return Phase::slide;
  return spin > 0.2 ? Phase::roll : Phase::stick;
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
