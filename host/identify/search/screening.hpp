// What candidates are screened in: coarse steps where these tell enough (coarse_model.hpp), else those of the fits.
#pragma once
#include <optional>

#include "host/identify/fit/coarse_model.hpp"
#include "host/identify/search/workflow.hpp"

namespace pvg::diagnose {

class Screening {
 public:
  Screening(Workflow& flow, const FitData& data, const Fit& base)
      : coarse_(coarse_model(flow.fitter, flow.predictor, flow.problem, flow.base, data, base.model)),
        fitter(coarse_ ? *coarse_->fitter : flow.fitter),
        data(coarse_ ? coarse_->data : data) {}
  Screening(const Screening&) = delete;

 private:
  std::optional<CoarseModel> coarse_;

 public:
  Fitter& fitter;
  const FitData& data;
};

}  // namespace pvg::diagnose
