#include "host/dataset/states_file.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "host/formats/hdf5.hpp"

namespace pvg {
namespace {

using hdf5::Series;

constexpr std::int64_t SCHEMA = 1;
constexpr int DEFLATE = 7;                     // level: 9 is 1 % smaller and takes 1.6 times as long
constexpr std::uint64_t NODE_CHUNK_ROWS = 64;  // 32: 2.5 % larger, but a single step is read in half the time
constexpr std::uint64_t CHUNK_BYTES = 256 << 10, MOST_CHUNK_ROWS = 4096;  // of compressed series other than nodes'

std::vector<double> flat(std::span<const Vec3> points) {
  std::vector<double> values;
  values.reserve(points.size() * 3);
  for (const Vec3& point : points) values.insert(values.end(), point.data(), point.data() + 3);
  return values;
}

// the values are the same, compressed or not
hdf5::Storage compressed(const hdf5::Shape& row, std::size_t bytes_per_value) {
  const std::uint64_t row_bytes = std::max<std::uint64_t>(bytes_per_value * hdf5::n_values(row), 1);
  hdf5::Shape chunk = row;
  chunk.insert(chunk.begin(), std::clamp<std::uint64_t>(CHUNK_BYTES / row_bytes, 1, MOST_CHUNK_ROWS));
  return {DEFLATE, true, chunk};
}

// row by row, as files and readers have it; Eigen stores columns
template <class Matrix>
void append_rows(std::vector<double>& values, const Matrix& matrix) {
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) values.push_back(matrix(i, j));
}

std::vector<std::uint32_t> flat(std::span<const Triangle> triangles) {
  std::vector<std::uint32_t> values;
  for (const Triangle& triangle : triangles) values.insert(values.end(), triangle.begin(), triangle.end());
  return values;
}

template <class T>
void write_rows(hdf5::File& file, const std::string& name, std::uint64_t columns, std::span<const T> values,
                bool compresses) {
  if (compresses)
    Series<T>(file, name, {columns}, compressed({columns}, sizeof(T))).append(values);
  else
    file.write<T>(name, {values.size() / columns, columns}, values);
}

void write_mesh(hdf5::File& file, const std::string& name, std::int64_t body, std::span<const Vec3> rest,
                std::span<const Triangle> triangles, std::span<const std::uint32_t> elements,
                std::uint64_t nodes_per_element, bool compresses) {
  const std::string group = "/mesh/" + name;
  write_rows<double>(file, group + "/rest", 3, flat(rest), compresses);
  write_rows<std::uint32_t>(file, group + "/elements", nodes_per_element, elements, compresses);
  write_rows<std::uint32_t>(file, group + "/triangles", 3, flat(triangles), compresses);
  file.write<std::int64_t>(group + "/body", {}, std::vector<std::int64_t>{body});
}

}  // namespace

std::vector<bool> is_stitched(const PhysicalScene& scene) {
  std::vector<bool> stitched(scene.soft_bodies.size(), false);
  for (const Stitch& stitch : scene.stitches)
    if (stitch.soft >= 0) stitched.at(std::size_t(stitch.soft)) = true;
  return stitched;
}

std::vector<std::size_t> driven_joints(const PhysicalScene& scene) {
  std::vector<std::size_t> driven;
  for (std::size_t i = 0; i < scene.joints.size(); ++i)
    if (is_driven(scene.joints[i])) driven.push_back(i);
  return driven;
}

struct StatesFile::Impl {
  Impl(const std::filesystem::path& path, const Scene& scene, const EpisodeHeader& header)
      : file(hdf5::File::create(path)), states(header.states), driven(driven_joints(scene)) {
    for (std::size_t i = 0; i < scene.rigid_bodies.size(); ++i) {
      const std::string& name = scene.rigid_bodies[i].name;
      (std::find(header.objects.begin(), header.objects.end(), name) == header.objects.end() ? links : rigids)
          .push_back(i);
    }
    open_series(scene);
  }

