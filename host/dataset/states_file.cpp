#include "host/dataset/states_file.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "host/dataset/states_layout.hpp"
#include "host/hdf5/series.hpp"

namespace pvg {
namespace {

using hdf5::Series;

constexpr std::uint64_t NODE_CHUNK_ROWS = 64;  // 32: 2.5 % larger, but a single step is read in half the time

// row by row, as files and readers have it; Eigen stores columns
template <class Matrix>
void append_rows(std::vector<double>& values, const Matrix& matrix) {
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) values.push_back(matrix(i, j));
}

}  // namespace

struct StatesFile::Impl {
  Impl(const std::filesystem::path& path, const Scene& scene, const EpisodeHeader& header)
      : file(hdf5::File::create(path)), states(header.states), layout(lay_out_states(scene, header)) {
    open_series(scene);
    if (header.is_disturbed) add<double>("/disturbance", {layout.driven.size()});
  }

  void open_series(const Scene& scene) {
    const std::uint64_t n_joints = layout.driven.size();
    add<double>("/time", {});
    for (const char* name : {"/q", "/a", "/torque"}) add<double>(name, {n_joints});
    add<double>("/T_link", {layout.links.size(), 3, 4});
    add<double>("/T_rigid", {layout.rigids.size(), 3, 4});
    file.make_group("/X_gripper");
    file.make_group("/X_deform");
    for (std::size_t i = 0; i < layout.soft.size(); ++i)
      add_nodes(layout.soft[i], scene.soft_bodies[i].mesh.points.size());
    for (std::size_t i = 0; i < layout.cloths.size(); ++i)
      add_nodes(layout.cloths[i], scene.cloths[i].mesh.points.size());
    if (states == RecordedStates::frames) add<std::int64_t>("/node_step", {});
    for (const char* name : {"/joint/position", "/joint/drive", "/joint/stop", "/joint/damping"})
      add<double>(name, {scene.joints.size()});
    const std::size_t n_bodies = scene.rigid_bodies.size() + scene.soft_bodies.size() + scene.cloths.size();
    for (const char* name : {"/force/net", "/force/torque"}) add<double>(name, {n_bodies, 3});
    for (const char* name : {"/pair_force/normal", "/pair_force/friction"}) add<double>(name, {3});
    add<std::int64_t>("/pair_force/bodies", {2});
    add<std::int64_t>("/pair_force/offset", {});
    put<std::int64_t>("/pair_force/offset", {0});
    for (const char* name : {"/contact/gap", "/contact/normal_force"}) add<double>(name, {});
    for (const char* name : {"/contact/points", "/contact/normal", "/contact/friction_force"}) add<double>(name, {3});
    for (const char* name : {"/solver/residual", "/solver/min_gap"}) add<double>(name, {});
    for (const char* name : {"/contact/offset", "/contact/kind", "/solver/newton", "/solver/cg", "/solver/contacts",
                             "/solver/retries", "/frame_step"})
      add<std::int64_t>(name, {});
    add<std::int64_t>("/contact/bodies", {2});
    put<std::int64_t>("/contact/offset", {0});
    if (!scene.displays.empty()) add<double>("/reading", {scene.displays.size()});
    for (const Camera& camera : scene.cameras) {
      cameras.push_back(camera);
      add<double>("/camera/" + camera.name + "/K", {3, 3});
      add<double>("/camera/" + camera.name + "/T_world_camera", {4, 4});
      file.write<double>("/camera/" + camera.name + "/distortion", {camera.distortion.size()}, camera.distortion);
    }
  }

  template <class T>
  std::map<std::string, Series<T>>& table() {
    if constexpr (std::is_same_v<T, double>)
      return numbers;
    else
      return integers;
  }
  template <class T>
  void add(const std::string& name, const hdf5::Shape& row) {
    hdf5::Storage storage;
    if (states != RecordedStates::full) storage = compressed(row, sizeof(T));
    table<T>().try_emplace(name, file, name, row, storage);
  }

  void add_nodes(const std::string& name, std::uint64_t n) {
    hdf5::Storage storage;
    // one coordinate per chunk: neighbours in space and time then share their high bytes
    if (states != RecordedStates::full) storage = {DEFLATE, true, {NODE_CHUNK_ROWS, n, 1}};
    numbers.try_emplace(name, file, name, hdf5::Shape{n, 3}, storage);
    if (states != RecordedStates::full) file.attribute(name, "rounded_to", NODE_GRID);
  }

