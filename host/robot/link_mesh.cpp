#include "host/robot/link_mesh.hpp"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <map>

#include "host/base/child_process.hpp"
#include "host/base/error.hpp"
#include "host/base/kept_results.hpp"
#include "host/base/outputs.hpp"
#include "host/formats/assimp_reader.hpp"

namespace pvg {
namespace {

constexpr std::size_t MOST_KEPT = 200;  // files

Vec3f to_vector(const aiVector3D& v) { return {v.x, v.y, v.z}; }

MeshPart convert(const aiMesh& mesh, const aiMaterial* material, const Vec3f& scale, const std::string& where) {
  MeshPart part;
  const float turn = scale.prod() < 0 ? -1.0f : 1.0f;  // a mirrored mesh would be inside out
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    part.mesh.points.push_back(to_vector(mesh.mVertices[i]).cwiseProduct(scale));
    if (!part.mesh.points.back().allFinite())
      throw UsageError(where + " has a vertex (number " + std::to_string(i) +
                       ") that is not a finite number; repair the mesh");
    if (mesh.HasNormals()) part.mesh.normals.push_back(to_vector(mesh.mNormals[i]).cwiseQuotient(scale).normalized());
    if (mesh.HasTextureCoords(0))
      part.mesh.uvs.emplace_back(mesh.mTextureCoords[0][i].x, 1 - mesh.mTextureCoords[0][i].y);
  }
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const unsigned* v = mesh.mFaces[i].mIndices;
    if (mesh.mFaces[i].mNumIndices != 3 || std::max({v[0], v[1], v[2]}) >= mesh.mNumVertices)
      throw UsageError(where + " has a face (number " + std::to_string(i) +
                       ") that is no triangle of its vertices; repair the mesh");
    if (turn > 0)
      part.mesh.triangles.push_back({v[0], v[1], v[2]});
    else
      part.mesh.triangles.push_back({v[0], v[2], v[1]});
  }
  aiColor4D color;
  if (material && aiGetMaterialColor(material, AI_MATKEY_COLOR_DIFFUSE, &color) == AI_SUCCESS)
    part.color = {color.r, color.g, color.b};
  return part;
}

std::vector<MeshPart> import(const std::filesystem::path& file, const Vec3& scale, const std::string& where) {
  Assimp::Importer importer;
  keep_one_reader(importer, file);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);  // as other readers of URDF do
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_PreTransformVertices |
                                                              aiProcess_JoinIdenticalVertices | aiProcess_SortByPType);
  if (!scene || scene->mNumMeshes == 0)
    throw UsageError(where + " could not be read (" + importer.GetErrorString() +
                     "); give an STL, OBJ, DAE or PLY file");
  std::vector<MeshPart> parts;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) {
    const aiMesh& mesh = *scene->mMeshes[i];
    const aiMaterial* material =
        mesh.mMaterialIndex < scene->mNumMaterials ? scene->mMaterials[mesh.mMaterialIndex] : nullptr;
    parts.push_back(convert(mesh, material, scale.cast<float>(), where));
  }
  return parts;
}

}  // namespace

std::vector<MeshPart> load_mesh_parts(const std::filesystem::path& file, const Vec3& scale, const std::string& owner) {
  const std::string where = owner + ": mesh " + file.string();
  if (!is_file(file)) throw UsageError(where + " does not exist; correct its path in the URDF");
  if (!scale.allFinite() || scale.cwiseAbs().minCoeff() == 0)
    throw UsageError(where + " is scaled by zero or by no finite number; correct scale in the URDF");
  if (!is_read_by_assimp(file))
    throw UsageError(where + " is of no format that is read here; give an STL, OBJ, DAE or PLY file");
  static KeptResults<std::string> kept(MOST_KEPT);
  std::string key = file_key(file);
  if (!key.empty()) pack(key, std::vector<Vec3>{scale});
  const std::string bytes = kept.of(key, [&] {
    // assimp crashes on some damaged files, reads others without end
    return in_child_process(where, limits_to_read(file), [&] {
      const std::vector<MeshPart> parts = import(file, scale, where);
      std::string packed;
      pack(packed, std::vector<std::size_t>{parts.size()});
      for (const auto& [mesh, color] : parts) {
        pack(packed, mesh.points), pack(packed, mesh.normals), pack(packed, mesh.uvs), pack(packed, mesh.triangles);
        pack(packed, std::vector<Vec3f>{color});
      }
      return packed;
    });
  });
  std::size_t at = 0;
  std::vector<std::size_t> n;
  unpack(bytes, at, n);
  std::vector<MeshPart> parts(n.at(0));
  std::vector<Vec3f> color;
  for (MeshPart& part : parts) {
    unpack(bytes, at, part.mesh.points), unpack(bytes, at, part.mesh.normals), unpack(bytes, at, part.mesh.uvs);
    unpack(bytes, at, part.mesh.triangles), unpack(bytes, at, color);
    part.color = color.at(0);
  }
  return parts;
}

VisualMesh moved(const VisualMesh& mesh, const Pose& pose) {
  VisualMesh result = mesh;
  for (Vec3f& p : result.points) p = (pose * p.cast<double>()).cast<float>();
  for (Vec3f& n : result.normals) n = (pose.linear() * n.cast<double>()).cast<float>();
  return result;
}

void add_to_collision(TriangleMesh& collision, const VisualMesh& mesh) {
  std::map<std::array<float, 3>, std::uint32_t> known;  // of this mesh alone: two shapes that touch stay two
  std::vector<std::uint32_t> index;
  for (const Vec3f& p : mesh.points) {
    const auto [entry, is_new] = known.try_emplace({p.x(), p.y(), p.z()}, std::uint32_t(collision.points.size()));
    if (is_new) collision.points.push_back(p.cast<double>());
    index.push_back(entry->second);
  }
  for (const Triangle& t : mesh.triangles) {
    const Triangle c = {index[t[0]], index[t[1]], index[t[2]]};
    const Vec3 &p = collision.points[c[0]], &q = collision.points[c[1]], &r = collision.points[c[2]];
    if ((q - p).cross(r - p).norm() > 0) collision.triangles.push_back(c);
  }
}

}  // namespace pvg
