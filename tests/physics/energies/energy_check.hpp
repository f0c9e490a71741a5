// What every energy term must satisfy, written once. A term's test brings the energy again, in double and in its
// plainest form, and elements to try; here the device's kernels are compared with it and with its differences.
#pragma once
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "host/device/device.hpp"
#include "host/geometry/mesh.hpp"
#include "shared/types.h"

namespace pvg {

// One element and where its sites are; params.site is filled in here.
template <class Params>
struct EnergyElement {
  Params params{};
  std::vector<Vec3> x, x0;  // [STENCIL, m] now and at the start of the step
};

struct EnergyResult {
  double energy = 0;         // [J]
  Eigen::VectorXd gradient;  // [3 STENCIL, N]
  Eigen::MatrixXd hessian;   // [3 STENCIL x 3 STENCIL, N/m]
};

// Of symmetric matrices. These stand in a file of their own since a compiler takes seconds for them.
double smallest_eigenvalue(const Eigen::MatrixXd& symmetric);
Eigen::MatrixXd nearest_positive(const Eigen::MatrixXd& symmetric);  // negative eigenvalues become zero
bool is_product(const Eigen::VectorXd& found, const Eigen::MatrixXd& matrix, const Eigen::VectorXd& x);
std::string text_of(const Eigen::VectorXd& numbers);

inline std::string name_of(const std::string& kernel) { return kernel.substr(kernel.find('/') + 1); }

template <class Params>
class EnergyCheck {
 public:
  using Element = EnergyElement<Params>;
  using Elements = std::vector<Element>;
  using HostEnergy = std::function<double(const Params&, const Vec3* x, const Vec3* x0, double h)>;
  static constexpr int STENCIL = int(sizeof(Params::site) / sizeof(u32)), SIZE = 3 * STENCIL;
  static constexpr double H = 0.0125;  // time step [s]

  // kernel: FOLDER/TERM, of kernels/energies/FOLDER/TERM.cl
  // length: of the steps for differences [m], a small part of an element's size
  // file: FOLDER/NAME of another kernel file; empty: the term's own
  // front: text that stands before the kernel file; empty: none
  EnergyCheck(const std::string& kernel, HostEnergy energy, double length, const std::string& file = "",
              const std::string& front = "")
      : host_energy_(std::move(energy)),
        length_(length),
        is_whole_(kernel.starts_with("contact/")),
        n_numbers_(is_whole_ ? SIZE * SIZE : 9 * STENCIL * (STENCIL + 1) / 2),
        program_(Program::from_text(device_, kernel,
                                    front + "#include \"energies/" + (file.empty() ? kernel : file) + ".cl\"\n")),
        energy_(program_.kernel(name_of(kernel) + "_energy_all")),
        gradient_(program_.kernel(name_of(kernel) + "_gradient_all")),
        hessian_(program_.kernel(name_of(kernel) + "_hessian_all")),
        product_(program_.kernel(name_of(kernel) + "_product_all")) {}

  Device& device() { return device_; }

  std::vector<EnergyResult> evaluate(const Elements& elements, bool with_hessian = true) {
    const Upload on_device(device_, elements);
    const std::size_t n = elements.size();
    Buffer<double> energy(device_, n, "energy"), rows(device_, (n + 1) * SIZE, "rows");
    Buffer<double> blocks(device_, with_hessian ? n * n_numbers_ : 0, "blocks");
    energy_(n, u32(n), on_device.params, on_device.x, on_device.x0, H, 0u, energy);
    gradient_(n, u32(n), on_device.params, on_device.x, on_device.x0, H, u32(STENCIL), rows);
    const double not_written = std::nan("");
    blocks.write(std::vector<double>(blocks.size(), not_written));
    // in two launches, as worlds have theirs
    for (const auto& [begin, end] : {std::pair<std::size_t, std::size_t>(0, n / 2), {n / 2, n}})
      if (with_hessian && end > begin)
        hessian_(end - begin, u32(end - begin), u32(begin), on_device.params, on_device.x, on_device.x0, H, 0u, blocks);
    const std::vector<double> energies = energy.read(), all_rows = rows.read(), all_blocks = blocks.read();
    std::vector<EnergyResult> results(n);
    for (std::size_t e = 0; e < n; ++e) {
      results[e].energy = energies[e];
      results[e].gradient = Eigen::Map<const Eigen::VectorXd>(&all_rows[(e + 1) * SIZE], SIZE);
      if (with_hessian) results[e].hessian = matrix_of(&all_blocks[e * n_numbers_]);
    }
    return results;
  }

