// The broad phase on the device: the collision mesh in buffers, one search tree per world and kind of primitive, and
// the candidate pairs of a motion.
#pragma once
#include <span>
#include <vector>

#include "contact/mesh.h"
#include "contact/tree.h"
#include "energies/contact/barrier.h"
#include "host/device/scan.hpp"
#include "host/model/physical_scene.hpp"
#include "host/physics/contact/collision_mesh.hpp"
#include "host/physics/linear/world_rows.hpp"

namespace pvg {

// Parts of one body, which is a solid or a sheet (contact acts outside its surface); parts of two bodies.
enum class PairsOf { all_bodies, one_solid, one_sheet, two_bodies };

class BroadPhase {
 public:
  // Bodies without a partner are left out. The trees' order comes from x: [n_sites, m]. Bodies stay together in it, so
  // it stays good while they move.
  BroadPhase(Device& device, const CollisionMesh& mesh, std::span<const ContactSettings> settings,
             std::span<const Vec3> x, PairsOf which = PairsOf::all_bodies);
  // Pairs that may come within activation distance and `margin` [m] while the sites move straight from x0 to x1
  // [n_sites x 3, m]: by world, in it first point-triangle, then edge-edge pairs.
  void find(const Buffer<double>& x0, const Buffer<double>& x1, double margin, WorldRows<Barrier>& pairs);
  // The same without waiting, where rows have room for so many; what is more is left out. How many there are is left in
  // offsets().
  void start_find(const Buffer<double>& x0, const Buffer<double>& x1, double margin, u32 capacity,
                  Buffer<Barrier>& rows);
  const Buffer<u32>& offsets() const { return offsets_; }                            // [n_queries + 1] of their pairs
  const Buffer<u32>& first_query_of_world() const { return first_query_of_world_; }  // [n_worlds + 1]
  const Buffer<double>& reference() const { return reference_; }  // x1 of the last search [n_sites x 3, m]
  std::size_t n_queries() const { return queries_.size(); }       // points and edges that look for partners
  bool finds_nothing() const { return queries_.size() == 0; }     // no two of these bodies may touch
  const Buffer<CollisionWorld>& worlds() const { return worlds_; }

 private:
  void find_near_bodies(const Buffer<double>& x0, const Buffer<double>& x1, double margin);
  void refit(const Buffer<double>& x0, const Buffer<double>& x1, double margin);
  void count(const Buffer<double>& x0, const Buffer<double>& x1, double margin);
  void fill(const Buffer<double>& x0, const Buffer<double>& x1, double margin, u32 capacity, Buffer<Barrier>& rows);

  u32 n_trees_, log2_leaves_;
  bool finds_near_bodies_;
  Buffer<CollisionPoint> points_;
  Buffer<CollisionEdge> edges_;
  Buffer<CollisionTriangle> triangles_;
  Buffer<CollisionBodyRow> bodies_;
  Buffer<CollisionWorld> worlds_;
  Buffer<double> rest_;           // [n_sites x 3, m] in the rest shape of their body
  Buffer<double> pair_friction_;  // coefficient of each pair of bodies, or -1 where they never touch
  Buffer<double> pair_adhesion_;  // of each pair of bodies [J/m^2]
  Buffer<TreeNode> nodes_;
  Buffer<Query> queries_;                  // by world: points, then edges in the order of their leaves
  Buffer<u32> disabled_first_, disabled_;  // [n_queries + 1], partners that a query must not find
  Buffer<u32> first_query_of_world_;       // [n_worlds + 1]
  Buffer<u32> counts_, offsets_, kept_;    // [n_queries], [n_queries + 1], [n_queries x N_KEPT]
  Buffer<u32> first_site_, sites_;         // [n_bodies + 1], of each body
  Buffer<float> near_;                     // [n_bodies x 8] where each has partners
  Buffer<f32> boxes_;                      // of bodies [n_bodies x 6, m]
  Buffer<double> reference_;
  Program program_, near_program_;
  Kernel refit_leaves_, refit_levels_, count_pairs_, fill_pairs_, body_boxes_, near_bodies_;
  Scan scan_;
};

}  // namespace pvg
