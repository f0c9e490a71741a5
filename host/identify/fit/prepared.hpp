// Windows made ready for fits, with the scene as it stands fitted to the same windows. A new preparation changes
// starts, sensitivities and the correction for the time step, and so all residuals: errors are compared within one
// preparation only.
#pragma once
#include <optional>

#include "host/identify/fit/fit.hpp"

namespace pvg::diagnose {

class Prepared {
 public:
  explicit Prepared(FitData data) : data_(std::move(data)) {}
  Prepared(FitData data, Fit base) : data_(std::move(data)), base_(std::move(base)) {}
  const FitData& data() const { return data_; }
  const Fit& base(Fitter& fitter);  // the scene as it stands, fitted when first asked for

 private:
  FitData data_;
  std::optional<Fit> base_;
};

// The time step's error and the sensitivities to the starts differ with an effect: both are found again at `fit`, which
// then continues there from the starts that it has. `prepared` becomes the new preparation; it and the fit stay as they
// are where that fails.
Fit prepared_again(Fitter& fitter, Prepared& prepared, const Fit& fit, int n_steps = criteria().n_more_steps);

}  // namespace pvg::diagnose
