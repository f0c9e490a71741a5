// The constants that decide a diagnosis: one row each, in the file of its stage, read by search, verdict and report
// alike.
//   X(stage, type, name, value, unit, meaning, evidence)
// stage: 1 measurement, 2 residual, 3 localisation, 4 screening, 5 fit, 6 decision, 7 proof
// (docs/theory/identification.md). evidence: what the value was chosen on. "not recorded": nobody wrote it down. How
// much the verdicts depend on each value: scripts/perturb_criteria.py. Bounds and log priors of a single effect, number
// of the scene or error of a sensor are in its own row (host/model/effect_list.hpp, data/scene_numbers.cpp,
// candidates/measurement_candidates.cpp).
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/identify/criteria_decision.hpp"
#include "host/identify/criteria_fit.hpp"
#include "host/identify/criteria_localisation.hpp"
#include "host/identify/criteria_measurement.hpp"
#include "host/identify/criteria_proof.hpp"
#include "host/identify/criteria_residual.hpp"
#include "host/identify/criteria_screening.hpp"

#define PVG_CRITERIA(X)        \
  PVG_CRITERIA_MEASUREMENT(X)  \
  PVG_CRITERIA_RESIDUAL(X)     \
  PVG_CRITERIA_LOCALISATION(X) \
  PVG_CRITERIA_SCREENING(X)    \
  PVG_CRITERIA_FIT(X)          \
  PVG_CRITERIA_DECISION(X)     \
  PVG_CRITERIA_PROOF(X)

namespace pvg::diagnose {

// Varied as a whole: set_criterion() gives the first value, and the others keep their ratios to it.
using Series = std::vector<double>;

struct Criteria {
#define PVG_CRITERION(stage, type, name, value, unit, meaning, evidence) type name = value;
  PVG_CRITERIA(PVG_CRITERION)
#undef PVG_CRITERION
};

// Those of this process: the values above unless set_criterion() was called before the first diagnosis.
const Criteria& criteria();

// For studies of how much a verdict depends on a value. A count is rounded to a whole number, at least 1. Throws a
// UsageError that lists similar names where there is no such criterion.
void set_criterion(std::string_view name, double value);
// "NAME=VALUE", as on the command line.
void set_criterion(const std::string& text);
void reset_criteria();

struct Criterion {
  int stage = 0;
  std::string name, unit, meaning, evidence;
  double value = 0, usual = 0;  // now; as in the table; of a series its first
  Series series;                // all values, as in the table; empty: no series
  bool is_count = false;
};
std::vector<Criterion> list_criteria();

}  // namespace pvg::diagnose
