#include "host/identify/fit/prior.hpp"

#include <cmath>

#include "host/identify/criteria.hpp"

namespace pvg::diagnose {
namespace {

double sigma_of(const Parameter& p) { return p.prior_sigma > 0 ? p.prior_sigma : p.high - p.low; }

bool is_habit(const Parameter& p) { return p.prior_is_habit && p.prior_sigma > 0; }

double squares_away(const Parameter& p, double x) { return std::pow((x - p.off) / sigma_of(p), 2); }

}  // namespace

double prior_cost(const Parameter& p, double x) {
  const double squares = squares_away(p, x), nu = criteria().student_freedom;
  return is_habit(p) ? (nu + 1) / 2 * std::log1p(squares / nu) : squares / 2;
}

double prior_weight(const Parameter& p, double x) {
  const double squares = squares_away(p, x), nu = criteria().student_freedom;
  return (is_habit(p) ? (nu + 1) / (nu + squares) : 1) / std::pow(sigma_of(p), 2);
}

}  // namespace pvg::diagnose
