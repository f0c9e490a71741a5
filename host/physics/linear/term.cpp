#include "host/physics/linear/term.hpp"

#include <cstring>

#include "host/physics/linear/world_rows.hpp"

namespace pvg {
namespace {

Program program_of(Device& device, const std::string& folder, const std::string& name, const std::string& front) {
  const std::string file = "energies/" + folder + "/" + name + ".cl";
  if (front.empty()) return Program(device, file);
  return Program::from_text(device, name + " of this scene", front + "#include \"" + file + "\"\n");
}

}  // namespace

Term::Kernels::Kernels(Device& device, const std::string& folder, const std::string& name, const std::string& front)
    : program(program_of(device, folder, name, front)),
      energy(program.kernel(name + "_energy_all")),
      gradient(program.kernel(name + "_gradient_all")),
      hessian(program.kernel(name + "_hessian_all")),
      product(program.kernel(name + "_product_all")) {}

Term::Term(Device& device, const std::string& folder, const std::string& name, std::size_t stencil,
           const std::string& front)
    : device_(&device),
      folder_(folder),
      name_(name),
      front_(front),
      stencil_(stencil),
      params_(device, 0, name),
      blocks_(device, 0, name + " blocks") {}

Term::Kernels& Term::kernels() {
  if (!kernels_) kernels_.emplace(*device_, folder_, name_, front_);
  return *kernels_;
}

void Term::set_bytes(const void* params, std::size_t n, std::size_t bytes, std::vector<u32> world_first) {
  n_ = n;
  world_first_ = std::move(world_first);
  const auto* first = static_cast<const unsigned char*>(params);
  params_.resize(n * bytes);
  params_.write(std::span(first, n * bytes));
  sites_.resize(n * stencil_);
  for (std::size_t e = 0; e < n; ++e) std::memcpy(&sites_[e * stencil_], first + e * bytes, stencil_ * sizeof(u32));
}

void Term::set_sites(const std::vector<u32>& sites, std::vector<u32> world_first) {
  n_ = sites.size() / stencil_;
  sites_ = sites;
  world_first_ = std::move(world_first);
  blocks_.resize(n_block_numbers());
}

void Term::set_size(std::size_t n, std::vector<u32> world_first) {
  n_ = n;
  know({}, std::move(world_first));
  blocks_.resize(n_block_numbers());
}

void Term::know(const std::vector<u32>& sites, std::vector<u32> world_first) {
  sites_ = sites;
  world_first_ = std::move(world_first);
}

void Term::write_params(std::span<const unsigned char> bytes) {
  if (shared_params_)
    shared_params_->write(first_byte_, bytes);
  else
    params_.write(bytes);
}

void Term::move_params(Buffer<unsigned char>& shared, std::size_t first_byte) {
  shared.write(first_byte, params_.read());
  shared_params_ = &shared;
  first_byte_ = first_byte;
}

void Term::move_blocks(Buffer<f64>& shared, std::size_t first_number) {
  shared_blocks_ = &shared;
  first_block_ = u32(first_number);
}

void Term::energy(const Buffer<f64>& x, const Buffer<f64>& x0, double h, std::size_t first, Buffer<f64>& energy) {
  if (n_ > 0) kernels().energy(n_, u32(n_), params_, x, x0, h, u32(first), energy);
}
void Term::gradient(const Buffer<f64>& x, const Buffer<f64>& x0, double h, Buffer<f64>& rows) {
  if (n_ > 0) kernels().gradient(n_, u32(n_), params_, x, x0, h, first_row, rows);
}
void Term::hessian(const Buffer<f64>& x, const Buffer<f64>& x0, double h, std::span<const char> worlds) {
  if (!shared_blocks_) blocks_.resize(n_block_numbers());
  if (n_ == 0) return;
  for (const auto& [begin, end] : pieces_of(world_first_, worlds))
    kernels().hessian(end - begin, end - begin, begin, params_, x, x0, h, first_block_,
                      shared_blocks_ ? *shared_blocks_ : blocks_);
}
void Term::product(const Buffer<f64>& direction, Buffer<f64>& rows) {
  if (n_ > 0) kernels().product(n_, u32(n_), params(), first_block_, blocks(), direction, first_row, rows);
}

}  // namespace pvg
