// What is simulated and seen, as plain structs: the meeting point of the loaders (above) and of physics and rendering
// (beside). SI units, radians; z up; quaternions Hamilton. Indices refer to the vectors of the same Scene.
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "host/geometry/mesh.hpp"
#include "host/geometry/visual_mesh.hpp"
#include "host/model/effect.hpp"
#include "host/pictures/picture.hpp"

namespace pvg {

using Mat3 = Eigen::Matrix3d;
using Pose = Eigen::Isometry3d;

// ---- bodies -----------------------------------------------------------------------------------------------------

struct PathPoint {
  double time = 0;               // [s]
  Pose pose = Pose::Identity();  // body to world
};

// A rigid body, simulated as an affine body: x(X) = p + A X with A held close to a rotation.
struct RigidBody {
  std::string name;
  TriangleMesh collision;                // in the body's frame; empty: the body does not collide
  double mass = 0;                       // [kg]
  Vec3 center_of_mass = Vec3::Zero();    // in the body's frame [m]
  Mat3 inertia = Mat3::Zero();           // about the centre of mass, axes of the body's frame [kg m^2]
  double volume = 0;                     // of the material [m^3]; scales the orthogonality energy
  double affine_modulus = 1e9;           // kappa of kappa V |A A^T - I|^2  [Pa]
  bool is_fixed = false;                 // never moves
  bool is_half_space = false;            // everything below z = 0 of its frame, without end; fixed, without a mesh
  bool is_prescribed = false;            // moves as told: along `path`, or at `velocity` and `angular_velocity`
  std::vector<PathPoint> path;           // ascending times; straight lines between, at rest before and after
  double friction = 0.5;                 // coefficient; a pair's is the geometric mean unless Scene::pair_friction says
  double contact_offset = 0;             // half thickness: contact acts this far outside the surface [m]
  Pose pose = Pose::Identity();          // initial, body to world
  Vec3 velocity = Vec3::Zero();          // of the frame's origin, world [m/s]
  Vec3 angular_velocity = Vec3::Zero();  // world [rad/s]
};

struct SolidMaterial {
  double density = 1000;        // [kg/m^3]
  double youngs_modulus = 1e6;  // [Pa], as a tensile test of the simulated bar shows it
  double poisson_ratio = 0.45;  // in [0, 0.5)
};

// A soft solid: stable neo-Hookean finite elements.
struct SoftBody {
  std::string name;
  TetMesh mesh;  // rest shape, in the body's frame
  SolidMaterial material;
  double friction = 0.5;
  double contact_offset = 0;     // [m]
  Pose pose = Pose::Identity();  // initial, body to world
  Vec3 velocity = Vec3::Zero();  // [m/s]
};

struct ClothMaterial {
  double area_density = 0.15;                     // [kg/m^2]
  double thickness = 4e-4;                        // contact acts half of it to each side of the mesh [m]
  double stretch_warp = 2e3, stretch_weft = 2e3;  // Young's modulus x thickness along the threads [N/m]
  double shear = 50;                              // shear modulus x thickness [N/m]
  double poisson_ratio = 0;                       // in the plane, sqrt(nu_warp_weft nu_weft_warp), in [0, 1)
  double limit_strain = 0.05;                     // threads stiffen beyond it: modulus x (1 + 6 stiffening (e - limit))
  double stiffening = 100;
  double bending_warp = 1e-5, bending_weft = 1e-5;  // flexural rigidity against bending the threads [N m]
};

// A thin sheet that stretches little and bends easily. Collides with itself and with everything else, on both sides.
struct Cloth {
  std::string name;
  TriangleMesh mesh;  // rest shape, in the cloth's frame; open or closed
  ClothMaterial material;
  Vec3 warp_direction = Vec3::UnitX();  // in the cloth's frame, projected on each triangle; the weft crosses it
  bool rest_is_flat = true;             // false: the angles between the mesh's triangles are without moment
  std::vector<std::uint32_t> pinned;    // points of the mesh that never move
  double friction = 0.5;
  Pose pose = Pose::Identity();  // initial, body to world
  Vec3 velocity = Vec3::Zero();  // [m/s]
};

// ---- what joins bodies ------------------------------------------------------------------------------------------

// A drive acts on a joint's coordinate q with the effort
//   position: stiffness (target - q) + damping (dtarget/dt - dq/dt)
//   velocity: damping (target - dq/dt)                                   torque: target
// plus what compensates gravity; the sum is cut at effort_limit.
struct Drive {
  enum class Mode { position, velocity, torque };
  Mode mode = Mode::position;
  double stiffness = 0;             // [N m/rad] or [N/m]
  double damping = 0;               // [N m s/rad] or [N s/m]
  double effort_limit = 0;          // [N m] or [N]; 0: none
  bool compensates_gravity = true;  // feeds forward the torque that the weight of everything it carries asks for
  // what a real drive may add, as the effects backlash, actuator_gain, actuator_lag and actuator_delay say
  double play = 0;           // total, within which it does not act [rad or m]
  double gain = 1;           // of the effort before it is cut
  double time_constant = 0;  // of its lag behind the targets [s]
  double delay = 0;          // of its targets [s]
};

struct Joint {
  enum class Type { fixed, revolute, prismatic, spherical };
  std::string name;
  Type type = Type::fixed;
  int parent = -1, child = -1;           // rigid bodies
  Pose parent_frame = Pose::Identity();  // joint frame in the parent's frame, at q = 0 equal to the child's
  Pose child_frame = Pose::Identity();   // joint frame in the child's frame
  Vec3 axis = Vec3::UnitZ();             // in the joint frame, unit; q > 0 turns/moves the child along it
  double lower = 0, upper = 0;           // stops [rad or m]; both 0: none
  double limit_stiffness = 0;            // of the stops [N m/rad or N/m]; 0: 1e5 N m/rad, 1e6 N/m
  double damping = 0;                    // of the joint itself, drive or not [N m s/rad or N s/m]
  double velocity_limit = 0;             // [rad/s or m/s]; 0: none
  double stiffness = 1e8;                // of the constraint itself [N/m]
  Drive drive;
  double initial = 0;  // q at the start [rad or m]
};

inline bool is_driven(const Joint& joint) {
  return joint.drive.mode == Drive::Mode::torque || joint.drive.stiffness > 0 || joint.drive.damping > 0;
}

// Stitch springs: each node of the soft body or cloth is drawn to the point of the rigid body where it starts.
// E = k/2 sum_i |x_i - xhat_i|^2
struct Stitch {
  int soft = -1, rigid = -1;         // bodies
  std::vector<std::uint32_t> nodes;  // of the soft body or cloth
  double stiffness = 1e5;            // k, of each spring [N/m]
  int cloth = -1;                    // instead of soft, which is then -1
  Vec3 direction = Vec3::Zero();     // in the rigid body's frame: acts along it alone, as rollers do; zero: all ways
};

// Coefficient of friction of one pair of bodies, by name.
struct PairFriction {
  std::string first, second;
  double coefficient = 0.5;
};

struct ContactSettings {
  double activation_distance = 1e-3;  // d_hat: contact acts below this gap [m]
  double stiffness = 1e7;             // kappa: barrier pressure scale [Pa]
  double friction_velocity = 1e-4;    // epsilon_v: sliding speed at which friction is fully developed [m/s]
  int friction_lag_passes = -1;  // how often lagged normal forces and tangents are renewed within a step; -1: until
                                 // they no longer move a point by more than the solver's tolerance
};

struct SolverSettings {
  enum class Integrator { implicit_euler, bdf2 };
  double time_step = 0.02;                             // h [s]
  Integrator integrator = Integrator::implicit_euler;  // bdf2: second order; its first step is implicit Euler's
  double velocity_tolerance = 1e-3;  // Newton stops when its next correction moves no point faster [m/s]
  int max_newton = 60;
  enum class Preconditioner { automatic, factor, schwarz, block_jacobi };  // host/physics/step/preconditioner.hpp
  Preconditioner preconditioner = Preconditioner::automatic;
  double cg_tolerance = 1e-4;  // relative, in the norm of the preconditioner
  int max_cg = 2000;
  int max_step_halvings = 4;  // a failed step is retried as two of half the length, this often
};

constexpr std::array<const char*, 4> PRECONDITIONER_NAMES = {"automatic", "factor", "schwarz", "block_jacobi"};

// ---- what is seen -----------------------------------------------------------------------------------------------

// docs/guide/pictures.md says what each kind is. Indices of textures are -1: none.
struct VisualMaterial {
  enum class Kind { diffuse, conductor, dielectric, emissive, shadow_receiver, metallic_roughness, cloth };
  enum class AlphaMode { opaque, mask, blend };
  std::string name;
  Kind kind = Kind::diffuse;
  Vec3f color = Vec3f::Constant(0.5f);   // linear Rec. 709: albedo, reflectance at normal incidence of a conductor, or
                                         // tint of what passes a dielectric's surface
  int texture = -1;                      // multiplies color, of emissive ones emission
  float roughness = 0.3f;                // GGX alpha = roughness^2; of a dielectric 0 is clear
  float index_of_refraction = 1.5f;      // of dielectrics and the coat of metallic_roughness
  Vec3f absorption = Vec3f::Zero();      // inside, Beer-Lambert [1/m]
  Vec3f emission = Vec3f::Zero();        // radiance of emissive and metallic_roughness surfaces [W/(sr m^2)]
  float shadow_strength = 1;             // lambda_s of the shadow receiver, in [0, 1]
  float metallic = 0, transmission = 0;  // of metallic_roughness, in [0, 1]
  bool is_thin = false;                  // a sheet without inside, of what transmits
  int priority = 0;                      // of overlapping solids that transmit the highest is there
  int metallic_roughness_texture = -1;   // plain values: green multiplies roughness, blue metallic
  int normal_texture = -1, emission_texture = -1;  // plain values; sRGB
  float normal_scale = 1;
  // bits of those textures that are laid out by VisualMesh::second_uvs
  enum TextureBit : unsigned { color_bit = 1, metallic_roughness_bit = 2, normal_bit = 4, emission_bit = 8 };
  unsigned on_second_uvs = 0;
  Vec3f edge_dip = Vec3f::Zero();            // of a conductor: a of kernels/materials/conductor.cl, 0: Schlick's curve
  Vec3f sheen = Vec3f::Zero();               // of cloth: reflectance scale of its fibres
  float sheen_roughness = 0.7f;              // in [0.5, 1]
  AlphaMode alpha_mode = AlphaMode::opaque;  // alpha: opacity times the texture's; mask: holes where it is below
  float opacity = 1, alpha_cutoff = 0.5f;    // alpha_cutoff; blend: 1 - alpha of the light goes straight on
};

// One visible thing. It follows a rigid body, a soft body (its mesh is then embedded in the body's tetrahedra, or
// without one made by subdivision of its surface), a cloth (whose surface is subdivided), or nothing.
struct Visual {
  std::string name;
  int mesh = -1;  // of Scene::visual_meshes; -1: of a soft body or cloth: made from its surface
  int material = -1;
  int rigid = -1, soft = -1, cloth = -1;  // body it follows; all -1: stands still
  Pose pose = Pose::Identity();           // mesh to body (or to world)
  int subdivision_levels = 1;             // of a soft body's or cloth's surface
  std::string part;                       // label in the segmentation masks, such as "gripper"
  bool casts_shadow_on_receivers = true;  // false for the captured background itself
};

// Figures on an object that is a scale: the mass that presses on it, as seven segments (display.hpp).
struct Display {
  std::string name;                            // of the object
  int rigid = -1;                              // body that weighs
  Pose pose = Pose::Identity();                // middle of the face in the body's frame; x right, y up, z out
  double width = 0, height = 0;                // of the face [m]; 0: none
  int digits = 5;                              // places
  double resolution = 1e-4;                    // of what is shown [kg]
  double tare = 0;                             // is taken from what presses [kg]
  double time_constant = 0.25;                 // of the reading's first-order lag [s]
  Vec3f color = Vec3f::Constant(0.02f);        // of the face, linear Rec. 709
  Vec3f radiance = Vec3f(0.25f, 1.2f, 0.45f);  // of a lit segment [W/(sr m^2)]
  int texture = -1;                            // of Scene::textures: its picture
};

// A rectangular area light, emitting on the side of cross(edge_u, edge_v).
struct RectangleLight {
  std::string name;
  Vec3 corner, edge_u, edge_v;  // world [m]
  Vec3f radiance;               // linear Rec. 709 [W/(sr m^2)]
};

// A ball that shines.
struct SphereLight {
  std::string name;
  Vec3 center = Vec3::Zero();  // world [m]
  double radius = 0;           // [m]
  Vec3f radiance;              // linear Rec. 709 [W/(sr m^2)]
  // of a spot: what is within the inner angle about its direction sees it shine, what is beyond the outer one does not
  Vec3 direction = -Vec3::UnitZ();
  double inner_angle = 4, outer_angle = 4;  // [rad]; above pi: shines everywhere
};

// A camera; the frame is optical (x right, y down, z forward). As in OpenCV, pixel (0, 0) is the centre of the top left
// pixel. What a real camera adds is off by default.
struct Camera {
  enum class Model { pinhole, fisheye };
  std::string name;
  int width = 320, height = 180;          // [pixels]
  double fx = 0, fy = 0, cx = 0, cy = 0;  // [pixels]
  Model model = Model::pinhole;
  std::vector<double> distortion;  // OpenCV k1 k2 p1 p2 k3 ..., of a fisheye k1 k2 k3 k4; empty: none
  int rigid = -1;                  // body it is mounted on; -1: world
  Pose pose = Pose::Identity();    // camera to body (or world)
  float exposure = 1;              // multiplies radiance
  double lens_radius = 0;          // of the aperture [m]; 0: everything is sharp
  double focus_distance = 1;       // along the optical axis [m]
  double exposure_time = 0;        // the shutter is open so long before the picture's time [s]
  double row_time = 0;             // rolling shutter: a row is read so long after the one above [s]
  std::vector<double> vignetting;  // v1 v2 v3 of 1 + v1 r^2 + v2 r^4 + v3 r^6, r = 1 at the farthest corner
  double full_well = 0;            // electrons at value 1, whose number has shot noise; 0: none
  double read_noise = 0;           // one sigma [electrons]
};

// ---- the scene --------------------------------------------------------------------------------------------------

struct Scene {
  std::string name;
  Vec3 gravity = Vec3(0, 0, -9.81);  // [m/s^2]
  std::vector<RigidBody> rigid_bodies;
  std::vector<SoftBody> soft_bodies;
  std::vector<Cloth> cloths;
  std::vector<Joint> joints;  // those with a drive take a target each, in this order
  std::vector<Stitch> stitches;
  std::vector<PairFriction> pair_friction;
  std::vector<std::array<int, 2>> noncolliding_rigid_bodies;  // besides jointed pairs, which never collide
  std::vector<Effect> effects;                                // what else acts, by name
  ContactSettings contact;
  SolverSettings solver;
  bool separates_start = false;  // free bodies that intersect at the start are moved apart

  std::vector<Texture> textures;
  std::vector<VisualMaterial> materials;
  std::vector<VisualMesh> visual_meshes;
  std::vector<Visual> visuals;
  std::vector<Display> displays;
  std::vector<RectangleLight> lights;
  std::vector<SphereLight> sphere_lights;
  Vec3f environment = Vec3f::Zero();  // radiance of every direction that no surface covers [W/(sr m^2)]
  EnvironmentMap environment_map;
  std::vector<Camera> cameras;
};

}  // namespace pvg
