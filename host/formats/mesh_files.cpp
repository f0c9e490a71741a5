#include "host/formats/mesh_files.hpp"

#include <fmt/format.h>

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <map>
#include <tuple>

#include "host/base/child_process.hpp"
#include "host/base/error.hpp"
#include "host/base/kept_results.hpp"
#include "host/base/notes.hpp"
#include "host/base/outputs.hpp"
#include "host/formats/assimp_reader.hpp"
#include "host/formats/raw_mesh.hpp"
#include "host/geometry/mesh_checks.hpp"
#include "host/pictures/srgb.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t MOST_KEPT = 100;  // files
constexpr double LARGE = 20;            // of a body that stands in a room [m]
constexpr double FARTHEST = 1e9;        // coordinate of a vertex [m]: squares and products of lengths stay in bounds

// What has been joined so far, and whether every part had normals and texture coordinates.
struct Joined {
  RawMesh mesh;
  bool has_normals = true, has_uvs = true, has_colors = true;
};

void append(const aiMesh& part, const aiMatrix4x4& to_root, Joined& out, const fs::path& file) {
  const auto first = std::uint32_t(out.mesh.points.size());
  const aiMatrix3x3 rotation = aiMatrix3x3(to_root);
  aiMatrix3x3 for_normals = rotation;
  for_normals.Inverse().Transpose();
  out.has_normals &= part.HasNormals();
  out.has_uvs &= part.HasTextureCoords(0);
  out.has_colors &= part.HasVertexColors(0);
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D p = to_root * part.mVertices[i];
    out.mesh.points.emplace_back(p.x, p.y, p.z);
    const aiVector3D n = part.HasNormals() ? for_normals * part.mNormals[i] : aiVector3D();
    out.mesh.normals.push_back(Vec3(n.x, n.y, n.z).normalized());
    // assimp counts v from the bottom row
    const aiVector3D uv = part.HasTextureCoords(0) ? part.mTextureCoords[0][i] : aiVector3D();
    out.mesh.uvs.emplace_back(uv.x, 1 - uv.y);
    // who writes colours of points takes them from pictures, in sRGB
    const aiColor4D color = part.HasVertexColors(0) ? part.mColors[0][i] : aiColor4D();
    out.mesh.colors.emplace_back(srgb_to_linear(color.r), srgb_to_linear(color.g), srgb_to_linear(color.b));
  }
  const bool mirrors = rotation.Determinant() < 0;
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices < 3) continue;  // points and lines have no surface
    if (face.mNumIndices > 3)
      throw UsageError(file.string() + ": a polygon could not be split into triangles; split it.");
    for (unsigned k = 0; k < 3; ++k)
      if (face.mIndices[k] >= part.mNumVertices)
        throw UsageError(file.string() + ": a triangle names a vertex that does not exist; export the mesh again.");
    Triangle t = {first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]};
    if (mirrors) std::swap(t[1], t[2]);
    out.mesh.triangles.push_back(t);
  }
}

void append_node(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent, Joined& out,
                 const fs::path& file) {
  const aiMatrix4x4 to_root = parent * node.mTransformation;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) append(*scene.mMeshes[node.mMeshes[i]], to_root, out, file);
  for (unsigned i = 0; i < node.mNumChildren; ++i) append_node(scene, *node.mChildren[i], to_root, out, file);
}

RawMesh read_any(const fs::path& file) {
  if (!is_file(file)) throw UsageError(file.string() + ": there is no such mesh file.");
  remember_read(file);
  const std::string kind = ending_of(file);
  RawMesh mesh;
  if (kind == ".gltf" || kind == ".glb") {
    mesh = read_gltf(file);
  } else if (is_read_by_assimp(file)) {
    mesh = read_with_assimp(file);
  } else {
    throw UsageError(file.string() + ": meshes are read from .obj, .stl, .ply, .dae, .gltf and .glb files.");
  }
  if (mesh.triangles.empty()) throw UsageError(file.string() + ": the file holds no triangles.");
  return mesh;
}

