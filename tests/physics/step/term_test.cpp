// The launcher of an energy term: what it compiles, and when.
#include "host/physics/linear/term.hpp"

#include <gtest/gtest.h>

#include "energies/joint/zero_length_spring.h"
#include "tests/physics/step/small_scenes.hpp"

namespace pvg {
namespace {

TEST(Term, NothingIsCompiledWithoutElements) {
  Device device;
  device.keep_programs_in("");  // of an earlier run
  Buffer<f64> x(device, std::vector<f64>{0, 0, 0, 0, 0, 2}, "x"), rows(device, 6, "rows"), energy(device, 1, "energy");
  Term term(device, "joint", "zero_length_spring", 2);
  term.set(std::vector<ZeroLengthSpring>{}, {0, 0});
  term.energy(x, x, 1, 0, energy);
  term.gradient(x, x, 1, rows);
  term.hessian(x, x, 1);
  term.product(x, rows);
  EXPECT_EQ(device.n_compiled(), 0u);
  term.set(std::vector<ZeroLengthSpring>{{{0, 1}, 3.0}}, {0, 1});
  term.energy(x, x, 1, 0, energy);
  EXPECT_EQ(energy.read().at(0), 6.0) << "k/2 l^2";
  EXPECT_EQ(device.n_compiled(), 1u);
}

TEST(Term, AFallingBoxCompilesItsTermsTogetherAndNoneByItself) {
  Device device;
  device.keep_programs_in("");  // of an earlier run
  PhysicalScene scene = empty_scene("falling box", 0.01);
  scene.rigid_bodies = {box_body("cube", Vec3::Constant(0.05), 1000, Vec3(0, 0, 1))};
  Simulation simulation(device, scene);
  simulation.step(std::vector<double>{});
  const std::size_t before = device.n_compiled();
  // its two terms are few elements: one program has both, so that their own are not known yet, as those of a spring
  for (const char* has : {"body/affine_inertia", "body/affine_orthogonality"})
    Program(device, "energies/" + std::string(has) + ".cl");
  EXPECT_EQ(device.n_compiled(), before + 2);
  for (const char* lacks : {"joint/zero_length_spring", "elastic/cloth_membrane", "contact/barrier"})
    Program(device, "energies/" + std::string(lacks) + ".cl");
  EXPECT_EQ(device.n_compiled(), before + 5);
  // a second box needs no more
  Simulation again(device, scene);
  again.step(std::vector<double>{});
  EXPECT_EQ(device.n_compiled(), before + 5);
}

}  // namespace
}  // namespace pvg
