// glTF 2.0 and GLB: triangle meshes of the scene with their node transforms.
#define TINYGLTF_IMPLEMENTATION
#include "host/formats/gltf_nodes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "host/base/error.hpp"
#include "host/base/outputs.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
constexpr double FARTHEST = 1e9;  // of a point [m]: squares and products of lengths stay in bounds

// what readers of glTF must know where a file demands it; of these we know all
constexpr const char* KNOWN_EXTENSIONS[] = {
    "KHR_lights_punctual", "KHR_materials_transmission", "KHR_materials_specular", "KHR_materials_volume",
    "KHR_materials_ior",   "KHR_materials_unlit",        "KHR_texture_transform",  "KHR_materials_emissive_strength"};

struct Reader {
  const tinygltf::Model& model;
  const fs::path& file;
  GltfNodes nodes;
  std::vector<bool> is_visited = std::vector<bool>(model.nodes.size(), false);

  [[noreturn]] void fail(const std::string& what) const { throw UsageError(file.string() + ": " + what + "."); }

  const tinygltf::Accessor& accessor(int i) const {
    if (i < 0 || i >= int(model.accessors.size())) fail("an accessor is missing");
    return model.accessors[i];
  }

  // First byte of element `at`, of `bytes` bytes; checked against the buffer.
  const unsigned char* element(const tinygltf::Accessor& a, std::size_t at, std::size_t bytes) const {
    if (a.bufferView < 0 || a.sparse.isSparse) fail("sparse accessors are not read; export without them");
    if (a.bufferView >= int(model.bufferViews.size())) fail("an accessor names a buffer view that does not exist");
    const tinygltf::BufferView& view = model.bufferViews[a.bufferView];
    if (view.buffer < 0 || view.buffer >= int(model.buffers.size())) fail("a buffer view names no buffer of the file");
    const auto& data = model.buffers[view.buffer].data;
    const int stride = a.ByteStride(view);
    if (view.byteLength > data.size() || view.byteOffset > data.size() - view.byteLength)
      fail("a buffer view reaches beyond its buffer");
    // each summand alone first: their sum could run over
    const auto is_within = [&](std::size_t offset) { return offset <= data.size(); };
    if (stride <= 0 || !is_within(view.byteOffset) || !is_within(a.byteOffset) || !is_within(at) ||
        !is_within(view.byteOffset + a.byteOffset + at * std::size_t(stride) + bytes))
      fail("an accessor reaches beyond its buffer");
    return data.data() + view.byteOffset + a.byteOffset + at * std::size_t(stride);
  }

  // [count][n] floats
  Eigen::Vector3d floats(const tinygltf::Accessor& a, std::size_t at, int n) const {
    if (tinygltf::GetNumComponentsInType(std::uint32_t(a.type)) < n) fail("vertex data have too few components");
    if (a.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT)
      fail("compressed or integer vertex data is not read; export floats");
    float v[3] = {};
    std::memcpy(v, element(a, at, n * sizeof(float)), n * sizeof(float));
    return {v[0], v[1], v[2]};
  }

