#include "host/capture/meshes/room_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "host/base/error.hpp"
#include "host/capture/surface.hpp"
#include "host/formats/assimp_reader.hpp"
#include "host/formats/mesh_files.hpp"
#include "host/load/gltf_scene.hpp"
#include "host/pictures/srgb.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

constexpr double LEAST_ROOM = 0.2, LARGEST_ROOM = 50;  // extent [m]

// a part of a glTF file with its material's colour in the colours of its points
VisualMesh colored_part(const GltfPart& part, const VisualMaterial& material, bool is_srgb) {
  VisualMesh mesh;
  mesh.points = part.mesh.points;
  mesh.triangles = part.mesh.triangles;
  mesh.colors = part.mesh.colors;
  if (mesh.colors.empty()) mesh.colors.assign(mesh.points.size(), Vec3f::Ones());
  for (Vec3f& color : mesh.colors) {
    if (is_srgb) color = color.unaryExpr(&srgb_to_linear);
    color = color.cwiseProduct(material.color);
  }
  if (material.texture >= 0)
    mesh.uvs = material.on_second_uvs & VisualMaterial::color_bit ? part.mesh.second_uvs : part.mesh.uvs;
  return mesh;
}

void append_part(const VisualMesh& part, VisualMesh& to) {
  const auto first = std::uint32_t(to.points.size());
  to.points.insert(to.points.end(), part.points.begin(), part.points.end());
  to.uvs.insert(to.uvs.end(), part.uvs.begin(), part.uvs.end());
  to.colors.insert(to.colors.end(), part.colors.begin(), part.colors.end());
  for (const Triangle& t : part.triangles) to.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

std::vector<CapturedSurface> read_gltf_room(const fs::path& file) {
  const GltfScene scene = read_gltf_scene(file);
  const bool is_srgb = scene.generator.find("trimesh") != std::string::npos;
  std::map<int, CapturedSurface> of_texture;  // -1: none
  for (const GltfPart& part : scene.parts) {
    const VisualMaterial& material = scene.materials[std::size_t(part.material)];
    const VisualMesh mesh = colored_part(part, material, is_srgb && !part.mesh.colors.empty());
    const int texture = mesh.uvs.empty() ? -1 : material.texture;
    CapturedSurface& surface = of_texture[texture];
    append_part(mesh, surface.mesh);
    if (texture >= 0) surface.texture = scene.textures[std::size_t(texture)];
  }
  std::vector<CapturedSurface> surfaces;
  for (auto& [texture, surface] : of_texture) surfaces.push_back(std::move(surface));
  return surfaces;
}

// Points that look the same are one; those that no triangle uses, and triangles without area, go.
VisualMesh unified_look(const VisualMesh& mesh) {
  VisualMesh out;
  std::map<std::array<float, 8>, std::uint32_t> known;
  for (const Triangle& t : mesh.triangles) {
    if (!(surface_area(mesh.points, {t}) > 0)) continue;
    Triangle kept;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f &p = mesh.points[t[k]], &c = mesh.colors[t[k]];
      const Vec2f uv = mesh.uvs.empty() ? Vec2f::Zero() : mesh.uvs[t[k]];
      const auto [at, is_new] =
          known.insert({{p.x(), p.y(), p.z(), c.x(), c.y(), c.z(), uv.x(), uv.y()}, std::uint32_t(out.points.size())});
      kept[k] = at->second;
      if (!is_new) continue;
      out.points.push_back(p);
      out.colors.push_back(c);
      if (!mesh.uvs.empty()) out.uvs.push_back(uv);
    }
    out.triangles.push_back(kept);
  }
  return out;
}

