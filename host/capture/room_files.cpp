#include "host/capture/room_files.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "host/base/atomic_files.hpp"
#include "host/formats/gltf_writer.hpp"
#include "host/formats/mesh_files.hpp"
#include "host/geometry/primitive_shapes.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

constexpr double PLAIN = 0.5;  // reflectance of what has no colours, as of an object without visuals

using nlohmann::ordered_json;

template <class Vector>
std::vector<float> packed(const std::vector<Vector>& v) {
  std::vector<float> out;
  for (const Vector& p : v) out.insert(out.end(), p.begin(), p.end());
  return out;
}

std::string pose_text(const Pose& pose) {
  const Vec3 t = pose.translation();
  const Eigen::Quaterniond q(pose.linear());
  return fmt::format("{{position: [{:.9g}, {:.9g}, {:.9g}], quaternion: [{:.9g}, {:.9g}, {:.9g}, {:.9g}]}}", t.x(),
                     t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
}

// of the depth cameras' optical frames in the capture's frame
std::string poses_text(const Room& room) {
  std::string text = "frame,x,y,z,qx,qy,qz,qw\n";
  for (std::size_t i = 0; i < room.frame_names.size(); ++i) {
    const Vec3 t = room.refinement->poses[i].translation();
    const Eigen::Quaterniond q(room.refinement->poses[i].linear());
    text += fmt::format("{},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}\n", room.frame_names[i], t.x(),
                        t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  }
  return text;
}

// of a room that was here before; this one may have fewer
void remove_planes_and_poses(const fs::path& folder) {
  fs::remove(folder / "poses.csv");
  fs::remove(folder / "surface.obj");
  std::vector<fs::path> planes;
  for (const auto& entry : fs::directory_iterator(folder))
    if (const std::string name = entry.path().filename().string();
        name.starts_with("plane_") && entry.path().extension() == ".obj")
      planes.push_back(entry.path());
  for (const fs::path& plane : planes) fs::remove(plane);
}

}  // namespace

void write_captured_meshes(const fs::path& file, std::span<const NamedMesh> meshes, bool is_unlit) {
  GltfWriter out(meshes.front().name);
  for (const auto& [name, mesh, texture] : meshes) {
    if (mesh->triangles.empty()) continue;
    tinygltf::Material material;
    material.name = name;
    material.doubleSided = true;
    material.pbrMetallicRoughness.metallicFactor = 0;
    if (is_unlit) material.extensions["KHR_materials_unlit"] = tinygltf::Value(tinygltf::Value::Object{});
    // white without loss would outshine everything, and its light would never end
    if (!is_unlit && !texture && mesh->colors.empty())
      material.pbrMetallicRoughness.baseColorFactor = {PLAIN, PLAIN, PLAIN, 1};
    if (texture && !texture->rgba.empty())
      material.pbrMetallicRoughness.baseColorTexture.index = out.add_texture(*texture);
    tinygltf::Primitive part;
    part.mode = TINYGLTF_MODE_TRIANGLES;
    part.material = int(out.model.materials.size());
    out.model.materials.push_back(material);
    part.attributes["POSITION"] = out.add_vectors(packed(mesh->points), TINYGLTF_TARGET_ARRAY_BUFFER);
    if (!mesh->normals.empty())
      part.attributes["NORMAL"] = out.add_vectors(packed(mesh->normals), TINYGLTF_TARGET_ARRAY_BUFFER);
    if (!mesh->colors.empty())
      part.attributes["COLOR_0"] = out.add(packed(mesh->colors), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, 3,
                                           TINYGLTF_TARGET_ARRAY_BUFFER);
    if (!mesh->uvs.empty())
      part.attributes["TEXCOORD_0"] = out.add(packed(mesh->uvs), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC2, 2,
                                              TINYGLTF_TARGET_ARRAY_BUFFER);
    part.indices = out.add_triangles(mesh->triangles);
    tinygltf::Node node;
    node.name = name;
    node.mesh = int(out.model.meshes.size());
    tinygltf::Mesh shape;
    shape.name = name;
    shape.primitives.push_back(part);
    out.model.meshes.push_back(shape);
    out.add_node(node);
  }
  if (is_unlit) out.model.extensionsUsed.push_back("KHR_materials_unlit");
  out.write(file);
}

void write_captured_mesh(const fs::path& file, const VisualMesh& mesh, const std::string& name, bool is_unlit) {
  const NamedMesh named{name, &mesh, nullptr};
  write_captured_meshes(file, {&named, 1}, is_unlit);
}

TriangleMesh plane_box(const CapturedPlane& plane) {
  TriangleMesh box = box_surface(Vec3(plane.width, plane.height, PLANE_THICKNESS));
  Vec3 center = Vec3::Zero();
  for (const Vec3& p : box.points) center += p / double(box.points.size());
  for (Vec3& p : box.points) p = plane.pose * (p - center - Vec3(0, 0, PLANE_THICKNESS / 2));
  return box;
}

void write_room(const fs::path& folder, const Room& room, const RoomSettings& settings) {
  std::vector<NamedMesh> meshes;
  for (std::size_t i = 0; i < room.looks.size(); ++i)
    meshes.push_back({i == 0 ? "room" : fmt::format("room {}", i + 1), &room.looks[i].mesh, &room.looks[i].texture});
  meshes.push_back({"guessed background", &room.background, nullptr});
  write_captured_meshes(folder / "room.glb", meshes, true);
  remove_planes_and_poses(folder);
  if (room.refinement) write_text_atomically(folder / "poses.csv", poses_text(room));
  std::string text =
      "# A captured room: `background: {capture: FOLDER}` in a task shows it and puts its planes under the bodies.\n"
      "# Metres; room frame: z up" +
      std::string(room.is_placed     ? ", the frame of the tags\n"
                  : room.ground >= 0 ? ", z = 0 on the plane `ground`\n"
                                     : "? no plane that faces up was found\n");
  text += "schema: 1\nmesh: room.glb\n";
  text += "capture_to_room: " + pose_text(room.room_from_capture) + "\n";
  if (room.n_frames > 0) text += fmt::format("voxel: {:.9g}\n", settings.fusion.voxel);
  if (!room.solid.triangles.empty()) {
    write_text_atomically(folder / "surface.obj", obj_text(room.solid));
    text += "surface: surface.obj    # for `contact: surface`\n";
  }
  text += fmt::format("ground: {}\n", room.ground >= 0 ? fmt::format("plane_{}", room.ground) : "none");
  text += "# size: of the rectangle [m]; roughness: of the surface on it [m]; sigmas: of the plane's place and tilt\n";
  text += "planes:\n";
  for (std::size_t i = 0; i < room.planes.size(); ++i) {
    const CapturedPlane& p = room.planes[i];
    write_text_atomically(folder / fmt::format("plane_{}.obj", i), obj_text(plane_box(p)));
    text += fmt::format(
        "  - {{name: plane_{}, mesh: plane_{}.obj, size: [{:.6g}, {:.6g}], area: {:.6g}, roughness: {:.4g}, "
        "height_sigma: {:.3g}, tilt_sigma: {:.3g},\n     pose: {}}}\n",
        i, i, p.width, p.height, p.area, p.roughness, p.height_sigma, p.tilt_sigma, pose_text(p.pose));
  }
  if (room.planes.empty()) text += "  []\n";
  write_text_atomically(folder / "room.yaml", text);
}

namespace {

ordered_json triple(const auto& v) { return {v.x(), v.y(), v.z()}; }

ordered_json quaternion_of(const Pose& pose) {
  const Eigen::Quaterniond q(pose.linear());
  return {q.x(), q.y(), q.z(), q.w()};
}

ordered_json planes_report(const Room& room) {
  ordered_json planes = ordered_json::array();
  for (std::size_t i = 0; i < room.planes.size(); ++i) {
    const CapturedPlane& p = room.planes[i];
    planes.push_back({{"name", fmt::format("plane_{}", i)},
                      {"is_ground", int(i) == room.ground},
                      {"center", triple(p.pose.translation())},
                      {"normal", triple(p.pose.linear().col(2))},
                      {"size", {p.width, p.height}},
                      {"area", p.area},
                      {"roughness", p.roughness},
                      {"height_sigma", p.height_sigma},
                      {"tilt_sigma", p.tilt_sigma}});
  }
  return planes;
}

ordered_json mesh_report(const Room& room) {
  return {{"vertices", room.mesh.points.size()},     {"triangles", room.mesh.triangles.size()},
          {"closed", room.n_boundary_edges == 0},    {"manifold", room.n_crowded_edges == 0},
          {"self_intersections", nullptr},  // not looked for: contact takes the planes
          {"boundary_edges", room.n_boundary_edges}, {"share_colored", room.share_colored}};
}

ordered_json surface_report(const Room& room) {
  const auto at = [&](std::size_t percent) {
    return room.solid_distances[(room.solid_distances.size() - 1) * percent / 100];
  };
  return {{"triangles", room.solid.triangles.size()},
          {"distance_median", at(50)},
          {"distance_p95", at(95)},
          {"distance_max", at(100)}};
}

ordered_json distance_report(const DepthErrors& d) {
  return {{"mean", d.mean}, {"median", d.median},   {"p90", d.p90},         {"p95", d.p95},
          {"max", d.max},   {"covered", d.covered}, {"frames", d.n_frames}, {"held_out", d.are_held_out}};
}

ordered_json exposure_report(const std::vector<Vec3f>& gains) {
  Vec3f least = gains.front(), most = least;
  for (const Vec3f& gain : gains) {
    least = least.cwiseMin(gain);
    most = most.cwiseMax(gain);
  }
  return {{"least_gain", triple(least)}, {"largest_gain", triple(most)}};
}

ordered_json refinement_report(const PoseRefinement& r, const Room& room) {
  ordered_json kept = ordered_json::array();
  for (const UnrefinedFrame& f : r.unrefined) kept.push_back({{"name", f.name}, {"share_near_others", f.share}});
  ordered_json out = {{"mean_shift", r.mean_shift},
                      {"largest_shift", r.largest_shift},
                      {"mean_turn", r.mean_turn},
                      {"largest_turn", r.largest_turn},
                      {"distance_before", r.distance_before},
                      {"distance_after", r.distance_after},
                      {"photo_disagreement_before", r.disagreement_before},
                      {"photo_disagreement_after", r.disagreement_after},
                      {"sweeps", r.n_sweeps},
                      {"cpu_ms_per_frame", r.cpu_ms_per_frame},
                      {"not_refined", kept}};
  if (room.depth_as_given)
    out["left_out_as_given"] = {{"median", room.depth_as_given->median},
                                {"p90", room.depth_as_given->p90},
                                {"p95", room.depth_as_given->p95},
                                {"covered", room.depth_as_given->covered}};
  return out;
}

ordered_json color_camera_report(const ColorOffset& offset) {
  return {{"offset", triple(offset.pose.translation())},
          {"quaternion", quaternion_of(offset.pose)},
          {"focal_scale", offset.focal_scale},
          {"center_shift", {offset.center[0], offset.center[1]}},
          {"disagreement_before", offset.disagreement_before},
          {"disagreement_after", offset.disagreement_after},
          {"disagreement_moved", offset.disagreement_moved}};
}

ordered_json photos_report(const PhotoErrors& p) {
  ordered_json out = {{"frames", p.n_frames},
                      {"psnr", p.psnr},
                      {"ssim", p.ssim},
                      {"psnr_covered", p.psnr_covered},
                      {"psnr_lut", p.psnr_lut},
                      {"ssim_lut", p.ssim_lut},
                      {"psnr_covered_lut", p.psnr_covered_lut},
                      {"psnr_diffuse", p.psnr_diffuse},
                      {"ssim_diffuse", p.ssim_diffuse},
                      {"psnr_diffuse_lut", p.psnr_diffuse_lut},
                      {"ssim_diffuse_lut", p.ssim_diffuse_lut},
                      {"covered", p.covered},
                      {"drawn", p.drawn},
                      {"placement",
                       {{"mean_shift", p.placement.mean_shift},
                        {"largest_shift", p.placement.largest_shift},
                        {"mean_turn", p.placement.mean_turn},
                        {"largest_turn", p.placement.largest_turn},
                        {"psnr_lut_before", p.placement.psnr_lut},
                        {"ssim_lut_before", p.placement.ssim_lut}}}};
  for (const LeftOutPhoto& photo : p.each) {
    const Camera& c = photo.camera;
    out["each"].push_back({{"file", photo.file},
                           {"position", triple(c.pose.translation())},
                           {"quaternion", quaternion_of(c.pose)},
                           {"intrinsics", {c.fx, c.fy, c.cx, c.cy}},
                           {"size", {c.width, c.height}},
                           {"psnr_lut", photo.psnr_lut},
                           {"ssim_lut", photo.ssim_lut}});
  }
  return out;
}

}  // namespace

ordered_json room_report(const Room& room, const RoomSettings& settings, double seconds, std::size_t peak_bytes) {
  ordered_json out = {{"schema", 1},  {"mesh", mesh_report(room)}, {"planes", planes_report(room)},
                      {"scale", 1.0}, {"seconds", seconds},        {"peak_bytes", peak_bytes}};
  if (!room.solid.triangles.empty()) out["surface"] = surface_report(room);
  if (room.n_frames > 0) {
    out["distance"] = distance_report(room.depth);
    out["fusion"] = {{"frames", room.n_frames},           {"voxel", settings.fusion.voxel},
                     {"blocks", room.n_blocks},           {"voxel_bytes", room.voxel_bytes},
                     {"ms_per_frame", room.ms_per_frame}, {"cpu_ms_per_frame", room.cpu_ms_per_frame}};
  }
  out["background"] = {{"triangles", room.background.triangles.size()}, {"is_guessed", true}};
  for (const CapturedSurface& look : room.looks)
    if (!look.texture.rgba.empty())
      out["textures"].push_back({{"width", look.texture.width}, {"height", look.texture.height}});
  if (!room.gains.empty()) out["exposure"] = exposure_report(room.gains);
  if (room.refinement) out["refinement"] = refinement_report(*room.refinement, room);
  if (room.color_offset) out["color_camera"] = color_camera_report(*room.color_offset);
  if (room.photos) out["photos"] = photos_report(*room.photos);
  return out;
}

}  // namespace pvg
