// The start of a free flight, against flights computed by hand.
#include "pipeline/validation/free_flight.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "host/base/error.hpp"

namespace pvg {
namespace {

constexpr double FRAME = 0.01;  // [s]
const Vec3 GRAVITY(0, 0, -9.81);

// A body that begins at (1, 2, 3) with (0.5, -0.2, 1) m/s, turned by 0.3 about x, and turns with (4, -3, 2) rad/s.
const Vec3 PLACE(1, 2, 3), VELOCITY(0.5, -0.2, 1), RATE(4, -3, 2);

Pose pose_at(double t) {
  Pose pose = Pose::Identity();
  pose.linear() = (Eigen::AngleAxisd(RATE.norm() * t, RATE.normalized()) * Eigen::AngleAxisd(0.3, Vec3::UnitX()))
                      .toRotationMatrix();
  pose.translation() = PLACE + VELOCITY * t + 0.5 * t * t * GRAVITY;
  return pose;
}

std::vector<Pose> flight(int n) {
  std::vector<Pose> poses;
  for (int k = 0; k < n; ++k) poses.push_back(pose_at(k * FRAME));
  return poses;
}

double difference(const FlightStart& start) {
  return (start.pose.matrix() - pose_at(0).matrix()).norm() + (start.velocity - VELOCITY).norm() +
         (start.angular_velocity - RATE).norm();
}

TEST(FreeFlight, IsFoundExactlyFromTwoFramesAndFromMany) {
  const std::vector<Pose> poses = flight(20);
  EXPECT_LE(difference(fit_flight(poses, FRAME, 0, 2, GRAVITY)), 1e-10);
  EXPECT_LE(difference(fit_flight(poses, FRAME, 0, 20, GRAVITY)), 1e-10);
}

TEST(FreeFlight, FramesOutsideItDoNotCount) {
  std::vector<Pose> poses = flight(20);
  for (const std::size_t k : {0, 1, 2, 15, 19}) {  // in the hand, and after the first impact
    poses[k].translation() += Vec3(0.1, 0, 0.05);
    poses[k].linear() = poses[k].linear() * Eigen::AngleAxisd(0.5, Vec3::UnitY());
  }
  EXPECT_LE(difference(fit_flight(poses, FRAME, 3, 15, GRAVITY)), 1e-10);
}

// Deviations of a line's slope: s / sqrt(sum (t - mean t)^2), here s sqrt(12 / (n (n^2 - 1))) / frame
TEST(FreeFlight, ErrorsOfRatesAreThoseOfALineThroughNoisyFrames) {
  constexpr int N = 12, N_TRIES = 400;
  constexpr double NOISE = 1e-3;  // [m], [rad]
  std::srand(1);
  double places = 0, turns = 0;
  for (int i = 0; i < N_TRIES; ++i) {
    std::vector<Pose> poses = flight(N);
    for (Pose& pose : poses) {  // uniform numbers of a variance of 1
      pose.translation() += NOISE * std::sqrt(3) * Vec3::Random();
      const Vec3 turn = NOISE * std::sqrt(3) * Vec3::Random();
      pose.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * pose.linear();
    }
    const FlightStart start = fit_flight(poses, FRAME, 0, N, GRAVITY);
    places += (start.velocity - VELOCITY).squaredNorm() / 3 / N_TRIES;
    turns += (start.angular_velocity - RATE).squaredNorm() / 3 / N_TRIES;
  }
  const double expected = NOISE * std::sqrt(12.0 / (N * (N * N - 1))) / FRAME;
  EXPECT_NEAR(std::sqrt(places), expected, 0.1 * expected);  // three deviations of 1200 squares: 6 %
  EXPECT_NEAR(std::sqrt(turns), expected,
              0.1 * expected);  // the axis turns by 0.6 rad on the way, which changes little
}

TEST(FreeFlight, OfOneFrameIsRefused) {
  EXPECT_THROW(fit_flight(flight(3), FRAME, 2, 3, GRAVITY), UsageError);
  EXPECT_THROW(fit_flight(flight(3), FRAME, 0, 4, GRAVITY), UsageError);
}

}  // namespace
}  // namespace pvg
