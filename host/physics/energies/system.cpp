#include "host/physics/energies/system.hpp"

#include <Eigen/Eigenvalues>
#include <numeric>

#include "host/geometry/tet_mesh.hpp"
#include "host/physics/energies/cloth.hpp"
#include "host/physics/energies/effects.hpp"
#include "host/physics/energies/prescribed_motion.hpp"

namespace pvg {
namespace {

constexpr u32 UNUSED_NODE = 0;                // its weight is 0
constexpr std::size_t MOST_LONE_BODIES = 32;  // that one dense factor of 12 unknowns each still pays for

// ---- nodes ------------------------------------------------------------------------------------------------------

void append(std::vector<double>& to, const Vec3& value) { to.insert(to.end(), value.data(), value.data() + 3); }

void add_node(System& system, std::size_t world, const Vec3& x, const Vec3& v, const Vec3& gravity, bool is_fixed) {
  append(system.x, x);
  append(system.v, is_fixed ? Vec3::Zero().eval() : v);
  append(system.gravity, gravity);
  system.node_world.push_back(u32(world));
  system.node_is_fixed.push_back(is_fixed);
}

void add_nodes(System& system, std::size_t world) {
  const PhysicalScene& scene = system.scenes[world];
  const u32 first = u32(system.n_nodes());
  for (const SoftBody& body : scene.soft_bodies) {
    system.soft_first_node[world].push_back(u32(system.n_nodes()));
    for (const Vec3& point : body.mesh.points)
      add_node(system, world, body.pose * point, body.velocity, scene.gravity, false);
  }
  for (const Cloth& cloth : scene.cloths) {
    system.cloth_first_node[world].push_back(u32(system.n_nodes()));
    const std::vector<char> is_pinned = cloth_is_pinned(cloth);
    for (std::size_t i = 0; i < is_pinned.size(); ++i)
      add_node(system, world, cloth.pose * cloth.mesh.points[i], cloth.velocity, scene.gravity, is_pinned[i]);
  }
  for (const RigidBody& body : scene.rigid_bodies) {
    system.rigid_first_node[world].push_back(u32(system.n_nodes()));
    add_node(system, world, body.pose.translation(), body.velocity, scene.gravity, body.is_fixed);
    for (int k = 0; k < 3; ++k) {
      const Vec3 axis = body.pose.linear().col(k);
      // gravity acts on the axes through the mass matrix, so their own share is zero
      add_node(system, world, axis, body.angular_velocity.cross(axis), Vec3::Zero(), body.is_fixed);
    }
  }
  system.node_ranges.push_back({u32(world), first, u32(system.n_nodes())});
}

// the body that a stitch draws to its rigid one
std::size_t stitched_body(const PhysicalScene& scene, const Stitch& stitch) {
  if ((stitch.soft >= 0) == (stitch.cloth >= 0))
    throw UsageError("a stitch of scene " + scene.name + " must name one soft body or one cloth");
  const std::size_t n_rigid = scene.rigid_bodies.size();
  return stitch.soft >= 0 ? n_rigid + stitch.soft : n_rigid + scene.soft_bodies.size() + stitch.cloth;
}

// ---- groups: bodies connected by joints and stitches, and rigid ones that stand alone ----------------------------

// Every node of every body with every node of every other, as contacts couple them in a stack.
void couple_by_contact(System& system, std::size_t world, const std::vector<std::size_t>& bodies) {
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      for (u32 a = 0; a < 4; ++a)
        for (u32 b = 0; b < 4; ++b)
          system.contact_couplings.push_back(
              {system.rigid_first_node[world][bodies[i]] + a, system.rigid_first_node[world][bodies[j]] + b});
}

void add_groups(System& system, std::size_t world) {
  const PhysicalScene& scene = system.scenes[world];
  const std::size_t n_rigid = scene.rigid_bodies.size(), n = n_bodies(scene);
  std::vector<std::size_t> root(n);
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](std::size_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  const auto join = [&](std::size_t a, std::size_t b) {
    const auto is_fixed = [&](std::size_t i) { return i < n_rigid && scene.rigid_bodies[i].is_fixed; };
    if (!is_fixed(a) && !is_fixed(b)) root[find(a)] = find(b);
  };
  for (const Joint& joint : scene.joints) join(joint.parent, joint.child);
  for (const Stitch& stitch : scene.stitches) join(stitch.rigid, stitched_body(scene, stitch));
  std::vector<std::size_t> n_joined(n, 0), lone;
  for (std::size_t i = 0; i < n; ++i) ++n_joined[find(i)];
  for (std::size_t i = 0; i < n_rigid; ++i)
    if (!scene.rigid_bodies[i].is_fixed && n_joined[find(i)] == 1) lone.push_back(i);
  if (lone.size() <= MOST_LONE_BODIES) {
    for (const std::size_t body : lone) join(body, lone[0]);
    couple_by_contact(system, world, lone);
  }

  std::vector<u32> group_of_root(n, NO_GROUP);
  const auto group = [&](std::size_t body) {
    u32& id = group_of_root[find(body)];
    if (id == NO_GROUP) {
      id = u32(system.group_world.size());
      system.group_world.push_back(u32(world));
    }
    return id;
  };
  for (std::size_t i = 0; i < scene.soft_bodies.size(); ++i)
    system.node_group.insert(system.node_group.end(), scene.soft_bodies[i].mesh.points.size(), group(n_rigid + i));
  for (std::size_t i = 0; i < scene.cloths.size(); ++i)
    for (const char is_pinned : cloth_is_pinned(scene.cloths[i]))
      system.node_group.push_back(is_pinned ? NO_GROUP : group(n_rigid + scene.soft_bodies.size() + i));
  for (std::size_t i = 0; i < n_rigid; ++i)
    system.node_group.insert(system.node_group.end(), 4, scene.rigid_bodies[i].is_fixed ? NO_GROUP : group(i));
}

// ---- terms ------------------------------------------------------------------------------------------------------

void check_material(const SoftBody& body) {
  const SolidMaterial& m = body.material;
  if (!(m.density > 0) || !(m.youngs_modulus > 0) || !(m.poisson_ratio >= 0 && m.poisson_ratio < 0.5))
    throw UsageError("soft body " + body.name +
                     ": density and Young's modulus must be positive and Poisson's ratio in [0, 0.5)");
}

template <class Element, int N>
Element elastic_element(const SoftBody& body, std::size_t e, u32 first_node) {
  const SolidMaterial& m = body.material;
  Element element{};
  Vec3 corner[4];
  for (int k = 0; k < N; ++k) {
    const u32 node = body.mesh.elements[e * N + k];
    element.site[k] = first_node + node;
    if (k < 4) corner[k] = body.mesh.points[node];
  }
  Mat3 shape;
  shape << corner[1] - corner[0], corner[2] - corner[0], corner[3] - corner[0];
  element.volume = shape.determinant() / 6;
  if (!(element.volume > 0))
    throw UsageError("soft body " + body.name + ": tetrahedron " + std::to_string(e) +
                     " is flat or inverted at rest; mesh the body again");
  const Mat3 inverse = shape.inverse();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) element.rest_inverse[3 * i + j] = inverse(i, j);
  element.mu = m.youngs_modulus / (2 * (1 + m.poisson_ratio));
  element.lambda = m.youngs_modulus * m.poisson_ratio / ((1 + m.poisson_ratio) * (1 - 2 * m.poisson_ratio));
  return element;
}

void add_soft_terms(System& system, std::size_t world) {
  const PhysicalScene& scene = system.scenes[world];
  for (std::size_t b = 0; b < scene.soft_bodies.size(); ++b) {
    const SoftBody& body = scene.soft_bodies[b];
    check_material(body);
    const u32 first = system.soft_first_node[world][b];
    const std::vector<double> masses = node_masses(body.mesh, body.material.density);
    for (std::size_t i = 0; i < masses.size(); ++i)
      system.point_inertia.rows.push_back({{first + u32(i)}, 0, masses[i]});
    for (std::size_t e = 0; e < body.mesh.n_elements(); ++e) {
      if (body.mesh.nodes_per_element == 10)
        system.stable_neo_hookean_10.rows.push_back(elastic_element<StableNeoHookean10, 10>(body, e, first));
      else
        system.stable_neo_hookean_4.rows.push_back(elastic_element<StableNeoHookean4, 4>(body, e, first));
    }
  }
}

void add_cloth_terms(System& system, std::size_t world) {
  const PhysicalScene& scene = system.scenes[world];
  for (std::size_t b = 0; b < scene.cloths.size(); ++b) {
    const Cloth& cloth = scene.cloths[b];
    check_cloth(cloth);
    const u32 first = system.cloth_first_node[world][b];
    const std::vector<double> masses = cloth_node_masses(cloth);
    for (std::size_t i = 0; i < masses.size(); ++i)
      system.point_inertia.rows.push_back({{first + u32(i)}, 0, masses[i]});
    for (const ClothMembrane& element : cloth_membrane_elements(cloth, first))
      system.cloth_membrane.rows.push_back(element);
    for (const TriangleBending& element : triangle_bending_elements(cloth, first))
      system.triangle_bending.rows.push_back(element);
  }
}

void add_rigid_terms(System& system, std::size_t world) {
  const PhysicalScene& scene = system.scenes[world];
  for (std::size_t b = 0; b < scene.rigid_bodies.size(); ++b) {
    const RigidBody& body = scene.rigid_bodies[b];
    if (body.is_fixed) continue;
    const u32 first = system.rigid_first_node[world][b];
    AffineInertia inertia{{first, first + 1, first + 2, first + 3}, {}};
    const Eigen::Matrix4d mass = body.is_prescribed ? prescribed_mass_matrix(body) : affine_mass_matrix(body);
    for (int i = 0, k = 0; i < 4; ++i)
      for (int j = i; j < 4; ++j) inertia.mass[k++] = mass(i, j);
    system.affine_inertia.rows.push_back(inertia);
    if (body.is_prescribed) continue;  // where it is to be is a rotation already
    if (!(body.volume > 0) || !(body.affine_modulus > 0))
      throw UsageError("rigid body " + body.name + " needs a positive volume and affine modulus");
    system.affine_orthogonality.rows.push_back(
        {{first + 1, first + 2, first + 3}, 0, body.affine_modulus * body.volume, 0});
  }
}

void add_stitches(System& system, std::size_t world) {
  const PhysicalScene& scene = system.scenes[world];
  for (const Stitch& stitch : scene.stitches) {
    stitched_body(scene, stitch);
    const bool is_cloth = stitch.cloth >= 0;
    const u32 first =
        is_cloth ? system.cloth_first_node[world][stitch.cloth] : system.soft_first_node[world][stitch.soft];
    const Pose to_rigid = scene.rigid_bodies[stitch.rigid].pose.inverse();
    const bool has_direction = stitch.direction.norm() > 0;
    const u32 direction =
        has_direction ? add_direction_site(system, world, stitch.rigid, stitch.direction.normalized()) : 0;
    for (const u32 node : stitch.nodes) {
      const u32 soft_site = first + node;
      const Vec3 start = Eigen::Map<const Vec3>(&system.x[3 * soft_site]);
      const u32 rigid_site = add_point_site(system, world, stitch.rigid, to_rigid * start);
      if (!has_direction) {
        system.zero_length_spring.rows.push_back({{soft_site, rigid_site}, stitch.stiffness});
        continue;
      }
      PrismaticDrive row{};  // its law along one direction is what rollers do
      row.site[0] = rigid_site;
      row.site[1] = soft_site;
      row.site[2] = direction;
      row.stiffness = stitch.stiffness;
      system.prismatic_drive.rows.push_back(row);
    }
  }
}

// ---- collision --------------------------------------------------------------------------------------------------

void add_collision_bodies(System& system, std::size_t world) {
  const PhysicalScene& scene = system.scenes[world];
  CollisionMesh& mesh = system.collision;
  const u32 first_body = u32(mesh.bodies.size()), n_rigid = u32(scene.rigid_bodies.size());
  for (const RigidBody& body : scene.rigid_bodies)
    mesh.bodies.push_back({u32(world), false, body.is_fixed || body.is_prescribed, body.contact_offset, body.friction,
                           body.is_half_space});
  for (const SoftBody& body : scene.soft_bodies)
    mesh.bodies.push_back({u32(world), true, false, body.contact_offset, body.friction});
  for (const Cloth& cloth : scene.cloths)
    mesh.bodies.push_back({u32(world), true, false, cloth.material.thickness / 2, cloth.friction});
  for (u32 b = 0; b < n_rigid; ++b) {
    const RigidBody& body = scene.rigid_bodies[b];
    std::vector<u32> site;
    const u32 first_site = u32(system.sites.size());
    if (body.is_half_space) {  // three points of its plane, counterclockwise seen from outside
      for (const Vec3& point : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)})
        site.push_back(add_point_site(system, world, int(b), point));
      mesh.triangles.push_back({{site[0], site[1], site[2]}, first_body + b});
      continue;
    }
    for (const Vec3& point : body.collision.points) site.push_back(add_point_site(system, world, int(b), point));
    add_surface(mesh, first_body + b, site, body.collision.points, body.collision.triangles);
    if (!body.is_fixed) system.speed_ranges.push_back({u32(world), first_site, u32(system.sites.size())});
    if (!body.is_fixed && site.empty()) {  // nothing touches it: its frame's axes stand for its motion
      const u32 node = system.rigid_first_node[world][b];
      system.speed_ranges.push_back({u32(world), node, node + 4});
    }
  }
  for (u32 b = 0; b < scene.soft_bodies.size(); ++b) {
    const SoftBody& body = scene.soft_bodies[b];
    const u32 first = system.soft_first_node[world][b];
    std::vector<u32> site(body.mesh.points.size());
    std::iota(site.begin(), site.end(), first);
    add_surface(mesh, first_body + n_rigid + b, site, body.mesh.points, body.mesh.surface);
    system.speed_ranges.push_back({u32(world), first, first + u32(site.size())});
  }
  for (u32 b = 0; b < scene.cloths.size(); ++b) {
    const TriangleMesh& cloth = scene.cloths[b].mesh;
    const u32 first = system.cloth_first_node[world][b];
    std::vector<u32> site(cloth.points.size());
    std::iota(site.begin(), site.end(), first);
    add_surface(mesh, first_body + n_rigid + u32(scene.soft_bodies.size()) + b, site, cloth.points, cloth.triangles);
    system.speed_ranges.push_back({u32(world), first, first + u32(site.size())});
  }
  for (const Joint& joint : scene.joints)
    mesh.noncolliding_bodies.push_back({first_body + u32(joint.parent), first_body + u32(joint.child)});
  for (const auto& [a, b] : scene.noncolliding_rigid_bodies)
    mesh.noncolliding_bodies.push_back({first_body + u32(a), first_body + u32(b)});
  const auto body_id = [&](const std::string& name) -> u32 {
    for (u32 b = 0; b < n_bodies(scene); ++b)
      if (body_name(scene, b) == name) return first_body + b;
    throw UsageError("friction of a pair: the scene has no body " + name);
  };
  for (const PairFriction& pair : scene.pair_friction)
    mesh.pair_friction.push_back({body_id(pair.first), body_id(pair.second), pair.coefficient});
}

