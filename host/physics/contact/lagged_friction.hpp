// Friction of contacts as they were when they were lagged: rows of energies/contact/friction.cl with normal force and
// tangent plane, and what sticking contacts carry over from step to step (friction_anchors.hpp).
#pragma once
#include <map>
#include <span>
#include <vector>

#include "contact/mesh.h"
#include "energies/contact/barrier.h"
#include "energies/contact/friction.h"
#include "host/device/device.hpp"
#include "host/physics/contact/collision_mesh.hpp"
#include "host/physics/contact/friction_anchors.hpp"
#include "host/physics/linear/world_rows.hpp"

namespace pvg {

class LaggedFriction {
 public:
  LaggedFriction(Device& device, const CollisionMesh& mesh);

  // Starts to find the rows of contacts at x [n_sites x 3, m], of which first_contact[n_worlds] knows how many there
  // are. usual: so many are read ahead
  void start(const WorldRows<Barrier>& contacts, const Buffer<u32>& first_contact, const Buffer<CollisionWorld>& worlds,
             const Buffer<double>& x, std::size_t usual);
  // They are the present ones from now on, for a step of length h [s], after the device was waited for. contact_first:
  // [n_worlds + 1]; x0, x1: sites at its start and where they are thought to come; effects go by it
  void take(const std::vector<u32>& contact_first, double h, const Buffer<double>& x0, const Buffer<double>& x1);
  void clear();

  const WorldRows<Friction>& rows() const { return rows_; }
  std::span<const Friction> on_host() const { return on_host_; }
  const std::vector<u32>& sites() const { return sites_; }  // [n x 4]
  // The same, and rows().first, where the device is apart from the host
  const Buffer<u32>& sites_on_device() const { return sites_on_device_; }
  const Buffer<u32>& first() const { return first_; }

  // What contacts remember of a step of length h from x0 to x: started, and taken for these worlds after the device was
  // waited for.
  void start_anchors(const Buffer<double>& x, const Buffer<double>& x0, double h);
  void take_anchors(std::span<const char> worlds);
  const std::vector<std::vector<FrictionAnchor>>& anchors() const { return anchors_; }  // [n_worlds]
  void restore_anchors(const std::vector<std::vector<FrictionAnchor>>& anchors) { anchors_ = anchors; }

  // what the present rows exert on the first body of each, by pair [N]
  std::map<PairKey, Vec3> forces(const Buffer<double>& x, const Buffer<double>& x0, double h);

 private:
  void give_to_device(bool is_as_lagged);

  Device* device_;
  std::vector<ContactEffect> effects_;
  u32 n_worlds_;
  Program program_, friction_program_;
  Kernel lag_friction_, anchor_friction_, friction_force_, friction_strain_;
  WorldRows<Friction> rows_;
  std::vector<Friction> on_host_;      // rows_
  Buffer<Friction> lagged_;            // the next ones, without what the host adds
  std::vector<Friction> read_lagged_;  // as read
  std::vector<u32> sites_, written_sites_, written_first_;
  Buffer<u32> sites_on_device_, first_;
  Buffer<double> anchors_on_device_, forces_, strains_;  // [n x 3]: m, N, 1
  std::vector<double> read_strains_;
  std::vector<std::vector<FrictionAnchor>> anchors_;  // each sorted by pair
};

}  // namespace pvg