  void open_series(const Scene& scene) {
    const std::uint64_t n_joints = driven.size();
    add<double>("/time", {});
    for (const char* name : {"/q", "/a", "/torque"}) add<double>(name, {n_joints});
    add<double>("/T_link", {links.size(), 3, 4});
    add<double>("/T_rigid", {rigids.size(), 3, 4});
    file.make_group("/X_gripper");
    file.make_group("/X_deform");
    const std::vector<bool> stitched = is_stitched(scene);
    for (std::size_t i = 0; i < stitched.size(); ++i) {
      const SoftBody& body = scene.soft_bodies[i];
      soft.push_back((stitched[i] ? "/X_gripper/" : "/X_deform/") + body.name);
      add_nodes(soft.back(), body.mesh.points.size());
    }
    for (const Cloth& cloth : scene.cloths) {
      cloths.push_back("/X_deform/" + cloth.name);
      add_nodes(cloths.back(), cloth.mesh.points.size());
    }
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
  void put_nodes(const std::vector<std::vector<Vec3>>& soft_nodes, const std::vector<std::vector<Vec3>>& cloth_nodes) {
    const auto put_rounded = [&](const std::string& name, std::span<const Vec3> nodes) {
      std::vector<double> values = flat(nodes);
      if (states != RecordedStates::full)
        for (double& value : values) value = std::round(value / NODE_GRID) * NODE_GRID;
      put(name, values);
    };
    for (std::size_t i = 0; i < soft.size(); ++i) put_rounded(soft[i], soft_nodes.at(i));
    for (std::size_t i = 0; i < cloths.size(); ++i) put_rounded(cloths[i], cloth_nodes.at(i));
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
  std::vector<std::size_t> driven, links, rigids;  // of Scene::joints, of Scene::rigid_bodies
  std::vector<std::string> soft, cloths;           // data set of each
  std::vector<Camera> cameras;
  std::int64_t n_contacts = 0, n_pairs = 0;
};

namespace {

void write_header(hdf5::File& file, const PhysicalScene& scene, const EpisodeHeader& header) {
  file.attribute("/", "schema", SCHEMA);
  file.attribute("/", "task", header.task);
  file.attribute("/", "seed", header.seed);
  file.attribute("/", "episode", header.episode);
  file.attribute("/", "h", scene.solver.time_step);
  file.attribute("/", "configuration", header.configuration);
  file.attribute("/", "states", RECORDED_STATES[std::size_t(header.states)]);
  for (const auto& [name, version] : header.versions) file.attribute("/", "version_" + name, version);
  std::vector<std::string> names;
  std::vector<double> values;
  for (const auto& [name, value] : header.sampled) {
    names.push_back(name);
    values.push_back(value);
  }
  file.write<double>("/sampled", {values.size()}, values);
  file.attribute("/sampled", "names", names);
}

void write_meshes(hdf5::File& file, const PhysicalScene& scene, bool compresses) {
  file.make_group("/mesh");
  for (std::size_t i = 0; i < scene.rigid_bodies.size(); ++i) {
    const RigidBody& body = scene.rigid_bodies[i];
    if (!body.collision.points.empty())
      write_mesh(file, body.name, std::int64_t(i), body.collision.points, body.collision.triangles, {}, 4, compresses);
  }
  for (std::size_t i = 0; i < scene.soft_bodies.size(); ++i) {
    const SoftBody& body = scene.soft_bodies[i];
    write_mesh(file, body.name, std::int64_t(scene.rigid_bodies.size() + i), body.mesh.points, body.mesh.surface,
               body.mesh.elements, std::uint64_t(body.mesh.nodes_per_element), compresses);
  }
  const std::size_t first_cloth = scene.rigid_bodies.size() + scene.soft_bodies.size();
  for (std::size_t i = 0; i < scene.cloths.size(); ++i) {
    const TriangleMesh& mesh = scene.cloths[i].mesh;
    write_mesh(file, scene.cloths[i].name, std::int64_t(first_cloth + i), mesh.points, mesh.triangles, {}, 4,
               compresses);
  }
}

void write_disabled(hdf5::File& file, std::span<const DisabledPair> disabled) {
  std::vector<std::int64_t> rows;
  for (const DisabledPair& pair : disabled) {
    rows.insert(rows.end(), {std::int64_t(pair.kind), pair.first, pair.second});
    rows.insert(rows.end(), pair.first_vertices.begin(), pair.first_vertices.end());
    rows.insert(rows.end(), pair.second_vertices.begin(), pair.second_vertices.end());
  }
  file.write<std::int64_t>("/contact_disabled", {disabled.size(), 9}, rows);
}

std::vector<std::string> names_of(const PhysicalScene& scene, const std::vector<std::size_t>& bodies) {
  std::vector<std::string> names;
  for (const std::size_t i : bodies) names.push_back(scene.rigid_bodies[i].name);
  return names;
}

}  // namespace

StatesFile::StatesFile(const std::filesystem::path& path, const Scene& scene, const EpisodeHeader& header,
                       std::span<const DisabledPair> disabled)
    : impl_(std::make_unique<Impl>(path, scene, header)) {
  hdf5::File& file = impl_->file;
  write_header(file, scene, header);
  write_meshes(file, scene, header.states != RecordedStates::full);
  write_disabled(file, disabled);

  std::vector<std::string> joints;
  for (const std::size_t i : impl_->driven) joints.push_back(scene.joints[i].name);
  for (const char* name : {"/q", "/a", "/torque"}) file.attribute(name, "names", joints);
  std::vector<std::string> all_joints;
  for (const Joint& joint : scene.joints) all_joints.push_back(joint.name);
  file.attribute("/joint", "names", all_joints);
  std::vector<std::string> displays;
  for (const Display& display : scene.displays) displays.push_back(display.name);
  if (!displays.empty()) file.attribute("/reading", "names", displays);
  file.attribute("/T_link", "names", names_of(scene, impl_->links));
  file.attribute("/T_rigid", "names", names_of(scene, impl_->rigids));

  // where to find each body: the data set as an index into the attribute `data_sets`, and the row in it
  std::vector<std::string> names, data_sets = {"/T_link", "/T_rigid"};
  std::vector<std::int64_t> source(scene.rigid_bodies.size()), row(scene.rigid_bodies.size());
  for (std::size_t i = 0; i < impl_->links.size(); ++i) row[impl_->links[i]] = std::int64_t(i);
  for (std::size_t i = 0; i < impl_->rigids.size(); ++i) {
    source[impl_->rigids[i]] = 1;
    row[impl_->rigids[i]] = std::int64_t(i);
  }
  for (const RigidBody& body : scene.rigid_bodies) names.push_back(body.name);
  const auto add_deformable = [&](const std::string& name, const std::string& data_set) {
    names.push_back(name);
    source.push_back(std::int64_t(data_sets.size()));
    row.push_back(0);
    data_sets.push_back(data_set);
  };
  for (std::size_t i = 0; i < scene.soft_bodies.size(); ++i) add_deformable(scene.soft_bodies[i].name, impl_->soft[i]);
  for (std::size_t i = 0; i < scene.cloths.size(); ++i) add_deformable(scene.cloths[i].name, impl_->cloths[i]);
  file.write<std::int64_t>("/bodies/source", {source.size()}, source);
  file.write<std::int64_t>("/bodies/row", {row.size()}, row);
  std::vector<std::int64_t> is_fixed(source.size(), 0), noncolliding;
  for (std::size_t i = 0; i < scene.rigid_bodies.size(); ++i) is_fixed[i] = scene.rigid_bodies[i].is_fixed;
  for (const Joint& joint : scene.joints) noncolliding.insert(noncolliding.end(), {joint.parent, joint.child});
  for (const auto& [first, second] : scene.noncolliding_rigid_bodies)
    noncolliding.insert(noncolliding.end(), {first, second});
  const auto goes_its_way = [&](std::size_t i) {
    return scene.rigid_bodies[i].is_fixed || scene.rigid_bodies[i].is_prescribed;
  };
  for (std::size_t i = 0; i < scene.rigid_bodies.size(); ++i)
    for (std::size_t j = i + 1; j < scene.rigid_bodies.size(); ++j)
      if (goes_its_way(i) && goes_its_way(j) && !(is_fixed[i] && is_fixed[j]))
        noncolliding.insert(noncolliding.end(), {std::int64_t(i), std::int64_t(j)});
  file.write<std::int64_t>("/bodies/is_fixed", {is_fixed.size()}, is_fixed);
  file.write<std::int64_t>("/bodies/noncolliding", {noncolliding.size() / 2, 2}, noncolliding);
  file.attribute("/bodies", "names", names);
  file.attribute("/bodies", "data_sets", data_sets);
}

StatesFile::~StatesFile() = default;
StatesFile::StatesFile(StatesFile&&) noexcept = default;

void StatesFile::append_step(const WorldState& state, const StepReport& report, std::span<const double> target) {
  Impl& to = *impl_;
  std::vector<double> q, torque, T_link, T_rigid;
  for (const std::size_t i : to.driven) {
    q.push_back(state.joint_position.at(i));
    torque.push_back(state.joint_effort.at(i));
  }
  for (const std::size_t i : to.links) append_rows(T_link, state.rigid.at(i));
  for (const std::size_t i : to.rigids) append_rows(T_rigid, state.rigid.at(i));
  to.put<double>("/time", {state.time});
  to.put("/q", q);
  to.put<double>("/a", {target.begin(), target.end()});
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
