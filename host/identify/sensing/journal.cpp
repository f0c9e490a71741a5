#include "host/identify/sensing/journal.hpp"

#include <array>
#include <cstring>
#include <map>

#include "host/base/error.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/sensing/prediction_bytes.hpp"

namespace pvg::diagnose {
namespace {

namespace fs = std::filesystem;
constexpr std::uint64_t MAGIC = 0x3267616964677670;  // "pvgdiag2"

// of a set of episodes none: what it holds is in the runs
std::vector<char> bytes_of(const fs::path& file) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) return {};
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void put_text(std::vector<char>& bytes, const std::string& text) {
  put(bytes, text.size());
  bytes.insert(bytes.end(), text.begin(), text.end());
}

void put_vector(std::vector<char>& bytes, const Vec3& v) {
  for (const double x : v) put(bytes, x);
}

void put_matrix(std::vector<char>& bytes, const auto& matrix) {
  for (const double x : matrix.reshaped()) put(bytes, x);
}

void put_list(std::vector<char>& bytes, const std::vector<double>& list) {
  put(bytes, list.size());
  for (const double x : list) put(bytes, x);
}

void put_list(std::vector<char>& bytes, const std::vector<Vec3>& list) {
  put(bytes, list.size());
  for (const Vec3& v : list) put_vector(bytes, v);
}

void put_numbers(std::vector<char>& bytes, const auto&... numbers) { (put(bytes, numbers), ...); }

void put_body(std::vector<char>& bytes, const RigidBody& b) {
  put_list(bytes, b.collision.points);
  put_vector(bytes, b.center_of_mass);
  put_matrix(bytes, b.inertia);
  put_numbers(bytes, b.mass, b.volume, b.affine_modulus, b.is_fixed, b.is_half_space, b.is_prescribed, b.friction,
              b.contact_offset);
  for (const PathPoint& point : b.path) {
    put(bytes, point.time);
    put_matrix(bytes, point.pose.matrix());
  }
  put_matrix(bytes, b.pose.matrix());
  put_vector(bytes, b.velocity);
  put_vector(bytes, b.angular_velocity);
}

void put_body(std::vector<char>& bytes, const SoftBody& b) {
  put_list(bytes, b.mesh.points);
  put_numbers(bytes, b.material.density, b.material.youngs_modulus, b.material.poisson_ratio, b.friction,
              b.contact_offset);
  put_matrix(bytes, b.pose.matrix());
  put_vector(bytes, b.velocity);
}

void put_body(std::vector<char>& bytes, const Cloth& b) {
  const ClothMaterial& m = b.material;
  put_list(bytes, b.mesh.points);
  put_numbers(bytes, m.area_density, m.thickness, m.stretch_warp, m.stretch_weft, m.shear, m.poisson_ratio,
              m.limit_strain, m.stiffening, m.bending_warp, m.bending_weft, b.rest_is_flat, b.friction);
  for (const std::uint32_t pinned : b.pinned) put(bytes, pinned);
  put_vector(bytes, b.warp_direction);
  put_matrix(bytes, b.pose.matrix());
  put_vector(bytes, b.velocity);
}

void put_joint(std::vector<char>& bytes, const Joint& j) {
  const Drive& d = j.drive;
  put_numbers(bytes, j.type, j.parent, j.child, j.lower, j.upper, j.limit_stiffness, j.damping, j.armature,
              j.velocity_limit, j.stiffness, j.initial);
  put_numbers(bytes, d.mode, d.stiffness, d.damping, d.damped_rate, d.effort_limit, d.compensates_gravity, d.play,
              d.gain, d.time_constant, d.delay);
  put_matrix(bytes, j.parent_frame.matrix());
  put_matrix(bytes, j.child_frame.matrix());
  put_vector(bytes, j.axis);
}

// All that physics reads of a scene; what is seen only is the scene file's, which the journal's key holds.
void put_scene(std::vector<char>& bytes, const PhysicalScene& scene) {
  put_vector(bytes, scene.gravity);
  for (const RigidBody& body : scene.rigid_bodies) put_body(bytes, body);
  for (const SoftBody& body : scene.soft_bodies) put_body(bytes, body);
  for (const Cloth& cloth : scene.cloths) put_body(bytes, cloth);
  for (const Joint& joint : scene.joints) put_joint(bytes, joint);
  for (const Stitch& stitch : scene.stitches) {
    put_numbers(bytes, stitch.soft, stitch.rigid, stitch.cloth, stitch.stiffness);
    put_vector(bytes, stitch.direction);
    for (const std::uint32_t node : stitch.nodes) put(bytes, node);
  }
  for (const PairFriction& pair : scene.pair_friction) {
    put_text(bytes, pair.first);
    put_text(bytes, pair.second);
    put(bytes, pair.coefficient);
  }
  for (const PairRestitution& pair : scene.pair_restitution) {
    put_text(bytes, pair.first);
    put_text(bytes, pair.second);
    put(bytes, pair.coefficient);
  }
  for (const std::array<int, 2>& pair : scene.noncolliding_rigid_bodies) put_numbers(bytes, pair[0], pair[1]);
  for (const Effect& effect : scene.effects) {
    for (const std::string& text : {effect.name, effect.target}) put_text(bytes, text);
    for (const std::string& text : effect.formulas) put_text(bytes, text);
    put_list(bytes, effect.parameters);
  }
  const ContactSettings& c = scene.contact;
  put_numbers(bytes, c.activation_distance, c.stiffness, c.friction_velocity, c.friction_lag_passes);
  const SolverSettings& s = scene.solver;
  put_numbers(bytes, s.time_step, s.integrator, s.velocity_tolerance, s.max_newton, s.preconditioner, s.cg_tolerance,
              s.max_cg, s.max_step_halvings, scene.separates_start);
}

void put_sensing(std::vector<char>& bytes, const Sensing& s) {
  put_numbers(bytes, s.clock_offset, s.clock_rate, s.length_scale);
  put_vector(bytes, s.frame_rotation);
  put_list(bytes, s.latency);
  put_list(bytes, s.bias);
  put_list(bytes, s.marker_offset);
  put(bytes, s.camera.size());
  for (const CameraError& camera : s.camera) put_numbers(bytes, camera.k1, camera.gain, camera.v1);
}

std::uint64_t hash_of_variant(const Variant& variant) {
  std::vector<char> bytes;
  put_scene(bytes, variant.scene);
  put_sensing(bytes, variant.sensing);
  return hash_of(bytes);
}

void put_window(std::vector<char>& bytes, const Window& window) {
  put_numbers(bytes, window.run, window.start, window.end, window.data.size());
  for (const Datum& datum : window.data) put_numbers(bytes, datum.channel, datum.sample, datum.component);
  put(bytes, window.correction.size());
  for (const double x : window.correction) put(bytes, x);
}

void put_start(std::vector<char>& bytes, const InitialState& start) {
  put_list(bytes, start.position);
  put_list(bytes, start.rate);
  for (const Pose& pose : start.pose) put_matrix(bytes, pose.matrix());
  put_list(bytes, start.velocity);
  put_list(bytes, start.spin);
}

}  // namespace

