#include "host/dataset/states_layout.hpp"

#include <algorithm>

namespace pvg {

std::vector<double> flat(std::span<const Vec3> points) {
  std::vector<double> values;
  values.reserve(points.size() * 3);
  for (const Vec3& point : points) values.insert(values.end(), point.data(), point.data() + 3);
  return values;
}

namespace {

using hdf5::Series;

constexpr std::int64_t STATES_SCHEMA = 1;
constexpr std::uint64_t CHUNK_BYTES = 256 << 10, MOST_CHUNK_ROWS = 4096;  // of compressed series other than nodes'

std::vector<std::uint32_t> corners(std::span<const Triangle> triangles) {
  std::vector<std::uint32_t> values;
  for (const Triangle& triangle : triangles) values.insert(values.end(), triangle.begin(), triangle.end());
  return values;
}

// what the index of compressed chunks takes: less is not worth one
constexpr std::size_t INDEX_BYTES = 3136;

template <class T>
void write_rows(hdf5::File& file, const std::string& name, std::uint64_t columns, std::span<const T> values,
                bool compresses) {
  if (compresses && values.size_bytes() > INDEX_BYTES)
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
  write_rows<std::uint32_t>(file, group + "/triangles", 3, corners(triangles), compresses);
  file.write<std::int64_t>(group + "/body", {}, std::vector<std::int64_t>{body});
}

void write_header(hdf5::File& file, const PhysicalScene& scene, const EpisodeHeader& header) {
  file.attribute("/", "schema", STATES_SCHEMA);
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

void write_names(hdf5::File& file, const Scene& scene, const EpisodeHeader& header, const StatesLayout& layout) {
  std::vector<std::string> joints;
  for (const std::size_t i : layout.driven) joints.push_back(scene.joints[i].name);
  for (const char* name : {"/q", "/a", "/torque"}) file.attribute(name, "names", joints);
  if (header.is_disturbed) file.attribute("/disturbance", "names", joints);
  std::vector<std::string> all_joints;
  for (const Joint& joint : scene.joints) all_joints.push_back(joint.name);
  file.attribute("/joint", "names", all_joints);
  std::vector<std::string> displays;
  for (const Display& display : scene.displays) displays.push_back(display.name);
  if (!displays.empty()) file.attribute("/reading", "names", displays);
  file.attribute("/T_link", "names", names_of(scene, layout.links));
  file.attribute("/T_rigid", "names", names_of(scene, layout.rigids));
}

// where to find each body: the data set as an index into the attribute `data_sets`, and the row in it
void write_places(hdf5::File& file, const PhysicalScene& scene, const StatesLayout& layout) {
  std::vector<std::string> names, data_sets = {"/T_link", "/T_rigid"};
  std::vector<std::int64_t> source(scene.rigid_bodies.size()), row(scene.rigid_bodies.size());
  for (std::size_t i = 0; i < layout.links.size(); ++i) row[layout.links[i]] = std::int64_t(i);
  for (std::size_t i = 0; i < layout.rigids.size(); ++i) {
    source[layout.rigids[i]] = 1;
    row[layout.rigids[i]] = std::int64_t(i);
  }
  for (const RigidBody& body : scene.rigid_bodies) names.push_back(body.name);
  const auto add_deformable = [&](const std::string& name, const std::string& data_set) {
    names.push_back(name);
    source.push_back(std::int64_t(data_sets.size()));
    row.push_back(0);
    data_sets.push_back(data_set);
  };
  for (std::size_t i = 0; i < scene.soft_bodies.size(); ++i) add_deformable(scene.soft_bodies[i].name, layout.soft[i]);
  for (std::size_t i = 0; i < scene.cloths.size(); ++i) add_deformable(scene.cloths[i].name, layout.cloths[i]);
  file.write<std::int64_t>("/bodies/source", {source.size()}, source);
  file.write<std::int64_t>("/bodies/row", {row.size()}, row);
  file.attribute("/bodies", "names", names);
  file.attribute("/bodies", "data_sets", data_sets);
}

void write_what_never_touches(hdf5::File& file, const PhysicalScene& scene) {
  std::vector<std::int64_t> is_fixed(scene.rigid_bodies.size() + scene.soft_bodies.size() + scene.cloths.size(), 0),
      noncolliding;
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

StatesLayout lay_out_states(const PhysicalScene& scene, const EpisodeHeader& header) {
  StatesLayout layout;
  layout.driven = driven_joints(scene);
  for (std::size_t i = 0; i < scene.rigid_bodies.size(); ++i) {
    const bool is_object =
        std::find(header.objects.begin(), header.objects.end(), scene.rigid_bodies[i].name) != header.objects.end();
    (is_object ? layout.rigids : layout.links).push_back(i);
  }
  const std::vector<bool> stitched = is_stitched(scene);
  for (std::size_t i = 0; i < stitched.size(); ++i)
    layout.soft.push_back((stitched[i] ? "/X_gripper/" : "/X_deform/") + scene.soft_bodies[i].name);
  for (const Cloth& cloth : scene.cloths) layout.cloths.push_back("/X_deform/" + cloth.name);
  return layout;
}

hdf5::Storage compressed(const hdf5::Shape& row, std::size_t bytes_per_value) {
  const std::uint64_t row_bytes = std::max<std::uint64_t>(bytes_per_value * hdf5::n_values(row), 1);
  hdf5::Shape chunk = row;
  chunk.insert(chunk.begin(), std::clamp<std::uint64_t>(CHUNK_BYTES / row_bytes, 1, MOST_CHUNK_ROWS));
  return {DEFLATE, true, chunk};
}

void write_constants(hdf5::File& file, const Scene& scene, const EpisodeHeader& header,
                     std::span<const DisabledPair> disabled, const StatesLayout& layout) {
  write_header(file, scene, header);
  write_meshes(file, scene, header.states != RecordedStates::full);
  write_disabled(file, disabled);
  write_names(file, scene, header, layout);
  write_places(file, scene, layout);
  write_what_never_touches(file, scene);
}

}  // namespace pvg