  void expect_energy(const Elements& all) {
    const Elements elements = enough(all);
    const std::vector<EnergyResult> results = evaluate(elements, false);
    for (std::size_t e = 0; e < elements.size(); ++e) {
      const double expected = host(elements[e]);
      ASSERT_LE(std::abs(results[e].energy - expected), 1e-9 * (std::abs(expected) + energy_scale_)) << "element " << e;
    }
  }

  // relative to the element's largest force, beside the rounding of the energy that is differentiated
  void expect_gradient(const Elements& all, double tolerance = 1e-6) {
    const Elements elements = enough(all);
    const std::vector<EnergyResult> results = evaluate(elements, false);
    for (std::size_t e = 0; e < elements.size(); ++e) {
      const Eigen::VectorXd expected = host_gradient(elements[e]);
      const double noise = 1e-14 * (std::abs(host(elements[e])) + energy_scale_) / length_;
      const double error = (results[e].gradient - expected).cwiseAbs().maxCoeff();
      ASSERT_LE(error, tolerance * expected.cwiseAbs().maxCoeff() + noise) << "element " << e << "\n"
                                                                           << text_of(results[e].gradient) << "\n"
                                                                           << text_of(expected);
    }
  }

  // H as the derivative of the device's own gradient; for elements where nothing had to be projected
  void expect_exact_hessian(const Elements& elements, double tolerance = 1e-6) {
    const std::vector<EnergyResult> results = evaluate(elements);
    for (std::size_t e = 0; e < elements.size(); ++e) {
      const Eigen::MatrixXd expected = difference_hessian(elements[e]);
      const double error = (results[e].hessian - expected).cwiseAbs().maxCoeff();
      ASSERT_LE(error, tolerance * expected.cwiseAbs().maxCoeff()) << "element " << e;
    }
  }

  void expect_symmetric_positive_hessian(const Elements& all) {
    const Elements elements = enough(all);
    const std::vector<EnergyResult> results = evaluate(elements);
    for (std::size_t e = 0; e < elements.size(); ++e) {
      const Eigen::MatrixXd& hessian = results[e].hessian;
      const double largest = hessian.cwiseAbs().maxCoeff();
      ASSERT_TRUE(std::isfinite(largest)) << "element " << e;
      ASSERT_LE((hessian - hessian.transpose()).cwiseAbs().maxCoeff(), 1e-12 * largest) << "element " << e;
      ASSERT_GE(smallest_eigenvalue(hessian), -1e-12 * SIZE * largest) << "element " << e;
    }
  }

  // sizes that need padding, the rows' offset, and H d against the blocks that were written
  void expect_awkward_sizes(const Elements& thousand) {
    ASSERT_EQ(thousand.size(), 1000u);
    const std::vector<EnergyResult> all = evaluate(enough(thousand));
    for (const std::size_t n : {0, 1, 3, 257, 1000}) {
      if (n > enough(thousand).size()) break;
      const Elements some(thousand.begin(), thousand.begin() + n);
      const std::vector<EnergyResult> results = evaluate(some);
      const std::vector<Eigen::VectorXd> d = directions(n), products = product(some, results, d);
      for (std::size_t e = 0; e < n; ++e) {
        ASSERT_EQ(results[e].energy, all[e].energy);
        ASSERT_EQ(results[e].gradient, all[e].gradient);
        ASSERT_EQ(results[e].hessian, all[e].hessian);
        ASSERT_TRUE(is_product(products[e], results[e].hessian, d[e]) || products[e].norm() == 0);
      }
    }
  }

