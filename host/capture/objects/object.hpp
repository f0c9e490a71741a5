// From a mesh of an object, sound or broken, to what a simulation takes: a closed surface without self-intersections,
// the mesh that is seen, mass properties, and how far the two are apart.
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "host/capture/objects/wrap.hpp"
#include "host/device/device.hpp"
#include "host/geometry/mass_properties.hpp"
#include "host/geometry/visual_mesh.hpp"

namespace pvg {

struct ObjectSettings {
  double scale = 1;              // of the file's lengths to metres
  double density = 0, mass = 0;  // [kg/m^3], [kg]; one of them, or neither: 1000 kg/m^3 is taken and said
  WrapSettings wrap;
  std::size_t triangles = 2000;  // of the simulation mesh
  double error = 0;              // between source and simulation mesh [m]; 0: as follows
  double error_share = 0.02;     // of the size, or two spacings of the wrap where they are given
  bool always_wraps = false;     // also a sound mesh
  bool is_soft = false;          // tetrahedra are made
};

struct CapturedObject {
  TriangleMesh simulation;
  VisualMesh visual;
  MassProperties mass;
  bool was_sound = false;                      // the source was closed, manifold and free of self-intersections
  double spacing = 0;                          // of the wrap [m]; 0: it was not needed
  double bridge = 0;                           // radius of the wrap's ball [m]
  double bound = 0;                            // no point of the simulation mesh is farther from the source [m]
  double volume_error = 0;                     // of the simulation mesh beside a sound source, as a share
  std::optional<TetMesh> tetrahedra;           // that fill the simulation mesh, of 4 nodes, if it is soft
  std::vector<double> to_source, from_source;  // distances between the surfaces, ascending [m]
};

// A thing as it comes, in metres.
struct ObjectSource {
  std::string name;   // of the file, for messages
  TriangleMesh mesh;  // of any quality
  VisualMesh visual;
  bool stands = false;  // on the plane z = 0: so does what is made of it, its middle on the z axis
};

// settings.scale is applied. UsageErrors name the file where nothing can be made of it.
ObjectSource read_object(const std::filesystem::path& file, const ObjectSettings& settings);
// The surface of a file of Gaussian splats (splats.hpp).
ObjectSource read_splat_object(Device& device, const std::filesystem::path& file, const ObjectSettings& settings);

// largest extent along an axis [m]
double size_of(const TriangleMesh& mesh);

CapturedObject capture_object(const ObjectSource& source, const ObjectSettings& settings);

// simulation.obj, visual.glb, object.yaml, report.json; of soft ones tetrahedra.msh
void write_object(const std::filesystem::path& folder, const CapturedObject& object, const ObjectSettings& settings,
                  double seconds);
nlohmann::ordered_json object_report(const CapturedObject& object, const ObjectSettings& settings, double seconds);

}  // namespace pvg
