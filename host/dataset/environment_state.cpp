#include "host/dataset/environment_state.hpp"

#include <algorithm>
#include <numeric>

#include "host/dataset/packed_columns.hpp"
#include "host/geometry/nearest_point.hpp"

namespace pvg {
namespace {

constexpr const char* AXES[] = {"x", "y", "z"};

// The two axes of the bounding box in which it is longest, the longer one not necessarily first.
std::array<int, 2> longest_axes(const Vec3& size) {
  std::array<int, 3> axes = {0, 1, 2};
  std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return size[a] > size[b]; });
  return {std::min(axes[0], axes[1]), std::max(axes[0], axes[1])};
}

}  // namespace

ClothKeypoints cloth_keypoints(const std::string& name, std::span<const Vec3> rest) {
  Vec3 low = rest.front(), high = rest.front();
  for (const Vec3& point : rest) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  const auto [u, v] = longest_axes(high - low);
  // of the rectangle, in units of its half sides from its middle
  constexpr int AROUND[8][2] = {{-1, -1}, {0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}};
  const Vec3 middle = (low + high) / 2, half = (high - low) / 2;
  ClothKeypoints keypoints{name, {}};
  for (std::size_t k = 0; k < keypoints.vertices.size(); ++k) {
    Vec3 place = middle;
    place[u] += AROUND[k][0] * half[u];
    place[v] += AROUND[k][1] * half[v];
    keypoints.vertices[k] = nearest_point(rest, place);
  }
  return keypoints;
}

std::vector<EnvironmentColumn> environment_columns(std::span<const std::string> objects,
                                                   std::span<const ClothKeypoints> cloths) {
  std::vector<EnvironmentColumn> columns;
  for (const std::string& object : objects)
    for (std::size_t i = 0; i < POSE_NUMBERS.size(); ++i)
      columns.push_back({without_slashes(object) + "_" + POSE_NUMBERS[i], i < 3});
  for (const ClothKeypoints& cloth : cloths)
    for (const char* keypoint : KEYPOINT_NAMES)
      for (const char* axis : AXES)
        columns.push_back({without_slashes(cloth.name) + "_" + keypoint + "_" + axis, true});
  return columns;
}

std::array<double, 24> keypoint_numbers(const ClothKeypoints& cloth, std::span<const Vec3> points) {
  std::array<double, 24> numbers;
  for (std::size_t k = 0; k < cloth.vertices.size(); ++k)
    for (std::size_t axis = 0; axis < 3; ++axis) numbers[3 * k + axis] = points[cloth.vertices[k]][Eigen::Index(axis)];
  return numbers;
}

}  // namespace pvg