  // forces sum to zero: the energy does not mind a shift of all sites
  void expect_no_net_force(const Elements& all) {
    const Elements elements = enough(all);
    for (const EnergyResult& r : evaluate(elements, false)) {
      Vec3 sum = Vec3::Zero();
      for (int s = 0; s < STENCIL; ++s) sum += r.gradient.template segment<3>(3 * s);
      ASSERT_LE(sum.norm(), 1e-11 * r.gradient.norm());
    }
  }

  // torques sum to zero and the energy stays: the energy does not mind a rotation of all sites
  void expect_rotation_invariance(const Elements& all) {
    const Elements elements = enough(all);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.1, Vec3(0.3, -0.5, 0.8).normalized()).toRotationMatrix();
    Elements turned = elements;
    for (Element& e : turned) {
      for (Vec3& x : e.x) x = turn * x;
      for (Vec3& x : e.x0) x = turn * x;
    }
    const std::vector<EnergyResult> before = evaluate(elements, false), after = evaluate(turned, false);
    for (std::size_t e = 0; e < elements.size(); ++e) {
      ASSERT_NEAR(after[e].energy, before[e].energy, 1e-10 * (std::abs(before[e].energy) + energy_scale_));
      Vec3 torque = Vec3::Zero();
      double size = 0;
      for (int s = 0; s < STENCIL; ++s) {
        torque += elements[e].x[s].cross(before[e].gradient.template segment<3>(3 * s));
        size += elements[e].x[s].norm() * before[e].gradient.template segment<3>(3 * s).norm();
      }
      ASSERT_LE(torque.norm(), 1e-10 * size);
    }
  }

  Eigen::VectorXd host_gradient(const Element& element) const {
    Eigen::VectorXd gradient(SIZE);
    for (int i = 0; i < SIZE; ++i)
      gradient(i) = (host(moved(element, i, length_)) - host(moved(element, i, -length_))) / (2 * length_);
    return gradient;
  }

  Eigen::MatrixXd difference_hessian(const Element& element) {
    Elements moves;
    for (int i = 0; i < SIZE; ++i) {
      moves.push_back(moved(element, i, length_));
      moves.push_back(moved(element, i, -length_));
    }
    const std::vector<EnergyResult> results = evaluate(moves, false);
    Eigen::MatrixXd hessian(SIZE, SIZE);
    for (int i = 0; i < SIZE; ++i)
      hessian.col(i) = (results[2 * i].gradient - results[2 * i + 1].gradient) / (2 * length_);
    return 0.5 * (hessian + hessian.transpose());
  }

  // energies below this are compared absolutely [J]
  void set_energy_scale(double scale) { energy_scale_ = scale; }

 private:
  struct Upload {
    Buffer<Params> params;
    Buffer<double> x, x0;
    // sites in reverse order, so that a kernel that ignores params.site is found out
    Upload(Device& device, const Elements& elements)
        : params(device, elements.size(), "params"),
          x(device, elements.size() * SIZE, "x"),
          x0(device, elements.size() * SIZE, "x0") {
      std::vector<Params> p;
      std::vector<double> now(elements.size() * SIZE), start(elements.size() * SIZE);
      for (std::size_t e = 0; e < elements.size(); ++e) {
        p.push_back(elements[e].params);
        for (int s = 0; s < STENCIL; ++s) {
          const u32 site = site_of(elements.size(), e, s);
          p.back().site[s] = site;
          put(now, site, elements[e].x[s]);
          put(start, site, elements[e].x0[s]);
        }
      }
      params.write(p);
      x.write(now);
      x0.write(start);
    }
  };

