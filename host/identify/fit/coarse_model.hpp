// Changes in coarse steps. Steps that are much too long for a residual still tell to a few per cent how a candidate
// changes it, for a part of the cost:
//   r(x) = r_fine(base) + r_coarse(x) - r_coarse(base)
// What is screened is simulated so; what is fitted is not.
#pragma once
#include <memory>
#include <optional>

#include "host/identify/fit/fit.hpp"

namespace pvg::diagnose {

struct CoarseModel {
  std::unique_ptr<const Variant> variant;  // the fitter's
  std::unique_ptr<Fitter> fitter;
  FitData data;  // its windows hold r_fine(base) - r_coarse(base) as a correction
};

// About a model and the measured starts, with the longest steps, of the scene's own or a half, a quarter ... of it,
// which cost less than half of what the fitter's do and err by a small share of what the channels do. None: there are
// no such steps. base: the fitter's.
std::optional<CoarseModel> coarse_model(Fitter& fitter, Predictor& predictor, const Problem& problem,
                                        const Variant& base, const FitData& data, const Model& model);

// Root mean square of what a window's channels do, in units of noise, about their means.
double signal_of(const Problem& problem, const Window& window);

}  // namespace pvg::diagnose