// All surfaces as one, whose points are one where they are at the same place; triangles in the same order.
VisualMesh joined_at_places(const std::vector<CapturedSurface>& surfaces) {
  VisualMesh out;
  std::map<std::array<float, 3>, std::uint32_t> known;
  for (const CapturedSurface& surface : surfaces)
    for (const Triangle& t : surface.mesh.triangles) {
      Triangle joined;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3f& p = surface.mesh.points[t[k]];
        const auto [at, is_new] = known.insert({{p.x(), p.y(), p.z()}, std::uint32_t(out.points.size())});
        joined[k] = at->second;
        if (!is_new) continue;
        out.points.push_back(p);
        out.colors.push_back(surface.mesh.colors[t[k]]);
      }
      out.triangles.push_back(joined);
    }
  return out;
}

void remove_loose_pieces(double least_area, std::vector<CapturedSurface>& surfaces) {
  const VisualMesh all = joined_at_places(surfaces);
  const std::vector<bool> stays = in_large_pieces(all.points, all.triangles, least_area);
  std::size_t at = 0;
  for (CapturedSurface& surface : surfaces) {
    std::vector<Triangle> kept;
    for (const Triangle& t : surface.mesh.triangles)
      if (stays[at++]) kept.push_back(t);
    surface.mesh.triangles = std::move(kept);
    surface.mesh = unified_look(surface.mesh);
  }
  std::erase_if(surfaces, [](const CapturedSurface& surface) { return surface.mesh.triangles.empty(); });
}

void check_size(const std::vector<CapturedSurface>& surfaces) {
  Eigen::AlignedBox3f box;
  for (const CapturedSurface& surface : surfaces)
    for (const Vec3f& p : surface.mesh.points) {
      if (!p.allFinite()) throw UsageError("a point of the mesh is not finite; export it again");
      box.extend(p);
    }
  const double size = box.isEmpty() ? 0 : double(box.sizes().maxCoeff());
  if (size < LEAST_ROOM || size > LARGEST_ROOM)
    throw UsageError(
        fmt::format("the mesh is {:.3g} m large, which no room is; give the metres per unit by --scale", size));
}

}  // namespace

std::vector<CapturedSurface> read_room_mesh(const fs::path& file) {
  const std::string ending = ending_of(file);
  std::vector<CapturedSurface> surfaces;
  if (ending == ".glb" || ending == ".gltf") {
    surfaces = read_gltf_room(file);
  } else {
    surfaces.push_back({read_colored_mesh(file), {}});
    VisualMesh& mesh = surfaces[0].mesh;
    mesh.uvs.clear();  // of a texture that is not read
    if (mesh.colors.empty()) mesh.colors.assign(mesh.points.size(), Vec3f::Constant(0.5f));
  }
  return surfaces;
}

Room room_of_mesh(std::vector<CapturedSurface> surfaces, const RoomSettings& settings, const Vec3& up,
                  const std::function<void(const std::string&)>& say) {
  check_size(surfaces);
  for (CapturedSurface& surface : surfaces) surface.mesh = unified_look(surface.mesh);
  remove_loose_pieces(settings.least_piece, surfaces);
  if (surfaces.empty()) throw UsageError("nothing is left of the mesh: each piece is smaller than --least-piece");
  std::size_t n = 0;
  for (const CapturedSurface& surface : surfaces) n += surface.mesh.triangles.size();
  if (settings.most_triangles > 0 && n > settings.most_triangles) {
    say(fmt::format("simplifying {} triangles", n));
    for (CapturedSurface& surface : surfaces)
      surface.mesh =
          simplified(surface.mesh, settings.most_triangles * surface.mesh.triangles.size() / n, settings.fusion.voxel);
  }
  Room room;
  room.mesh = joined_at_places(surfaces);
  room.looks = std::move(surfaces);
  room.share_colored = 1;
  const EdgeCounts edges = count_edges(room.mesh.triangles);
  room.n_boundary_edges = edges.boundary;
  room.n_crowded_edges = edges.crowded;
  say("finding planes");
  place_room(settings, up, Vec3(-1e6, 0, 0), room);  // x stays as it was, as nearly as the ground's sides allow
  return room;
}

}  // namespace pvg
