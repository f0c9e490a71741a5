#include "host/calibration/tag_frame.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <opencv2/calib3d.hpp>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"

namespace pvg {
namespace {

constexpr double LARGEST_SCALE_ERROR = 0.05;

struct CornerRay {
  Vec3 origin, direction;  // of unit length, in the capture's frame
  std::size_t photo;
};

std::array<CornerRay, 4> corner_rays(const TagPhoto& photo, const FoundTag& tag, std::size_t number) {
  const Camera& camera = photo.camera;
  const cv::Matx33d K(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  std::vector<cv::Point2d> pixels, straight;
  for (const Eigen::Vector2d& corner : tag.corners) pixels.emplace_back(corner.x(), corner.y());
  if (camera.model == Camera::Model::fisheye)
    cv::fisheye::undistortPoints(pixels, straight, K, camera.distortion);
  else
    cv::undistortPoints(pixels, straight, K, camera.distortion, cv::noArray(), cv::noArray(),
                        cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 50, 1e-12));
  std::array<CornerRay, 4> rays;
  for (std::size_t k = 0; k < 4; ++k)
    rays[k] = {camera.pose.translation(), camera.pose.linear() * Vec3(straight[k].x, straight[k].y, 1).normalized(),
               number};
  return rays;
}

double widest_angle(const std::vector<CornerRay>& rays) {
  double least_cosine = 1;
  for (const CornerRay& a : rays)
    for (const CornerRay& b : rays) least_cosine = std::min(least_cosine, a.direction.dot(b.direction));
  return std::acos(std::clamp(least_cosine, -1.0, 1.0));
}

Vec3 nearest_point(const std::vector<CornerRay>& rays) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Vec3 b = Vec3::Zero();
  for (const CornerRay& ray : rays) {
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - ray.direction * ray.direction.transpose();
    A += across;
    b += across * ray.origin;
  }
  return A.ldlt().solve(b);
}

}  // namespace

TagFrame locate_tags(std::span<const TagPhoto> photos, const std::vector<PlacedTag>& tags, double least_angle) {
  TagFrame out;
  std::vector<Vec3> seen, given;
  std::vector<bool> is_used(photos.size(), false);
  for (const PlacedTag& tag : tags) {
    std::array<std::vector<CornerRay>, 4> rays;
    for (std::size_t i = 0; i < photos.size(); ++i)
      for (const FoundTag& found : photos[i].found) {
        if (found.id != tag.id) continue;
        const std::array<CornerRay, 4> of_photo = corner_rays(photos[i], found, i);
        for (std::size_t k = 0; k < 4; ++k) rays[k].push_back(of_photo[k]);
      }
    if (rays[0].empty() || widest_angle(rays[0]) < least_angle) continue;
    out.used.push_back(tag.id);
    for (const CornerRay& ray : rays[0]) is_used[ray.photo] = true;
    for (int k = 0; k < 4; ++k) {
      const double half = tag.size / 2;
      seen.push_back(nearest_point(rays[std::size_t(k)]));
      given.push_back(tag.pose * Vec3(k == 1 || k == 2 ? half : -half, k >= 2 ? half : -half, 0));
    }
  }
  std::sort(out.used.begin(), out.used.end());
  out.n_photos = std::size_t(std::count(is_used.begin(), is_used.end(), true));
  if (seen.empty())
    throw UsageError(
        fmt::format("none of the {} of the list is seen by two of the {} from different sides; take more "
                    "photos of them",
                    counted(tags.size(), "tag"), counted(photos.size(), "photo")));
  const auto matrix = [](const std::vector<Vec3>& points) {
    return Eigen::Matrix3Xd(Eigen::Map<const Eigen::Matrix3Xd>(points[0].data(), 3, Eigen::Index(points.size())));
  };
  const Eigen::Matrix3Xd from = matrix(seen), to = matrix(given);
  out.scale = Eigen::umeyama(from, to, true).topLeftCorner<3, 1>().norm();
  if (std::abs(out.scale - 1) > LARGEST_SCALE_ERROR)
    throw UsageError(fmt::format(
        "by the photos' poses the tags are {:.3f} times as large as the list says; are the poses in metres, and is "
        "`size` the edge of the black border?",
        1 / out.scale));
  out.world_from_capture.matrix() = Eigen::umeyama(from, to, false);
  double sum = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) sum += (out.world_from_capture * seen[i] - given[i]).squaredNorm();
  out.residual = std::sqrt(sum / double(seen.size()));
  return out;
}

}  // namespace pvg