  std::uint32_t index(const tinygltf::Accessor& a, std::size_t at) const {
    switch (a.componentType) {
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return *element(a, at, 1);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
        std::uint16_t v;
        std::memcpy(&v, element(a, at, 2), 2);
        return v;
      }
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: {
        std::uint32_t v;
        std::memcpy(&v, element(a, at, 4), 4);
        return v;
      }
      default:
        fail("indices have an unknown type");
    }
  }

  // of floats, or of whole numbers that stand for 0 to 1
  Vec3f color(const tinygltf::Accessor& a, std::size_t at) const {
    if (a.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT) return floats(a, at, 3).cast<float>();
    Vec3f c;
    if (a.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) {
      const unsigned char* v = element(a, at, 3);
      for (int k = 0; k < 3; ++k) c[k] = float(v[k]) / 255.0f;
    } else if (a.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) {
      std::uint16_t v[3];
      std::memcpy(v, element(a, at, sizeof v), sizeof v);
      for (int k = 0; k < 3; ++k) c[k] = float(v[k]) / 65535.0f;
    } else {
      fail("vertex colours have an unknown type");
    }
    return c;
  }

  void add(const tinygltf::Primitive& part, const std::string& name, const Eigen::Affine3d& to_world) {
    if (part.mode != TINYGLTF_MODE_TRIANGLES && part.mode != -1) return;
    const auto attribute = [&](const char* name) {
      const auto at = part.attributes.find(name);
      return at == part.attributes.end() ? -1 : at->second;
    };
    const int positions = attribute("POSITION"), normals = attribute("NORMAL"), uvs = attribute("TEXCOORD_0"),
              second_uvs = attribute("TEXCOORD_1"), colors = attribute("COLOR_0");
    if (positions < 0) fail("a mesh has no positions");
    GltfPrimitive& added = nodes.primitives.emplace_back();
    added.name = name;
    added.material = part.material;
    RawMesh& mesh = added.mesh;
    const std::size_t n = accessor(positions).count;
    const Eigen::Matrix3d for_normals = to_world.linear().inverse().transpose();
    for (const int other : {normals, uvs, second_uvs, colors})
      if (other >= 0 && accessor(other).count < n)
        fail("a mesh has fewer normals, coordinates or colours than positions");
    for (std::size_t i = 0; i < n; ++i) {
      mesh.points.push_back(to_world * floats(accessor(positions), i, 3));
      if (!(mesh.points.back().cwiseAbs().maxCoeff() <= FARTHEST))
        fail("a vertex of `" + name +
             "` is not finite or more than a million kilometres away; correct the node's scale "
             "and translation");
      if (normals >= 0) mesh.normals.push_back((for_normals * floats(accessor(normals), i, 3)).normalized());
      if (uvs >= 0) mesh.uvs.push_back(floats(accessor(uvs), i, 2).head<2>().cast<float>());
      if (second_uvs >= 0) added.second_uvs.push_back(floats(accessor(second_uvs), i, 2).head<2>().cast<float>());
      if (colors >= 0) added.colors.push_back(color(accessor(colors), i));
    }
    const std::size_t n_corners = part.indices < 0 ? n : accessor(part.indices).count;
    const bool mirrors = to_world.linear().determinant() < 0;
    for (std::size_t i = 0; i + 2 < n_corners; i += 3) {
      Triangle t;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = part.indices < 0 ? std::uint32_t(i + k) : index(accessor(part.indices), i + k);
        if (v >= n) fail("an index names a vertex that does not exist");
        t[k] = v;
      }
      if (mirrors) std::swap(t[1], t[2]);
      mesh.triangles.push_back(t);
    }
  }

  // the node's own transform; what is there must be whole
  Eigen::Affine3d local_of(const tinygltf::Node& node) const {
    const auto is_bad = [](const std::vector<double>& values, std::size_t n) {
      return (!values.empty() && values.size() != n) ||
             !std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
    };
    if (is_bad(node.matrix, 16) || is_bad(node.translation, 3) || is_bad(node.rotation, 4) || is_bad(node.scale, 3))
      fail("the node `" + node.name + "` has a transform of too few numbers or one that is not finite");
    Eigen::Affine3d local = Eigen::Affine3d::Identity();
    if (!node.matrix.empty()) {
      local.matrix() = Eigen::Map<const Eigen::Matrix4d>(node.matrix.data());
      if (local.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1))
        fail("the node `" + node.name + "` has a matrix whose last row is not 0 0 0 1");
      return local;
    }
    if (!node.translation.empty()) local.translate(Eigen::Vector3d(node.translation.data()));
    if (!node.rotation.empty()) {
      const Eigen::Vector4d turn(node.rotation.data());
      if (!(turn.norm() > 0.5 && turn.norm() < 2)) fail("the node `" + node.name + "` has a rotation that is no turn");
      local.rotate(Eigen::Quaterniond(turn));
    }
    if (!node.scale.empty()) local.scale(Eigen::Vector3d(node.scale.data()));
    return local;
  }

  void visit(int i, const Eigen::Affine3d& parent, int depth) {
    // a node with two parents could stand for two to the power of the depth
    if (i < 0 || i >= int(model.nodes.size()) || depth > 100 || is_visited[i]) fail("its nodes do not form a tree");
    is_visited[i] = true;
    const tinygltf::Node& node = model.nodes[i];
    const Eigen::Affine3d to_world = parent * local_of(node);
    if (node.mesh >= int(model.meshes.size())) fail("a node names a mesh that does not exist");
    if (node.mesh >= 0) {
      const std::string& name = node.name.empty() ? model.meshes[node.mesh].name : node.name;
      for (const tinygltf::Primitive& part : model.meshes[node.mesh].primitives) add(part, name, to_world);
    }
    if (node.camera >= int(model.cameras.size())) fail("a node names a camera that does not exist");
    if (node.camera >= 0) nodes.cameras.push_back({node.name, node.camera, to_world});
    const auto light = node.extensions.find("KHR_lights_punctual");
    if (light != node.extensions.end()) {
      const int index = light->second.Has("light") ? light->second.Get("light").GetNumberAsInt() : -1;
      if (index < 0 || index >= int(model.lights.size())) fail("a node names a light that does not exist");
      nodes.lights.push_back({node.name, index, to_world});
    }
    for (const int child : node.children) visit(child, to_world, depth + 1);
  }
};