// stitched surfaces start together and stay together by construction: their element pairs never touch
void disable_stitched_pairs(System& system) {
  std::vector<Vec3> x;
  for (const Site& site : system.sites) {
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < 4; ++k) sum += site.weight[k] * Eigen::Map<const Vec3>(&system.x[3 * site.node[k]]);
    x.push_back(sum);
  }
  u32 first_body = 0;
  for (const PhysicalScene& scene : system.scenes) {
    for (const Stitch& stitch : scene.stitches)
      disable_pairs_within(system.collision, first_body + stitch.rigid, first_body + u32(stitched_body(scene, stitch)),
                           x, 2 * scene.contact.activation_distance);
    first_body += u32(n_bodies(scene));
  }
}

}  // namespace

std::size_t n_bodies(const PhysicalScene& scene) {
  return scene.rigid_bodies.size() + scene.soft_bodies.size() + scene.cloths.size();
}

const std::string& body_name(const PhysicalScene& scene, std::size_t body) {
  const std::size_t n_rigid = scene.rigid_bodies.size(), n_soft = scene.soft_bodies.size();
  if (body < n_rigid) return scene.rigid_bodies[body].name;
  return body < n_rigid + n_soft ? scene.soft_bodies[body - n_rigid].name : scene.cloths[body - n_rigid - n_soft].name;
}

