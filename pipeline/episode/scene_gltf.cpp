#include "pipeline/episode/scene_gltf.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "host/formats/gltf_writer.hpp"
#include "host/formats/picture_files.hpp"
#include "host/render/camera.hpp"
#include "host/render/lights.hpp"
#include "host/render/soft_visual.hpp"

namespace pvg {
namespace {

using Floats = GltfWriter::Floats;
using Value = tinygltf::Value;

std::vector<double> doubles(const Vec3f& v) { return {v.x(), v.y(), v.z()}; }

Value value_of(const Vec3f& v) {
  return Value(Value::Array{Value(double(v.x())), Value(double(v.y())), Value(double(v.z()))});
}

std::vector<double> matrix_of(const Eigen::Matrix4d& m) { return {m.data(), m.data() + 16}; }  // by columns, as in glTF

class SceneWriter {
 public:
  SceneWriter(const Scene& scene, const SceneState& state) : scene_(scene), state_(state), out_(scene.name) {}

  GltfWriter& write() {
    texture_.assign(scene_.textures.size(), -1);
    for (const VisualMaterial& material : scene_.materials) add_material(material);
    mesh_.assign(scene_.visual_meshes.size(), {});
    for (const Visual& visual : scene_.visuals) add_visual(visual);
    add_lights();
    for (const Camera& camera : scene_.cameras) add_camera(camera);
    return out_;
  }

 private:
  void use(const std::string& extension) {
    auto& used = out_.model.extensionsUsed;
    if (std::find(used.begin(), used.end(), extension) == used.end()) used.push_back(extension);
  }
  void extend(tinygltf::Material& material, const std::string& extension, Value::Object fields) {
    use(extension);
    material.extensions[extension] = Value(std::move(fields));
  }

  int texture(int i) {
    int& index = texture_.at(std::size_t(i));
    if (index < 0) index = out_.add_texture(scene_.textures[std::size_t(i)]);
    return index;
  }

  void add_material(const VisualMaterial& from) {
    tinygltf::Material to;
    to.name = from.name;
    const GltfModel model = kind_of(from).gltf;
    const bool is_glass = model == GltfModel::glass, is_coated = model == GltfModel::coated;
    const bool is_metal = model == GltfModel::metal, shines = model == GltfModel::shining;
    tinygltf::PbrMetallicRoughness& pbr = to.pbrMetallicRoughness;
    pbr.baseColorFactor = {from.color.x(), from.color.y(), from.color.z(), from.opacity};
    to.alphaMode = std::array{"OPAQUE", "MASK", "BLEND"}[std::size_t(from.alpha_mode)];
    to.alphaCutoff = from.alpha_cutoff;
    pbr.metallicFactor = is_metal ? 1 : is_coated ? from.metallic : 0;
    pbr.roughnessFactor = is_metal || is_glass || is_coated ? from.roughness : 1;
    if (from.texture >= 0 && !shines) pbr.baseColorTexture.index = texture(from.texture);
    if (from.metallic_roughness_texture >= 0)
      pbr.metallicRoughnessTexture.index = texture(from.metallic_roughness_texture);
    if (from.normal_texture >= 0) {
      to.normalTexture.index = texture(from.normal_texture);
      to.normalTexture.scale = from.normal_scale;
    }
    if (model == GltfModel::plain) extend(to, "KHR_materials_specular", {{"specularFactor", Value(0.0)}});
    if (model == GltfModel::unlit) extend(to, "KHR_materials_unlit", {});
    if (model == GltfModel::cloth)
      extend(
          to, "KHR_materials_sheen",
          {{"sheenColorFactor", value_of(from.sheen)}, {"sheenRoughnessFactor", Value(double(from.sheen_roughness))}});
    if (is_glass || is_coated) add_inside(from, is_glass ? 1 : from.transmission, to);
    if (shines || is_coated) add_emission(from.emission, to);
    if (shines) pbr.baseColorFactor = {0, 0, 0, from.opacity};
    const int shining = shines ? from.texture : from.emission_texture;
    if (shining >= 0) to.emissiveTexture.index = texture(shining);
    const auto set = [&](unsigned bit) { return from.on_second_uvs & bit ? 1 : 0; };
    pbr.baseColorTexture.texCoord = set(VisualMaterial::color_bit);
    pbr.metallicRoughnessTexture.texCoord = set(VisualMaterial::metallic_roughness_bit);
    to.normalTexture.texCoord = set(VisualMaterial::normal_bit);
    to.emissiveTexture.texCoord = set(shines ? VisualMaterial::color_bit : VisualMaterial::emission_bit);
    to.doubleSided = !is_glass;
    out_.model.materials.push_back(to);
  }