void check_finite(const RawMesh& mesh, const fs::path& file) {
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    if (!mesh.points[i].allFinite()) {
      throw UsageError(file.string() + ": a vertex is not a finite position (NaN or infinite); export the mesh again.");
    }
    if (mesh.points[i].cwiseAbs().maxCoeff() > FARTHEST)
      throw UsageError(file.string() + ": a vertex is more than a million kilometres away; export the mesh again.");
  }
}

double size_of(const std::vector<Vec3>& points) {
  Vec3 low = points.front(), high = low;
  for (const Vec3& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (high - low).norm();
}

TriangleMesh welded(const RawMesh& mesh) {
  const double size = size_of(mesh.points);
  if (!(size > 0)) return {mesh.points, mesh.triangles};
  return weld_points({mesh.points, mesh.triangles}, 1e-7 * size);
}

// For each corner of each triangle: the mean of the normals around its point, weighted by angle, of those triangles
// that lean less than crease_angle away from this one.
std::vector<Vec3> corner_normals(const RawMesh& mesh, double crease_angle) {
  std::map<std::array<double, 3>, std::vector<std::size_t>> around;  // point -> triangles
  std::vector<Vec3> face(mesh.triangles.size());
  const auto key = [&](std::uint32_t i) {
    const Vec3& p = mesh.points[i];
    return std::array<double, 3>{p.x() + 0.0, p.y() + 0.0, p.z() + 0.0};
  };
  for (std::size_t t = 0; t < face.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    face[t] = (mesh.points[b] - mesh.points[a]).cross(mesh.points[c] - mesh.points[a]).normalized();
    for (const std::uint32_t corner : mesh.triangles[t]) around[key(corner)].push_back(t);
  }
  const auto angle_at = [&](std::size_t t, const std::array<double, 3>& point) {
    const Triangle& v = mesh.triangles[t];
    const int k = key(v[0]) == point ? 0 : key(v[1]) == point ? 1 : 2;
    const Vec3 p = mesh.points[v[k]];
    const Vec3 e = mesh.points[v[(k + 1) % 3]] - p, f = mesh.points[v[(k + 2) % 3]] - p;
    return std::atan2(e.cross(f).norm(), e.dot(f));
  };
  const double flattest = std::cos(crease_angle);
  std::vector<Vec3> normals(3 * face.size());
  for (std::size_t t = 0; t < face.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto point = key(mesh.triangles[t][k]);
      Vec3 sum = Vec3::Zero();
      for (const std::size_t other : around[point]) {
        if (other == t || face[other].dot(face[t]) > flattest) sum += angle_at(other, point) * face[other];
      }
      normals[3 * t + k] = sum.norm() > 0 ? sum.normalized() : face[t];
    }
  }
  return normals;
}

VisualMesh unified(const RawMesh& mesh, const std::vector<Vec3>& normals) {
  VisualMesh out;
  std::map<std::tuple<float, float, float, float, float, float, float, float>, std::uint32_t> known;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Triangle triangle;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t i = mesh.triangles[t][k];
      const Vec3f p = mesh.points[i].cast<float>(),
                  n = normals.empty() ? Vec3f::Zero() : Vec3f(normals[3 * t + k].cast<float>());
      const Vec2f uv = mesh.uvs.empty() ? Vec2f::Zero() : mesh.uvs[i];
      const auto [at, is_new] =
          known.insert({{p.x(), p.y(), p.z(), n.x(), n.y(), n.z(), uv.x(), uv.y()}, std::uint32_t(out.points.size())});
      triangle[k] = at->second;
      if (!is_new) continue;
      out.points.push_back(p);
      if (!normals.empty()) out.normals.push_back(n);
      if (!mesh.uvs.empty()) out.uvs.push_back(uv);
    }
    if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0])
      out.triangles.push_back(triangle);
  }
  return out;
}

