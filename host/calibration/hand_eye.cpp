#include "host/calibration/hand_eye.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <random>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/base/statistics.hpp"

namespace pvg {
namespace {

using Vec12 = Eigen::Matrix<double, 12, 1>;
using Mat12 = Eigen::Matrix<double, 12, 12>;
using Pixels = std::vector<Eigen::Vector2d>;

constexpr std::size_t FEWEST_POSES = 4;
constexpr std::size_t DRAWN = 4;               // photos of a trial
constexpr int TRIALS = 60;                     // with half of the photos wrong, one of 16 trials has none of them
constexpr int ITERATIONS = 30;                 // of the least squares
constexpr double LARGEST_RATIO = 3;            // of a photo's residual to the median one
constexpr double SMALLEST_POSE_OUTLIER = 0.5;  // residual of a photo that is never left out [pixels]
constexpr double LEAST_TURN = 0.09;            // about a second axis, root mean square over all pairs of photos [rad]
constexpr double LARGEST_RESIDUAL = 0.02;      // of the picture's width: more is no solution

// Corners of one photo's known tags: their places, and where a camera without distortion would see them.
struct View {
  std::size_t photo = 0;
  std::vector<Vec3> points;  // in the tags' frame [m]
  Pixels pixels;
  Pose hand, camera_in_tags;
};

struct Guess {
  Pose mount = Pose::Identity(), tags = Pose::Identity();
};

Pixels straightened(const Pixels& seen, const Camera& camera) {
  const cv::Matx33d K(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  std::vector<cv::Point2d> in, out;
  for (const Eigen::Vector2d& p : seen) in.emplace_back(p.x(), p.y());
  if (camera.model == Camera::Model::fisheye)
    cv::fisheye::undistortPoints(in, out, K, camera.distortion, cv::noArray(), K);
  else
    cv::undistortPoints(in, out, K, camera.distortion, cv::noArray(), K,
                        cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 40, 1e-8));
  Pixels pixels;
  for (const cv::Point2d& p : out) pixels.emplace_back(p.x, p.y);
  return pixels;
}

View view_of(const HandPhoto& photo, std::size_t number, const std::vector<PlacedTag>& tags, const Camera& camera) {
  View view;
  view.photo = number;
  view.hand = photo.hand;
  Pixels seen;
  for (const FoundTag& found : photo.found)
    for (const PlacedTag& tag : tags) {
      if (tag.id != found.id) continue;
      for (std::size_t k = 0; k < 4; ++k) {
        const double half = tag.size / 2;
        view.points.push_back(tag.pose * Vec3(k == 1 || k == 2 ? half : -half, k >= 2 ? half : -half, 0));
        seen.push_back(found.corners[k]);
      }
    }
  if (view.points.empty()) return view;
  view.pixels = straightened(seen, camera);
  view.camera_in_tags = place_camera(photo.found, tags, camera).pose;
  return view;
}

Guess park(const std::vector<const View*>& views) {
  std::vector<cv::Mat> hand_turn, hand_shift, tags_turn, tags_shift;
  const auto add = [](const Pose& pose, std::vector<cv::Mat>& turn, std::vector<cv::Mat>& shift) {
    cv::Mat R(3, 3, CV_64F), t(3, 1, CV_64F);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) R.at<double>(i, j) = pose.linear()(i, j);
      t.at<double>(i) = pose.translation()[i];
    }
    turn.push_back(R);
    shift.push_back(t);
  };
  for (const View* view : views) {
    add(view->hand, hand_turn, hand_shift);
    add(view->camera_in_tags.inverse(), tags_turn, tags_shift);
  }
  cv::Mat R, t;
  cv::calibrateHandEye(hand_turn, hand_shift, tags_turn, tags_shift, R, t, cv::CALIB_HAND_EYE_PARK);
  Guess guess;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) guess.mount.linear()(i, j) = R.at<double>(i, j);
    guess.mount.translation()[i] = t.at<double>(i);
  }
  guess.tags = views[0]->hand * guess.mount * views[0]->camera_in_tags.inverse();
  return guess;
}

