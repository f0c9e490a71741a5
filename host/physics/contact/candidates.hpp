// Pairs of primitives that may touch. They are looked for a little farther than contact reaches, so that they serve for
// more than one motion: three lists, each looked for again only when it no longer serves.
//   Pairs of different bodies serve while no site is farther than half the margin from where it was.
//   Pairs of one body serve while the body, but for a rigid motion of it as a whole, has deformed by less than that;
//   sheets, which deform all the time, have a list apart from that of solids.
#pragma once
#include <span>
#include <vector>

#include "host/physics/contact/broad_phase.hpp"

namespace pvg {

class Candidates {
 public:
  // x: sites at the start [n_sites, m]; margin [m]
  Candidates(Device& device, const CollisionMesh& mesh, std::span<const ContactSettings> settings,
             std::span<const Vec3> x, double margin);

  // At least every pair that may come within activation distance while the sites move straight from x0 to x1
  // [n_sites x 3, m]. By world: the pairs of one solid, of one sheet, of two bodies; within each in the order of the
  // broad phase.
  void find(const Buffer<double>& x0, const Buffer<double>& x1);
  const WorldRows<Barrier>& rows() const { return rows_; }
  const Buffer<CollisionWorld>& worlds() const { return between_bodies_.worlds(); }

 private:
  // a body that may touch itself
  struct Deformable {
    std::vector<u32> sites;       // of its surface
    std::vector<Vec3> reference;  // where they were when its pairs were looked for [m]
  };
  // the pairs of one body of all solids, or of all sheets
  struct Within {
    BroadPhase broad_phase;
    WorldRows<Barrier> pairs;
    std::vector<Deformable> bodies;
    bool serves(std::span<const double> x0, std::span<const double> x1, double margin) const;
  };
  bool serves_between(std::span<const double> x0, std::span<const double> x1) const;
  void merge();

  std::size_t n_worlds_;
  double margin_;
  Within solids_, sheets_;
  BroadPhase between_bodies_;
  Program program_;
  Kernel place_rows_;
  WorldRows<Barrier> between_, rows_;
  Buffer<u32> first_, place_;       // [n_worlds + 1], [n_worlds] of the list that is placed
  std::vector<u32> surface_sites_;  // of all bodies
  std::vector<double> reference_;   // of all sites, for pairs between bodies; empty before the first search
};

}  // namespace pvg
