// Contacts of whole bodies: what is found, how far a motion may go, what pushes whom, and what cannot start.
#include "host/physics/contact/contact.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>

namespace pvg {
namespace {

struct Bodies {
  CollisionMesh mesh;
  std::vector<Vec3> x;  // [n_sites, m]
};

// a box of the given size whose faces are two triangles each; corners are its sites
void add_box(Bodies& bodies, const CollisionBody& body, const Vec3& low, const Vec3& size) {
  std::vector<u32> site;
  std::vector<Vec3> rest;
  for (u32 k = 0; k < 8; ++k) {
    rest.push_back(low + Vec3((k & 1) * size[0], (k >> 1 & 1) * size[1], (k >> 2) * size[2]));
    site.push_back(u32(bodies.x.size()));
    bodies.x.push_back(rest.back());
  }
  const std::vector<Triangle> triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                           {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  bodies.mesh.bodies.push_back(body);
  add_surface(bodies.mesh, u32(bodies.mesh.bodies.size()) - 1, site, rest, triangles);
}

// a fixed table of 1 m and a cube of 0.1 m, `gap` above it
void add_cube_on_table(Bodies& bodies, u32 world, double gap, double offset = 0) {
  add_box(bodies, {.world = world, .is_fixed = true, .offset = offset, .friction = 0.4}, Vec3(-0.5, -0.5, -0.1),
          Vec3(1, 1, 0.1));
  add_box(bodies, {.world = world, .offset = offset, .friction = 0.9}, Vec3(-0.03, -0.04, gap), Vec3(0.1, 0.1, 0.1));
}

Bodies cube_on_table(double gap, double offset = 0) {
  Bodies bodies;
  add_cube_on_table(bodies, 0, gap, offset);
  return bodies;
}

std::vector<double> flat(const std::vector<Vec3>& x) {
  std::vector<double> values;
  for (const Vec3& p : x) values.insert(values.end(), {p[0], p[1], p[2]});
  return values;
}

std::vector<Vec3> cube_moved(std::vector<Vec3> x, const Vec3& by) {
  for (std::size_t i = 8; i < 16; ++i) x[i] += by;
  return x;
}

const ContactSettings SETTINGS = {.activation_distance = 1e-3, .stiffness = 1e7, .friction_velocity = 1e-3};

struct Trial {
  Device device;
  Bodies bodies;
  ContactSet contact;
  explicit Trial(const Bodies& b)
      : bodies(b), contact(device, b.mesh, std::vector<ContactSettings>(b.mesh.n_worlds, SETTINGS), b.x) {}
  Buffer<double> upload(const std::vector<Vec3>& x) { return Buffer<double>(device, flat(x), "x"); }
};

TEST(ContactSet, CubeOnTheTableTouchesWithItsLowerFace) {
  Trial trial(cube_on_table(5e-4));
  const Buffer<double> x = trial.upload(trial.bodies.x);
  trial.contact.find_candidates(x, x);
  trial.contact.find_contacts(x);
  u32 n_points = 0;
  for (const Barrier& row : trial.contact.contacts().rows.read()) {
    // lower corners are sites 8 .. 11
    n_points += row.kind == POINT_TRIANGLE && row.body[0] == 1 && row.site[0] < 12;
    EXPECT_EQ(row.body[0] + row.body[1], 1u);
    EXPECT_NEAR(row.friction, 0.6, 1e-15);  // sqrt(0.4 0.9)
  }
  EXPECT_GE(n_points, 4u);
  EXPECT_NEAR(trial.contact.min_gap(x)[0], 5e-4, 1e-15);
}

// What lists of contacts depend on is told even where their number stays the same.
TEST(ContactSet, OtherPairsAreAChangeAndTheSameOnesAreNone) {
  Trial trial(cube_on_table(5e-4));
  const auto find = [&](const Vec3& by) {
    const Buffer<double> x = trial.upload(cube_moved(trial.bodies.x, by));
    trial.contact.find_candidates(x, x);
    trial.contact.find_contacts(x);
    return trial.contact.contacts().n();
  };
  const u32 n = find({-0.3, -0.3, 0});  // above one of the table's triangles
  EXPECT_EQ(trial.contact.last_change(), trial.contact.search());
  const u32 last_change = trial.contact.last_change();
  EXPECT_EQ(find({-0.301, -0.3, 0}), n);
  EXPECT_EQ(trial.contact.last_change(), last_change);
  EXPECT_GT(trial.contact.search(), last_change);
  EXPECT_EQ(find({0.3, 0.3, 0}), n);  // above the other
  EXPECT_EQ(trial.contact.last_change(), trial.contact.search());
}

// A soft strip of two layers of triangles, 0.4 mm apart and with sides of 0.6 mm: closer than the activation distance
// of 1 mm everywhere. `squeeze` brings the layers together.
Bodies thin_soft_block(double squeeze) {
  Bodies bodies;
  add_box(bodies, {.collides_with_itself = true}, Vec3::Zero(), Vec3(6e-4, 6e-4, 4e-4));
  for (Vec3& p : bodies.x) p[2] *= 1 - squeeze;
  return bodies;
}

TEST(ContactSet, BodyAtRestDoesNotPushItselfApartHoweverSmall) {
  for (const double offset : {0.0, 1e-3}) {
    Bodies bodies = thin_soft_block(0);
    bodies.mesh.bodies[0].offset = offset;
    Trial trial(bodies);
    const Buffer<double> x = trial.upload(bodies.x);
    trial.contact.find_candidates(x, x);
    trial.contact.find_contacts(x);
    EXPECT_EQ(trial.contact.contacts().n(), 0u);
    EXPECT_FALSE(trial.contact.find_start_conflict(bodies.x).has_value());
  }
}

TEST(ContactSet, BodySqueezedBelowHalfItsRestGapPushesBack) {
  Trial trial(thin_soft_block(0));
  const std::vector<Vec3> squeezed = thin_soft_block(0.6).x, flat_block = thin_soft_block(1.1).x;
  const Buffer<double> x = trial.upload(squeezed);
  trial.contact.find_candidates(x, x);
  trial.contact.find_contacts(x);
  ASSERT_GT(trial.contact.contacts().n(), 0u);
  double widest = 0;
  for (const Barrier& row : trial.contact.contacts().rows.read()) widest = std::max(widest, row.activation_distance);
  EXPECT_NEAR(widest, 2e-4, 1e-12);  // half of the 0.4 mm between the layers
  // and it cannot be pushed through itself
  const Buffer<double> through = trial.upload(flat_block);
  const Buffer<double> rest = trial.upload(trial.bodies.x);
  trial.contact.find_candidates(rest, through);
  EXPECT_LT(trial.contact.largest_step(rest, through)[0], 1 / 1.1);
}

TEST(ContactSet, FarBodiesHaveNoCandidatesAndMayGoAnywhere) {
  Trial trial(cube_on_table(0.1));
  const Buffer<double> x0 = trial.upload(trial.bodies.x);
  const Buffer<double> x1 = trial.upload(cube_moved(trial.bodies.x, Vec3(0, 0, 1)));
  trial.contact.find_candidates(x0, x1);
  EXPECT_EQ(trial.contact.candidates().n(), 0u);
  EXPECT_EQ(trial.contact.largest_step(x0, x1), std::vector<double>{1});
  trial.contact.find_contacts(x0);
  EXPECT_EQ(trial.contact.contacts().n(), 0u);
  EXPECT_TRUE(std::isinf(trial.contact.min_gap(x0)[0]));
  trial.contact.lag_friction(x0, 0.01, x0, x0);
  EXPECT_EQ(trial.contact.friction().n(), 0u);
  EXPECT_TRUE(trial.contact.forces(x0, x0, 0.01)[0].empty());
}

TEST(ContactSet, FallThroughTheTableIsStoppedAtItsFace) {
  for (const double offset : {0.0, 0.02}) {
    Trial trial(cube_on_table(0.1, offset));
    const Buffer<double> x0 = trial.upload(trial.bodies.x);
    const Buffer<double> x1 = trial.upload(cube_moved(trial.bodies.x, Vec3(0, 0, -10)));
    trial.contact.find_candidates(x0, x1);
    const double step = trial.contact.largest_step(x0, x1)[0], touching = (0.1 - 2 * offset) / 10;
    EXPECT_LT(step, touching);
    EXPECT_GE(step, 0.9 * touching - 1e-12);
  }
}

// The normal forces are -dE/dz of the barrier energy and act on the cube upward, as much as on the table downward.
TEST(ContactSet, NormalForcesAreTheSlopeOfTheEnergy) {
  Trial trial(cube_on_table(4e-4));
  Program program(trial.device, "energies/contact/barrier.cl");
  Kernel energy_kernel = program.kernel("barrier_energy_all");
  const Buffer<double> x = trial.upload(trial.bodies.x);
  trial.contact.find_candidates(x, x);
  trial.contact.find_contacts(x);
  const auto energy = [&](double z) {
    const u32 n = trial.contact.candidates().n();
    const Buffer<double> moved = trial.upload(cube_moved(trial.bodies.x, Vec3(0, 0, z)));
    Buffer<double> energies(trial.device, n, "energies");
    energy_kernel(n, n, trial.contact.candidates().rows, moved, moved, 0.01, 0u, energies);
    double sum = 0;
    for (const double e : energies.read()) sum += e;
    return sum;
  };
  double lift = 0;
  const std::vector<ContactForce> forces = trial.contact.forces(x, x, 0.01)[0];
  for (const ContactForce& force : forces) {
    EXPECT_NEAR(force.gap, 4e-4, 1e-12);
    EXPECT_NEAR(force.point[2], 2e-4, 1e-12);
    EXPECT_NEAR(std::abs(force.normal[2]), 1, 1e-12);
    EXPECT_EQ(force.friction_force, Vec3::Zero());
    lift += force.normal_force * force.normal[2] * (force.first == 1 ? 1 : -1);
  }
  EXPECT_NEAR(lift, -(energy(1e-8) - energy(-1e-8)) / 2e-8, 1e-5 * lift);
  EXPECT_GT(lift, 1);
}

TEST(ContactSet, FrictionPullsAgainstTheSlidingWithTheLaggedForce) {
  Trial trial(cube_on_table(4e-4));
  const double h = 0.01;
  const Buffer<double> x0 = trial.upload(trial.bodies.x);
  // far beyond epsilon_v h = 1e-5 m
  const Buffer<double> x = trial.upload(cube_moved(trial.bodies.x, Vec3(3e-4, 0, 0)));
  trial.contact.find_candidates(x0, x);
  trial.contact.find_contacts(x0);
  trial.contact.lag_friction(x0, 0.01, x0, x0);
  double lagged = 0;
  for (const Friction& row : trial.contact.friction().rows.read()) lagged += row.normal_force;
  trial.contact.find_contacts(x);
  Vec3 on_cube = Vec3::Zero();
  const std::vector<ContactForce> forces = trial.contact.forces(x, x0, h)[0];
  for (const ContactForce& force : forces) on_cube += force.friction_force * (force.first == 1 ? 1 : -1);
  EXPECT_NEAR(on_cube[0], -0.6 * lagged, 1e-9 * lagged);
  EXPECT_NEAR(on_cube[1], 0, 1e-9 * lagged);
  trial.contact.lagged().clear();
  EXPECT_EQ(trial.contact.friction().n(), 0u);
}

u32 n_flat(const CollisionMesh& mesh) {
  u32 n = 0;
  for (const CollisionEdge& edge : mesh.edges) n += edge.is_flat;
  return n;
}

TEST(CollisionMesh, OnlyTheDiagonalsOfARigidBoxAreFlat) {
  Bodies rigid, soft;
  add_box(rigid, {}, Vec3::Zero(), Vec3(0.1, 0.2, 0.3));
  add_box(soft, {.collides_with_itself = true}, Vec3::Zero(), Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(rigid.mesh.edges.size(), 18u);
  EXPECT_EQ(n_flat(rigid.mesh), 6u);
  for (const CollisionEdge& edge : rigid.mesh.edges)
    EXPECT_EQ(edge.is_flat != 0, ((rigid.x[edge.site[0]] - rigid.x[edge.site[1]]).array() != 0).count() == 2);
  EXPECT_EQ(n_flat(soft.mesh), 0u);
}

// an edge of the cube ends 0.2 mm beside the diagonal of the table, which would push it aside
TEST(ContactSet, EdgesBesideTheDiagonalOfATableAreNotPushedAside) {
  Bodies bodies;
  add_box(bodies, {.is_fixed = true}, Vec3(-0.5, -0.5, -0.1), Vec3(1, 1, 0.1));
  add_box(bodies, {}, Vec3(0.0002 * std::sqrt(2), -0.1, 5e-4), Vec3(0.1, 0.1, 0.1));
  Trial trial(bodies);
  const Buffer<double> x = trial.upload(bodies.x);
  trial.contact.find_candidates(x, x);
  trial.contact.find_contacts(x);
  const std::vector<Barrier> rows = trial.contact.candidates().rows.read();
  EXPECT_TRUE(std::any_of(rows.begin(), rows.end(), [](const Barrier& row) { return row.area == 0; }));
  const std::vector<ContactForce> forces = trial.contact.forces(x, x, 0.01)[0];
  EXPECT_FALSE(forces.empty());
  for (const ContactForce& force : forces) {
    EXPECT_GT(force.normal_force, 0);
    EXPECT_EQ(force.kind, ContactForce::Kind::point_triangle);  // inside the table's face its corners carry it
  }
}

// the diagonals of two faces, one above the other
TEST(ContactSet, FlatEdgesMayNotCross) {
  Bodies bodies;
  add_box(bodies, {}, Vec3(-0.5, -0.5, -0.1), Vec3(1, 1, 0.1));
  add_box(bodies, {}, Vec3(-0.2, -0.2, 1e-3), Vec3(0.4, 0.4, 0.1));
  Trial trial(bodies);
  const Buffer<double> x0 = trial.upload(bodies.x);
  std::vector<Vec3> through = bodies.x;
  for (std::size_t i = 8; i < 16; ++i) through[i] -= Vec3(0, 0, 0.01);
  const Buffer<double> x1 = trial.upload(through);
  trial.contact.find_candidates(x0, x1);
  Program program(trial.device, "contact/accd_steps.cl");
  Kernel steps_kernel = program.kernel("accd_steps");
  const u32 n = trial.contact.candidates().n();
  Buffer<double> steps(trial.device, n, "steps");
  Buffer<double> of_64(trial.device, (n + 63) / 64, "least_of_64");
  steps_kernel(n, n, trial.contact.candidates().rows, x0, x1, steps, of_64);
  const std::vector<double> step = steps.read();
  const std::vector<Barrier> rows = trial.contact.candidates().rows.read();
  int n_stopped = 0;
  for (u32 i = 0; i < n; ++i) n_stopped += rows[i].area == 0 && step[i] < 0.1;
  EXPECT_GT(n_stopped, 0);
}

template <class Row>
std::vector<Row> of_world(const WorldRows<Row>& rows, u32 world, u32 first_site, u32 first_body) {
  std::vector<Row> found = rows.rows.read(rows.first[world], rows.first[world + 1] - rows.first[world]);
  for (Row& row : found) {
    for (u32& site : row.site) site -= first_site;
    for (u32& body : row.body) body -= first_body;
    row.world = 0;
  }
  return found;
}

TEST(ContactSet, AWorldInCompanyGivesTheBitsOfTheWorldAlone) {
  Bodies many;
  many.mesh.n_worlds = 3;
  add_cube_on_table(many, 0, 2e-4);
  add_cube_on_table(many, 1, 4e-4);
  add_box(many, {.world = 1}, Vec3(0.1, 0.1, 0.3), Vec3(0.1, 0.1, 0.1));
  add_box(many, {.world = 2}, Vec3(0, 0, 0), Vec3(0.1, 0.1, 0.1));
  Bodies one;
  add_cube_on_table(one, 0, 4e-4);
  add_box(one, {.world = 0}, Vec3(0.1, 0.1, 0.3), Vec3(0.1, 0.1, 0.1));
  const auto fall = [](std::vector<Vec3> x, std::size_t first) {
    for (std::size_t i = first + 8; i < first + 16; ++i) x[i] += Vec3(1e-3, 2e-3, -1e-3);
    return x;
  };
  Trial alone(one), company(many);
  const auto run = [](Trial& trial, const std::vector<Vec3>& target) {
    const Buffer<double> x0 = trial.upload(trial.bodies.x), x1 = trial.upload(target);
    trial.contact.find_candidates(x0, x1);
    const std::vector<double> step = trial.contact.largest_step(x0, x1);
    trial.contact.find_contacts(x0);
    trial.contact.lag_friction(x0, 0.01, x0, x0);
    return step;
  };
  const double expected = run(alone, fall(one.x, 0))[0];
  const std::vector<double> found = run(company, fall(fall(many.x, 16), 0));
  EXPECT_EQ(found[1], expected);
  EXPECT_EQ(found[2], 1);
  const auto expect_same = [](const auto& a, const auto& b) {
    ASSERT_EQ(a.size(), b.size());
    ASSERT_FALSE(a.empty());
    EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]), 0);
  };
  expect_same(of_world(alone.contact.candidates(), 0, 0, 0), of_world(company.contact.candidates(), 1, 16, 2));
  expect_same(of_world(alone.contact.contacts(), 0, 0, 0), of_world(company.contact.contacts(), 1, 16, 2));
  expect_same(of_world(alone.contact.friction(), 0, 0, 0), of_world(company.contact.friction(), 1, 16, 2));
}

TEST(ContactSet, StartInsideAnotherBodyIsNamed) {
  Bodies bodies;
  bodies.mesh.n_worlds = 2;
  add_cube_on_table(bodies, 0, 1e-3);
  add_cube_on_table(bodies, 1, -0.01);
  Trial trial(bodies);
  const auto conflict = trial.contact.find_start_conflict(bodies.x);
  ASSERT_TRUE(conflict);
  EXPECT_TRUE(conflict->intersects);
  EXPECT_EQ(conflict->world, 1u);
  EXPECT_EQ(std::minmax({conflict->first_body, conflict->second_body}), std::minmax({2u, 3u}));
}

// Where a body is inside of another one as a whole no surface meets another, and no contact pushes it out.
TEST(ContactSet, StartEnclosedByAnotherBodyIsNamed) {
  const auto with_pebble = [](const Vec3& low) {
    Bodies bodies = cube_on_table(1e-3);
    add_box(bodies, {}, low, Vec3(0.02, 0.02, 0.02));
    return bodies;
  };
  Bodies bodies = with_pebble({0.2, 0.2, -0.06});
  Trial trial(bodies);
  const auto conflict = trial.contact.find_start_conflict(bodies.x);
  ASSERT_TRUE(conflict);
  EXPECT_TRUE(conflict->intersects);
  EXPECT_EQ(conflict->first_body, 2u);
  EXPECT_EQ(conflict->second_body, 0u);
  Trial above(with_pebble({0.2, 0.2, 0.06}));
  EXPECT_FALSE(above.contact.find_start_conflict(above.bodies.x));
  bodies.mesh.noncolliding_bodies.push_back({0, 2});
  Trial passing(bodies);
  EXPECT_FALSE(passing.contact.find_start_conflict(bodies.x));
}

TEST(ContactSet, StartWithinTheOffsetsIsNamed) {
  Trial trial(cube_on_table(1.5e-3, 1e-3));
  const auto conflict = trial.contact.find_start_conflict(trial.bodies.x);
  ASSERT_TRUE(conflict);
  EXPECT_FALSE(conflict->intersects);
  EXPECT_NEAR(conflict->gap, -5e-4, 1e-12);
  EXPECT_EQ(conflict->first_body + conflict->second_body, 1u);
  Trial apart(cube_on_table(2.5e-3, 1e-3));
  EXPECT_FALSE(apart.contact.find_start_conflict(apart.bodies.x));
}

TEST(ContactSet, PairsThatNeverCollideMayIntersectAtTheStart) {
  Bodies bodies = cube_on_table(-0.01);
  bodies.mesh.noncolliding_bodies.push_back({1, 0});
  Trial trial(bodies);
  EXPECT_FALSE(trial.contact.find_start_conflict(bodies.x));
  Bodies stitched = cube_on_table(0);  // face on face
  EXPECT_TRUE(find_surface_intersection(stitched.mesh, stitched.x));
  EXPECT_GT(disable_pairs_within(stitched.mesh, 1, 0, stitched.x, 1e-6), 0u);
  EXPECT_FALSE(find_surface_intersection(stitched.mesh, stitched.x));
}

TEST(ContactSet, SettingsWithoutActivationDistanceAreRefused) {
  Device device;
  const Bodies bodies = cube_on_table(0.1);
  EXPECT_THROW(ContactSet(device, bodies.mesh, std::vector<ContactSettings>{{.activation_distance = 0}}, bodies.x),
               UsageError);
  EXPECT_THROW(ContactSet(device, bodies.mesh, std::vector<ContactSettings>(2), bodies.x), std::logic_error);
}

}  // namespace
}  // namespace pvg
