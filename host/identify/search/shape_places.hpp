// Where a law of several strengths and a shape is tried, such as friction that falls with speed. Which strengths fit
// depends on the shape, and a fit that begins at another shape, or at strengths of another one, ends in another
// minimum. So the strengths x are fitted at each of several shapes s by one Gauss-Newton step
//   x_s = argmin over low <= x <= high of |r(x_0) + J_s (x - x_0)|^2
// from x_0, where the first strength explains most alone, since the shape does nothing while the other ones are off.
#pragma once
#include <vector>

#include "host/identify/search/screen.hpp"

namespace pvg::diagnose {

// The models at the fitted strengths; none of another law. some: the windows in which it is tried, few: the base there,
// of which the candidate is the last part in `screened`.
std::vector<Model> places_at_shapes(Fitter& fitter, const FitData& some, const Fit& few, const Screened& screened);

}  // namespace pvg::diagnose
