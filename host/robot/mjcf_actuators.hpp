// Joints and actuators of an MJCF file. Internal to its reader.
#pragma once
#include "host/robot/mjcf_geometry.hpp"

namespace pvg::mjcf {

// The joint of a body: its type, axis, limits, friction and spring. frame: of the body in its parent's frame (or in the
// world), where the joint stands at `ref`.
MultibodyJoint read_joint(const Element& element, const Compiler& compiler, const Pose& frame);

// Gives joints of the model their drives. The command of a drive is what the joint is told to do, in its own units:
// with a `gear` g the control of MuJoCo is g times that (position, velocity) or the g-th part of it (torque).
void read_actuators(const TiXmlElement& root, const Defaults& defaults, const Compiler& compiler,
                    const std::string& file, Multibody& model);

}  // namespace pvg::mjcf
