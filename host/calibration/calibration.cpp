#include "host/calibration/calibration.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"

namespace pvg {
namespace {

constexpr std::size_t FEWEST_PHOTOS = 3;
constexpr double LEAST_TILT = 0.17;       // between two photos' views of the board [rad]
constexpr double SMALLEST_OUTLIER = 0.3;  // residual of a photo that is never left out [pixels]

struct Points {
  std::vector<std::vector<cv::Point3f>> board;
  std::vector<std::vector<cv::Point2f>> picture;
  std::vector<std::size_t> photo;
};

Points points_of(const std::vector<BoardPhoto>& photos) {
  Points points;
  for (std::size_t i = 0; i < photos.size(); ++i) {
    if (!photos[i].is_used) continue;
    points.photo.push_back(i);
    points.board.emplace_back();
    points.picture.emplace_back();
    for (const BoardCorner& c : photos[i].corners) {
      points.board.back().emplace_back(float(c.point.x()), float(c.point.y()), float(c.point.z()));
      points.picture.back().emplace_back(float(c.pixel.x()), float(c.pixel.y()));
    }
  }
  return points;
}

struct Solution {
  cv::Mat K, distortion, sigma;
  std::vector<cv::Mat> turn, shift;
};

int flags_of(int n_distortion) {
  if (n_distortion == 8) return cv::CALIB_RATIONAL_MODEL;
  if (n_distortion == 5) return 0;
  if (n_distortion == 4) return cv::CALIB_FIX_K3;
  return cv::CALIB_FIX_K1 | cv::CALIB_FIX_K2 | cv::CALIB_FIX_K3 | cv::CALIB_ZERO_TANGENT_DIST;
}

Solution solve(const Points& points, const cv::Size& size, const CalibrationSettings& settings) {
  Solution s;
  try {
    if (settings.model == Camera::Model::fisheye) {
      cv::fisheye::calibrate(points.board, points.picture, size, s.K, s.distortion, s.turn, s.shift,
                             cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC | cv::fisheye::CALIB_FIX_SKEW);
    } else {
      cv::Mat others, per_view;
      cv::calibrateCamera(points.board, points.picture, size, s.K, s.distortion, s.turn, s.shift, s.sigma, others,
                          per_view, flags_of(settings.n_distortion));
    }
  } catch (const cv::Exception&) {
    throw UsageError(
        "the photos do not determine the camera: the board must be seen from several sides and fill the "
        "picture's corners in some photos");
  }
  return s;
}

// sets every used photo's residual; returns the root mean square of all
double set_residuals(std::vector<BoardPhoto>& photos, const Points& points, const Solution& s, bool is_fisheye) {
  double all = 0;
  std::size_t n_all = 0;
  for (std::size_t i = 0; i < points.photo.size(); ++i) {
    std::vector<cv::Point2f> projected;
    if (is_fisheye)
      cv::fisheye::projectPoints(points.board[i], projected, s.turn[i], s.shift[i], s.K, s.distortion);
    else
      cv::projectPoints(points.board[i], s.turn[i], s.shift[i], s.K, s.distortion, projected);
    BoardPhoto& photo = photos[points.photo[i]];
    photo.differences.clear();
    double sum = 0;
    for (std::size_t k = 0; k < projected.size(); ++k) {
      const cv::Point2f d = points.picture[i][k] - projected[k];
      photo.differences.emplace_back(double(d.x), double(d.y));
      sum += photo.differences.back().squaredNorm();
    }
    photo.residual = std::sqrt(sum / double(projected.size()));
    all += sum;
    n_all += projected.size();
  }
  return std::sqrt(all / double(n_all));
}

// How the corners of a photo move with the intrinsics (8 columns: fx fy cx cy k1 to k4) and with the board's pose (6).
Eigen::Matrix<double, Eigen::Dynamic, 14> fisheye_jacobian(const std::vector<cv::Point3f>& board, const Solution& s,
                                                           std::size_t photo) {
  const auto project = [&](int parameter, double by) {
    cv::Mat K = s.K.clone(), distortion = s.distortion.clone(), turn = s.turn[photo].clone(),
            shift = s.shift[photo].clone();
    double* const moved[14] = {&K.at<double>(0, 0),          &K.at<double>(1, 1),          &K.at<double>(0, 2),
                               &K.at<double>(1, 2),          distortion.ptr<double>(),     distortion.ptr<double>() + 1,
                               distortion.ptr<double>() + 2, distortion.ptr<double>() + 3, turn.ptr<double>(),
                               turn.ptr<double>() + 1,       turn.ptr<double>() + 2,       shift.ptr<double>(),
                               shift.ptr<double>() + 1,      shift.ptr<double>() + 2};
    *moved[parameter] += by;
    const std::vector<cv::Point3d> points(board.begin(), board.end());
    std::vector<cv::Point2d> pixels;
    cv::fisheye::projectPoints(points, pixels, turn, shift, K, distortion);
    return pixels;
  };
  Eigen::Matrix<double, Eigen::Dynamic, 14> J(2 * Eigen::Index(board.size()), 14);
  for (int parameter = 0; parameter < 14; ++parameter) {
    const double step = parameter < 4 ? 1e-2 : 1e-5;  // pixels; rad, m and the distortion's own numbers
    const std::vector<cv::Point2d> more = project(parameter, step), less = project(parameter, -step);
    for (std::size_t i = 0; i < board.size(); ++i) {
      J(2 * Eigen::Index(i), parameter) = (more[i].x - less[i].x) / (2 * step);
      J(2 * Eigen::Index(i) + 1, parameter) = (more[i].y - less[i].y) / (2 * step);
    }
  }
  return J;
}

// Standard deviations of the intrinsics: of the inverse of J^T J over all photos, whose poses are eliminated (Schur
// complement), times the variance of a coordinate: the squares over 2 n - 8 - 6 n_photos. OpenCV gives none.
std::vector<double> fisheye_sigma(const Points& points, const Solution& s, double residual) {
  Eigen::Matrix<double, 8, 8> information = Eigen::Matrix<double, 8, 8>::Zero();
  double n = 0;
  for (std::size_t i = 0; i < points.photo.size(); ++i) {
    const Eigen::Matrix<double, Eigen::Dynamic, 14> J = fisheye_jacobian(points.board[i], s, i);
    const Eigen::Matrix<double, 14, 14> A = J.transpose() * J;
    information += A.topLeftCorner<8, 8>() -
                   A.topRightCorner<8, 6>() * A.bottomRightCorner<6, 6>().ldlt().solve(A.bottomLeftCorner<6, 8>());
    n += double(points.board[i].size());
  }
  const double freedom = std::max(1.0, 2 * n - 8 - 6 * double(points.photo.size()));
  const Eigen::Matrix<double, 8, 1> variance = information.inverse().diagonal() * (residual * residual * n / freedom);
  std::vector<double> sigma;
  for (const double v : variance) sigma.push_back(std::sqrt(v));
  return sigma;
}

double largest_tilt(const Solution& s) {
  std::vector<cv::Vec3d> normals;
  for (const cv::Mat& turn : s.turn) {
    cv::Mat R;
    cv::Rodrigues(turn, R);
    normals.emplace_back(R.at<double>(0, 2), R.at<double>(1, 2), R.at<double>(2, 2));
  }
  double largest = 0;
  for (const cv::Vec3d& a : normals)
    for (const cv::Vec3d& b : normals) largest = std::max(largest, std::acos(std::clamp(a.dot(b), -1.0, 1.0)));
  return largest;
}

std::size_t n_used(const std::vector<BoardPhoto>& photos) {
  return std::size_t(std::count_if(photos.begin(), photos.end(), [](const BoardPhoto& p) { return p.is_used; }));
}

void demand_photos(const std::vector<BoardPhoto>& photos) {
  if (n_used(photos) >= FEWEST_PHOTOS) return;
  throw UsageError("the board is found in " + std::to_string(n_used(photos)) + " of " +
                   counted(photos.size(), "photo") + "; three are the least, fifteen from all sides are good");
}

// the photo that stands out most; photos.size(): none
std::size_t worst_outlier(const std::vector<BoardPhoto>& photos, double largest_ratio) {
  std::vector<double> residuals;
  std::size_t worst = photos.size();
  for (std::size_t i = 0; i < photos.size(); ++i) {
    if (!photos[i].is_used) continue;
    residuals.push_back(photos[i].residual);
    if (worst == photos.size() || photos[i].residual > photos[worst].residual) worst = i;
  }
  std::sort(residuals.begin(), residuals.end());
  const double limit = std::max(SMALLEST_OUTLIER, largest_ratio * residuals[residuals.size() / 2]);
  return photos[worst].residual > limit ? worst : photos.size();
}

}  // namespace

CameraCalibration calibrate_camera(std::vector<BoardPhoto> photos, int width, int height,
                                   const CalibrationSettings& settings) {
  for (BoardPhoto& photo : photos)
    if (photo.is_used && photo.corners.size() < settings.fewest_corners) {
      photo.is_used = false;
      photo.reason = photo.corners.empty() ? "the board is not found"
                                           : "the photo shows only " + counted(photo.corners.size(), "corner");
    }
  demand_photos(photos);
  const bool is_fisheye = settings.model == Camera::Model::fisheye;
  CameraCalibration out;
  Solution s;
  while (true) {
    const Points points = points_of(photos);
    s = solve(points, {width, height}, settings);
    out.residual = set_residuals(photos, points, s, is_fisheye);
    const std::size_t outlier = worst_outlier(photos, settings.largest_ratio);
    if (outlier == photos.size() || n_used(photos) <= FEWEST_PHOTOS) break;
    photos[outlier].is_used = false;
    photos[outlier].differences.clear();
    photos[outlier].reason = "its residual stands out: is the board bent, blurred or another one?";
  }
  if (largest_tilt(s) < LEAST_TILT)
    throw UsageError(
        "all photos show the board from one side, which leaves the focal length open; tilt it by 30 "
        "degrees to all sides");
  Camera& camera = out.camera;
  camera.model = settings.model;
  camera.width = width;
  camera.height = height;
  camera.fx = s.K.at<double>(0, 0);
  camera.fy = s.K.at<double>(1, 1);
  camera.cx = s.K.at<double>(0, 2);
  camera.cy = s.K.at<double>(1, 2);
  const std::size_t n = is_fisheye ? 4 : std::size_t(settings.n_distortion);
  for (std::size_t i = 0; i < n; ++i) camera.distortion.push_back(s.distortion.ptr<double>()[i]);
  if (is_fisheye)
    out.sigma = fisheye_sigma(points_of(photos), s, out.residual);
  else
    for (std::size_t i = 0; i < 4 + n; ++i) out.sigma.push_back(s.sigma.ptr<double>()[i]);
  out.photos = std::move(photos);
  return out;
}

CameraPlace place_camera(const std::vector<FoundTag>& found, const std::vector<PlacedTag>& tags, const Camera& camera) {
  std::vector<cv::Point3d> world;
  std::vector<cv::Point2d> pixels;
  CameraPlace out;
  for (const FoundTag& seen : found)
    for (const PlacedTag& tag : tags) {
      if (tag.id != seen.id) continue;
      out.used.push_back(tag.id);
      for (int k = 0; k < 4; ++k) {
        const double half = tag.size / 2;
        const Vec3 p = tag.pose * Vec3(k == 1 || k == 2 ? half : -half, k >= 2 ? half : -half, 0);
        world.emplace_back(p.x(), p.y(), p.z());
        pixels.emplace_back(seen.corners[std::size_t(k)].x(), seen.corners[std::size_t(k)].y());
      }
    }
  if (world.empty())
    throw UsageError("none of the " + counted(tags.size(), "tag") + " of the list is among the " +
                     counted(found.size(), "tag") + " of the photo");
  const cv::Matx33d K(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  // of a fisheye the pixels are undistorted first
  std::vector<double> distortion = camera.distortion;
  if (camera.model == Camera::Model::fisheye) {
    std::vector<cv::Point2d> straight;
    cv::fisheye::undistortPoints(pixels, straight, K, distortion, cv::noArray(), K);
    pixels = straight;
    distortion.clear();
  }
  cv::Mat turn, shift;
  cv::solvePnP(world, pixels, K, distortion, turn, shift, false,
               world.size() == 4 ? cv::SOLVEPNP_IPPE : cv::SOLVEPNP_SQPNP);
  cv::solvePnPRefineLM(world, pixels, K, distortion, turn, shift);
  cv::Mat J;
  std::vector<cv::Point2d> projected;
  cv::projectPoints(world, turn, shift, K, distortion, projected, J);
  double sum = 0;
  for (std::size_t i = 0; i < projected.size(); ++i) {
    const cv::Point2d d = projected[i] - pixels[i];
    sum += d.dot(d);
  }
  out.residual = std::sqrt(sum / double(projected.size()));
  cv::Mat R;
  cv::Rodrigues(turn, R);
  Pose from_world = Pose::Identity();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) from_world.linear()(i, j) = R.at<double>(i, j);
    from_world.translation()[i] = shift.at<double>(i);
  }
  out.pose = from_world.inverse();
  // (J^T J)^-1 times the variance of a coordinate; columns 0-2 turn, 3-5 shift of the world before the camera
  const cv::Mat A = J.colRange(0, 6);
  const cv::Mat covariance =
      cv::Mat(A.t() * A).inv(cv::DECOMP_SVD) * (sum / std::max(1.0, 2.0 * double(world.size()) - 6));
  for (int i = 0; i < 3; ++i) {
    out.rotation_sigma[i] = std::sqrt(covariance.at<double>(i, i));
    out.position_sigma[i] = std::sqrt(covariance.at<double>(3 + i, 3 + i));
  }
  return out;
}

}  // namespace pvg
