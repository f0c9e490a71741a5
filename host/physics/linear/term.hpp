// One energy term of the incremental potential on the device: the launcher around kernels/energies/<folder>/<term>.cl.
// Nothing is compiled before there are elements. Elements are sorted by world; each has `stencil` sites and writes that
// many rows (see kernels/energies/assemble.cl).
#pragma once
#include <optional>
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
  // New numbers for the same elements, such as this step's targets.
  template <class Params>
  void update(const std::vector<Params>& params) {
    params_.write(std::span(reinterpret_cast<const unsigned char*>(params.data()), params.size() * sizeof(Params)));
  }

  // x, x0: site positions [n_sites x 3, m]; h [s]
  // the elements' energies [n_elements, J], from number `first` on
  void energy(const Buffer<f64>& x, const Buffer<f64>& x0, double h, std::size_t first, Buffer<f64>& energy);
  // the same over n other rows that lie on the device already, as contacts do
  template <class Params>
  void energy_over(const Buffer<Params>& params, std::size_t n, const Buffer<f64>& x, const Buffer<f64>& x0, double h,
                   std::size_t first, Buffer<f64>& energy) {
    if (n > 0) kernels().energy(n, u32(n), params, x, x0, h, u32(first), energy);
  }
  void gradient(const Buffer<f64>& x, const Buffer<f64>& x0, double h, Buffer<f64>& rows);  // [N]
  void hessian(const Buffer<f64>& x, const Buffer<f64>& x0, double h);                      // kept in blocks()
  void product(const Buffer<f64>& direction, Buffer<f64>& rows);                            // rows = H direction

  std::size_t size() const { return n_; }
  std::size_t stencil() const { return stencil_; }
  const std::string& name() const { return name_; }
  const std::vector<u32>& sites() const { return sites_; }              // [n_elements x stencil]
  const std::vector<u32>& world_first() const { return world_first_; }  // [n_worlds + 1]
  const Buffer<f64>& blocks() const { return blocks_; }                 // [n_elements x (3 stencil)^2, N/m]
  Buffer<unsigned char>& params() { return params_; }
  u32 first_row = 0;  // where its rows begin in the row buffer

 private:
  struct Kernels {
    Kernels(Device& device, const std::string& folder, const std::string& name, const std::string& front);
    Program program;
    Kernel energy, gradient, hessian, product;
  };
  Kernels& kernels();  // compiled when they are first asked for
  void set_bytes(const void* params, std::size_t n, std::size_t bytes, std::vector<u32> world_first);
  Device* device_;
  std::string folder_, name_, front_;
  std::size_t stencil_, n_ = 0;
  std::optional<Kernels> kernels_;
  Buffer<unsigned char> params_;
  Buffer<f64> blocks_;
  std::vector<u32> sites_, world_first_;
};

}  // namespace pvg
