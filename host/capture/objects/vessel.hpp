// The outside of a vessel from masks in photos: what no depth sensor sees, and nobody has measured.
#pragma once
#include "host/capture/objects/lathe.hpp"
#include "host/capture/objects/silhouette.hpp"

namespace pvg {

struct Vessel {
  Eigen::Vector2d axis = Eigen::Vector2d::Zero();  // where it stands on z = 0 [m]
  double height = 0;                               // [m]
  std::vector<double> radii;                       // at even heights, from the foot to the rim [m]
  double residual = 0;                             // root mean square over all rays [pixels]
  std::vector<double> residual_of_view;            // the same of each photo
  Profile outside() const;                         // from the axis at the bottom to the rim
};

// The body of revolution about a vertical axis, standing on z = 0, which the rays touch. A UsageError where fewer than
// three photos have rays, or where they see no such body.
Vessel fit_vessel(std::span<const TouchingRay> rays, std::size_t n_views);

// The masks of a folder (read_masked_views), three or more.
std::vector<MaskedView> read_vessel_views(const std::filesystem::path& folder);

// scale: metres per unit of the poses. A UsageError names the photo that disagrees with the others.
Vessel vessel_of_masks(Device& device, std::vector<MaskedView> views, double scale);

}  // namespace pvg