Pose moved(const Pose& pose, const Vec3& shift, const Vec3& turn) {  // in the pose's own frame
  Pose motion = Pose::Identity();
  motion.translation() = shift;
  if (turn.norm() > 0) motion.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  return pose * motion;
}

Guess moved(const Guess& g, const Vec12& step) {
  return {moved(g.mount, step.segment<3>(0), step.segment<3>(3)),
          moved(g.tags, step.segment<3>(6), step.segment<3>(9))};
}

// seen minus projected, [2 x corners]; far away where a corner is behind the camera
Eigen::VectorXd differences(const View& view, const Guess& g, const Camera& camera) {
  const Pose to_camera = (view.hand * g.mount).inverse() * g.tags;
  Eigen::VectorXd d(2 * Eigen::Index(view.points.size()));
  for (std::size_t i = 0; i < view.points.size(); ++i) {
    const Vec3 p = to_camera * view.points[i];
    const Eigen::Vector2d seen =
        p.z() > 1e-6 ? Eigen::Vector2d(camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy)
                     : Eigen::Vector2d(1e4, 1e4);
    d.segment<2>(2 * Eigen::Index(i)) = view.pixels[i] - seen;
  }
  return d;
}

double residual_of(const View& view, const Guess& g, const Camera& camera) {
  return std::sqrt(differences(view, g, camera).squaredNorm() / double(view.points.size()));
}

double median_residual(const std::vector<View>& views, const Guess& g, const Camera& camera) {
  std::vector<double> residuals;
  for (const View& view : views) residuals.push_back(residual_of(view, g, camera));
  return upper_median(std::move(residuals));
}

double sum_of_squares(const std::vector<const View*>& views, const Guess& g, const Camera& camera) {
  double sum = 0;
  for (const View* view : views) sum += differences(*view, g, camera).squaredNorm();
  return sum;
}

// Levenberg and Marquardt over both poses; the normal matrix at the end goes to `normal`.
Guess refined(const std::vector<const View*>& views, Guess g, const Camera& camera, Mat12& normal) {
  double damping = 1e-4, sum = sum_of_squares(views, g, camera);
  for (int iteration = 0; iteration < ITERATIONS; ++iteration) {
    normal.setZero();
    Vec12 right = Vec12::Zero();
    for (const View* view : views) {
      const Eigen::VectorXd d = differences(*view, g, camera);
      Eigen::MatrixXd J(d.size(), 12);
      constexpr double STEP = 1e-6;  // [m, rad]
      for (int k = 0; k < 12; ++k)
        J.col(k) = (differences(*view, moved(g, STEP * Vec12::Unit(k)), camera) -
                    differences(*view, moved(g, -STEP * Vec12::Unit(k)), camera)) /
                   (2 * STEP);
      normal += J.transpose() * J;
      right -= J.transpose() * d;
    }
    Mat12 damped = normal;
    damped.diagonal() *= 1 + damping;
    const Vec12 step = damped.ldlt().solve(right);
    const Guess next = moved(g, step);
    const double then = sum_of_squares(views, next, camera);
    if (then > sum) {
      damping *= 10;
      if (damping > 1e6) break;
      continue;
    }
    g = next;
    damping = std::max(damping / 10, 1e-9);
    const bool is_done = sum - then <= 1e-12 * sum;
    sum = then;
    if (is_done) break;
  }
  return g;
}

// The second largest turn, about axes that are perpendicular, between all pairs of photos [rad].
double second_turn(const std::vector<View>& views) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  double n = 0;
  for (const View& a : views)
    for (const View& b : views) {
      const Eigen::AngleAxisd turn(a.hand.linear().transpose() * b.hand.linear());
      spread += turn.angle() * turn.angle() * turn.axis() * turn.axis().transpose();
      n += 1;
    }
  return std::sqrt(std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread / n).eigenvalues()[1]));
}

