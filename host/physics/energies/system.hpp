// A scene (or several, as worlds) turned into nodes, sites and the rows of every energy term: what the solver works on.
#pragma once
#include <span>
#include <vector>

#include "energies/body/force_law.h"
#include "energies/elastic/plastic_flow.h"
#include "energy_terms.h"
#include "host/model/physical_scene.hpp"
#include "host/model/state.hpp"
#include "host/physics/contact/collision_mesh.hpp"
#include "host/physics/linear/group_preconditioner.hpp"
#include "host/physics/linear/world_reduce.hpp"
#include "solve/site.h"

namespace pvg {

// The elements of one term, sorted by world.
template <class Params>
struct Rows {
  std::vector<Params> rows;
  std::vector<u32> world_first = {0};  // [n_worlds + 1]
  void end_world() { world_first.push_back(u32(rows.size())); }
};

// Formulas as OpenCL C, each once: laws that differ in their coefficients alone are one and are compiled once.
using LawTexts = std::vector<std::string>;

// Where what acts along a joint's coordinate stands in the rows of its type; -1: nowhere.
struct JointRows {
  int drive = -1, limit = -1;
  std::vector<int> effects, laws;
};

// The torque of a row of `spin` follows the normal force between two bodies of its world.
struct RollingResistance {
  u32 spin = 0;
  std::size_t world = 0;
  int first = -1, second = -1;  // bodies
  double arm = 0;               // [m]
};

// A known force on a point of a rigid body and a torque, from one time to another: rows of point_force get them.
struct Push {
  std::size_t world = 0;
  int rigid = -1;
  Vec3 point = Vec3::Zero();                         // in the body's frame [m]
  double from = 0, to = 0;                           // [s]
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();  // world frame [N], [N m]
  u32 row = 0;  // of the force; the three after it, on the body's axes, make the torque
};

// Nodes of each world: those of its soft bodies first, then of its cloths, then (p, a1, a2, a3) of each rigid body.
struct System {
  std::vector<PhysicalScene> scenes;  // [n_worlds]

  // nodes
  std::vector<double> x, v, gravity;                  // [n_nodes x 3]  [m], [m/s], [m/s^2]
  std::vector<u32> node_world, node_is_fixed;         // [n_nodes]
  std::vector<u32> node_group;                        // factored together; NO_GROUP where fixed
  std::vector<u32> group_world;                       // [n_groups]
  std::vector<std::array<u32, 2>> contact_couplings;  // nodes of one group that nothing but contact couples
  std::vector<WorldRange> node_ranges;                // one per world
  std::vector<std::vector<u32>> soft_first_node;      // [n_worlds][n_soft_bodies]
  std::vector<std::vector<u32>> cloth_first_node;     // [n_worlds][n_cloths]
  std::vector<std::vector<u32>> rigid_first_node;     // [n_worlds][n_rigid_bodies]

  // sites: site i is node i for i < n_nodes, then points and directions of rigid bodies
  std::vector<Site> sites;
  std::vector<WorldRange> speed_ranges;  // sites whose motion decides on convergence: points of bodies

  // terms
#define MEMBER(folder, name, Struct, stencil) Rows<Struct> name;
  ENERGY_TERMS(MEMBER)
#undef MEMBER
  std::vector<PlasticFlow> plastic_flow_4, plastic_flow_10;  // of elements of stable_neo_hookean_4 and _10
  std::vector<RollingResistance> rolling_resistance;
  std::vector<Push> pushes;
  std::vector<ForceLaw> force_law;                 // of rows of point_force
  LawTexts joint_laws, force_laws;                 // what revolute_law and prismatic_law, and what force_law number
  std::vector<std::vector<JointRows>> joint_rows;  // [n_worlds][n_joints]

  CollisionMesh collision;  // body ids: world after world, rigid bodies first, then soft ones, then cloths

  std::size_t n_nodes() const { return node_world.size(); }
  std::size_t n_worlds() const { return scenes.size(); }
};

// Throws a UsageError naming the body or joint where a scene cannot be simulated.
System make_system(std::span<const PhysicalScene> worlds);

// Bodies of a scene, counted rigid, then soft, then cloth.
std::size_t n_bodies(const PhysicalScene& scene);
const std::string& body_name(const PhysicalScene& scene, std::size_t body);

// Site ids of points and directions of rigid bodies, appended to System::sites.
u32 add_point_site(System& system, std::size_t world, int rigid, const Vec3& point);          // in the body's frame [m]
u32 add_direction_site(System& system, std::size_t world, int rigid, const Vec3& direction);  // in the body's frame

// joint.cpp: the rows of one world's joints
void add_joints(System& system, std::size_t world);

// Inertia about the body's origin as the 4 x 4 mass matrix of (p, a1, a2, a3); throws a UsageError naming the body
// where no solid can have this inertia.
Eigen::Matrix4d affine_mass_matrix(const RigidBody& body);

}  // namespace pvg
