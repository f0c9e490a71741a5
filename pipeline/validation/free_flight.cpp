// Places: the straight line through x - g t^2 / 2, by least squares.
// Turns: the line through what is left over, r(t) = log(R(t) R0^T exp(-w t)) = e + w' t, corrects R0 and w until it is
// 0.
#include "pipeline/validation/free_flight.hpp"

#include <algorithm>
#include <string>

#include "host/base/error.hpp"

namespace pvg {
namespace {

constexpr int N_CORRECTIONS = 20;  // each leaves a part of the error that is as small as the turn is in radians

Mat3 turned_by(const Vec3& turn) {
  const double angle = turn.norm();
  return angle > 0 ? Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() : Mat3::Identity();
}

Vec3 turn_of(const Mat3& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

// By least squares: values [n x 3] = at_zero + slope t.
struct Line {
  Vec3 at_zero, slope;
};

Line line_through(const Eigen::VectorXd& times, const Eigen::MatrixX3d& values) {
  Eigen::MatrixX2d columns(times.size(), 2);
  columns << Eigen::VectorXd::Ones(times.size()), times;
  const Eigen::Matrix<double, 2, 3> line = columns.colPivHouseholderQr().solve(values);
  return {line.row(0).transpose(), line.row(1).transpose()};
}

}  // namespace

FlightStart fit_flight(std::span<const Pose> poses, double frame, std::size_t first, std::size_t end,
                       const Vec3& gravity) {
  if (end > poses.size() || first + 2 > end)
    throw UsageError("a flight is fitted to two frames or more, here are " +
                     std::to_string(end - std::min(first, end)));
  const std::span<const Pose> seen = poses.subspan(first, end - first);
  const auto n = Eigen::Index(seen.size());
  const Eigen::VectorXd times = frame * Eigen::VectorXd::LinSpaced(n, double(first), double(end - 1));
  Eigen::MatrixX3d values(n, 3);
  for (Eigen::Index k = 0; k < n; ++k)
    values.row(k) = (seen[k].translation() - 0.5 * times[k] * times[k] * gravity).transpose();
  const Line places = line_through(times, values);

  const double between = times[n - 1] - times[0];
  FlightStart start;
  start.velocity = places.slope;
  start.angular_velocity = Vec3::Zero();
  for (Eigen::Index k = 1; k < n; ++k)
    start.angular_velocity += turn_of(seen[k].linear() * seen[k - 1].linear().transpose()) / between;
  Mat3 turned = turned_by(-times[0] * start.angular_velocity) * seen[0].linear();
  for (int i = 0; i < N_CORRECTIONS; ++i) {
    for (Eigen::Index k = 0; k < n; ++k)
      values.row(k) =
          turn_of(seen[k].linear() * (turned_by(times[k] * start.angular_velocity) * turned).transpose()).transpose();
    const Line left = line_through(times, values);
    turned = turned_by(left.at_zero) * turned;
    start.angular_velocity += left.slope;
  }
  start.pose.linear() = turned;
  start.pose.translation() = places.at_zero;
  return start;
}

}  // namespace pvg