  void add_inside(const VisualMaterial& from, double transmission, tinygltf::Material& to) {
    extend(to, "KHR_materials_ior", {{"ior", Value(double(from.index_of_refraction))}});
    if (transmission == 0) return;
    extend(to, "KHR_materials_transmission", {{"transmissionFactor", Value(transmission)}});
    if (from.is_thin) return;
    Value::Object volume = {{"thicknessFactor", Value(1.0)}};
    const float strongest = from.absorption.maxCoeff();
    if (strongest > 0) {
      // exp(-sigma d) at the depth d where the strongest channel has fallen to 1/e
      volume["attenuationDistance"] = Value(1.0 / double(strongest));
      volume["attenuationColor"] = value_of((-from.absorption / strongest).array().exp().matrix());
    }
    extend(to, "KHR_materials_volume", volume);
  }

  void add_emission(const Vec3f& radiance, tinygltf::Material& to) {
    const float strength = std::max(1.0f, radiance.maxCoeff());
    to.emissiveFactor = doubles(radiance / strength);
    if (strength > 1) extend(to, "KHR_materials_emissive_strength", {{"emissiveStrength", Value(double(strength))}});
  }

  tinygltf::Primitive primitive_of(const VisualMesh& mesh) {
    Floats points, normals, uvs, second_uvs, colors;
    for (const Vec3f& c : mesh.colors) colors.insert(colors.end(), c.data(), c.data() + 3);
    for (const Vec3f& p : mesh.points) points.insert(points.end(), p.data(), p.data() + 3);
    for (const Vec3f& n : mesh.normals) normals.insert(normals.end(), n.data(), n.data() + 3);
    for (const Vec2f& uv : mesh.uvs) uvs.insert(uvs.end(), uv.data(), uv.data() + 2);
    for (const Vec2f& uv : mesh.second_uvs) second_uvs.insert(second_uvs.end(), uv.data(), uv.data() + 2);
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.attributes["POSITION"] = out_.add_vectors(points, TINYGLTF_TARGET_ARRAY_BUFFER);
    if (!normals.empty()) primitive.attributes["NORMAL"] = out_.add_vectors(normals, TINYGLTF_TARGET_ARRAY_BUFFER);
    const auto add_pairs = [&](const Floats& pairs) {
      return out_.add(pairs, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC2, 2, TINYGLTF_TARGET_ARRAY_BUFFER);
    };
    if (!uvs.empty()) primitive.attributes["TEXCOORD_0"] = add_pairs(uvs);
    if (!second_uvs.empty()) primitive.attributes["TEXCOORD_1"] = add_pairs(second_uvs);
    if (!colors.empty()) primitive.attributes["COLOR_0"] = out_.add_vectors(colors, TINYGLTF_TARGET_ARRAY_BUFFER);
    primitive.indices = out_.add_triangles(mesh.triangles);
    return primitive;
  }

