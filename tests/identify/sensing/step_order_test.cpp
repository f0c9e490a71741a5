// What two steps give together
#include "host/identify/sensing/step_order.hpp"

#include <gtest/gtest.h>

namespace pvg::diagnose {
namespace {

std::vector<Prediction> predictions_of(double residual) {
  Prediction prediction;
  prediction.residual = Eigen::VectorXd::Constant(1, residual);
  return {prediction};
}

// 3 + h at h = 1 and 1/2, and 3 + h^2.
TEST(StepOrder, LimitIsThatOfAnErrorOfTheOrder) {
  EXPECT_DOUBLE_EQ(extrapolated(predictions_of(4), predictions_of(3.5), 1)[0].residual[0], 3);
  EXPECT_DOUBLE_EQ(extrapolated(predictions_of(4), predictions_of(3.25), 2)[0].residual[0], 3);
}

TEST(StepOrder, LimitFailsWhereEitherStepDoes) {
  std::vector<Prediction> failed = predictions_of(4);
  failed[0].succeeded = false;
  EXPECT_FALSE(extrapolated(failed, predictions_of(3), 1)[0].succeeded);
}

TEST(StepOrder, IsFirstOfADampedCommandAndOfImplicitEuler) {
  Variant variant;
  EXPECT_EQ(order_of_steps(variant), 1);
  variant.scene.solver.integrator = SolverSettings::Integrator::bdf2;
  EXPECT_EQ(order_of_steps(variant), 2);
  Joint joint;
  joint.damping = 1;  // acts at the end of a step, as inertia does
  variant.scene.joints = {joint};
  EXPECT_EQ(order_of_steps(variant), 2);
  variant.scene.joints[0].drive.mode = Drive::Mode::position;
  variant.scene.joints[0].drive.stiffness = variant.scene.joints[0].drive.damping = 1;
  EXPECT_EQ(order_of_steps(variant), 1);
  variant.extrapolates = true;
  EXPECT_EQ(order_of_steps(variant), 2);
}

TEST(StepOrder, ErrorOfFirstOrderIsTwiceTheChangeByHalfTheStepAndOfSecondFourThirds) {
  EXPECT_DOUBLE_EQ(richardson_factor(1), 2);
  EXPECT_DOUBLE_EQ(richardson_factor(2), 4.0 / 3);
  EXPECT_DOUBLE_EQ(richardson_factor(3), 8.0 / 7);
}

}  // namespace
}  // namespace pvg::diagnose
