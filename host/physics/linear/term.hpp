// One energy term of the incremental potential on the device: the launcher around kernels/energies/<folder>/<term>.cl.
// Nothing is compiled before there are elements. Elements are sorted by world; each has `stencil` sites and writes that
// many rows (see kernels/energies/assemble.cl).
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/device/device.hpp"
#include "host/physics/linear/world_reduce.hpp"

namespace pvg {

class Term {
 public:
  // front: text made at run time that stands before the kernel file, such as the laws of a scene; empty: none
  // folder, name: of the kernel file, energies/<folder>/<name>.cl
  Term(Device& device, const std::string& folder, const std::string& name, std::size_t stencil,
       const std::string& front = "");

  // The elements, sorted by world. Params is the struct of the term; its first member is `u32 site[stencil]`.
  // world_first: [n_worlds + 1] where each world's elements begin
  template <class Params>
  void set(const std::vector<Params>& params, std::vector<u32> world_first) {
    static_assert(sizeof(Params) % 16 == 0);
    set_bytes(params.data(), params.size(), sizeof(Params), std::move(world_first));
  }
  // Elements whose numbers stand elsewhere, for which gradient() and hessian() are not called.
  // sites: [n x stencil]
  void set_sites(const std::vector<u32>& sites, std::vector<u32> world_first);
  // The same where the sites are on the device alone, n elements or room for them: sites() is empty.
  void set_size(std::size_t n, std::vector<u32> world_first);
  // What is known of these later: how many there are in each world, and their sites, if these are wanted.
  void know(const std::vector<u32>& sites, std::vector<u32> world_first);
  // New numbers for the same elements, such as this step's targets.
  template <class Params>
  void update(const std::vector<Params>& params) {
    write_params({reinterpret_cast<const unsigned char*>(params.data()), params.size() * sizeof(Params)});
  }
  // From now on its elements stand in a buffer of several terms, from this byte on; what launches that buffer's terms
  // together launches this one too (host/physics/energies/small_terms.hpp). Not for what set() is called for again.
  void move_params(Buffer<unsigned char>& shared, std::size_t first_byte);
  // Its Hessian blocks are written to a buffer of several terms, from this number on.
  void move_blocks(Buffer<f64>& shared, std::size_t first_number);

  // x, x0: site positions [n_sites x 3, m]; h [s]
  // the elements' energies [n_elements, J], from number `first` on
  void energy(const Buffer<f64>& x, const Buffer<f64>& x0, double h, std::size_t first, Buffer<f64>& energy);
  void gradient(const Buffer<f64>& x, const Buffer<f64>& x0, double h, Buffer<f64>& rows);  // [N]
  // Kept in blocks(). worlds: [n_worlds] whose elements' are wanted, or empty, then all are
  void hessian(const Buffer<f64>& x, const Buffer<f64>& x0, double h, std::span<const char> worlds = {});
  void product(const Buffer<f64>& direction, Buffer<f64>& rows);  // rows = H direction

  std::size_t size() const { return n_; }
  std::size_t stencil() const { return stencil_; }
  const std::string& name() const { return name_; }
  const std::vector<u32>& sites() const { return sites_; }              // [n_elements x stencil]
  const std::vector<u32>& world_first() const { return world_first_; }  // [n_worlds + 1]
  // [n_elements x n_element_numbers(), N/m], from number first_block() on: the upper half of an element's 3 x 3 blocks
  // (kernels/energies/upper_blocks.cl); of contacts the whole matrix, row-major
  Buffer<f64>& own_blocks() { return blocks_; }
  const Buffer<f64>& blocks() const { return shared_blocks_ ? *shared_blocks_ : blocks_; }
  u32 first_block() const { return first_block_; }
  std::size_t n_element_numbers() const {
    return folder_ == "contact" ? 9 * stencil_ * stencil_ : 9 * stencil_ * (stencil_ + 1) / 2;
  }
  std::size_t n_block_numbers() const { return n_ * n_element_numbers(); }
  Buffer<unsigned char>& params() { return shared_params_ ? *shared_params_ : params_; }
  std::size_t n_param_bytes() const { return params_.size(); }
  u32 first_row = 0;  // where its rows begin in the row buffer

 private:
  struct Kernels {
    Kernels(Device& device, const std::string& folder, const std::string& name, const std::string& front);
    Program program;
    Kernel energy, gradient, hessian, product;
  };
  Kernels& kernels();  // compiled when they are first asked for
  void write_params(std::span<const unsigned char> bytes);
  void set_bytes(const void* params, std::size_t n, std::size_t bytes, std::vector<u32> world_first);
  Device* device_;
  std::string folder_, name_, front_;
  std::size_t stencil_, n_ = 0;
  std::optional<Kernels> kernels_;
  Buffer<unsigned char> params_;
  Buffer<f64> blocks_;
  Buffer<unsigned char>* shared_params_ = nullptr;  // instead of its own
  Buffer<f64>* shared_blocks_ = nullptr;
  std::size_t first_byte_ = 0;
  u32 first_block_ = 0;
  std::vector<u32> sites_, world_first_;
};

}  // namespace pvg
