// How far each world may move: additive continuous collision detection over the candidates, then the smallest part of
// the motion per world.
#pragma once
#include "energies/contact/barrier.h"
#include "host/device/device.hpp"
#include "host/physics/linear/world_rows.hpp"

namespace pvg {

// The smallest of the values of each world; the order of the values does not matter to it.
class WorldMinimum {
 public:
  explicit WorldMinimum(Device& device);
  // first: [n_worlds + 1] runs in values;  none: of a world without values
  std::vector<double> operator()(const std::vector<u32>& first, const Buffer<double>& values, double none);

 private:
  Program program_;
  Kernel min_of_worlds_;
  Buffer<u32> first_;
  Buffer<double> least_;
};

class ContinuousCollision {
 public:
  explicit ContinuousCollision(Device& device);
  // The part in [0, 1] of the motion x0 -> x1 [n_sites x 3, m] that is certified for each world.
  std::vector<double> largest_step(const WorldRows<Barrier>& pairs, const Buffer<double>& x0, const Buffer<double>& x1);
  // Starts to find the part of each pair [pairs.n()].
  const Buffer<double>& start(const WorldRows<Barrier>& pairs, const Buffer<double>& x0, const Buffer<double>& x1);
  // room for the results of so many pairs, which another launch finds
  Buffer<double>& steps(std::size_t n);
  Buffer<double>& of_64() { return of_64_; }
  const Buffer<double>& of_64() const { return of_64_; }  // the least of each 64 of them, of the last call

 private:
  Program program_;
  Kernel accd_steps_;
  Buffer<double> steps_, of_64_;
  WorldMinimum minimum_;
};

}  // namespace pvg