u32 add_point_site(System& system, std::size_t world, int rigid, const Vec3& point) {
  const u32 p = system.rigid_first_node[world][rigid];
  system.sites.push_back({{p, p + 1, p + 2, p + 3}, {1, point.x(), point.y(), point.z()}});
  return u32(system.sites.size() - 1);
}

u32 add_direction_site(System& system, std::size_t world, int rigid, const Vec3& direction) {
  const u32 p = system.rigid_first_node[world][rigid];
  system.sites.push_back({{p, p + 1, p + 2, p + 3}, {0, direction.x(), direction.y(), direction.z()}});
  return u32(system.sites.size() - 1);
}

// M = integral of rho [1, X]^T [1, X] = [m, m c^T; m c, S] with S = tr(I)/2 - I about the body's origin
Eigen::Matrix4d affine_mass_matrix(const RigidBody& body) {
  const Mat3 second = 0.5 * body.inertia.trace() * Mat3::Identity() - body.inertia;
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(second);
  if (!(body.mass > 0) || !(eigen.eigenvalues().minCoeff() > 0))
    throw UsageError("rigid body " + body.name +
                     ": mass must be positive and the principal inertias must obey the triangle inequality");
  Eigen::Matrix4d mass;
  mass(0, 0) = body.mass;
  mass.block<3, 1>(1, 0) = body.mass * body.center_of_mass;
  mass.block<1, 3>(0, 1) = body.mass * body.center_of_mass.transpose();
  mass.block<3, 3>(1, 1) = second + body.mass * body.center_of_mass * body.center_of_mass.transpose();
  return mass;
}

