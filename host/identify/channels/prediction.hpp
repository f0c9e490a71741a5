// What the files of several kinds of channels share: what a sensor makes of a vector, values between steps,
// differences.
#pragma once
#include "host/identify/channels/channel.hpp"

namespace pvg::diagnose {

Mat3 rotation_of(const Vec3& vector);  // of a rotation vector [rad]

// The channel's entry of a list; zero where the list is empty.
Vec3 entry_of(const std::vector<Vec3>& list, std::size_t channel);

// One number of a joint with its bias.
std::vector<double> sensed(const Look& look, double value);

// A vector with its bias: all three components, or its part along the channel's axis.
std::vector<double> sensed(const Channel& channel, const Look& look, const Vec3& value);

// A length as the measurement's frame and scale show it.
Vec3 in_frame(const Look& look, const Vec3& value);

// The same with its bias: all three components, or its part along the channel's axis.
std::vector<double> sensed_length(const Channel& channel, const Look& look, const Vec3& value);

// A point of a rigid body, or the weighted nodes of a soft body or cloth, moved by the channel's marker offset.
Vec3 point_of(const Channel& channel, const Look& look);

// A cubic through four steps; before the start the line that touches it there, since what a late channel saw first is
// from before the window, and what moves was on its way.
std::vector<double> cubic_value(const Channel& channel, const Steps& steps, double time);

// The slope of that cubic [1/s], of the first half of the numbers; the other half, its bias, is added.
std::vector<double> slope_with_bias(const Channel& channel, const Steps& steps, double time);

// What a first-order low pass of that cut-off [Hz] makes of steps of length h [s], in place  [n x width]:
//   tau y' = x - y,  tau = 1 / (2 pi f),  x straight between the steps, before the start on the line of the first two.
void low_pass(std::vector<double>& steps, std::size_t width, double h, double cut_off);

// Pictures lie on the line between two steps, as each costs one.
std::vector<double> between_pictures(const Channel& channel, const Steps& steps, double time);

Vec3 plain_difference(const double* measured, const double* predicted, int n);

}  // namespace pvg::diagnose
