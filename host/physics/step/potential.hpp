// The incremental potential of all worlds: the sum of its terms, their gradient gathered to the nodes, and the product
// of the Hessian with a direction. What never changes its elements is assembled into a sparse matrix, contact and
// friction are not.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "host/physics/contact/contact.hpp"
#include "host/physics/energies/terms.hpp"
#include "host/physics/linear/conjugate_gradients.hpp"
#include "host/physics/linear/gather.hpp"
#include "host/physics/linear/term.hpp"
#include "host/physics/linear/world_reduce.hpp"
#include "host/physics/step/preconditioner.hpp"

namespace pvg {

// Positions of all nodes and of the sites that they carry.
struct Positions {
  Positions(Device& device, std::size_t n_nodes, std::size_t n_sites, const std::string& name)
      : node(device, 3 * n_nodes, name), site(device, 3 * n_sites, name + " sites") {}
  Buffer<f64> node, site;  // [n_nodes x 3], [n_sites x 3]
};

class Potential {
 public:
  enum class Coupling { step_begins, before_solve, solve_took_long };

  Potential(Device& device, const System& system);

  void update_sites(Positions& positions);  // site from node

  // This step's numbers. start: positions at its beginning; predicted: where inertia leads; h: its length [s];
  // inertia_h: what stands for h in the inertia, which depends on the integrator [s]
  void begin_step(const Positions& start, const Positions& predicted, double h, double inertia_h);
  void update_joints(const System& system);  // this step's numbers of drives and stops
  void update_spin(const System& system);    // this step's torques of rolling resistance
  void update_forces(const System& system);  // this step's pushes; before set_forces
  // Forces that follow a law, from where bodies are at the start of this step and v: velocities there [n_nodes x 3,
  // m/s]
  void set_forces(const Buffer<f64>& v);
  void set_friction(const ContactSet& contacts);

  // Lets the rest shapes of solids that yield or creep follow a step of length h [s] that ended at x, in these worlds.
  void flow(const Positions& x, double h, std::span<const char> worlds);
  // These rest shapes: rest_inverse of the elements of System::plastic_flow_4, then _10  [n x 9, 1/m]
  std::vector<double> flowed();
  void restore_flowed(const std::vector<double>& rest_inverse);

  // value [n_sites x 3] of nodes [n_nodes x 3]
  void to_sites(const Buffer<f64>& node, Buffer<f64>& value);
  const Buffer<Site>& sites() const { return sites_; }

  // Whether differentiate() needs to know on the host which sites contacts have.
  bool reads_contacts() const;
  // Whether it does with contacts that are foreseen (ContactSet::foresee()), and then what they were; false where they
  // change what start_factorize() takes for a pattern: once_coupled, as of couple_contacts() when a step begins.
  bool can_foresee_contacts() const;
  bool take_foreseen(const ContactSet& contacts, std::span<const char> once_coupled);

  // Sum of all terms per world [J]; which candidates touch is left in contacts.activity().
  std::vector<double> energy(const Positions& x, ContactSet& contacts);
  // The same on the device. defers_sum: the sum of a world's elements is left to start_list_contacts(), which is called
  // next and lists the contacts as well.
  const Buffer<f64>& start_energy(const Positions& x, ContactSet& contacts, bool defers_sum = false);
  void start_list_contacts(ContactSet& contacts);
  // Gradient [n_nodes x 3, N] and Hessian blocks at x, with these active contacts. worlds: [n_worlds] whose matrix is
  // wanted, the others' stays as it was made last; or empty, then all are. Returns whether it set what a solve starts
  // from: dx = 0, residual = -gradient; only where they are given
  bool differentiate(const Positions& x, const ContactSet& contacts, Buffer<f64>& gradient,
                     std::span<const char> worlds = {}, Buffer<f64>* dx = nullptr, Buffer<f64>* residual = nullptr);
  void differentiate(const Positions& x, Buffer<f64>& gradient);  // without contacts
  // out = H direction;  [n_nodes x 3]
  void product(const Buffer<f64>& direction, Buffer<f64>& out);
  CgOperators operators();  // of the Hessian and the preconditioner, until the next differentiate()
  // Starts to factor the preconditioner at the blocks of the last differentiate(). failed(): a node of the first group
  // of bodies whose matrix is not positive definite, or nothing, after the device was waited for. factorize(): both.
  // gradient: the first precondition() will be of -gradient.
  // world_keeps: [n_worlds] whose factors stay, where keeps_factors(); or empty, then none do
  void start_factorize(std::span<const char> world_is_active, const Buffer<f64>* gradient = nullptr,
                       std::span<const char> world_keeps = {});
  bool keeps_factors(u32 world) const { return preconditioner_->keeps_factors(world); }
  std::optional<u32> failed() const { return preconditioner_->failed(); }
  std::optional<u32> factorize(std::span<const char> world_is_active);
  // From now on the factors of these worlds hold the pairs of nodes that the contacts of the last differentiate()
  // couple, besides those that they hold. At the beginning of a step those are given up where most are contacts no
  // more; before a solve a few new ones are left out, for a new pattern has to be analysed.
  void couple_contacts(std::span<const char> worlds, Coupling when);
  const std::vector<std::vector<NodePair>>& couplings() const { return couplings_; }  // [n_worlds], sorted
  void restore_couplings(const std::vector<std::vector<NodePair>>& couplings);
  const BlockMatrix& matrix() const { return *matrix_; }  // of the terms whose elements never change
  std::size_t preconditioner_bytes() const { return preconditioner_->n_bytes(); }
  // out = M^-1 residual;  [n_nodes x 3]
  void precondition(const Buffer<f64>& residual, Buffer<f64>& out) { preconditioner_->apply(residual, out, chunks_); }

