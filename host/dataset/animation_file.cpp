#include "host/dataset/animation_file.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "host/formats/gltf_writer.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
using Floats = std::vector<float>;

struct AnimationWriter : GltfWriter {
  using GltfWriter::GltfWriter;
  tinygltf::Animation animation;
  int times = -1;  // accessor of the pictures' times

  int add_material() {
    // hues a golden angle apart, so that neighbours in the list differ
    const double hue = 2.39996 * double(model.materials.size());
    tinygltf::Material material;
    material.doubleSided = true;
    material.pbrMetallicRoughness.metallicFactor = 0;
    material.pbrMetallicRoughness.baseColorFactor = {0.5 + 0.3 * std::cos(hue), 0.5 + 0.3 * std::cos(hue + 2.0944),
                                                     0.5 + 0.3 * std::cos(hue + 4.18879), 1};
    model.materials.push_back(material);
    return int(model.materials.size()) - 1;
  }

  // a node under the root that shows these triangles; targets: accessors of displacements
  int add_body(const std::string& name, const Floats& points, const std::vector<Triangle>& triangles,
               const std::vector<int>& targets) {
    tinygltf::Primitive primitive;
    primitive.attributes["POSITION"] = add_vectors(points, TINYGLTF_TARGET_ARRAY_BUFFER);
    primitive.indices = add_triangles(triangles);
    primitive.material = add_material();
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    for (const int target : targets) primitive.targets.push_back({{"POSITION", target}});
    tinygltf::Mesh mesh;
    mesh.name = name;
    mesh.primitives.push_back(primitive);
    mesh.weights.assign(targets.size(), 0);
    model.meshes.push_back(mesh);
    tinygltf::Node node;
    node.name = name;
    node.mesh = int(model.meshes.size()) - 1;
    return add_node(node);
  }

  void animate(int node, const std::string& path, int values) {
    tinygltf::AnimationSampler sampler;
    sampler.input = times;
    sampler.output = values;
    sampler.interpolation = "LINEAR";
    animation.samplers.push_back(sampler);
    tinygltf::AnimationChannel channel;
    channel.sampler = int(animation.samplers.size()) - 1;
    channel.target_node = node;
    channel.target_path = path;
    animation.channels.push_back(channel);
  }
};

Floats floats(const std::vector<Vec3>& points) {
  Floats values;
  for (const Vec3& p : points) values.insert(values.end(), {float(p[0]), float(p[1]), float(p[2])});
  return values;
}

// the rotation nearest to the affine body's matrix
Eigen::Quaterniond rotation_of(const AffineMap& map) {
  const Eigen::JacobiSVD<Mat3> svd(map.leftCols<3>(), Eigen::ComputeFullU | Eigen::ComputeFullV);
  return Eigen::Quaterniond(Mat3(svd.matrixU() * svd.matrixV().transpose())).normalized();
}

void add_rigid(AnimationWriter& writer, const RigidBody& body, const TriangleMesh& surface, std::size_t index,
               const std::vector<SceneState>& states) {
  if (surface.triangles.empty()) return;
  const int node = writer.add_body(body.name, floats(surface.points), surface.triangles, {});
  Floats places, turns;
  Eigen::Quaterniond last = Eigen::Quaterniond::Identity();
  for (const SceneState& state : states) {
    const Vec3 p = state.rigid[index].col(3);
    places.insert(places.end(), {float(p[0]), float(p[1]), float(p[2])});
    Eigen::Quaterniond q = rotation_of(state.rigid[index]);
    if (q.dot(last) < 0) q.coeffs() *= -1;  // the shorter way between two pictures
    last = q;
    turns.insert(turns.end(), {float(q.x()), float(q.y()), float(q.z()), float(q.w())});
  }
  // a program that shows no motion shows the start
  writer.model.nodes[std::size_t(node)].translation = {places[0], places[1], places[2]};
  writer.model.nodes[std::size_t(node)].rotation = {turns[0], turns[1], turns[2], turns[3]};
  writer.animate(node, "translation", writer.add_vectors(places));
  writer.animate(node, "rotation", writer.add(turns, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC4, 4));
}

// points: of each picture. The first is the mesh, the others are displacements from it, shown one after the other.
void add_deforming(AnimationWriter& writer, const std::string& name, const std::vector<Triangle>& surface,
                   const std::vector<const std::vector<Vec3>*>& points) {
  // the surface's points alone, in order of their first use
  std::vector<int> place(points[0]->size(), -1);
  std::vector<std::size_t> used;
  std::vector<Triangle> triangles = surface;
  for (Triangle& t : triangles)
    for (auto& corner : t) {
      if (place[corner] < 0) {
        place[corner] = int(used.size());
        used.push_back(corner);
      }
      corner = std::uint32_t(place[corner]);
    }
  const auto picture = [&](std::size_t k) {
    std::vector<Vec3> shown;
    for (const std::size_t i : used) shown.push_back((*points[k])[i] - (k > 0 ? (*points[0])[i] : Vec3(Vec3::Zero())));
    return floats(shown);
  };
  std::vector<int> targets;
  for (std::size_t k = 1; k < points.size(); ++k) targets.push_back(writer.add_vectors(picture(k)));
  const int node = writer.add_body(name, picture(0), triangles, targets);
  if (targets.empty()) return;
  Floats weights;
  for (std::size_t k = 0; k < points.size(); ++k)
    for (std::size_t target = 1; target < points.size(); ++target) weights.push_back(k == target ? 1.0f : 0.0f);
  writer.animate(node, "weights", writer.add_scalars(weights));
}

AnimationWriter writer_of(const Scene& scene, const std::vector<SceneState>& states) {
  AnimationWriter writer(scene.name);
  Floats times;
  for (const SceneState& state : states) times.push_back(float(state.time));
  writer.times = writer.add_scalars(times);
  for (std::size_t b = 0; b < scene.rigid_bodies.size(); ++b)
    add_rigid(writer, scene.rigid_bodies[b], scene.rigid_bodies[b].collision, b, states);
  for (const auto& [rigid, surface] : scene.passing_surfaces)
    add_rigid(writer, scene.rigid_bodies[std::size_t(rigid)], surface, std::size_t(rigid), states);
  const auto through_time = [&](auto points_of) {
    std::vector<const std::vector<Vec3>*> points;
    for (const SceneState& state : states) points.push_back(&points_of(state));
    return points;
  };
  for (std::size_t b = 0; b < scene.soft_bodies.size(); ++b)
    add_deforming(writer, scene.soft_bodies[b].name, scene.soft_bodies[b].mesh.surface,
                  through_time([b](const SceneState& s) -> const std::vector<Vec3>& { return s.soft[b]; }));
  for (std::size_t b = 0; b < scene.cloths.size(); ++b)
    add_deforming(writer, scene.cloths[b].name, scene.cloths[b].mesh.triangles,
                  through_time([b](const SceneState& s) -> const std::vector<Vec3>& { return s.cloth[b]; }));
  if (!writer.animation.channels.empty()) writer.model.animations.push_back(writer.animation);
  return writer;
}

}  // namespace

void AnimationFile::write(const fs::path& file) const { writer_of(scene_, states_).write(file); }

}  // namespace pvg
