#include "pipeline/serve/world_arrays.hpp"

namespace pvg {

void put(std::vector<double>& numbers, const Vec3& v) { numbers.insert(numbers.end(), v.data(), v.data() + 3); }

void put(std::vector<double>& numbers, const AffineMap& map) {
  for (Eigen::Index i = 0; i < 3; ++i)
    for (Eigen::Index j = 0; j < 4; ++j) numbers.push_back(map(i, j));
}

void add_numbers(Message& message, const std::string& name, const std::vector<std::size_t>& shape,
                 const std::vector<double>& numbers) {
  add_array(message, name, shape, std::span<const double>(numbers));
}

void add_points(Message& message, const std::string& name, const std::vector<Vec3>& points) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double), "points lie one after the other");
  const double* first = points.empty() ? nullptr : points.front().data();
  add_array(message, name, {points.size(), 3}, std::span<const double>(first, 3 * points.size()));
}

void add_contacts(const WorldState& state, Message& message) {
  const std::size_t n = state.contacts.size();
  std::vector<double> points, normals, frictions, gaps, normal_forces;
  std::vector<std::int64_t> bodies;
  for (const ContactForce& contact : state.contacts) {
    put(points, contact.point);
    put(normals, contact.normal);
    put(frictions, contact.friction_force);
    gaps.push_back(contact.gap);
    normal_forces.push_back(contact.normal_force);
    bodies.insert(bodies.end(), {contact.first, contact.second});
  }
  add_numbers(message, "contact/points", {n, 3}, points);
  add_numbers(message, "contact/normal", {n, 3}, normals);
  add_numbers(message, "contact/friction_force", {n, 3}, frictions);
  add_numbers(message, "contact/gap", {n}, gaps);
  add_numbers(message, "contact/normal_force", {n}, normal_forces);
  add_array(message, "contact/bodies", {n, 2}, std::span<const std::int64_t>(bodies));
}

}  // namespace pvg