 private:
  ContactElements contact_elements();
  bool has_contacts() const { return barrier_.size() + friction_.size() > 0; }
  void set_contacts(const ContactSet& contacts);
  bool has_listed(const ContactSet& contacts) const;
  void list_contacts_on_device(const ContactSet& contacts);
  bool differentiate(const Positions& x, const ContactSet* contacts, Buffer<f64>& gradient,
                     std::span<const char> worlds, Buffer<f64>* dx, Buffer<f64>* residual);
  std::vector<std::vector<NodePair>> next_couplings(std::span<const char> worlds, Coupling when);
  void append_coupled(std::span<const u32> sites, std::vector<NodePair>& pairs) const;
  bool launches_together() const;
  bool is_inertia(const Term& term) const { return &term == &terms_.point_inertia || &term == &terms_.affine_inertia; }
  const Buffer<f64>& origin(const Term& term) const;  // what a term is told as x0
  double step_length(const Term& term) const { return is_inertia(term) ? inertia_h_ : h_; }

  const System& system_;
  Program nodes_program_;
  Kernel nodes_to_sites_, gather_rows_, gather_two_lists_, product_of_contacts_;
  Buffer<Site> sites_;
  Buffer<u32> node_is_fixed_;

  Terms terms_;  // whose elements never change
  std::optional<SmallTerms> small_terms_;
  std::optional<ForceLaws> force_laws_;
  // their rows are kept by the ContactSet and launched together
  Term barrier_, friction_;
  Buffer<FrictionDual> friction_dual_;  // [n_friction]
  bool friction_is_new_ = true;         // no Hessian was made since set_friction()
  const Term* const contact_terms_[2] = {&barrier_, &friction_};
  struct ContactKernels {
    explicit ContactKernels(Device& device);
    Program program;
    Kernel energy, derivatives;
  };
  ContactKernels& contact_kernels();
  std::optional<ContactKernels> contact_kernels_;  // made for the first contact
  std::optional<Kernel> flow_4_, flow_10_;         // where something yields or creeps
  Buffer<PlasticFlow> flows_4_, flows_10_;
  Buffer<u32> world_steps_;
  std::vector<Term*> constant_;     // those of terms_
  std::vector<std::size_t> large_;  // of these, that have launches of their own

  Gather constant_gather_, contact_gather_;
  std::unique_ptr<BlockMatrix> matrix_;
  std::unique_ptr<Preconditioner> preconditioner_;
  WorldChunks chunks_;  // of nodes
  std::vector<std::vector<NodePair>> couplings_;
  Buffer<u32> contact_sites_;            // [n_contacts and n_friction x 4]
  std::vector<u32> gathered_sites_;      // what it holds, which contact_gather_ was made of
  std::size_t n_gathered_contacts_ = 0;  // of these
  u32 gathered_search_ = 0;  // number of the search for contacts that it was made of on the device; 0: not known
  u32 foreseen_search_ = 0;  // the same where how many there are is not known yet
  Buffer<f64> rows_, element_energy_, world_energy_, direction_site_;
  std::optional<Buffer<f64>> unused_;  // where nobody wants to know what a solve starts from
  u32 n_constant_rows_ = 0;
  WorldReduce reduce_;
  std::vector<u32> first_energy_;          // of each constant term in element_energy_, and where they end
  std::vector<WorldRange> energy_ranges_;  // of the constant terms
  WorldChunks energy_chunks_;              // of all terms
  bool defers_sum_ = false;                // of their energies

  const Positions *start_ = nullptr, *predicted_ = nullptr;
  double h_ = 0, inertia_h_ = 0;
};

}  // namespace pvg
