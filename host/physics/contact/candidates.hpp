// Pairs of primitives that may touch. They are looked for a little farther than contact reaches, so that they serve for
// more than one motion: three lists, each looked for again only when it no longer serves.
//   Pairs of different bodies serve while no site is farther than half the margin from where it was.
//   Pairs of one body serve while the body, but for a rigid motion of it as a whole, has deformed by less than that;
//   sheets, which deform all the time, have a list apart from that of solids.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "host/physics/contact/broad_phase.hpp"

namespace pvg {

// How much farther than the activation distance candidates are looked for [m]: a part of it, or as far as several last
// corrections of Newton's method lead. They then mostly serve for the whole step after its first guess. On a device
// apart from the host a search takes longer, for its launches and waits, than what more candidates take afterwards:
// chosen by the counts of docs/measured/2026-11-25_counts.md. `least` where pairs of one body are many:
// docs/measured/2026-11-27_candidates.md.
struct Margins {
  double usual, least;
};
Margins margins_of(const Device& device, std::span<const ContactSettings> settings, double correction);

class Candidates {
 public:
  enum List : u32 { SOLIDS, SHEETS, BETWEEN, N_LISTS };
  using Lists = std::array<bool, N_LISTS>;

  // x: sites at the start [n_sites, m]; margin [m]; least_margin: where pairs of one body are many [m]
  Candidates(Device& device, const CollisionMesh& mesh, std::span<const ContactSettings> settings,
             std::span<const Vec3> x, double margin, double least_margin);

  // At least every pair that may come within activation distance while the sites move straight from x0 to x1
  // [n_sites x 3, m]. By world: the pairs of one solid, of one sheet, of two bodies; within each in the order of the
  // broad phase.
  void find(const Buffer<double>& x0, const Buffer<double>& x1);
  // The same where start_check() was for this very motion and the device was waited for since. Returns which lists did
  // not serve then.
  Lists renew(const Buffer<double>& x0, const Buffer<double>& x1);
  // Starts to look for these lists without waiting: rows() has room for somewhat more than were found last, and what is
  // left of it belongs to no world. Whether there was room for all is told by serve() after the device was waited for;
  // if not, renew() looks for them again. start_check() was for this motion, its result need not be known.
  void start_renew(const Buffer<double>& x0, const Buffer<double>& x1, const Lists& which);
  // Starts to find whether the present ones serve for this motion, which is known after the device was waited for.
  void start_check(const Buffer<double>& x0, const Buffer<double>& x1);
  // The same, but by start_certify(), which comes next: there in one launch with what is certified of the motion
  // (continuous_collision.hpp).  steps: [n], of_64: least of each 64 of them
  void defer_check() { is_check_deferred_ = true; }
  bool is_check_deferred() const { return is_check_deferred_; }
  void start_certify(const Buffer<double>& x0, const Buffer<double>& x1, Buffer<double>& steps, Buffer<double>& of_64);
  bool serve() const { return surface_sites_.size() == 0 || (serves(SOLIDS) && serves(SHEETS) && serves(BETWEEN)); }
  Lists lacking() const;  // by the last check
  // A check, and what start_renew() looked for, are to be answered by take_foreseen(), after the device was waited for;
  // another check may be started before. Until then the present lists are thought to serve.
  void foresee();
  // Whether they did. If not, find() is to be called for that motion. lacked(): which lists the check found lacking.
  bool take_foreseen();
  const Lists& lacked() const { return lacked_; }
  // Between start_renew() and what follows the next wait n() is the room, and only n() is known.
  const WorldRows<Barrier>& rows() const { return rows_; }
  const Buffer<u32>& first() const { return first_of_world_; }  // rows().first on the device
  const Buffer<CollisionWorld>& worlds() const { return between_bodies_.worlds(); }

 private:
  // the pairs of one body of all solids, or of all sheets, which may touch themselves
  struct Within {
    BroadPhase broad_phase;
    WorldRows<Barrier> pairs;
    Buffer<u32> first_site, sites;  // [n_bodies + 1], of the bodies' surfaces
    double margin;                  // with which they were looked for [m]
    bool has_reference = false;
  };
  Within make_within(Device& device, const CollisionMesh& mesh, std::span<const ContactSettings> settings,
                     std::span<const Vec3> x, PairsOf which);
  bool serves(List list) const {
    return has_reference(list) && (is_late_[list] ? n_found(list) <= room_[list] : serves_[list] != check_);
  }
  bool has_reference(List list) const;
  void forget_reference(List list);
  void take_late(List list);  // how many there are
  void sum_worlds();          // where these begin in rows_
  BroadPhase& broad_phase(List list);
  WorldRows<Barrier>& pairs(List list);
  u32 n_found(List list) const;                                                // as the device told
  void search(List list, const Buffer<double>& x0, const Buffer<double>& x1);  // waits for how many there are
  void start_merge();
  // What a check has to look at.
  struct Checked {
    u32 n_solids, n_sheets, n_surface;  // bodies, bodies, sites
    u32 n_groups() const { return n_solids + n_sheets + u32((n_surface + GROUP_SIZE - 1) / GROUP_SIZE); }
  };
  Checked begin_check();

  Device* device_;
  std::size_t n_worlds_;
  double margin_, least_margin_;
  Within solids_, sheets_;
  BroadPhase between_bodies_;
  Program program_, serves_program_;
  Kernel merge_lists_, lists_serve_;
  std::optional<Kernel> check_and_certify_;  // made when it is first asked for
  bool is_check_deferred_ = false;
  WorldRows<Barrier> between_, rows_;
  Buffer<u32> found_;                   // [N_LISTS x (n_worlds + 1)] where the worlds of each list begin
  Buffer<u32> first_of_world_;          // [n_worlds + 1] of rows_
  Buffer<u32> surface_sites_;           // of all bodies
  bool has_reference_ = false;          // pairs between bodies
  std::array<u32, N_LISTS> room_ = {};  // pairs of each list that rows_ took
  Lists is_late_ = {};                  // looked for by start_renew(), not taken yet
  Buffer<u32> serves_on_device_;        // [N_LISTS] the last check in which a list did not serve
  std::vector<u32> serves_;             // as read
  std::vector<u32> read_found_;         // found_ of the last start_renew()
  u32 check_ = 0;                       // number of the last one
  // the same of what was foreseen
  std::vector<u32> foreseen_serves_;
  u32 foreseen_check_ = 0;
  Lists foreseen_is_late_ = {}, lacked_ = {};
};

}  // namespace pvg