System make_system(std::span<const PhysicalScene> worlds) {
  System system;
  for (const PhysicalScene& world : worlds) system.scenes.push_back(with_effects(world));
  const std::size_t n = worlds.size();
  system.soft_first_node.resize(n);
  system.cloth_first_node.resize(n);
  system.rigid_first_node.resize(n);
  for (std::size_t w = 0; w < n; ++w) {
    add_nodes(system, w);
    add_groups(system, w);
  }
  for (u32 node = 0; node < system.n_nodes(); ++node)
    system.sites.push_back({{node, UNUSED_NODE, UNUSED_NODE, UNUSED_NODE}, {1, 0, 0, 0}});
  system.collision.n_worlds = u32(n);
  for (std::size_t w = 0; w < n; ++w) {
    add_soft_terms(system, w);
    add_cloth_terms(system, w);
    add_rigid_terms(system, w);
    add_stitches(system, w);
    add_joints(system, w);
    add_body_effects(system, w);
    add_collision_bodies(system, w);
    add_contact_effects(system, w);
#define END_WORLD(folder, name, Struct, stencil) system.name.end_world();
    ENERGY_TERMS(END_WORLD)
#undef END_WORLD
  }
  disable_stitched_pairs(system);
  check_collision_mesh(system.collision, system.sites.size());
  return system;
}

}  // namespace pvg