  // of frames only: those of the last step wait until it is known whether they are kept
  void put_nodes(const WorldState& state) {
    if (states == RecordedStates::frames) {
      flush_nodes();
      waiting = {state.soft, state.cloth, false};
    } else {
      put_nodes(state.soft, state.cloth);
    }
  }
  std::vector<double> rounded(std::span<const Vec3> nodes) const {
    std::vector<double> values = flat(nodes);
    if (states != RecordedStates::full)
      for (double& value : values) value = std::round(value / NODE_GRID) * NODE_GRID;
    return values;
  }
  void put_nodes(const std::vector<std::vector<Vec3>>& soft_nodes, const std::vector<std::vector<Vec3>>& cloth_nodes) {
    for (std::size_t i = 0; i < layout.soft.size(); ++i) put(layout.soft[i], rounded(soft_nodes.at(i)));
    for (std::size_t i = 0; i < layout.cloths.size(); ++i) put(layout.cloths[i], rounded(cloth_nodes.at(i)));
  }
  void write_start_of_nodes(const std::string& name, std::span<const Vec3> nodes) {
    const hdf5::Storage storage = states == RecordedStates::full ? hdf5::Storage() : compressed({3}, sizeof(double));
    Series<double>(file, "/start" + name, {3}, storage).append(rounded(nodes));
  }
  void flush_nodes() {
    if (!waiting) return;
    if (!waiting->is_kept)
      for (auto* bodies : {&waiting->soft, &waiting->cloth})
        for (std::vector<Vec3>& nodes : *bodies)
          std::fill(nodes.begin(), nodes.end(), Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
    put_nodes(waiting->soft, waiting->cloth);
    waiting.reset();
  }
  template <class T>
  void put(const std::string& name, const std::vector<T>& values) {
    table<T>().at(name).append(values);
  }

  void put_contacts(const WorldState& state) {
    std::vector<double> points, normals, gaps, normal_forces, friction_forces;
    std::vector<std::int64_t> kinds, bodies;
    for (const ContactForce& contact : state.contacts) {
      points.insert(points.end(), contact.point.data(), contact.point.data() + 3);
      normals.insert(normals.end(), contact.normal.data(), contact.normal.data() + 3);
      friction_forces.insert(friction_forces.end(), contact.friction_force.data(), contact.friction_force.data() + 3);
      gaps.push_back(contact.gap);
      normal_forces.push_back(contact.normal_force);
      kinds.push_back(std::int64_t(contact.kind));
      bodies.insert(bodies.end(), {contact.first, contact.second});
    }
    n_contacts += std::int64_t(state.contacts.size());
    put("/contact/points", points);
    put("/contact/normal", normals);
    put("/contact/friction_force", friction_forces);
    put("/contact/gap", gaps);
    put("/contact/normal_force", normal_forces);
    put("/contact/kind", kinds);
    put("/contact/bodies", bodies);
    put<std::int64_t>("/contact/offset", {n_contacts});
  }

  void put_forces(const WorldState& state) {
    const auto append = [](std::vector<double>& to, const Vec3& v) { to.insert(to.end(), v.data(), v.data() + 3); };
    std::vector<double> net, torque, normal, friction;
    std::vector<std::int64_t> bodies;
    for (const BodyForce& force : state.body_force) {
      append(net, force.force);
      append(torque, force.torque);
    }
    for (const PairForce& pair : state.pair_force) {
      append(normal, pair.normal);
      append(friction, pair.friction);
      bodies.insert(bodies.end(), {pair.first, pair.second});
    }
    n_pairs += std::int64_t(state.pair_force.size());
    put("/force/net", net);
    put("/force/torque", torque);
    put("/pair_force/normal", normal);
    put("/pair_force/friction", friction);
    put("/pair_force/bodies", bodies);
    put<std::int64_t>("/pair_force/offset", {n_pairs});
    put("/joint/position", state.joint_position);
    put("/joint/drive", state.joint_effort);
    put("/joint/stop", state.joint_stop_effort);
    put("/joint/damping", state.joint_damping_effort);
  }

  struct WaitingNodes {
    std::vector<std::vector<Vec3>> soft, cloth;
    bool is_kept = false;
  };

  // the series must be closed before their file
  hdf5::File file;
  RecordedStates states;
  std::optional<WaitingNodes> waiting;
  std::int64_t n_steps = 0;
  std::map<std::string, Series<double>> numbers;
  std::map<std::string, Series<std::int64_t>> integers;
  StatesLayout layout;
  std::vector<Camera> cameras;
  std::int64_t n_contacts = 0, n_pairs = 0;
};

StatesFile::StatesFile(const std::filesystem::path& path, const Scene& scene, const EpisodeHeader& header,
                       std::span<const DisabledPair> disabled)
    : impl_(std::make_unique<Impl>(path, scene, header)) {
  write_constants(impl_->file, scene, header, disabled, impl_->layout);
}

StatesFile::~StatesFile() = default;
StatesFile::StatesFile(StatesFile&&) noexcept = default;

void StatesFile::write_start(const WorldState& state, std::span<const Eigen::Matrix4d> T_world_camera) {
  Impl& to = *impl_;
  std::vector<double> q, T_link, T_rigid;
  for (const std::size_t i : to.layout.driven) q.push_back(state.joint_position.at(i));
  for (const std::size_t i : to.layout.links) append_rows(T_link, state.rigid.at(i));
  for (const std::size_t i : to.layout.rigids) append_rows(T_rigid, state.rigid.at(i));
  to.file.write("/start/q", {q.size()}, q);
  to.file.write("/start/T_link", {to.layout.links.size(), 3, 4}, T_link);
  to.file.write("/start/T_rigid", {to.layout.rigids.size(), 3, 4}, T_rigid);
  for (std::size_t i = 0; i < to.layout.soft.size(); ++i) to.write_start_of_nodes(to.layout.soft[i], state.soft.at(i));
  for (std::size_t i = 0; i < to.layout.cloths.size(); ++i)
    to.write_start_of_nodes(to.layout.cloths[i], state.cloth.at(i));
  for (std::size_t i = 0; i < T_world_camera.size(); ++i) {
    std::vector<double> pose;
    append_rows(pose, T_world_camera[i]);
    to.file.write("/start/camera/" + to.cameras.at(i).name + "/T_world_camera", {4, 4}, pose);
  }
}

void StatesFile::append_step(const WorldState& state, const StepReport& report, std::span<const double> target,
                             std::span<const double> disturbance) {
  Impl& to = *impl_;
  std::vector<double> q, torque, T_link, T_rigid;
  for (const std::size_t i : to.layout.driven) {
    q.push_back(state.joint_position.at(i));
    torque.push_back(state.joint_effort.at(i));
  }
  for (const std::size_t i : to.layout.links) append_rows(T_link, state.rigid.at(i));
  for (const std::size_t i : to.layout.rigids) append_rows(T_rigid, state.rigid.at(i));
  to.put<double>("/time", {state.time});
  to.put("/q", q);
  to.put<double>("/a", {target.begin(), target.end()});
  if (!disturbance.empty()) to.put<double>("/disturbance", {disturbance.begin(), disturbance.end()});
  to.put("/torque", torque);
  to.put("/T_link", T_link);
  to.put("/T_rigid", T_rigid);
  to.put_nodes(state);
  ++to.n_steps;
  if (!state.reading.empty()) to.put("/reading", state.reading);
  to.put_contacts(state);
  to.put_forces(state);
  to.put<std::int64_t>("/solver/newton", {report.newton});
  to.put<std::int64_t>("/solver/cg", {report.cg});
  to.put<std::int64_t>("/solver/contacts", {report.contacts});
  to.put<std::int64_t>("/solver/retries", {report.retries});
  to.put<double>("/solver/residual", {report.residual});
  to.put<double>("/solver/min_gap", {report.min_gap});
}

void StatesFile::keep_nodes() {
  Impl& to = *impl_;
  if (!to.waiting || to.waiting->is_kept) return;
  to.waiting->is_kept = true;
  to.put<std::int64_t>("/node_step", {to.n_steps - 1});
}

void StatesFile::append_frame(std::size_t step, std::span<const Eigen::Matrix4d> T_world_camera) {
  impl_->put<std::int64_t>("/frame_step", {std::int64_t(step)});
  for (std::size_t i = 0; i < impl_->cameras.size(); ++i) {
    const Camera& camera = impl_->cameras[i];
    std::vector<double> pose;
    append_rows(pose, T_world_camera[i]);
    impl_->put("/camera/" + camera.name + "/T_world_camera", pose);
    impl_->put<double>("/camera/" + camera.name + "/K", {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1});
  }
}

void StatesFile::close() {
  impl_->flush_nodes();
  impl_->numbers.clear();
  impl_->integers.clear();
  impl_->file.close();
}

}  // namespace pvg
