// What the samples near a time say of a value and its rate there.
#pragma once
#include <cstddef>
#include <vector>

#include "host/identify/data/problem.hpp"

namespace pvg::diagnose {

struct LocalFit {  // slope per second
  double value = 0, slope = 0, value_sigma = 0, slope_sigma = 0;
  bool is_there = false;
};

// A parabola through the samples around time t0 of component k: value and slope there. Where the run begins, and a
// constant explains its first samples as well, the value is their mean and the slope 0: the few samples that are near
// enough for the parabola give a rate of up to some sigma to what is at rest, and the law of what sticks or has play
// has a kink there, over which no fit of the start leads. Within a run, where the samples of both sides of t0 follow no
// parabola and those of one side do, as beside an impact, that side's counts.
LocalFit fit_around(const std::vector<double>& t, const std::vector<double>& values, std::size_t width, std::size_t k,
                    double t0, double sigma);

// Where something is turned to and how fast it turns [rad/s]; sigmas of a rotation vector [rad] and of the spin.
struct TurnFit {
  Mat3 rotation = Mat3::Identity();
  Vec3 spin = Vec3::Zero();
  double sigma = 0, spin_sigma = 0;
};

// Of orientations of noise `sigma` [rad], one per sample as quaternions x y z w.
TurnFit turn_around(const Run& run, const std::vector<double>& values, double t0, double sigma);

}  // namespace pvg::diagnose