std::uint64_t hash_of(std::span<const char> bytes, std::uint64_t so_far) {
  for (const char byte : bytes) so_far = (so_far ^ static_cast<unsigned char>(byte)) * 1099511628211u;
  return so_far;
}

std::uint64_t question_of(const Problem& problem, std::span<const Job> jobs) {
  std::vector<char> bytes;
  for (const double value : {criteria().drive_memory, criteria().late_clock_most}) put(bytes, value);
  for (const Channel& channel : problem.channels) put(bytes, channel.sigma);
  for (const Run& run : problem.runs) {
    put_list(bytes, run.noise_scale);
    for (const std::vector<double>& noise : run.jitter_noise) put_list(bytes, noise);
  }
  std::map<const Variant*, std::uint64_t> known;
  for (const Job& job : jobs) {
    const auto [at, is_new] = known.try_emplace(job.variant, 0);
    if (is_new) at->second = hash_of_variant(*job.variant);
    put(bytes, at->second);
    put(bytes, job.wants_phases);
    put_window(bytes, *job.window);
    put_start(bytes, job.initial);
  }
  return hash_of(bytes);
}

std::uint64_t journal_key(const Problem& problem, const std::string& settings) {
  std::uint64_t key = hash_of(settings);
  for (const fs::path& file : {problem.recording.file, problem.recording.scene}) key = hash_of(bytes_of(file), key);
  for (const Run& run : problem.runs)
    for (const std::vector<double>& values : run.values) {
      const char* first = reinterpret_cast<const char*>(values.data());
      key = hash_of({first, sizeof(double) * values.size()}, key);
    }
  std::vector<char> commands;
  for (const Run& run : problem.runs)
    for (const TargetTable& targets : run.targets) put_list(commands, targets.value);
  for (const Run& run : problem.runs)
    for (const KnownPush& push : run.pushes) {
      put_numbers(commands, push.from, push.to);
      put_list(commands, push.effect.parameters);
    }
  key = hash_of(commands, key);
  std::error_code ignored;
  const auto built = fs::last_write_time("/proc/self/exe", ignored).time_since_epoch().count();
  std::vector<char> bytes;
  put(bytes, built);
  return hash_of(bytes, key);
}

Journal::Journal(fs::path file, std::uint64_t key) : file_(std::move(file)), content_(bytes_of(file_)) {
  std::vector<char> head;
  put(head, MAGIC);
  put(head, key);
  if (content_.size() < head.size() || std::memcmp(content_.data(), head.data(), head.size()) != 0) {
    content_ = head;
    std::ofstream(file_, std::ios::binary).write(head.data(), std::streamsize(head.size()));
  }
  at_ = head.size();
}

std::optional<std::vector<Prediction>> Journal::result_for(std::uint64_t question) {
  if (out_.is_open() || at_ >= content_.size()) return std::nullopt;
  const std::span<const char> rest = std::span<const char>(content_).subspan(at_);
  std::uint64_t asked = 0;
  std::optional<Unpacked> result;
  if (rest.size() >= sizeof asked) std::memcpy(&asked, rest.data(), sizeof asked);
  if (asked == question) result = unpacked(rest.subspan(sizeof asked));
  if (!result) {
    content_.resize(at_);
    return std::nullopt;
  }
  at_ += sizeof asked + result->n_bytes;
  ++n_read_;
  return std::move(result->predictions);
}

void Journal::add(std::uint64_t question, const std::vector<Prediction>& result) {
  if (file_.empty()) return;
  if (!out_.is_open()) {  // what follows the last result that was read is void
    std::error_code ignored;
    fs::resize_file(file_, at_, ignored);
    out_.open(file_, std::ios::binary | std::ios::app);
  }
  std::vector<char> bytes;
  put(bytes, question);
  const std::vector<char> content = packed(result);
  bytes.insert(bytes.end(), content.begin(), content.end());
  out_.write(bytes.data(), std::streamsize(bytes.size()));
  out_.flush();
  if (!out_) throw Failure(file_.string() + " could not be written");
}

void Journal::remove() {
  out_.close();
  std::error_code ignored;
  if (!file_.empty()) std::filesystem::remove(file_, ignored);
}

}  // namespace pvg::diagnose
