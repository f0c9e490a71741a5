#include "host/identify/sensing/question.hpp"

#include <array>
#include <map>

#include "host/identify/criteria.hpp"
#include "host/identify/sensing/prediction_bytes.hpp"

namespace pvg::diagnose {
namespace {

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

// All that physics reads of a scene; what is seen only, and of meshes all but the points, the journal's key holds.
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

std::uint64_t hash_of_scene(const PhysicalScene& scene) {
  std::vector<char> bytes;
  put_scene(bytes, scene);
  return hash_of(bytes);
}

std::uint64_t hash_of_sensing(const Sensing& sensing) {
  std::vector<char> bytes;
  put_sensing(bytes, sensing);
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

std::uint64_t hash_of_window(const Window& window) {
  std::vector<char> bytes;
  put_window(bytes, window);
  return hash_of(bytes);
}

// What predictions depend on besides their jobs.
std::uint64_t hash_of_noise(const Problem& problem) {
  std::vector<char> bytes;
  for (const double value : {criteria().drive_memory, criteria().late_clock_most}) put(bytes, value);
  for (const Channel& channel : problem.channels) put(bytes, channel.sigma);
  for (const Run& run : problem.runs) {
    put_list(bytes, run.noise_scale);
    for (const std::vector<double>& noise : run.jitter_noise) put_list(bytes, noise);
  }
  return hash_of(bytes);
}

// The hash of what a pointer points to, found once.
template <class T>
class Once {
 public:
  template <class Hash>
  std::uint64_t operator()(const T* what, const Hash& hash) {
    const auto [at, is_new] = known_.try_emplace(what, 0);
    if (is_new) at->second = hash(*what);
    return at->second;
  }

 private:
  std::map<const T*, std::uint64_t> known_;
};

}  // namespace

std::uint64_t hash_of(std::span<const char> bytes, std::uint64_t so_far) {
  return fnv1a({bytes.data(), bytes.size()}, so_far);
}

std::vector<Question> questions_of(const Problem& problem, std::span<const Job> jobs) {
  const std::uint64_t noise = hash_of_noise(problem);
  Once<Variant> scene, sensing;
  Once<Window> window;
  std::vector<Question> questions;
  for (const Job& job : jobs) {
    std::vector<char> motion, all;
    put_numbers(motion, scene(job.variant, [](const Variant& v) { return hash_of_scene(v.scene); }), job.window->run,
                job.window->start, job.window->end);
    put_start(motion, job.initial);
    put_numbers(all, hash_of(motion), sensing(job.variant, [](const Variant& v) { return hash_of_sensing(v.sensing); }),
                window(job.window, hash_of_window), job.wants_phases, noise);
    questions.push_back({hash_of(motion), hash_of(all)});
  }
  return questions;
}

std::uint64_t hash_of(std::span<const Question> questions) {
  std::vector<char> bytes;
  for (const Question& question : questions) put(bytes, question.all);
  return hash_of(bytes);
}

}  // namespace pvg::diagnose
