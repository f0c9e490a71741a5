// Contact of all worlds on the device: which pairs can touch on a motion, how far the motion may go, which pairs touch,
// and the lagged friction rows. The energies are those of energies/contact/barrier.cl and energies/contact/friction.cl,
// evaluated by the solver over the parameter buffers that are kept here.
//
// In one Newton iteration:  find_contacts(x) -> gradient, Hessian over contacts();  solve for the direction;
//   find_candidates(x, x + p);  step = largest_step(x, x + p);  line search, at each trial:  the barrier energy over
//   candidates(), and at the last one find_contacts(trial).  Before the first: find_candidates(x, x), find_contacts(x).
// Candidates are kept as long as they serve, so they may be more than are asked for; what is made of them does not
// change.
//
// Each of these can be done in three ways, with equal results:
//   waiting    find_candidates(), largest_step(), find_contacts(), find_and_lag_friction(): known when they return
//   started    start_...(): kernels are only started; the result is known after device.finish(), and taken by
//              candidates_serve() with renew_candidates(), by take_contacts() and by take_friction()
//   foreseen   as started, but not even taken after the next finish(): foresee() supposes that candidates and contacts
//              are as many as they were, with room to spare, so that more can be started on top of them;
//              take_foreseen() tells whether it was so, and all must be done again, waiting, if not
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "energies/contact/barrier.h"
#include "host/device/device.hpp"
#include "host/model/physical_scene.hpp"
#include "host/model/world_state.hpp"
#include "host/physics/contact/candidates.hpp"
#include "host/physics/contact/collision_mesh.hpp"
#include "host/physics/contact/lagged_friction.hpp"
#include "host/physics/linear/world_reduce.hpp"
#include "host/physics/linear/world_rows.hpp"

namespace pvg {

class ContactSet {
 public:
  // settings: of each world. x: sites at the start [n_sites, m]; the order of the search trees comes from it, so two
  // sets made from the same arguments give the same bits ever after. correction: how far the solver's last corrections
  // move a site [m]; candidates are then looked for far enough to serve for several.
  ContactSet(Device& device, const CollisionMesh& mesh, std::span<const ContactSettings> settings,
             std::span<const Vec3> x, double correction = 0);
  ~ContactSet();
  ContactSet(ContactSet&&) noexcept;

  // All x below: sites on the device [n_sites x 3, m].

  // At least every pair that may come within activation distance while the sites move straight from x0 to x1.
  void find_candidates(const Buffer<double>& x0, const Buffer<double>& x1);
  const WorldRows<Barrier>& candidates() const;
  // Starts to find whether the present candidates serve for a motion; known after the device was waited for.
  void start_check(const Buffer<double>& x0, const Buffer<double>& x1);
  void defer_check();  // start_largest_steps(), which comes next, does it in the same launch
  bool candidates_serve() const;
  // For that motion, the lists that do not serve: as Candidates::renew(), start_renew(), lacking()
  Candidates::Lists renew_candidates(const Buffer<double>& x0, const Buffer<double>& x1);
  void start_renew_candidates(const Buffer<double>& x0, const Buffer<double>& x1, const Candidates::Lists& which);
  Candidates::Lists lacking_candidates() const;

  // The last check, candidates and list of contacts are to be answered by take_foreseen(), after the device was waited
  // for; others may be started before. Until then the candidates are thought to serve, and contacts() to have room for
  // somewhat more than were taken last, of which first_contact() knows how many there are.
  void foresee();
  bool is_foreseen() const;  // since then
  // Whether it came so. If not, find_candidates() is to be called for that motion, and the contacts looked for again.
  bool take_foreseen();
  // What was found then: [n_worlds + 1], sites as contact_sites() if they were read, lists that did not serve
  const std::vector<u32>& foreseen_first() const;
  std::vector<u32> foreseen_sites() const;
  const Candidates::Lists& lacked_candidates() const;

  // The largest part in [0, 1] of the motion x0 -> x1, of each world, that is certified to keep every candidate apart.
  // x0, x1: as given to find_candidates, or any part of that motion. A pair that is already closer than its offset
  // gives 0.
  std::vector<double> largest_step(const Buffer<double>& x0, const Buffer<double>& x1);
  // The same part of each candidate, on the device: the smallest of a world's is its own.
  const Buffer<double>& start_largest_steps(const Buffer<double>& x0, const Buffer<double>& x1);
  const Buffer<double>& least_of_64_steps() const;  // of each 64 candidates
  const Buffer<u32>& first_candidate() const;       // [n_worlds + 1] on the device

  // The candidates within activation distance at x: rows of energies/contact/barrier.cl.
  void find_contacts(const Buffer<double>& x);
  // The same without waiting: until take_contacts(), after the device was waited for, contacts() has the rows of all
  // candidates, of which first_contact()[n_worlds] are contacts.
  void start_find_contacts(const Buffer<double>& x);
  // The same where who evaluates the candidates' energies leaves in activity() which exert a force [n_candidates], and
  // in activity_counts() how many of each 64.
  Buffer<u32>& activity();
  Buffer<u32>& activity_counts();
  void start_list_contacts();
  // The same, and in the same launch the energy of each world from those of its elements [J]: of `chunks`, then of the
  // candidates, which begin at number `from`. late_partial: as of WorldReduce. There must be candidates.
  struct EnergySum {
    const WorldChunks& chunks;
    const Buffer<double>& element;
    u32 from;
    Buffer<double>& late_partial;
    Buffer<double>& world;
  };
  void start_list_contacts(const EnergySum& sum);
  void take_contacts();
  const Buffer<u32>& first_contact() const;  // [n_worlds + 1] on the device
  u32 n_worlds() const;
  // [n_contacts x 4]; reads them if that was not done and they are not those that were read last
  const std::vector<u32>& contact_sites() const;
  void read_sites(bool wanted);                // whether it does, from now on; at first it does
  const Buffer<u32>& sites_on_device() const;  // [n_contacts x 4]
  // Number of the last search for contacts, as taken, and of the last one whose sites differed from those before.
  u32 search() const;
  u32 last_change() const;
  const WorldRows<Barrier>& contacts() const;

  // Friction rows from the contacts of the last find_contacts, with normal forces at x (the same x) and anchors for a
  // step of length h [s]. x0, x1: sites at its start and where they are thought to come; effects on friction go by it.
  void lag_friction(const Buffer<double>& x, double h, const Buffer<double>& x0, const Buffer<double>& x1);
  // The same in two parts: x before, the rest after the device was waited for.
  void start_lag_friction(const Buffer<double>& x);
  void take_friction(double h, const Buffer<double>& x0, const Buffer<double>& x1);
  // find_contacts(x) and this, waiting once
  void find_and_lag_friction(const Buffer<double>& x, double h, const Buffer<double>& x0, const Buffer<double>& x1);
  const WorldRows<Friction>& friction() const;
  LaggedFriction& lagged();  // these and what belongs to them
  const LaggedFriction& lagged() const;

  // Smallest gap (distance minus offsets) of each world at x [m]; infinite where none is below its activation distance.
  std::vector<double> min_gap(const Buffer<double>& x);

  // Contacts at x with their forces, of one world each; friction from the present friction rows, x0: sites at the start
  // of the step, h: its length [s]. Rows whose pair has parted since are left out. ContactForce::first and second are
  // indices into CollisionMesh::bodies.
  std::vector<std::vector<ContactForce>> forces(const Buffer<double>& x, const Buffer<double>& x0, double h);

  // Nothing, or the first pair of bodies that cannot start like this. x: [n_sites, m]
  std::optional<StartConflict> find_start_conflict(std::span<const Vec3> x);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pvg
