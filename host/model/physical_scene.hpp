// What physics reads of a scene, as plain structs: bodies, what joins them, what acts on them. SI units, radians; z up;
// quaternions Hamilton. Indices refer to the vectors of the same PhysicalScene.
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "host/geometry/mesh.hpp"
#include "host/model/effect.hpp"

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
  double friction = 0.5;                 // coefficient; a pair's is the geometric mean unless
                                         // PhysicalScene::pair_friction says
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
//   position: stiffness (target - q) + damping (dtarget/dt - dq/dt), or damping (-dq/dt) if damped_rate is the joint's
//   velocity: damping (target - dq/dt)                                   torque: target
// plus what compensates gravity; the sum, damping included, is cut at effort_limit.
struct Drive {
  enum class Mode { position, velocity, torque };
  enum class DampedRate { error, joint };
  Mode mode = Mode::position;
  double stiffness = 0;                        // [N m/rad] or [N/m]
  double damping = 0;                          // [N m s/rad] or [N s/m]
  DampedRate damped_rate = DampedRate::error;  // of the mode position: of target - q, or of q alone
  double effort_limit = 0;                     // [N m] or [N]; 0: none
  bool compensates_gravity = true;  // feeds forward the torque that the weight of everything it carries asks for
  // what a real drive may add, as the effects backlash, actuator_gain, actuator_lag and actuator_delay say
  double play = 0;           // total width, within which only damping acts: a dead band, or backlash [rad or m]
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
  double armature = 0;                   // inertia of what turns with the coordinate, a geared rotor [kg m^2 or kg]
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

// Coefficient of restitution of one pair of rigid bodies, by name: their contacts part with this share of the speed at
// which they met.
struct PairRestitution {
  std::string first, second;
  double coefficient = 0;  // in [0, 1]
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
  int texture = -1;                            // of Appearance::textures: its picture
};

// ---- the scene --------------------------------------------------------------------------------------------------
struct PhysicalScene {
  std::string name;
  Vec3 gravity = Vec3(0, 0, -9.81);  // [m/s^2]
  std::vector<RigidBody> rigid_bodies;
  std::vector<SoftBody> soft_bodies;
  std::vector<Cloth> cloths;
  std::vector<Joint> joints;  // those with a drive take a target each, in this order
  std::vector<Stitch> stitches;
  std::vector<PairFriction> pair_friction;
  std::vector<PairRestitution> pair_restitution;
  std::vector<std::array<int, 2>> noncolliding_rigid_bodies;  // besides jointed pairs, which never collide
  std::vector<Effect> effects;                                // what else acts, by name
  std::vector<Display> displays;
  ContactSettings contact;
  SolverSettings solver;
  bool separates_start = false;  // free bodies that intersect at the start are moved apart
};

}  // namespace pvg
