// What can touch: the surfaces of all bodies of all worlds as points, edges and triangles over sites, and who may touch
// whom. Everything is sorted by world: bodies by their world, primitives by the world of their body.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "contact/mesh.h"
#include "host/geometry/mesh.hpp"

namespace pvg {

struct CollisionBody {
  u32 world = 0;
  bool collides_with_itself = false;  // soft bodies; a rigid one never does
  bool is_fixed = false;              // or moves as told: two of these never collide
  double offset = 0;                  // contact acts this far outside the surface [m]
  double friction = 0.5;              // coefficient; a pair's is the geometric mean unless `pair_friction` says
  bool is_half_space = false;         // its one triangle stands for the whole plane and what is below it
};

struct BodyPairFriction {
  u32 first = 0, second = 0;
  double coefficient = 0.5;
};

// Effects on the contact of a pair of bodies (host/model/effect.hpp has their laws).
struct ContactEffect {
  u32 first = 0, second = 0;
  double adhesion = 0;         // [J/m^2]
  double dissipation = 0;      // of the approach [s/m]
  double slip_change = 0;      // of the coefficient of friction, fully developed far above slip_velocity
  double slip_velocity = 0.1;  // [m/s]
  double across_change = 0;    // of the coefficient across `direction`
  u32 direction_site = 0;      // the x axis of a rigid first body
  bool has_direction = false;  // else the direction is the world's x
};

struct CollisionMesh {
  u32 n_worlds = 1;
  std::vector<CollisionBody> bodies;
  std::vector<CollisionPoint> points;
  std::vector<CollisionEdge> edges;
  std::vector<CollisionTriangle> triangles;
  // Of each site in the rest shape of its body [m]; NaN where no surface uses the site. Parts of one body act on each
  // other from half the distance that they have at rest (kernels/contact/candidate_pair.cl).
  std::vector<Vec3> rest;

  std::vector<BodyPairFriction> pair_friction;
  std::vector<ContactEffect> effects;
  std::vector<std::array<u32, 2>> noncolliding_bodies;      // jointed links and the like
  std::vector<std::array<u32, 2>> disabled_point_triangle;  // indices into points, triangles
  std::vector<std::array<u32, 2>> disabled_edge_edge;       // indices into edges, either order
};

// An edge between two triangles of one plane, of a body that does not deform, is flat: it exerts no force on other
// edges, but may not cross them either. Its normals are those of the plane only where the closest points lie inside
// both edges; beside a plane face's diagonal they would tilt. Nothing is missed: where the closest points of two
// surfaces lie inside a flat edge and another edge, their difference is normal to the plane, and so the other edge runs
// parallel to it. On the way along that edge at the same distance comes an end of it, whose distance from the plane's
// triangle counts, or an edge that bounds the plane, which is not flat.
//
// Appends the surface of one body: every point that a triangle uses, every edge once, every triangle, with areas of the
// rest shape (a triangle gives a third of its area to each corner and to each edge). Call in the order of worlds.
// site: of each point [n_points];  rest: [n_points, m]
void add_surface(CollisionMesh& mesh, u32 body, std::span<const u32> site, std::span<const Vec3> rest,
                 std::span<const Triangle> triangles);

// Records every element pair of the two bodies that is closer than `distance` [m] at x as one that never touches, such
// as a finger's surface where it is stitched to its mount. x: sites [n_sites, m]. Returns how many pairs were added.
std::size_t disable_pairs_within(CollisionMesh& mesh, u32 first_body, u32 second_body, std::span<const Vec3> x,
                                 double distance);

// Coefficient of friction of each pair of bodies of each world, or -1 where the pair never touches.
// Entry [worlds[w].first_pair + i * n_bodies + j] for the i-th and j-th body of world w; symmetric.
struct BodyPairTable {
  std::vector<u32> first;     // [n_worlds + 1] where each world's table begins
  std::vector<u32> n_bodies;  // [n_worlds]
  std::vector<u32> index;     // [n_bodies] of each body within its world
  std::vector<double> friction;
  std::vector<double> adhesion;  // [J/m^2], likewise
  double operator()(const CollisionMesh& mesh, u32 a, u32 b) const {
    const u32 world = mesh.bodies[a].world;
    return friction[first[world] + index[a] * n_bodies[world] + index[b]];
  }
};
BodyPairTable make_body_pair_table(const CollisionMesh& mesh);

// Throws std::logic_error where the mesh is not sorted by world or an index leaves its range.
void check_collision_mesh(const CollisionMesh& mesh, std::size_t n_sites);

// What makes a state unfit to start from: the first pair found of bodies that intersect (exact test on the linear
// surfaces, or one inside of the other), or that are closer than their contact offsets allow.
struct StartConflict {
  u32 world = 0, first_body = 0, second_body = 0;
  u32 first_site = 0, second_site = 0;  // a site of each element, for messages
  bool intersects = false;              // false: closer than the offsets
  double gap = 0;                       // distance minus offsets [m]; 0 where they intersect
};
// Exact test of all edges against all triangles, of all points against all half-spaces that may touch. x: [n_sites, m]
std::optional<StartConflict> find_surface_intersection(const CollisionMesh& mesh, std::span<const Vec3> x);
// A body that is inside of a closed one which it may touch, where no surface meets another: nothing would ever push it
// out. Of surfaces that do not intersect. x: [n_sites, m]
std::optional<StartConflict> find_enclosed_body(const CollisionMesh& mesh, std::span<const Vec3> x);

}  // namespace pvg
