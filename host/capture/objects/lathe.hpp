// A body of revolution from a profile: what no depth sensor sees, such as a drinking glass. Pure but for reading.
#pragma once
#include "host/capture/objects/object.hpp"

namespace pvg {

using Profile = std::vector<Eigen::Vector2d>;  // radius and height [m], along the outline

// CSV with the columns radius and height, the first row on the axis (radius 0), and none between first and last row.
// UsageErrors name file and row.
Profile read_profile(const std::filesystem::path& file, double scale);

// A profile that ends on the axis is a whole outline and comes back. One that ends at a rim is the outside of a vessel:
// the inside is added, `wall` [m] from it, its corners mitred and its rim flat. UsageErrors where a wall is missing or
// not wanted, or where the outline crosses itself.
Profile closed_outline(const Profile& profile, double wall);

// The outline, turned about the z axis. Radii are a little larger than the outline's, so that the volume of the
// polygons is that of the circles.
TriangleMesh revolved(const Profile& outline, std::uint32_t sectors);

// closed_outline of the profile, revolved. UsageErrors begin with the name.
ObjectSource turned_object(const std::string& name, const Profile& profile, double wall);
ObjectSource read_lathe_object(const std::filesystem::path& file, double wall, double scale);

}  // namespace pvg