  void add_primitive(const std::string& name, tinygltf::Primitive primitive, int material,
                     const Eigen::Matrix4d& pose) {
    primitive.material = material;
    tinygltf::Mesh mesh;
    mesh.name = name;
    mesh.primitives.push_back(primitive);
    out_.model.meshes.push_back(mesh);
    tinygltf::Node node;
    node.name = name;
    node.mesh = int(out_.model.meshes.size()) - 1;
    node.matrix = matrix_of(pose);
    out_.add_node(node);
  }

  void add_visual(const Visual& visual) {
    Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
    if (visual.soft >= 0 || visual.cloth >= 0)
      return add_primitive(visual.name, primitive_of(deformed(visual)), visual.material, pose);
    // meshes that several visuals show stand once in the file
    tinygltf::Primitive& shared = mesh_.at(std::size_t(visual.mesh));
    if (shared.attributes.empty()) shared = primitive_of(scene_.visual_meshes[std::size_t(visual.mesh)]);
    if (visual.rigid >= 0) pose.topRows<3>() = state_.rigid[std::size_t(visual.rigid)];
    add_primitive(visual.name, shared, visual.material, pose * visual.pose.matrix());
  }

  VisualMesh deformed(const Visual& visual) const {
    const CarriedMesh carried = carried_mesh(scene_, visual);
    VisualMesh mesh = carried.rest;
    const std::vector<Vec3>& nodes =
        visual.soft >= 0 ? state_.soft[std::size_t(visual.soft)] : state_.cloth[std::size_t(visual.cloth)];
    mesh.points.clear();
    for (const Vec3& p : multiply(carried.weights, nodes)) mesh.points.push_back(p.cast<float>());
    if (!mesh.normals.empty()) mesh.normals = moved_normals(carried, mesh.points);
    return mesh;
  }

  void add_light(const std::string& name, const Vec3f& radiance, const VisualMesh& mesh, const Eigen::Matrix4d& pose) {
    tinygltf::Material material;
    material.name = name;
    material.pbrMetallicRoughness.baseColorFactor = {0, 0, 0, 1};
    add_emission(radiance, material);
    out_.model.materials.push_back(material);
    add_primitive(name, primitive_of(mesh), int(out_.model.materials.size()) - 1, pose);
  }

  void add_lights() {
    for (const RectangleLight& light : scene_.lights) {
      Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
      pose.topRows<3>() << light.edge_u, light.edge_v, light.edge_u.cross(light.edge_v).normalized(), light.corner;
      add_light(light.name, light.radiance, light_square(), pose);
    }
    for (const SphereLight& light : scene_.sphere_lights) {
      Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
      pose.topLeftCorner<3, 3>() *= light.radius;
      pose.topRightCorner<3, 1>() = light.center;
      add_light(light.name, light.radiance, light_sphere(), pose);
    }
  }

  void add_camera(const Camera& from) {
    tinygltf::Camera camera;
    camera.name = from.name;
    camera.type = "perspective";
    camera.perspective.yfov = 2 * std::atan(from.height / 2.0 / from.fy);
    camera.perspective.aspectRatio = double(from.width) / from.height;
    camera.perspective.znear = 1e-3;
    camera.perspective.zfar = 1e3;
    out_.model.cameras.push_back(camera);
    tinygltf::Node node;
    node.name = from.name;
    node.camera = int(out_.model.cameras.size()) - 1;
    // glTF's cameras look along -z with y up
    const Eigen::Vector4d flip(1, -1, -1, 1);
    node.matrix = matrix_of(camera_to_world(from, state_) * flip.asDiagonal());
    out_.add_node(node);
  }

  const Scene& scene_;
  const SceneState& state_;
  GltfWriter out_;
  std::vector<int> texture_;               // [Scene::textures] index in the file, -1: not written yet
  std::vector<tinygltf::Primitive> mesh_;  // [Scene::visual_meshes] likewise
};

}  // namespace

void write_scene_gltf(const std::filesystem::path& file, const Scene& scene, const SceneState& state) {
  SceneWriter(scene, state).write().write(file);
}

}  // namespace pvg
