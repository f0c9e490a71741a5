#include "host/load/read_sections.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "host/model/metals.hpp"

namespace pvg {
namespace {

using Section = YamlSection;
constexpr double PI = std::numbers::pi;

// about the fixed axes x, y, z in this order
Mat3 from_roll_pitch_yaw(const Vec3& angles) {
  using Eigen::AngleAxisd;
  return (AngleAxisd(angles.z(), Vec3::UnitZ()) * AngleAxisd(angles.y(), Vec3::UnitY()) *
          AngleAxisd(angles.x(), Vec3::UnitX()))
      .toRotationMatrix();
}

// An optical frame at `position` whose z axis meets `look_at`; `up` is upward in the picture.
Pose read_camera_pose(Section& section) {
  if (!section.has("look_at")) return read_pose(section);
  const Vec3 position = section.vector("position", Unit::length, -REACH, REACH);
  const Vec3 forward = section.vector("look_at", Unit::length, -REACH, REACH) - position;
  const Vec3 up = section.vector("up", Unit::none, -1e6, 1e6, Vec3::UnitZ());
  const Vec3 right = forward.cross(up);
  if (!(right.norm() > 1e-9 * forward.norm() * up.norm()))
    section.fail("look_at", "must not lie along `up` from `position`");
  Pose pose = Pose::Identity();
  pose.translation() = position;
  pose.linear().col(0) = right.normalized();
  pose.linear().col(2) = forward.normalized();
  pose.linear().col(1) = pose.linear().col(2).cross(pose.linear().col(0));
  return pose;
}

float share(Section& section, const std::string& key, double otherwise) {
  return float(section.number(key, Unit::none, 0, 1, otherwise));
}

// what light that enters a solid or sheet meets
void read_inside(Section& section, VisualMaterial& material) {
  material.index_of_refraction = float(section.number("index_of_refraction", Unit::none, 1, 4, 1.5));
  material.absorption = read_color(section, "absorption", Vec3f::Zero(), 1e6, Unit::per_length);
  material.is_thin = section.boolean("thin", false);
  material.priority = section.integer("priority", 0, 1000, 0);
  if (material.is_thin && !material.absorption.isZero())
    section.fail("absorption", "is of no use: a thin sheet has no inside; tint it with `color`");
}

// where the surface is not there
void read_alpha(Section& section, VisualMaterial& material) {
  using Mode = VisualMaterial::AlphaMode;
  material.alpha_mode = Mode(section.choice("alpha_mode", {"opaque", "mask", "blend"}, 0));
  if (material.alpha_mode == Mode::opaque) return;
  material.opacity = share(section, "opacity", 1);
  if (material.alpha_mode == Mode::mask) material.alpha_cutoff = share(section, "alpha_cutoff", 0.5);
}

// a measured metal's colours, if it names one
void read_metal(Section& section, VisualMaterial& material) {
  material.roughness = share(section, "roughness", 0.3);
  if (!section.has("metal")) return;
  if (section.has("color")) section.fail("metal", "and `color` exclude each other: the metal has its own");
  const std::size_t metal = section.choice("metal", metal_names());
  material.color = metal_reflectance(metal, 1).cast<float>();
  material.edge_dip = metal_edge_dip(metal).cast<float>();
}

VisualMaterial read_material(Section& section, std::vector<std::filesystem::path>* textures) {
  using Kind = VisualMaterial::Kind;
  VisualMaterial material;
  const auto read_texture_file = [&](const std::string& key, int& index) {
    if (!textures || !section.has(key)) return;
    index = int(textures->size());
    textures->push_back(section.file(key));
  };
  material.name = section.text("name");
  material.kind = Kind(section.choice(
      "kind", {"diffuse", "conductor", "dielectric", "emissive", "shadow_receiver", "metallic_roughness", "cloth"}));
  const bool is_glass = material.kind == Kind::dielectric;
  material.color = read_color(section, "color", is_glass ? Vec3f::Ones() : material.color, 1);
  read_texture_file("texture", material.texture);
  read_texture_file("normal_texture", material.normal_texture);
  if (material.normal_texture >= 0)
    material.normal_scale = float(section.number("normal_scale", Unit::none, 0, 100, 1));
  if (!is_glass) read_alpha(section, material);
  if (material.kind == Kind::conductor) read_metal(section, material);
  if (is_glass) {
    material.roughness = share(section, "roughness", 0);
    read_inside(section, material);
  }
  if (material.kind == Kind::emissive)
    material.emission = section.vector("emission", Unit::radiance, 0, 1e6).cast<float>();
  if (material.kind == Kind::shadow_receiver) material.shadow_strength = share(section, "shadow_strength", 1);
  if (material.kind == Kind::metallic_roughness) {
    material.roughness = share(section, "roughness", 1);
    material.metallic = share(section, "metallic", 0);
    material.transmission = share(section, "transmission", 0);
    material.emission = read_color(section, "emission", Vec3f::Zero(), 1e6, Unit::radiance);
    read_texture_file("metallic_roughness_texture", material.metallic_roughness_texture);
    read_texture_file("emission_texture", material.emission_texture);
    read_inside(section, material);
  }
  if (material.kind == Kind::cloth) {
    material.sheen = read_color(section, "sheen", Vec3f::Constant(0.3f), 1);
    material.sheen_roughness = float(section.number("sheen_roughness", Unit::none, 0.5, 1, material.sheen_roughness));
  }
  section.done();
  return material;
}

// `intrinsics` or `vertical_field_of_view`, in units of the picture's size
void read_intrinsics(Section& section, CameraSection& camera) {
  if (!section.has("intrinsics")) {
    camera.vertical_field_of_view = section.number("vertical_field_of_view", Unit::angle, 0.01, 3.0);
    return;
  }
  if (section.has("vertical_field_of_view"))
    section.fail("intrinsics", "and `vertical_field_of_view` exclude each other");
  const std::vector<double> k = section.numbers("intrinsics", Unit::none, -1e7, 1e7);
  if (k.size() != 4) section.fail("intrinsics", "must be [fx, fy, cx, cy] in pixels");
  if (!(k[0] > 1e-3 && k[1] > 1e-3)) section.fail("intrinsics", "must have focal lengths fx and fy above 0");
  camera.intrinsics = {k[0] / camera.height, k[1] / camera.height, (k[2] + 0.5) / camera.width,
                       (k[3] + 0.5) / camera.height};
}

// what a real camera adds
void read_optics(Section& section, Camera& optics) {
  optics.model = Camera::Model(section.choice("model", {"pinhole", "fisheye"}, 0));
  const bool is_fisheye = optics.model == Camera::Model::fisheye;
  if (section.has("distortion")) optics.distortion = section.numbers("distortion", Unit::none, -1e4, 1e4);
  const std::size_t n = optics.distortion.size();
  if (is_fisheye ? n != 0 && n != 4 : n != 0 && n != 4 && n != 5 && n != 8)
    section.fail("distortion", is_fisheye ? "must be OpenCV's k1 k2 k3 k4 of a fisheye"
                                          : "must be OpenCV's 4, 5 or 8 numbers k1 k2 p1 p2 k3 k4 k5 k6");
  optics.lens_radius = section.number("lens_radius", Unit::length, 0, 1, 0);
  if (is_fisheye && optics.lens_radius > 0) section.fail("lens_radius", "is not for a fisheye: all is sharp there");
  if (optics.lens_radius > 0) optics.focus_distance = section.number("focus_distance", Unit::length, 1e-4, 1e5);
  optics.exposure_time = section.number("exposure_time", Unit::time, 0, 100, 0);
  optics.row_time = section.number("row_time", Unit::time, 0, 1, 0);
  if (section.has("vignetting")) optics.vignetting = section.numbers("vignetting", Unit::none, -10, 10);
  if (optics.vignetting.size() > 3) section.fail("vignetting", "must be up to three numbers v1 v2 v3");
  optics.full_well = section.number("full_well", Unit::none, 0, 1e9, 0);
  optics.read_noise = section.number("read_noise", Unit::none, 0, 1e6, 0);
  if (optics.read_noise > 0 && optics.full_well == 0)
    section.fail("read_noise", "is in electrons and needs `full_well`, their number at value 1");
}

}  // namespace

SampledPose read_sampled_pose(Section& parent) {
  SampledPose pose;
  if (!parent.has("pose")) return pose;
  Section section = parent.section("pose");
  pose.object = section.text("object", "");
  pose.x = section.range("x", Unit::length, -REACH, REACH, 0);
  pose.y = section.range("y", Unit::length, -REACH, REACH, 0);
  pose.z = section.range("z", Unit::length, -REACH, REACH, 0);
  pose.roll = section.range("roll", Unit::angle, -2 * PI, 2 * PI, 0);
  pose.pitch = section.range("pitch", Unit::angle, -2 * PI, 2 * PI, 0);
  pose.yaw = section.range("yaw", Unit::angle, -2 * PI, 2 * PI, 0);
  section.done();
  return pose;
}

void check_schema(Section& root) {
  if (root.integer("schema", 0, 1000000) != 1) root.fail("schema", "must be 1, the only version this program reads");
}

Pose read_pose(Section& section) {
  Pose pose = Pose::Identity();
  pose.translation() = section.vector("position", Unit::length, -REACH, REACH, Vec3::Zero());
  pose.linear() = from_roll_pitch_yaw(section.vector("rotation", Unit::angle, -2 * PI, 2 * PI, Vec3::Zero()));
  return pose;
}

Pose read_pose(Section& parent, const std::string& key) {
  if (!parent.has(key)) return Pose::Identity();
  Section section = parent.section(key);
  const Pose pose = read_pose(section);
  section.done();
  return pose;
}

Vec3f read_color(Section& section, const std::string& key, const Vec3f& otherwise, double high, Unit unit) {
  return section.vector(key, unit, 0, high, otherwise.cast<double>()).cast<float>();
}

void add_materials(Section& root, std::vector<VisualMaterial>& materials,
                   std::vector<std::filesystem::path>* textures) {
  for (Section& section : root.sections("materials")) {
    const VisualMaterial material = read_material(section, textures);
    for (const VisualMaterial& other : materials) {
      if (other.name == material.name) section.fail("name", "`" + material.name + "` is taken by a material above");
    }
    materials.push_back(material);
  }
}

std::vector<VisualSection> read_visuals(Section& section) {
  std::vector<VisualSection> visuals;
  for (Section& visual : section.sections("visuals")) {
    const std::filesystem::path mesh = visual.file("mesh");
    const bool has_own = mesh.extension() == ".glb" || mesh.extension() == ".gltf";
    const std::string material = has_own ? visual.text("material", "") : visual.text("material");
    visuals.push_back({mesh, material, visual.number("crease_angle", Unit::angle, 0, PI, 0.7)});
    visual.done();
  }
  return visuals;
}

ObjectSection read_object(Section& section) {
  ObjectSection object;
  object.name = section.text("name");
  if (section.has("mesh")) object.mesh = section.file("mesh");
  object.visuals = read_visuals(section);
  object.is_fixed = section.boolean("fixed", false);
  if (section.has("density")) object.density = section.number("density", Unit::density, 1e-3, 1e5);
  if (section.has("mass")) object.mass = section.number("mass", Unit::mass, 1e-6, 1e5);
  const bool needs_mass = !object.is_fixed && !object.mesh.empty();
  if (needs_mass && (object.density > 0) == (object.mass > 0)) {
    section.fail("", "must have either `density` or `mass`, because it can move");
  }
  if (!needs_mass && (object.density > 0 || object.mass > 0))
    section.fail("", "has a mass but cannot move: leave `density` and `mass` out");
  if (object.mesh.empty() && object.visuals.empty())
    section.fail("", "has neither `mesh` nor `visuals`: there is nothing to do with it");
  object.friction = section.number("friction", Unit::none, 0, 10, object.friction);
  object.affine_modulus = section.number("affine_modulus", Unit::pressure, 1e3, 1e12, object.affine_modulus);
  object.pose = read_sampled_pose(section);
  section.done();
  return object;
}

ContactSettings read_contact(Section& root) {
  ContactSettings contact;
  if (!root.has("contact")) return contact;
  Section section = root.section("contact");
  contact.activation_distance =
      section.number("activation_distance", Unit::length, 1e-6, 0.1, contact.activation_distance);
  contact.stiffness = section.number("stiffness", Unit::pressure, 1, 1e12, contact.stiffness);
  contact.friction_velocity = section.number("friction_velocity", Unit::speed, 1e-8, 1, contact.friction_velocity);
  contact.friction_lag_passes = section.integer("friction_lag_passes", -1, 100, contact.friction_lag_passes);
  if (contact.friction_lag_passes == 0)
    section.fail("friction_lag_passes", "must be a number of passes, or -1: until the friction no longer changes");
  section.done();
  return contact;
}

SolverSettings read_solver(Section& root, double largest_time_step) {
  SolverSettings solver;
  solver.time_step = root.number("time_step", Unit::time, 1e-6, largest_time_step);
  if (!root.has("solver")) return solver;
  Section section = root.section("solver");
  solver.velocity_tolerance = section.number("velocity_tolerance", Unit::speed, 1e-9, 1, solver.velocity_tolerance);
  solver.integrator =
      SolverSettings::Integrator(section.choice("integrator", {"implicit_euler", "bdf2"}, int(solver.integrator)));
  solver.max_newton = section.integer("max_newton", 1, 10000, solver.max_newton);
  solver.preconditioner = SolverSettings::Preconditioner(section.choice(
      "preconditioner", {PRECONDITIONER_NAMES.begin(), PRECONDITIONER_NAMES.end()}, int(solver.preconditioner)));
  solver.cg_tolerance = section.number("cg_tolerance", Unit::none, 1e-15, 0.5, solver.cg_tolerance);
  solver.max_cg = section.integer("max_cg", 1, 1000000, solver.max_cg);
  solver.max_step_halvings = section.integer("max_step_halvings", 0, 20, solver.max_step_halvings);
  section.done();
  return solver;
}

BackgroundSection read_background(Section section) {
  BackgroundSection background;
  background.mesh = section.file("mesh");
  background.texture = section.file("texture");
  background.pose = read_pose(section);
  background.shadow_strength = float(section.number("shadow_strength", Unit::none, 0, 1, background.shadow_strength));
  section.done();
  return background;
}

void read_light(Section& section, Task& task) {
  const std::string name = section.text("name");
  if (section.choice("kind", {"rectangle", "sphere"}, 0) == 1) {
    SphereLight light;
    light.name = name;
    light.center = section.vector("center", Unit::length, -REACH, REACH);
    light.radius = section.number("radius", Unit::length, 1e-6, REACH);
    light.radiance = section.vector("radiance", Unit::radiance, 0, 1e6).cast<float>();
    section.done();
    task.sphere_lights.push_back(light);
    return;
  }
  RectangleLight light;
  light.name = name;
  light.corner = section.vector("corner", Unit::length, -REACH, REACH);
  light.edge_u = section.vector("edge_u", Unit::length, -REACH, REACH);
  light.edge_v = section.vector("edge_v", Unit::length, -REACH, REACH);
  if (!(light.edge_u.cross(light.edge_v).norm() > 0)) section.fail("edge_u", "and `edge_v` must span a rectangle");
  if (std::abs(light.edge_u.dot(light.edge_v)) > 1e-6 * light.edge_u.norm() * light.edge_v.norm()) {
    section.fail("edge_u", "and `edge_v` must be at right angles");
  }
  light.radiance = section.vector("radiance", Unit::radiance, 0, 1e6).cast<float>();
  section.done();
  task.lights.push_back(light);
}

CameraSection read_camera(Section& section) {
  CameraSection camera;
  camera.name = section.text("name");
  camera.mount = section.text("mount", camera.mount);
  // even numbers: video with half resolution in colour needs them
  camera.width = section.integer("width", 16, 8192);
  camera.height = section.integer("height", 16, 8192);
  if (camera.width % 2 != 0) section.fail("width", "must be even, for the video");
  if (camera.height % 2 != 0) section.fail("height", "must be even, for the video");
  read_intrinsics(section, camera);
  read_optics(section, camera.optics);
  camera.pose = read_camera_pose(section);
  camera.exposure = float(section.number("exposure", Unit::none, 1e-6, 1e6, 1));
  camera.records_gripper_mask = section.boolean("records_gripper_mask", false);
  section.done();
  return camera;
}

}  // namespace pvg
