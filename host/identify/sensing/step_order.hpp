// The order p of the error of a time step h, e = c h^p, and what it makes of the difference of two steps (Richardson
// 1911): p(0) = p(h) + k (p(h/2) - p(h)), k = 2^p / (2^p - 1).
#pragma once
#include "host/identify/sensing/rollout.hpp"

namespace pvg::diagnose {

bool dissipates(const PhysicalScene& scene);
bool damps_rate_of_command(const PhysicalScene& scene);

// 2 of BDF2. 1 of implicit Euler, and of BDF2 where a drive damps the rate of its command, which is the mean over a
// step. Of what is extrapolated one more.
int order_of_steps(const Variant& variant);

// k of an order.
double richardson_factor(int order);

// What steps of no length would give, of the same jobs in steps and in half of them.
std::vector<Prediction> extrapolated(const std::vector<Prediction>& coarse, std::vector<Prediction> fine, int order);

}  // namespace pvg::diagnose