RawMesh import(const fs::path& file) {
  Assimp::Importer importer;
  keep_one_reader(importer, file);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);  // else z-up files are turned to y up
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate);
  if (!scene || !scene->mRootNode) {
    std::string reason = importer.GetErrorString();
    if (reason.find("std::") != std::string::npos || reason.find("bad_alloc") != std::string::npos)
      reason = "it claims more vertices or triangles than it can hold; export it again";
    while (reason.ends_with('.')) reason.pop_back();
    throw UsageError(file.string() + ": cannot be read as a mesh: " + reason + ".");
  }
  Joined joined;
  append_node(*scene, *scene->mRootNode, aiMatrix4x4(), joined, file);
  if (!joined.has_normals) joined.mesh.normals.clear();
  if (!joined.has_uvs) joined.mesh.uvs.clear();
  if (!joined.has_colors) joined.mesh.colors.clear();
  return std::move(joined.mesh);
}

}  // namespace

RawMesh read_with_assimp(const fs::path& file) {
  static KeptResults<std::string> kept(MOST_KEPT);
  const std::string bytes = kept.of(file_key(file), [&] {
    // assimp crashes on some damaged files, reads others without end
    return in_child_process(file.string(), limits_to_read(file), [&] {
      const RawMesh mesh = import(file);
      std::string packed;
      pack(packed, mesh.points), pack(packed, mesh.normals), pack(packed, mesh.uvs), pack(packed, mesh.colors);
      pack(packed, mesh.triangles);
      return packed;
    });
  });
  RawMesh mesh;
  std::size_t at = 0;
  unpack(bytes, at, mesh.points), unpack(bytes, at, mesh.normals), unpack(bytes, at, mesh.uvs);
  unpack(bytes, at, mesh.colors), unpack(bytes, at, mesh.triangles);
  return mesh;
}

TriangleMesh read_surface(const fs::path& file) {
  const RawMesh mesh = read_any(file);
  check_finite(mesh, file);
  return welded(mesh);
}

TriangleMesh read_closed_surface(const fs::path& file) {
  TriangleMesh surface = read_surface(file);
  check_closed_surface(surface, file.string());
  return surface;
}

void tell_of_size(const TriangleMesh& mesh, const std::string& file) {
  const double size = mesh.points.empty() ? 0 : size_of(mesh.points);
  if (!(size > LARGE)) return;
  tell_note(fmt::format(
      "{} is {:.0f} m large: is it in mm? Lengths in meshes are metres; scale it by 0.001 where it is", file, size));
}

VisualMesh read_visual_mesh(const fs::path& file, double crease_angle) {
  const RawMesh mesh = read_any(file);
  check_finite(mesh, file);
  std::vector<Vec3> normals;
  if (!mesh.normals.empty()) {
    for (const Triangle& t : mesh.triangles) {
      for (const std::uint32_t corner : t) normals.push_back(mesh.normals[corner]);
    }
  } else if (crease_angle > 0) {
    normals = corner_normals(mesh, crease_angle);
  }
  return unified(mesh, normals);
}

VisualMesh read_colored_mesh(const fs::path& file) {
  const RawMesh mesh = read_any(file);
  check_finite(mesh, file);
  VisualMesh out;
  for (const Vec3& p : mesh.points) out.points.push_back(p.cast<float>());
  out.uvs = mesh.uvs;
  out.colors = mesh.colors;
  out.triangles = mesh.triangles;
  return out;
}

std::string obj_text(const TriangleMesh& mesh) {
  std::string text;
  for (const Vec3& p : mesh.points) text += fmt::format("v {:.9g} {:.9g} {:.9g}\n", p.x(), p.y(), p.z());
  for (const Triangle& t : mesh.triangles) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

VisualMesh visual_of(const TriangleMesh& surface) {
  VisualMesh mesh;
  for (const Vec3& p : surface.points) mesh.points.push_back(p.cast<float>());
  mesh.triangles = surface.triangles;
  return mesh;
}

}  // namespace pvg
