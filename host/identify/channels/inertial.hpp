// What the sensors that turn with a rigid body share: its rotations, step after step.
#pragma once
#include "host/identify/channels/channel.hpp"

namespace pvg::diagnose {

// Numbers are kept per step behind each other; a rotation is nine of them, row by row.
void put(std::vector<double>& trace, const Vec3& vector);
void put(std::vector<double>& trace, const Mat3& rotation);
Vec3 vector_at(const Steps& steps, std::size_t step, std::size_t offset);
Mat3 rotation_at(const Steps& steps, std::size_t step, std::size_t offset);

// What holds between whole steps, on the line through two of `n` values that are `first` + k steps after the start.
struct Between {
  std::size_t before = 0;
  double share = 0;  // of the one after
};
Between between(double place, double first, std::size_t n);

// All three components, or the part along the channel's axis.
std::vector<double> along(const Channel& channel, const Vec3& value);

}  // namespace pvg::diagnose
