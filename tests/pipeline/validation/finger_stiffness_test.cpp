// The fin-ray finger of data/grippers, pressed on its pad: how its mesh compares with the same mesh refined.
#include <gtest/gtest.h>

#include "host/load/task_file.hpp"
#include "pipeline/validation/finger.hpp"

namespace pvg {
namespace {

// Four nodes instead of ten make it several times too stiff: what the finger's mesh must avoid. How near it is to a
// finer mesh over the whole curve is the validation case `finger`.
TEST(FingerStiffness, TenNodesPerElementDoNotLock) {
  Device device;
  const FingerSection finger = load_gripper(PVG_DATA_FOLDER "/grippers/umi_finray/gripper.yaml").fingers.at(0);
  ASSERT_EQ(finger.nodes_per_element, 10);
  const TetMesh linear = linear_finger_mesh(finger);
  const auto deflection = [&](const TetMesh& mesh) {
    return pad_deflections(device, mesh, finger.material, {0.1}).at(0);
  };
  const double task = deflection(make_quadratic(linear)), refined = deflection(make_quadratic(refine(linear)));
  EXPECT_LE(task, refined) << "a finer mesh is never stiffer";
  EXPECT_NEAR(refined / task, 1, 0.08);
  EXPECT_GT(task / deflection(linear), 2);
}

}  // namespace
}  // namespace pvg
