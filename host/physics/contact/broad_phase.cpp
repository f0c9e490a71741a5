#include "host/physics/contact/broad_phase.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>

#include "host/physics/linear/tree_order.hpp"

namespace pvg {
namespace {

// the run of each world in primitives that are sorted by world: [n_worlds + 1]
template <class Primitive>
std::vector<u32> first_of_world(const CollisionMesh& mesh, const std::vector<Primitive>& primitives) {
  std::vector<u32> first(mesh.n_worlds + 1, 0);
  for (const Primitive& primitive : primitives) ++first[mesh.bodies[primitive.body].world + 1];
  for (u32 world = 0; world < mesh.n_worlds; ++world) first[world + 1] += first[world];
  return first;
}

std::vector<CollisionBodyRow> body_rows(const CollisionMesh& mesh, const BodyPairTable& table) {
  std::vector<CollisionBodyRow> rows;
  for (std::size_t i = 0; i < mesh.bodies.size(); ++i)
    rows.push_back({mesh.bodies[i].world, table.index[i], mesh.bodies[i].offset, mesh.bodies[i].is_half_space, {}});
  return rows;
}

std::vector<CollisionWorld> world_rows(std::span<const ContactSettings> settings, const BodyPairTable& table) {
  std::vector<CollisionWorld> rows;
  for (std::size_t w = 0; w < settings.size(); ++w)
    rows.push_back({table.first[w], table.n_bodies[w], settings[w].activation_distance, settings[w].stiffness,
                    settings[w].friction_velocity});
  return rows;
}

// [n_sites x 3, m]; NaN where no surface said
std::vector<double> rest_of_sites(const CollisionMesh& mesh, std::size_t n_sites) {
  std::vector<double> rest(3 * n_sites, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < std::min(n_sites, mesh.rest.size()); ++i)
    for (int k = 0; k < 3; ++k) rest[3 * i + k] = mesh.rest[i][k];
  return rest;
}

// how many leaves the largest tree needs, as a power of two
u32 find_log2_leaves(const CollisionMesh& mesh) {
  const std::vector<u32> triangles = first_of_world(mesh, mesh.triangles), edges = first_of_world(mesh, mesh.edges);
  u32 most = 1;
  for (u32 w = 0; w < mesh.n_worlds; ++w)
    most = std::max({most, triangles[w + 1] - triangles[w], edges[w + 1] - edges[w]});
  return u32(std::bit_width(most - 1));
}

// [n_bodies] which have a partner by the table, and which world's body they are
struct Participants {
  const BodyPairTable& table;
  std::vector<char> has_partner;
};

Participants find_participants(const CollisionMesh& mesh, const BodyPairTable& table) {
  Participants found{table, {}};
  for (std::size_t i = 0; i < mesh.bodies.size(); ++i) {
    const u32 world = mesh.bodies[i].world, n = table.n_bodies[world];
    const auto row = table.friction.begin() + table.first[world] + table.index[i] * n;
    found.has_partner.push_back(std::any_of(row, row + n, [](double friction) { return !(friction < 0); }));
  }
  return found;
}

// [n_bodies] which body's edges come first among those of its world: the shorter they are. An edge looks among those
// behind it, so that many short ones find the few long ones; a long one, which would find thousands, would keep a GPU
// waiting.
std::vector<u32> order_by_edge_length(const CollisionMesh& mesh, std::span<const Vec3> x) {
  std::vector<double> length(mesh.bodies.size(), 0), n(mesh.bodies.size(), 0);
  for (const CollisionEdge& edge : mesh.edges) {
    length[edge.body] += (x[edge.site[1]] - x[edge.site[0]]).norm();
    n[edge.body] += 1;
  }
  for (std::size_t i = 0; i < n.size(); ++i) length[i] /= std::max(1.0, n[i]);
  std::vector<u32> bodies(n.size()), rank(n.size());
  std::iota(bodies.begin(), bodies.end(), 0u);
  std::stable_sort(bodies.begin(), bodies.end(), [&](u32 i, u32 j) { return length[i] < length[j]; });
  for (u32 k = 0; k < bodies.size(); ++k) rank[bodies[k]] = k;
  return rank;
}

// leaves and bodies of one tree; the boxes come from the device.  rank: [n_bodies] whose leaves come first
template <class Primitive>
std::vector<u32> fill_tree(std::span<TreeNode> tree, const std::vector<Primitive>& primitives, u32 begin, u32 end,
                           std::span<const Vec3> x, std::span<const u32> rank, const Participants& participants) {
  std::vector<Vec3> centroids;
  std::vector<u32> body, rank_of_item, taken;
  for (u32 i = begin; i < end; ++i) {
    if (!participants.has_partner[primitives[i].body]) continue;
    taken.push_back(i);
    Vec3 sum = Vec3::Zero();
    for (const u32 site : primitives[i].site) sum += x[site];
    centroids.push_back(sum / double(std::size(primitives[i].site)));
    body.push_back(participants.table.index[primitives[i].body]);
    rank_of_item.push_back(rank[primitives[i].body]);
  }
  std::vector<u32> order = order_of_leaves(centroids, rank_of_item);
  const std::size_t n_leaves = tree.size() / 2;
  for (TreeNode& node : tree) node = {{}, {}, MANY_BODIES, NOTHING};
  for (std::size_t slot = 0; slot < order.size(); ++slot) {
    tree[n_leaves + slot].body = body[order[slot]];
    tree[n_leaves + slot].primitive = order[slot] = taken[order[slot]];
  }
  for (std::size_t k = n_leaves - 1; k >= 1; --k) {
    // an empty half says nothing about the body
    const TreeNode &a = tree[2 * k], &b = tree[2 * k + 1];
    tree[k].body = b.body == a.body || b.primitive == NOTHING ? a.body : MANY_BODIES;
    tree[k].primitive = a.primitive == NOTHING ? NOTHING : 0;  // above the leaves: is there anything?
  }
  return order;
}

struct Trees {
  std::vector<TreeNode> nodes;
  std::vector<Query> queries;
  std::vector<u32> first_query_of_world;
};

Trees make_trees(const CollisionMesh& mesh, std::span<const Vec3> x, const BodyPairTable& table, u32 log2_leaves) {
  const Participants participants = find_participants(mesh, table);
  const std::vector<u32> first_point = first_of_world(mesh, mesh.points), first_edge = first_of_world(mesh, mesh.edges),
                         first_triangle = first_of_world(mesh, mesh.triangles);
  const std::size_t n_nodes = std::size_t(2) << log2_leaves;
  std::vector<u32> as_given(mesh.bodies.size());
  std::iota(as_given.begin(), as_given.end(), 0u);
  const std::vector<u32> by_length = order_by_edge_length(mesh, x);
  Trees trees;
  trees.nodes.resize(2 * mesh.n_worlds * n_nodes);
  for (u32 w = 0; w < mesh.n_worlds; ++w) {
    const std::span<TreeNode> of_triangles(trees.nodes.data() + 2 * w * n_nodes, n_nodes);
    const std::span<TreeNode> of_edges(of_triangles.data() + n_nodes, n_nodes);
    fill_tree(of_triangles, mesh.triangles, first_triangle[w], first_triangle[w + 1], x, as_given, participants);
    const std::vector<u32> edges =
        fill_tree(of_edges, mesh.edges, first_edge[w], first_edge[w + 1], x, by_length, participants);
    trees.first_query_of_world.push_back(u32(trees.queries.size()));
    for (u32 i = first_point[w]; i < first_point[w + 1]; ++i)
      if (participants.has_partner[mesh.points[i].body]) trees.queries.push_back({i, 0, w, mesh.points[i].body});
    for (u32 slot = 0; slot < edges.size(); ++slot)
      trees.queries.push_back({edges[slot] | IS_EDGE, slot, w, mesh.edges[edges[slot]].body});
  }
  trees.first_query_of_world.push_back(u32(trees.queries.size()));
  return trees;
}

struct Disabled {
  std::vector<u32> first, partner;
};

// for each query the partners that it must not find
Disabled disabled_of_queries(const CollisionMesh& mesh, const std::vector<Query>& queries) {
  std::vector<std::vector<u32>> of_point(mesh.points.size()), of_edge(mesh.edges.size());
  for (const auto& [point, triangle] : mesh.disabled_point_triangle) of_point[point].push_back(triangle);
  for (const auto& [a, b] : mesh.disabled_edge_edge) {
    of_edge[a].push_back(b);
    of_edge[b].push_back(a);
  }
  Disabled disabled;
  for (const Query& query : queries) {
    disabled.first.push_back(u32(disabled.partner.size()));
    const auto& row = query.primitive & IS_EDGE ? of_edge[query.primitive & ~IS_EDGE] : of_point[query.primitive];
    disabled.partner.insert(disabled.partner.end(), row.begin(), row.end());
  }
  disabled.first.push_back(u32(disabled.partner.size()));
  return disabled;
}

// the table with the other pairs marked as never touching
BodyPairTable table_of(const CollisionMesh& mesh, PairsOf which) {
  BodyPairTable table = make_body_pair_table(mesh);
  if (which == PairsOf::all_bodies) return table;
  u32 body = 0;  // of all worlds
  for (std::size_t w = 0; w < table.n_bodies.size(); ++w)
    for (u32 a = 0; a < table.n_bodies[w]; ++a, ++body) {
      const PairsOf own = mesh.bodies[body].offset > 0 ? PairsOf::one_sheet : PairsOf::one_solid;
      for (u32 b = 0; b < table.n_bodies[w]; ++b)
        if (which != (a == b ? own : PairsOf::two_bodies))
          table.friction[table.first[w] + a * table.n_bodies[w] + b] = -1;
    }
  return table;
}

// the sites of each body's surface
struct BodySites {
  std::vector<u32> first = {0}, site;
};

BodySites sites_of_bodies(const CollisionMesh& mesh) {
  std::vector<std::vector<u32>> of_body(mesh.bodies.size());
  for (const CollisionPoint& each : mesh.points) of_body[each.body].push_back(each.site);
  for (const CollisionEdge& each : mesh.edges)
    of_body[each.body].insert(of_body[each.body].end(), each.site, each.site + 2);
  for (const CollisionTriangle& each : mesh.triangles)
    of_body[each.body].insert(of_body[each.body].end(), each.site, each.site + 3);
  BodySites all;
  for (std::vector<u32>& sites : of_body) {
    std::sort(sites.begin(), sites.end());
    sites.erase(std::unique(sites.begin(), sites.end()), sites.end());
    all.site.insert(all.site.end(), sites.begin(), sites.end());
    all.first.push_back(u32(all.site.size()));
  }
  return all;
}

// [n_bodies x 8] boxes as of contact/near_bodies.cl that hold everything
std::vector<float> everywhere(std::size_t n_bodies) {
  std::vector<float> boxes(8 * n_bodies, 0);
  for (std::size_t body = 0; body < n_bodies; ++body)
    std::fill_n(&boxes[8 * body], 6, -std::numeric_limits<float>::infinity());
  return boxes;
}

constexpr u32 LEVELS = 7;  // that one launch refits, as in contact/broad_phase.cl

}  // namespace

BroadPhase::BroadPhase(Device& device, const CollisionMesh& mesh, std::span<const ContactSettings> settings,
                       std::span<const Vec3> x, PairsOf which)
    : n_trees_(2 * mesh.n_worlds),
      log2_leaves_(find_log2_leaves(mesh)),
      // two launches more; a device apart from the host has a work-item for every query
      finds_near_bodies_(which == PairsOf::two_bodies && device.info().runs_host_functions),
      points_(device, mesh.points, "collision_points"),
      edges_(device, mesh.edges, "collision_edges"),
      triangles_(device, mesh.triangles, "collision_triangles"),
      bodies_(device, 0, "collision_bodies"),
      worlds_(device, 0, "collision_worlds"),
      rest_(device, 0, "rest_sites"),
      pair_friction_(device, 0, "pair_friction"),
      pair_adhesion_(device, 0, "pair_adhesion"),
      nodes_(device, 0, "tree_nodes"),
      queries_(device, 0, "queries"),
      disabled_first_(device, 0, "disabled_first"),
      disabled_(device, 0, "disabled"),
      first_query_of_world_(device, 0, "first_query_of_world"),
      counts_(device, 0, "pair_counts"),
      offsets_(device, 0, "pair_offsets"),
      kept_(device, 0, "kept_partners"),
      first_site_(device, 0, "first site of body"),
      sites_(device, 0, "sites of bodies"),
      near_(device, everywhere(mesh.bodies.size()), "where bodies are near"),
      boxes_(device, 6 * mesh.bodies.size(), "body boxes"),
      reference_(device, 3 * x.size(), "reference"),
      program_(device, "contact/broad_phase.cl", avx_options(device.info())),
      near_program_(device, "contact/near_bodies.cl"),
      refit_leaves_(program_.kernel("refit_leaves")),
      refit_levels_(program_.kernel("refit_levels")),
      count_pairs_(program_.kernel("count_pairs")),
      fill_pairs_(program_.kernel("fill_pairs")),
      body_boxes_(near_program_.kernel("body_boxes")),
      near_bodies_(near_program_.kernel("near_bodies")),
      scan_(device) {
  const auto upload = [](auto& buffer, const auto& values) {
    buffer.resize(values.size());
    buffer.write(values);
  };
  const BodyPairTable table = table_of(mesh, which);
  upload(bodies_, body_rows(mesh, table));
  upload(worlds_, world_rows(settings, table));
  upload(rest_, rest_of_sites(mesh, x.size()));
  upload(pair_friction_, table.friction);
  upload(pair_adhesion_, table.adhesion);
  const Trees trees = make_trees(mesh, x, table, log2_leaves_);
  upload(nodes_, trees.nodes);
  upload(queries_, trees.queries);
  upload(first_query_of_world_, trees.first_query_of_world);
  const Disabled disabled = disabled_of_queries(mesh, trees.queries);
  upload(disabled_first_, disabled.first);
  upload(disabled_, disabled.partner);
  const BodySites sites = sites_of_bodies(mesh);
  upload(first_site_, sites.first);
  upload(sites_, sites.site);
  counts_.resize(trees.queries.size());
  kept_.resize(trees.queries.size() * N_KEPT);
}

void BroadPhase::find_near_bodies(const Buffer<double>& x0, const Buffer<double>& x1, double margin) {
  const u32 n = u32(bodies_.size());
  body_boxes_(n * GROUP_SIZE, n * u32(GROUP_SIZE), first_site_, sites_, bodies_, worlds_, margin, x0, x1, boxes_);
  near_bodies_(n, n, bodies_, worlds_, pair_friction_, boxes_, near_);
}

void BroadPhase::refit(const Buffer<double>& x0, const Buffer<double>& x1, double margin) {
  const std::size_t n_leaves = std::size_t(n_trees_) << log2_leaves_;
  const std::size_t n_sites = reference_.size() / 3, n = std::max(n_leaves, n_sites);
  refit_leaves_(n, u32(n), u32(n_leaves), u32(n_sites), log2_leaves_, nodes_, edges_, triangles_, bodies_, worlds_,
                near_, margin, x0, x1, reference_);
  for (u32 level = log2_leaves_; level > 0; level -= std::min(level, LEVELS)) {
    const u32 n = n_trees_ << (level - 1);
    refit_levels_(n, n, level - 1, log2_leaves_, nodes_);
  }
}

void BroadPhase::find(const Buffer<double>& x0, const Buffer<double>& x1, double margin, WorldRows<Barrier>& pairs) {
  if (finds_nothing()) {
    pairs.first.assign(worlds_.size() + 1, 0);
    pairs.rows.resize(0);
    return;
  }
  count(x0, x1, margin);
  pairs.first = scan_.read_at(offsets_, first_query_of_world_);
  pairs.rows.resize(pairs.n());
  fill(x0, x1, margin, pairs.n(), pairs.rows);
}

void BroadPhase::start_find(const Buffer<double>& x0, const Buffer<double>& x1, double margin, u32 capacity,
                            Buffer<Barrier>& rows) {
  rows.resize(capacity);
  if (finds_nothing()) return;
  count(x0, x1, margin);
  fill(x0, x1, margin, capacity, rows);
}

void BroadPhase::count(const Buffer<double>& x0, const Buffer<double>& x1, double margin) {
  const std::size_t n = queries_.size();
  if (finds_near_bodies_) find_near_bodies(x0, x1, margin);
  refit(x0, x1, margin);
  count_pairs_(n, u32(n), log2_leaves_, queries_, nodes_, points_, edges_, triangles_, bodies_, worlds_, rest_,
               pair_friction_, disabled_first_, disabled_, near_, margin, x0, x1, counts_, kept_);
  scan_(n, counts_, offsets_);
}

void BroadPhase::fill(const Buffer<double>& x0, const Buffer<double>& x1, double margin, u32 capacity,
                      Buffer<Barrier>& rows) {
  const std::size_t n = queries_.size();
  fill_pairs_(n, u32(n), log2_leaves_, queries_, nodes_, points_, edges_, triangles_, bodies_, worlds_, rest_,
              pair_friction_, pair_adhesion_, disabled_first_, disabled_, margin, x0, x1, offsets_, kept_, capacity,
              rows);
}

}  // namespace pvg
