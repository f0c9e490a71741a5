// The sections that say what is seen: materials, lights, cameras, background, render.
#include <cmath>

#include "host/load/camera_file.hpp"
#include "host/load/read_sections.hpp"
#include "host/load/tables.hpp"
#include "host/model/metals.hpp"

namespace pvg {
namespace {

using Section = YamlSection;
using Material = MaterialSection;
using Kind = VisualMaterial::Kind;
using AlphaMode = VisualMaterial::AlphaMode;

std::vector<std::string> kind_names() {
  std::vector<std::string> names;
  for (const MaterialKind& kind : MATERIAL_KINDS) names.push_back(kind.name);
  return names;
}

std::string kind_meanings() {
  std::string all;
  for (const MaterialKind& kind : MATERIAL_KINDS) all += (all.empty() ? "" : "; ") + std::string(kind.meaning);
  return all;
}

// defaults that follow from the kind
void set_defaults(Material& material) {
  if (material.kind == Kind::dielectric) material.color = Vec3f::Ones();
  if (material.kind == Kind::dielectric) material.roughness = 0;
  if (material.kind == Kind::metallic_roughness) material.roughness = 1;
  if (material.kind == Kind::cloth) material.sheen = Vec3f::Constant(0.3f);
}

// a measured metal's colours
void read_metal(Section& section, Material& material) {
  if (section.has("color")) section.fail("metal", "and `color` exclude each other: the metal has its own");
  const std::size_t metal = section.choice("metal", metal_names());
  material.color = metal_reflectance(metal, 1).cast<float>();
  material.edge_dip = metal_edge_dip(metal).cast<float>();
}

void check_material(Section& section, Material& material) {
  if (material.kind == Kind::emissive) section.vector("emission", Unit::radiance, 0, 1e6);  // says that it is missing
  if (material.is_thin && !material.absorption.isZero())
    section.fail("absorption", "is of no use: a thin sheet has no inside; tint it with `color`");
}

auto is_any_of(std::initializer_list<Kind> kinds) {
  return [kinds = std::vector<Kind>(kinds)](const Material& material) {
    return std::find(kinds.begin(), kinds.end(), material.kind) != kinds.end();
  };
}

// An optical frame at `position` whose z axis meets `look_at`; `up` is upward in the picture.
Pose read_camera_pose(Section& section) {
  if (!section.has("look_at")) return read_pose(section);
  const Vec3 position = section.vector("position", Unit::length, -REACH, REACH);
  const Vec3 forward = section.vector("look_at", Unit::length, -REACH, REACH) - position;
  const Vec3 up = section.vector("up", Unit::none, -1e6, 1e6, Vec3::UnitZ());
  const Vec3 right = forward.cross(up);
  if (!(forward.norm() > 0)) section.fail("look_at", "must be another point than `position`");
  if (!(up.norm() > 0)) section.fail("up", "must be a direction, which is upward in the picture, but is zero");
  if (!(right.norm() > 1e-9 * forward.norm() * up.norm()))
    section.fail("up", std::string(section.has("up") ? "" : "is not given, so it is [0, 0, 1], and ") +
                           "must not be parallel to the view from `position` to `look_at`; give another, such as " +
                           (std::abs(forward.normalized().y()) < 0.9 ? "[0, 1, 0]" : "[1, 0, 0]"));
  Pose pose = Pose::Identity();
  pose.translation() = position;
  pose.linear().col(0) = right.normalized();
  pose.linear().col(2) = forward.normalized();
  pose.linear().col(1) = pose.linear().col(2).cross(pose.linear().col(0));
  return pose;
}

// in units of the picture's size
void read_intrinsics(Section& section, CameraSection& camera) {
  if (section.has("vertical_field_of_view"))
    section.fail("intrinsics", "and `vertical_field_of_view` exclude each other");
  const std::vector<double> k = section.numbers("intrinsics", Unit::none, -1e7, 1e7);
  if (k.size() != 4) section.fail("intrinsics", "must be [fx, fy, cx, cy] in pixels");
  if (!(k[0] > 1e-3 && k[1] > 1e-3)) section.fail("intrinsics", "must have focal lengths fx and fy above 0");
  camera.intrinsics = {k[0] / camera.height, k[1] / camera.height, (k[2] + 0.5) / camera.width,
                       (k[3] + 0.5) / camera.height};
}

// size, intrinsics and lens of a calibrated camera; another width or height keeps the view
void read_calibration(Section& section, CameraSection& camera) {
  for (const char* key : {"intrinsics", "vertical_field_of_view", "model", "distortion"})
    if (section.has(key)) section.fail("calibration", std::string("and `") + key + "` exclude each other");
  const Camera measured = read_camera_file(section.file("calibration"));
  if (std::abs(double(camera.width) * measured.height - double(camera.height) * measured.width) > 0)
    section.fail("calibration", "is of pictures of " + std::to_string(measured.width) + " x " +
                                    std::to_string(measured.height) + " pixels; keep their shape");
  camera.optics.model = measured.model;
  camera.optics.distortion = measured.distortion;
  const double w = measured.width, h = measured.height;
  camera.intrinsics = {measured.fx / h, measured.fy / h, (measured.cx + 0.5) / w, (measured.cy + 0.5) / h};
}

void check_optics(Section& section, Camera& optics) {
  const bool is_fisheye = optics.model == Camera::Model::fisheye;
  const std::size_t n = optics.distortion.size();
  if (is_fisheye ? n != 0 && n != 4 : n != 0 && n != 4 && n != 5 && n != 8)
    section.fail("distortion", is_fisheye ? "must be OpenCV's k1 k2 k3 k4 of a fisheye"
                                          : "must be OpenCV's 4, 5 or 8 numbers k1 k2 p1 p2 k3 k4 k5 k6");
  if (is_fisheye && optics.lens_radius > 0) section.fail("lens_radius", "is not for a fisheye: all is sharp there");
  if (optics.vignetting.size() > 3) section.fail("vignetting", "must be up to three numbers v1 v2 v3");
  if (optics.read_noise > 0 && optics.full_well == 0)
    section.fail("read_noise", "is in electrons and needs `full_well`, their number at value 1");
}

void check_camera(Section& section, CameraSection& camera) {
  // even numbers: video with half resolution in colour needs them
  if (camera.width % 2 != 0) section.fail("width", "must be even, for the video");
  if (camera.height % 2 != 0) section.fail("height", "must be even, for the video");
  if (camera.intrinsics.empty()) section.number("vertical_field_of_view", Unit::angle, 0.01, 3.0);  // or it is missing
}

void check_background(Section& section, BackgroundSection& background) {
  const bool is_gltf = background.mesh.extension() == ".glb" || background.mesh.extension() == ".gltf";
  if (background.texture.empty() && !is_gltf)
    section.fail("", "lacks the key `texture`, which a mesh without a look of its own needs");
}

// A light of no radiance is a mistake that only shows as a dark picture.
template <class Light>
void check_shines(Section& section, Light& light) {
  if (!(light.radiance.maxCoeff() > 0))
    section.fail("radiance", "must be above 0 in one colour, or the light be left out");
}

void check_rectangle(Section& section, RectangleLight& light) {
  if (!(light.edge_u.cross(light.edge_v).norm() > 0)) section.fail("edge_u", "and `edge_v` must span a rectangle");
  if (std::abs(light.edge_u.dot(light.edge_v)) > 1e-6 * light.edge_u.norm() * light.edge_v.norm())
    section.fail("edge_u", "and `edge_v` must be at right angles");
  check_shines(section, light);
}

}  // namespace

const Fields<MaterialSection>& material_fields() {
  using M = Material;
  const auto transmits = is_any_of({Kind::dielectric, Kind::metallic_roughness});
  const auto is_general = is_any_of({Kind::metallic_roughness});
  const auto is_cut_out = [](const M& m) { return m.alpha_mode != AlphaMode::opaque; };
  const std::string inside = "`dielectric`, `metallic_roughness`", general = "`metallic_roughness`";
  static const Fields<M> FIELDS =
      Fields<M>()
          .name(&M::name, "of the material")
          .choice("kind", &M::kind, kind_names(), kind_meanings())
          .required()
          .then(set_defaults)
          .number("color", &M::color, Unit::none, 0, 1,
                  "linear Rec. 709: albedo, reflectance of a metal at normal incidence, tint of what crosses glass")
          .otherwise("0.5, `dielectric` 1")
          .file("texture", &M::texture_file, "multiplies `color`, of emissive ones `emission`")
          .number("roughness", &M::roughness, Unit::none, 0, 1, "GGX width alpha = roughness^2; below 0.032 a mirror")
          .when(is_any_of({Kind::conductor, Kind::dielectric, Kind::metallic_roughness}),
                "`conductor`, `dielectric`, `metallic_roughness`")
          .otherwise("0.3, 0, 1")
          .custom({"metal", "", "none", shown_names(metal_names()), "`conductor`: measured constants, replace `color`"},
                  read_metal, nullptr)
          .when(is_any_of({Kind::conductor}), "")
          .number("index_of_refraction", &M::index_of_refraction, Unit::none, 1, 4, "of the inside, or of the coat")
          .when(transmits, inside)
          .number("absorption", &M::absorption, Unit::per_length, 0, 1e6,
                  "dims light inside by exp(-absorption length)")
          .when(transmits, inside)
          .number("emission", &M::emission, Unit::radiance, 0, 1e6, "radiance of the surface; its triangles are lights")
          .when(is_any_of({Kind::emissive, Kind::metallic_roughness}), "`emissive`, `metallic_roughness`")
          .otherwise("required of `emissive`")
          .number("shadow_strength", &M::shadow_strength, Unit::none, 0, 1, "share of the light that shadows take")
          .when(is_any_of({Kind::shadow_receiver}), "`shadow_receiver`")
          .number("ambient", &M::ambient, Unit::none, 0, 1,
                  "share of the light that comes evenly from all around; the rest is that of the lamps")
          .when(is_any_of({Kind::shadow_receiver}), "`shadow_receiver`")
          .file("metallic_roughness_texture", &M::metallic_roughness_file,
                "plain values: green multiplies `roughness`, blue `metallic`")
          .when(is_general, general)
          .file("normal_texture", &M::normal_file, "tangent space, green up")
          .file("emission_texture", &M::emission_file, "sRGB, multiplies `emission`")
          .when(is_general, general)
          .number("normal_scale", &M::normal_scale, Unit::none, 0, 100, "of `normal_texture`")
          .when([](const M& m) { return !m.normal_file.empty(); }, "with `normal_texture`")
          .number("metallic", &M::metallic, Unit::none, 0, 1, "share of metal")
          .when(is_general, general)
          .number("transmission", &M::transmission, Unit::none, 0, 1, "share of light that passes the base")
          .when(is_general, general)
          .flag("thin", &M::is_thin, "a sheet without inside: light passes straight")
          .when(transmits, inside)
          .number("priority", &M::priority, Unit::none, 0, 1000,
                  "where solids overlap, the highest priority fills the space")
          .when(transmits, inside)
          .number("edge_dip", &M::edge_dip, Unit::none, -INFINITY, INFINITY, "of a measured metal")
          .only_resolved()
          .number("sheen", &M::sheen, Unit::none, 0, 1, "reflectance scale of the fibres")
          .when(is_any_of({Kind::cloth}), "`cloth`")
          .otherwise("0.3")
          .number("sheen_roughness", &M::sheen_roughness, Unit::none, 0.5, 1, "of the fibres")
          .when(is_any_of({Kind::cloth}), "`cloth`")
          .choice("alpha_mode", &M::alpha_mode, {"opaque", "mask", "blend"},
                  "`mask`: absent where alpha (`opacity` times texture) is below `alpha_cutoff`; `blend`: lets its "
                  "share of the light pass")
          .when([](const M& m) { return m.kind != Kind::dielectric; }, "not `dielectric`")
          .number("opacity", &M::opacity, Unit::none, 0, 1, "scale of alpha")
          .when(is_cut_out, "`mask`, `blend`")
          .number("alpha_cutoff", &M::alpha_cutoff, Unit::none, 0, 1, "see `alpha_mode`")
          .when([](const M& m) { return m.alpha_mode == AlphaMode::mask; }, "`mask`")
          .check(check_material);
  return FIELDS;
}

const Fields<RectangleLight>& rectangle_light_fields() {
  using L = RectangleLight;
  static const Fields<L> FIELDS =
      Fields<L>()
          .name(&L::name, "of the light")
          .number("corner", &L::corner, Unit::length, -REACH, REACH, "in the world")
          .required()
          .number("edge_u", &L::edge_u, Unit::length, -REACH, REACH, "an edge from the corner")
          .required()
          .number("edge_v", &L::edge_v, Unit::length, -REACH, REACH,
                  "the other edge, at right angles; shines to the side of edge_u x edge_v")
          .required()
          .number("radiance", &L::radiance, Unit::radiance, 0, 1e6, "red, green, blue")
          .required()
          .check(check_rectangle);
  return FIELDS;
}

const Fields<SphereLight>& sphere_light_fields() {
  using L = SphereLight;
  static const Fields<L> FIELDS = Fields<L>()
                                      .name(&L::name, "of the light")
                                      .number("center", &L::center, Unit::length, -REACH, REACH, "in the world")
                                      .required()
                                      .number("radius", &L::radius, Unit::length, 1e-6, REACH, "of the ball")
                                      .required()
                                      .number("radiance", &L::radiance, Unit::radiance, 0, 1e6, "red, green, blue")
                                      .required()
                                      .check(check_shines<SphereLight>);
  return FIELDS;
}

const Fields<Camera>& optics_fields() {
  using C = Camera;
  static const Fields<C> FIELDS =
      Fields<C>()
          .choice("model", &C::model, {"pinhole", "fisheye"},
                  "OpenCV's; a fisheye (Kannala-Brandt) sees beyond 90 degrees")
          .number("distortion", &C::distortion, Unit::none, -1e4, 1e4,
                  "OpenCV's k1 k2 p1 p2 [k3 [k4 k5 k6]], of a fisheye k1 k2 k3 k4")
          .number("lens_radius", &C::lens_radius, Unit::length, 0, 1, "of a thin lens; 0: everything is sharp")
          .number("focus_distance", &C::focus_distance, Unit::length, 1e-4, 1e5,
                  "sharp at this distance along the axis")
          .required()
          .when([](const C& c) { return c.lens_radius > 0 && c.model == Camera::Model::pinhole; }, "with `lens_radius`")
          .number("exposure_time", &C::exposure_time, Unit::time, 0, 100,
                  "motion blur: open shutter before the frame's time; at most 16 instants")
          .number("row_time", &C::row_time, Unit::time, 0, 1,
                  "rolling shutter: delay from row to row, the last row at the frame's time; strips of 8 rows")
          .number("vignetting", &C::vignetting, Unit::none, -10, 10,
                  "v1 v2 v3 of 1 + v1 r^2 + v2 r^4 + v3 r^6, r = 1 at the farthest corner")
          .number("full_well", &C::full_well, Unit::none, 0, 1e9,
                  "electrons at value 1, which have shot noise; 0: no noise")
          .number("read_noise", &C::read_noise, Unit::none, 0, 1e6, "one sigma of every value [electrons]")
          .check(check_optics);
  return FIELDS;
}

const Fields<CameraSection>& camera_fields() {
  using C = CameraSection;
  static const Fields<C> FIELDS =
      Fields<C>()
          .name(&C::name, "of the camera")
          .text("mount", &C::mount, "`world`, `gripper_base`, or with several arms `NAME/gripper_base`")
          .number("width", &C::width, Unit::none, 16, 8192, "pixels, even")
          .required()
          .number("height", &C::height, Unit::none, 16, 8192, "pixels, even")
          .required()
          .custom({"intrinsics", "", "none", "-1e7 to 1e7",
                   "`[fx, fy, cx, cy]` in pixels, replaces `vertical_field_of_view`. As in OpenCV, pixel (0, 0) is the "
                   "centre of the top left one"},
                  read_intrinsics, nullptr)
          .number("vertical_field_of_view", &C::vertical_field_of_view, Unit::angle, 0.01, 3.0, "of the picture")
          .otherwise("required, unless `intrinsics` or `calibration` stands there")
          .written_when([](const C& c) { return c.intrinsics.empty(); })
          .number("intrinsics_per_size", &C::intrinsics, Unit::none, -INFINITY, INFINITY, "of any size")
          .only_resolved()
          .written_when([](const C& c) { return !c.intrinsics.empty(); })
          .include(optics_fields(), &C::optics)
          .custom({"calibration", "", "none", "file",
                   "camera file of `calibrate camera`: replaces intrinsics, `model` and `distortion`"},
                  read_calibration, nullptr)
          .custom({"position", "m", "[0, 0, 0]", "-100 to 100", "in the frame of `mount`"}, nullptr, nullptr)
          .custom({"look_at", "m", "none", "-100 to 100", "point on the optical axis; `rotation` is then left out"},
                  nullptr, nullptr)
          .custom({"up", "", "[0, 0, 1]", "", "upward in the picture, with `look_at`"}, nullptr, nullptr)
          .custom(
              {"rotation", "rad", "[0, 0, 0]", "", "roll, pitch, yaw of the optical frame: x right, y down, z forward"},
              nullptr, nullptr)
          .reads([](Section& s, C& c) { c.pose = read_camera_pose(s); })
          .pose("pose", &C::pose, "to `mount`")
          .only_resolved()
          .number("exposure", &C::exposure, Unit::none, 1e-6, 1e6,
                  "multiplies radiance; a receiver's texture is kept as captured")
          .flag("records_gripper_mask", &C::records_gripper_mask, "writes masks of the gripper beside the video")
          .check(check_camera);
  return FIELDS;
}

const Fields<BackgroundSection>& background_fields() {
  using B = BackgroundSection;
  static const Fields<B> FIELDS =
      Fields<B>()
          .file("mesh", &B::mesh, "of the captured background; a glTF brings its own look")
          .required()
          .file("texture", &B::texture, "its picture, unless the mesh is a glTF")
          .own_pose(&B::pose, "in the world")
          .number("shadow_strength", &B::shadow_strength, Unit::none, 0, 1, "share of the light that shadows take")
          .number("ambient", &B::ambient, Unit::none, 0, 1,
                  "share of the light that comes evenly from all around; the rest is that of the lamps")
          .flag("relit", &B::is_relit, RELIT_MEANING)
          .check(check_background);
  return FIELDS;
}

const Fields<RenderSection>& render_fields() {
  using R = RenderSection;
  static const Fields<R> FIELDS =
      Fields<R>()
          .number("frames_per_second", &R::frames_per_second, Unit::frequency, 0.1, 1000, "of the videos")
          .number("samples", &R::samples, Unit::none, 1, 65536, "paths per pixel")
          .flag("adaptive", &R::adaptive,
                "more paths where the noise is, `samples` is their mean; see [pictures](../guide/pictures.md)")
          .number("max_depth", &R::max_depth, Unit::none, 1, 64, "bounces of a path")
          .file("lut", &R::lut, "table of `calibrate lut`, applied to the pictures")
          .flag("denoise", &R::denoise, "filters the noise of few samples, see [pictures](../guide/pictures.md)");
  return FIELDS;
}

}  // namespace pvg