// The solution from few photos that suits half of all best (least median of squares, Rousseeuw 1984).
Guess first_guess(const std::vector<View>& views, const Camera& camera) {
  std::mt19937 random(1);
  std::vector<std::size_t> order(views.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  Guess best;
  double least = INFINITY;
  for (int trial = 0; trial < TRIALS; ++trial) {
    std::vector<const View*> drawn;
    for (std::size_t i = 0; i < std::min(DRAWN, order.size()); ++i) {
      std::swap(order[i], order[i + random() % (order.size() - i)]);
      drawn.push_back(&views[order[i]]);
    }
    Mat12 normal;
    Guess guess = park(drawn);
    if (!guess.mount.matrix().allFinite()) continue;
    guess = refined(drawn, guess, camera, normal);
    const double median = median_residual(views, guess, camera);
    if (median < least) {
      least = median;
      best = guess;
    }
  }
  return best;
}

}  // namespace

HandEye calibrate_hand_eye(std::vector<HandPhoto> photos, const std::vector<PlacedTag>& tags, const Camera& camera) {
  std::vector<View> views;
  for (std::size_t i = 0; i < photos.size(); ++i) {
    View view = view_of(photos[i], i, tags, camera);
    photos[i].is_used = !view.points.empty();
    if (photos[i].is_used)
      views.push_back(std::move(view));
    else
      photos[i].reason = "none of the tags is found";
  }
  if (views.size() < FEWEST_POSES)
    throw UsageError("tags are found in " + std::to_string(views.size()) + " of " + counted(photos.size(), "photo") +
                     "; four are the least, fifteen from all sides are good");
  if (second_turn(views) < LEAST_TURN)
    throw UsageError(
        "the hand turned about one axis alone, which leaves the camera's place along it open; tilt it by 30 degrees "
        "about others, too");
  Guess guess = first_guess(views, camera);
  const double median = median_residual(views, guess, camera);
  if (!(median < LARGEST_RESIDUAL * camera.width))
    throw UsageError("no mount of the camera suits half of the photos (median residual " +
                     std::to_string(int(std::min(median, 1e6))) +
                     " pixels); are the rows of --hand in the photos' order, and in radians and metres?");
  HandEye out;
  Mat12 normal;
  std::vector<const View*> used;
  // each pass decides anew which photos stand out
  for (int pass = 0; pass < 3; ++pass) {
    const double limit = std::max(SMALLEST_POSE_OUTLIER, LARGEST_RATIO * median_residual(views, guess, camera));
    used.clear();
    for (const View& view : views)
      if (residual_of(view, guess, camera) <= limit) used.push_back(&view);
    guess = refined(used, guess, camera, normal);
  }
  if (used.size() < FEWEST_POSES)
    throw UsageError("only " + counted(used.size(), "photo agrees with others", "photos agree with each other") +
                     "; four are the least");
  std::size_t n_corners = 0;
  for (const View& view : views) {
    HandPhoto& photo = photos[view.photo];
    photo.residual = residual_of(view, guess, camera);
    photo.is_used = std::find(used.begin(), used.end(), &view) != used.end();
    if (photo.is_used)
      n_corners += view.points.size();
    else
      photo.reason = "its residual stands out: did the tags move, or is its row of another photo?";
  }
  const double sum = sum_of_squares(used, guess, camera);
  const Mat12 covariance = normal.inverse() * (sum / std::max(1.0, 2.0 * double(n_corners) - 12));
  out.mount = guess.mount;
  out.tags = guess.tags;
  out.residual = std::sqrt(sum / double(n_corners));
  for (int k = 0; k < 3; ++k) {
    out.position_sigma[k] = std::sqrt(covariance(k, k));
    out.rotation_sigma[k] = std::sqrt(covariance(3 + k, 3 + k));
  }
  out.photos = std::move(photos);
  return out;
}

}  // namespace pvg
