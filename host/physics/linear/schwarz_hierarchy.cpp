#include "host/physics/linear/schwarz_hierarchy.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <numeric>

#include "host/geometry/mesh.hpp"

namespace pvg {
namespace {

constexpr u32 N_COARSE = 4;        // functions of a cluster
constexpr double SMALLEST = 1e-9;  // of a coarse function beside the largest: below it depends on the others

// What is clustered on one level: nodes, frames of rigid bodies, or clusters of the level below.
struct Item {
  Vec3 position;
  u32 world = 0, n_slots = 0;
  Eigen::Matrix<double, 4, 4> modes;  // of its slots (rows): values of 1, x, y, z
  std::vector<u32> neighbours;        // items, ascending
};

using Items = std::vector<u32>;

u32 slots_of(const std::vector<Item>& items, const Items& of) {
  return std::accumulate(of.begin(), of.end(), 0u, [&](u32 sum, u32 i) { return sum + items[i].n_slots; });
}

// Halves across the longest axis until each part fits.
void bisect(const std::vector<Item>& items, Items part, u32 width, std::vector<Items>& parts) {
  if (slots_of(items, part) <= width) {
    std::sort(part.begin(), part.end());
    parts.push_back(std::move(part));
    return;
  }
  Vec3 low = items[part[0]].position, high = low;
  for (const u32 i : part) {
    low = low.cwiseMin(items[i].position);
    high = high.cwiseMax(items[i].position);
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const auto middle = part.begin() + std::ptrdiff_t(part.size() / 2);
  std::nth_element(part.begin(), middle, part.end(), [&](u32 a, u32 b) {
    const double at = items[a].position[axis], bt = items[b].position[axis];
    return at != bt ? at < bt : a < b;
  });
  bisect(items, Items(part.begin(), middle), width, parts);
  bisect(items, Items(middle, part.end()), width, parts);
}

// The parts of a set that its items' neighbours hold together, each ascending, in the order of their first.
std::vector<Items> connected_parts(const std::vector<Item>& items, const Items& set) {
  enum : char { OUTSIDE, WAITING, TAKEN };
  std::vector<char> mark(items.size(), OUTSIDE);
  for (const u32 i : set) mark[i] = WAITING;
  std::vector<Items> parts;
  for (const u32 seed : set) {
    if (mark[seed] == TAKEN) continue;
    Items part{seed};
    mark[seed] = TAKEN;
    for (std::size_t k = 0; k < part.size(); ++k)
      for (const u32 j : items[part[k]].neighbours)
        if (mark[j] == WAITING) {
          mark[j] = TAKEN;
          part.push_back(j);
        }
    std::sort(part.begin(), part.end());
    parts.push_back(std::move(part));
  }
  return parts;
}

std::vector<Items> by_world(const std::vector<Item>& items) {
  std::vector<Items> worlds;
  for (u32 i = 0; i < items.size(); ++i) {
    if (items[i].world >= worlds.size()) worlds.resize(items[i].world + 1);
    worlds[items[i].world].push_back(i);
  }
  std::erase_if(worlds, [](const Items& world) { return world.empty(); });
  return worlds;
}

std::vector<Items> cluster(const std::vector<Item>& items, u32 width) {
  std::vector<Items> bodies, clusters;
  for (const Items& world : by_world(items))
    for (Items& body : connected_parts(items, world)) bodies.push_back(std::move(body));
  // every body is one item already: bodies of a world are taken together
  if (bodies.size() == items.size()) bodies = by_world(items);
  const bool is_within_body = bodies.size() < items.size() && !bodies.empty();
  for (const Items& body : bodies) {
    std::vector<Items> parts;
    bisect(items, body, width, parts);
    for (const Items& part : parts) {
      const bool all_apart = connected_parts(items, part).size() == part.size();
      if (is_within_body && !all_apart)
        for (Items& piece : connected_parts(items, part)) clusters.push_back(std::move(piece));
      else
        clusters.push_back(part);
    }
  }
  return clusters;
}

// Nodes that move, each rigid body's four as one item.
std::vector<Item> first_items(const MatrixPattern& pattern, const SchwarzNodes& nodes, u32 width,
                              std::vector<Items>& item_nodes) {
  const std::size_t n = nodes.world.size();
  std::vector<u32> item_of(n, NO_SLOT);
  std::vector<Item> items;
  auto frame = nodes.first_frame.begin();
  for (u32 node = 0; node < n;) {
    const bool is_frame = frame != nodes.first_frame.end() && *frame == node;
    if (is_frame) ++frame;
    const u32 n_nodes = is_frame && width >= 4 ? 4 : 1;
    if (!nodes.is_fixed[node]) {
      Item item;
      item.position = Vec3(&nodes.position[3 * std::size_t(node)]);
      item.world = nodes.world[node];
      item.n_slots = n_nodes;
      item.modes.setZero();
      Items members;
      for (u32 k = 0; k < n_nodes; ++k) {
        // an axis is a difference of points: it does not move with a translation
        item.modes(k, 0) = k == 0;
        item.modes.block<1, 3>(k, 1) = Eigen::Map<const Eigen::RowVector3d>(&nodes.position[3 * std::size_t(node + k)]);
        members.push_back(node + k);
        item_of[node + k] = u32(items.size());
      }
      items.push_back(item);
      item_nodes.push_back(members);
    }
    node += n_nodes;
  }
  for (u32 i = 0; i < items.size(); ++i) {
    Items& neighbours = items[i].neighbours;
    for (const u32 node : item_nodes[i])
      for (u32 k = pattern.first[node]; k < pattern.first[node + 1]; ++k)
        if (const u32 j = item_of[pattern.column[k]]; j != NO_SLOT && j != i) neighbours.push_back(j);
    std::sort(neighbours.begin(), neighbours.end());
    neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
  }
  return items;
}

// The cluster's functions 1, x, y, z about its middle, orthonormal over its slots: B = Q R. Weights are the rows of Q,
// R are the modes of what stands for the cluster on the next level. Functions that depend on those before are left out.
void orthonormalize(const Eigen::Matrix<double, Eigen::Dynamic, 4>& modes, std::span<std::array<double, 4>> weights,
                    Eigen::Matrix4d& coarse_modes) {
  Eigen::Matrix<double, Eigen::Dynamic, 4> q(modes.rows(), 4);
  q.setZero();
  coarse_modes.setZero();
  for (int k = 0; k < 4; ++k) {
    Eigen::VectorXd v = modes.col(k);
    const double before = v.norm();
    for (int pass = 0; pass < 2; ++pass)
      for (int j = 0; j < k; ++j) v -= q.col(j).dot(v) * q.col(j);
    if (v.norm() > SMALLEST * before) q.col(k) = v.normalized();
  }
  coarse_modes = q.transpose() * modes;
  for (Eigen::Index i = 0; i < modes.rows(); ++i)
    for (int k = 0; k < 4; ++k) weights[std::size_t(i)][std::size_t(k)] = q(i, k);
}

std::vector<Item> coarse_items(const std::vector<Item>& items, const std::vector<Items>& clusters) {
  std::vector<u32> cluster_of(items.size());
  for (u32 c = 0; c < clusters.size(); ++c)
    for (const u32 i : clusters[c]) cluster_of[i] = c;
  std::vector<Item> coarse(clusters.size());
  for (u32 c = 0; c < clusters.size(); ++c) {
    Item& item = coarse[c];
    item.world = items[clusters[c][0]].world;
    item.n_slots = N_COARSE;
    item.position.setZero();
    for (const u32 i : clusters[c]) {
      item.position += items[i].position / double(clusters[c].size());
      for (const u32 j : items[i].neighbours)
        if (cluster_of[j] != c) item.neighbours.push_back(cluster_of[j]);
    }
    std::sort(item.neighbours.begin(), item.neighbours.end());
    item.neighbours.erase(std::unique(item.neighbours.begin(), item.neighbours.end()), item.neighbours.end());
  }
  return coarse;
}

}  // namespace

SchwarzHierarchy make_schwarz_hierarchy(const MatrixPattern& pattern, const SchwarzNodes& nodes, u32 width,
                                        std::size_t most_levels) {
  SchwarzHierarchy hierarchy;
  hierarchy.slot_of_node.assign(nodes.world.size(), NO_SLOT);
  std::vector<Items> item_nodes;
  std::vector<Item> items = first_items(pattern, nodes, width, item_nodes);
  while (!items.empty() && hierarchy.levels.size() < most_levels) {
    const std::vector<Items> clusters = cluster(items, width);
    std::vector<Item> coarse = coarse_items(items, clusters);
    const bool is_first = hierarchy.levels.empty();
    SchwarzLevel level;
    level.width = width;
    level.parent.assign(clusters.size(), NO_SLOT);
    level.weights.assign(clusters.size() * width, {0, 0, 0, 0});
    for (u32 c = 0; c < clusters.size(); ++c) {
      level.cluster_world.push_back(coarse[c].world);
      Eigen::Matrix<double, Eigen::Dynamic, 4> modes(slots_of(items, clusters[c]), 4);
      u32 slot = 0;
      for (const u32 i : clusters[c]) {
        if (is_first)
          for (u32 k = 0; k < items[i].n_slots; ++k) hierarchy.slot_of_node[item_nodes[i][k]] = c * width + slot + k;
        else
          hierarchy.levels.back().parent[i] = c * width + slot;
        modes.middleRows(slot, items[i].n_slots) = items[i].modes.topRows(items[i].n_slots);
        slot += items[i].n_slots;
      }
      orthonormalize(modes, std::span(level.weights).subspan(std::size_t(c) * width, slot), coarse[c].modes);
    }
    const bool is_last = clusters.size() == by_world(items).size();
    hierarchy.levels.push_back(std::move(level));
    if (is_last) break;
    items = std::move(coarse);
  }
  return hierarchy;
}

}  // namespace pvg