// Pictures stay packed; textures.cpp unpacks them.
bool keep_bytes(tinygltf::Image* image, int, std::string*, std::string*, int, int, const unsigned char* bytes, int n,
                void*) {
  image->image.assign(bytes, bytes + n);
  return true;
}

// The library opens a folder as a file, whose length then is none.
bool is_readable_file(const std::string& path, void*) {
  std::error_code none;
  return fs::is_regular_file(path, none);
}

void check_version(const tinygltf::Model& model, const fs::path& file) {
  if (!model.asset.version.starts_with("2"))
    throw UsageError(file.string() + ": is glTF of version " + model.asset.version + "; export version 2.0.");
  for (const std::string& needed : model.extensionsRequired)
    if (std::find(std::begin(KNOWN_EXTENSIONS), std::end(KNOWN_EXTENSIONS), needed) == std::end(KNOWN_EXTENSIONS))
      throw UsageError(file.string() + ": needs the extension " + needed +
                       ", which this program does not know; export without it.");
}

}  // namespace

tinygltf::Model load_gltf(const fs::path& file) {
  if (!is_file(file)) throw UsageError(file.string() + ": there is no such glTF file.");
  remember_read(file);
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(keep_bytes, nullptr);
  loader.SetFsCallbacks(
      {is_readable_file, tinygltf::ExpandFilePath, tinygltf::ReadWholeFile, tinygltf::WriteWholeFile, nullptr});
  tinygltf::Model model;
  std::string error, warning;
  const bool is_binary = file.extension() == ".glb" || file.extension() == ".GLB";
  const bool is_read = is_binary ? loader.LoadBinaryFromFile(&model, &error, &warning, file.string())
                                 : loader.LoadASCIIFromFile(&model, &error, &warning, file.string());
  if (is_read) {
    check_version(model, file);
    return model;
  }
  // the library's own words about a broken text are of no use to who exported it
  if (error.find("json.exception") != std::string::npos || error.find("std::") != std::string::npos)
    throw UsageError(file.string() + ": cannot be read as glTF: it is no whole JSON text; export it again.");
  for (char& c : error)
    if (c == '\n') c = ' ';
  while (!error.empty() && (error.back() == ' ' || error.back() == '.')) error.pop_back();
  throw UsageError(file.string() + ": cannot be read as glTF: " + error + ".");
}

GltfNodes read_gltf_nodes(const tinygltf::Model& model, const fs::path& file) {
  Reader reader{model, file, {}};
  Eigen::Affine3d z_up = Eigen::Affine3d::Identity();
  z_up.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  const int scene = model.defaultScene < 0 ? 0 : model.defaultScene;
  if (scene >= int(model.scenes.size())) reader.fail("it has no scene");
  for (const int node : model.scenes[scene].nodes) reader.visit(node, z_up, 0);
  return std::move(reader.nodes);
}

RawMesh read_gltf(const fs::path& file) {
  RawMesh joined;
  bool has_normals = true, has_uvs = true;
  const tinygltf::Model model = load_gltf(file);
  for (const GltfPrimitive& part : read_gltf_nodes(model, file).primitives) {
    const RawMesh& mesh = part.mesh;
    const std::uint32_t first = std::uint32_t(joined.points.size());
    has_normals &= !mesh.normals.empty();
    has_uvs &= !mesh.uvs.empty();
    joined.points.insert(joined.points.end(), mesh.points.begin(), mesh.points.end());
    joined.normals.insert(joined.normals.end(), mesh.normals.begin(), mesh.normals.end());
    joined.uvs.insert(joined.uvs.end(), mesh.uvs.begin(), mesh.uvs.end());
    for (const Triangle& t : mesh.triangles) joined.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  if (!has_normals) joined.normals.clear();
  if (!has_uvs) joined.uvs.clear();
  return joined;
}

}  // namespace pvg