  // calls at(row, column, number) for the numbers that are kept of an element, in their order
  template <class At>
  void for_each_number(const At& at) const {
    int number = 0;
    if (is_whole_)
      for (int i = 0; i < SIZE * SIZE; ++i) at(i / SIZE, i % SIZE, number++);
    else
      for (int a = 0; a < STENCIL; ++a)
        for (int b = a; b < STENCIL; ++b)
          for (int k = 0; k < 9; ++k) at(3 * a + k / 3, 3 * b + k % 3, number++);
  }
  // what is not kept is what lies on the other side of the diagonal
  Eigen::MatrixXd matrix_of(const double* numbers) const {
    Eigen::MatrixXd hessian(SIZE, SIZE);
    for_each_number([&](int row, int column, int number) {
      hessian(row, column) = numbers[number];
      if (!is_whole_ && column / 3 > row / 3) hessian(column, row) = numbers[number];
    });
    return hessian;
  }

  // $PVG_OCLGRIND is set where kernels run in a simulator, a thousand times slower: a few elements are enough there
  static Elements enough(const Elements& all) {
    if (!std::getenv("PVG_OCLGRIND") || all.size() <= 70) return all;
    return Elements(all.begin(), all.begin() + 70);
  }

  static void put(std::vector<double>& values, u32 site, const Vec3& v) {
    for (int i = 0; i < 3; ++i) values[3 * site + i] = v(i);
  }

  static u32 site_of(std::size_t n, std::size_t e, int s) { return u32(n * STENCIL - 1 - (e * STENCIL + s)); }

  double host(const Element& e) const { return host_energy_(e.params, e.x.data(), e.x0.data(), H); }

  static Element moved(Element element, int coordinate, double by) {
    element.x[coordinate / 3](coordinate % 3) += by;
    return element;
  }

  static std::vector<Eigen::VectorXd> directions(std::size_t n) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<Eigen::VectorXd> d(n, Eigen::VectorXd(SIZE));
    for (Eigen::VectorXd& v : d)
      for (double& value : v) value = uniform(random);
    return d;
  }

  std::vector<Eigen::VectorXd> product(const Elements& elements, const std::vector<EnergyResult>& results,
                                       const std::vector<Eigen::VectorXd>& d) {
    const std::size_t n = elements.size();
    const Upload on_device(device_, elements);
    std::vector<double> all_d(n * SIZE), all_blocks;
    for (std::size_t e = 0; e < n; ++e) {
      for (int s = 0; s < STENCIL; ++s) put(all_d, site_of(n, e, s), d[e].template segment<3>(3 * s));
      for_each_number([&](int row, int column, int) { all_blocks.push_back(results[e].hessian(row, column)); });
    }
    Buffer<double> on_device_d(device_, all_d, "d"), blocks(device_, all_blocks, "blocks");
    Buffer<double> rows(device_, (n + 1) * SIZE, "rows");
    product_(n, u32(n), on_device.params, 0u, blocks, on_device_d, u32(STENCIL), rows);
    const std::vector<double> all_rows = rows.read();
    std::vector<Eigen::VectorXd> products;
    for (std::size_t e = 0; e < n; ++e)
      products.push_back(Eigen::Map<const Eigen::VectorXd>(&all_rows[(e + 1) * SIZE], SIZE));
    return products;
  }

  HostEnergy host_energy_;
  double length_;
  double energy_scale_ = 0;
  bool is_whole_;          // all numbers of a Hessian are kept, not those of its upper blocks alone
  std::size_t n_numbers_;  // of an element's Hessian
  Device device_;
  Program program_;
  Kernel energy_, gradient_, hessian_, product_;
};

// Uniform numbers for tests, the same on every run.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double number(double low, double high) { return low + (high - low) * (engine_() / 4294967296.0); }
  Vec3 vector(double half_size) {
    const double x = number(-half_size, half_size), y = number(-half_size, half_size);
    return Vec3(x, y, number(-half_size, half_size));
  }
  Eigen::Matrix3d rotation() {
    return Eigen::Quaterniond(number(-1, 1), number(-1, 1), number(-1, 1), number(0.1, 1))
        .normalized()
        .toRotationMatrix();
  }

 private:
  std::mt19937 engine_;
};

}  // namespace pvg
