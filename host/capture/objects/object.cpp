#include "host/capture/objects/object.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "host/base/atomic_files.hpp"
#include "host/base/error.hpp"
#include "host/capture/objects/sound_wrap.hpp"
#include "host/capture/objects/splats.hpp"
#include "host/capture/objects/surface_distance.hpp"
#include "host/capture/objects/thickness.hpp"
#include "host/capture/room_files.hpp"
#include "host/capture/surface.hpp"
#include "host/formats/mesh_files.hpp"
#include "host/formats/tet_file.hpp"
#include "host/formats/tetgen.hpp"
#include "host/geometry/exact_intersection.hpp"
#include "host/geometry/mesh_checks.hpp"
#include "host/geometry/tet_quality.hpp"
#include "host/model/physical_scene.hpp"

namespace pvg {
namespace {

constexpr double WATER = 1000;  // [kg/m^3]

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return values.empty() ? 0 : sum / double(values.size());
}

double at_share(const std::vector<double>& sorted, double share) {
  return sorted.empty() ? 0 : sorted[std::size_t(share * double(sorted.size() - 1))];
}

// of even bins from zero to the largest value
nlohmann::ordered_json histogram(const std::vector<double>& values, double largest) {
  constexpr int BINS = 16;
  std::vector<std::size_t> counts(BINS, 0);
  const double width = largest / BINS;
  for (const double v : values) ++counts[std::size_t(width > 0 ? std::clamp(int(v / width), 0, BINS - 1) : 0)];
  return {{"width", width}, {"counts", counts}};
}

nlohmann::ordered_json thickness_report(const TriangleMesh& mesh) {
  const std::vector<WallThickness> walls = wall_thickness(mesh);
  if (walls.empty()) return nullptr;
  std::vector<double> values;
  for (const WallThickness& wall : walls) values.push_back(wall.thickness);
  const Vec3& thinnest = walls.front().place;
  const double reach = ContactSettings{}.activation_distance;
  return {{"least", values.front()},
          {"least_at", {thinnest.x(), thinnest.y(), thinnest.z()}},
          {"p05", at_share(values, 0.05)},
          {"median", at_share(values, 0.5)},
          {"histogram", histogram(values, values.back())},
          {"activation_distance", reach},  // a task's, unless it says otherwise
          {"share_below", share_thinner(walls, reach)}};
}

// Needles on the surface become slivers inside, so the surface of a soft thing has none below this shape (see
// edge_collapse.hpp). Measured on seven shapes, docs/measured/2026-11-27_capture_all_rows.md.
constexpr double SOFT_SHAPE = 0.2;
constexpr double RADIUS_EDGE = 1.4;       // that TetGen is asked for
constexpr double LEAST_DIHEDRAL = 10;     // [degrees]; it may ask for up to 18, and ends surely below that
constexpr double LARGEST_DIHEDRAL = 130;  // [degrees]; flips and smoothing for this are what removes slivers

// Points may be added on the surface, which stays where it is: of few triangles it has long ones.
TetMesh filled(const TriangleMesh& surface, const std::string& name) {
  TetgenOptions options;
  options.radius_edge_ratio = RADIUS_EDGE;
  options.least_dihedral = LEAST_DIHEDRAL;
  options.largest_dihedral = LARGEST_DIHEDRAL;
  options.keeps_surface = false;
  options.nodes_per_element = 4;
  return tetrahedralize(surface, options, name);
}

nlohmann::ordered_json tetrahedra_report(const TetMesh& mesh) {
  const TetQuality quality = tet_quality(mesh);
  return {{"nodes", mesh.points.size()},
          {"elements", mesh.n_elements()},
          {"least_dihedral_degrees", quality.least_dihedral * 180 / std::numbers::pi},
          {"largest_radius_edge", quality.largest_radius_edge},
          {"slivers", quality.n_slivers}};
}

// an entry of `objects` of a task
std::string rigid_entry(const MassProperties& m) {
  return fmt::format(
      "objects:\n  - name: object\n    mesh: simulation.obj\n    visuals: [{{mesh: visual.glb}}]\n"
      "    mass: {:.6g} kg\n    friction: 0.5    # not measured\n",
      m.mass);
}

// an entry of `bodies` of a scene
std::string soft_entry(const MassProperties& m) {
  return fmt::format(
      "bodies:\n  - name: object\n    kind: soft\n    shape: {{tetrahedra: {{mesh: tetrahedra.msh}}}}\n"
      "    material: {{density: {:.6g}, youngs_modulus: 1e5, poisson_ratio: 0.4}}    # stiffness: not measured\n"
      "    visuals: [{{mesh: visual.glb}}]\n    friction: 0.5    # not measured\n",
      m.mass / m.volume);
}

// The wrap adds its offset below a foot, too.
void stand_on_ground(CapturedObject& object) {
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  for (const Vec3& p : object.simulation.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Vec3 foot(0.5 * (low.x() + high.x()), 0.5 * (low.y() + high.y()), low.z());
  for (Vec3& p : object.simulation.points) p -= foot;
  for (Vec3f& p : object.visual.points) p -= foot.cast<float>();
  object.mass.center -= foot;
}

}  // namespace

double size_of(const TriangleMesh& mesh) {
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  for (const Vec3& p : mesh.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (high - low).maxCoeff();
}

ObjectSource read_object(const std::filesystem::path& file, const ObjectSettings& settings) {
  ObjectSource source{file.string(), read_surface(file), {}};
  if (source.mesh.triangles.empty()) throw UsageError(source.name + " holds no triangles");
  for (const Vec3& p : source.mesh.points)
    if (!p.allFinite()) throw UsageError(source.name + ": a point is not finite; export it again");
  for (Vec3& p : source.mesh.points) p *= settings.scale;
  source.visual = read_visual_mesh(file);
  for (Vec3f& p : source.visual.points) p *= float(settings.scale);
  return source;
}

ObjectSource read_splat_object(Device& device, const std::filesystem::path& file, const ObjectSettings& settings) {
  ObjectSource source{file.string(), {}, surface_of_splats(device, read_splats(file, settings.scale))};
  if (source.visual.triangles.empty()) throw UsageError(source.name + ": the splats show no surface");
  for (const Vec3f& p : source.visual.points) source.mesh.points.push_back(p.cast<double>());
  source.mesh.triangles = source.visual.triangles;
  return source;
}

CapturedObject capture_object(const ObjectSource& source, const ObjectSettings& settings) {
  if (settings.density > 0 && settings.mass > 0) throw UsageError("--density and --mass exclude each other");
  const TriangleMesh& mesh = source.mesh;
  tell_of_size(mesh, source.name);
  CapturedObject out;
  out.was_sound = is_sound(mesh);
  WrapSettings wrap = settings.wrap;
  if (wrap.spacing <= 0) wrap.spacing = size_of(mesh) / SAMPLES_ACROSS;
  if (!(wrap.spacing > 0)) throw UsageError(source.name + ": all points are one");
  const double share = settings.wrap.spacing > 0 ? 2 * wrap.spacing : settings.error_share * size_of(mesh);
  const double error = settings.error > 0 ? settings.error : share;
  SoundWrap wrapped{mesh, {}, 0};
  std::optional<NearestTriangle> source_surface;  // that was wrapped
  out.bound = error;
  if (!out.was_sound || settings.always_wraps) {
    if (wrap.bridge <= 0) wrap.bridge = 4 * wrap.spacing;
    out.bound = std::max(wrap.bridge, 0.6 * wrap.spacing + error);
    source_surface.emplace(mesh);
    wrapped = sound_wrap(*source_surface, wrap, out.bound, source.name);
    out.spacing = wrapped.settings.spacing;
    out.bridge = wrapped.settings.bridge;
  }
  const SourceBound source_bound{source_surface ? &*source_surface : nullptr, out.bound, wrapped.distance};
  SimplifiedSolid simplified =
      simplified_solid(wrapped.mesh, settings.triangles, error, source_bound, settings.is_soft ? SOFT_SHAPE : NEEDLE);
  out.simulation = std::move(simplified.mesh);
  const bool is_wrapped = out.spacing > 0;  // else the distances are those of the simplification
  out.to_source = is_wrapped ? surface_distances(out.simulation, *source_surface) : std::move(simplified.to_original);
  out.from_source = is_wrapped ? surface_distances(mesh, out.simulation) : std::move(simplified.from_original);
  const double density = settings.density > 0 ? settings.density : WATER;
  const TriangleMesh& weighed = out.was_sound ? mesh : out.simulation;
  out.mass = mass_properties(weighed, density);
  if (settings.mass > 0) {
    out.mass.inertia *= settings.mass / out.mass.mass;
    out.mass.mass = settings.mass;
  }
  if (out.was_sound) out.volume_error = enclosed_volume(out.simulation) / out.mass.volume - 1;
  out.visual = source.visual;
  if (source.stands) stand_on_ground(out);
  if (settings.is_soft) out.tetrahedra = filled(out.simulation, source.name);
  return out;
}

nlohmann::ordered_json object_report(const CapturedObject& object, const ObjectSettings& settings, double seconds) {
  const Eigen::Matrix3d& I = object.mass.inertia;
  const EdgeCounts edges = count_edges(object.simulation.triangles);
  const bool intersects = find_intersection(object.simulation.points, object.simulation.triangles).has_value();
  return {{"schema", 1},
          {"mesh",
           {{"vertices", object.simulation.points.size()},
            {"triangles", object.simulation.triangles.size()},
            {"closed", edges.boundary == 0},
            {"manifold", edges.crowded == 0},
            {"self_intersections", intersects ? 1 : 0}}},
          {"visual", {{"vertices", object.visual.points.size()}, {"triangles", object.visual.triangles.size()}}},
          {"planes", nlohmann::ordered_json::array()},
          {"scale", settings.scale},
          {"seconds", seconds},
          {"peak_bytes", nullptr},  // no device is used
          {"source_was_sound", object.was_sound},
          {"wrap_spacing", object.spacing},
          {"bridge", object.bridge},
          {"volume", object.mass.volume},
          {"volume_error", object.was_sound ? nlohmann::ordered_json(object.volume_error) : nullptr},
          {"mass", object.mass.mass},
          {"center", {object.mass.center.x(), object.mass.center.y(), object.mass.center.z()}},
          {"inertia", {I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)}},
          {"thickness", thickness_report(object.simulation)},
          {"tetrahedra", object.tetrahedra ? tetrahedra_report(*object.tetrahedra) : nlohmann::ordered_json(nullptr)},
          {"distance",
           {{"mean", mean(object.to_source)},
            {"p95", at_share(object.to_source, 0.95)},
            {"max", at_share(object.to_source, 1)},
            {"bound", object.bound},
            {"histogram", histogram(object.to_source, at_share(object.to_source, 1))},
            {"from_source_mean", mean(object.from_source)},  // inner walls of the source have no place in the mesh
            {"from_source_max", at_share(object.from_source, 1)}}}};
}

void write_object(const std::filesystem::path& folder, const CapturedObject& object, const ObjectSettings& settings,
                  double seconds) {
  write_text_atomically(folder / "simulation.obj", obj_text(object.simulation));
  write_captured_mesh(folder / "visual.glb", object.visual, "object", false);
  const MassProperties& m = object.mass;
  write_text_atomically(
      folder / "object.yaml",
      fmt::format("# An entry of {}; paths are relative to this folder. Mass properties{}:\n"
                  "#   volume {:.6g} m^3, centre ({:.6g}, {:.6g}, {:.6g}) m, inertia about it ({:.6g}, {:.6g}, {:.6g}) "
                  "kg m^2\n",
                  object.tetrahedra ? "`bodies` of a scene" : "`objects` of a task",
                  settings.density <= 0 && settings.mass <= 0 ? " of water, for want of --density or --mass" : "",
                  m.volume, m.center.x(), m.center.y(), m.center.z(), m.inertia(0, 0), m.inertia(1, 1),
                  m.inertia(2, 2)) +
          (object.tetrahedra ? soft_entry(m) : rigid_entry(m)));
  if (object.tetrahedra) write_text_atomically(folder / "tetrahedra.msh", tetrahedra_text(*object.tetrahedra));
  write_text_atomically(folder / "report.json", object_report(object, settings, seconds).dump(2) + "\n");
}

}  // namespace pvg
