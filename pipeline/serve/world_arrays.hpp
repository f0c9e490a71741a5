// Numbers of a simulated world as arrays of a message, named as in states.h5.
#pragma once
#include <string>
#include <vector>

#include "host/model/world_state.hpp"
#include "pipeline/serve/protocol.hpp"

namespace pvg {

void put(std::vector<double>& numbers, const Vec3& v);
void put(std::vector<double>& numbers, const AffineMap& map);  // row by row

void add_numbers(Message& message, const std::string& name, const std::vector<std::size_t>& shape,
                 const std::vector<double>& numbers);
void add_points(Message& message, const std::string& name, const std::vector<Vec3>& points);  // [n, 3]

// contact/bodies, points, normal, gap, normal_force, friction_force
void add_contacts(const WorldState& state, Message& message);

}  // namespace pvg
