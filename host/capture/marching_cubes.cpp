// The cases of marching cubes, from the rule alone. No triangle has an inner edge within a face of the cube where that
// can be avoided: the neighbour might have the same one, and four triangles would share it.
#include <algorithm>
#include <array>

#include "host/base/error.hpp"
#include "host/capture/fusion.hpp"

namespace pvg {
namespace {

constexpr unsigned CASE_LENGTH = 16;  // as in marching_cubes.cl
constexpr std::uint8_t END = 255;

// Corners of the six faces, counter-clockwise seen from outside; bits x, y, z of a corner.
constexpr unsigned FACES[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

// e = 4 axis + k: along `axis` from the corner whose other two bits are those of k
std::uint8_t edge_between(unsigned a, unsigned b) {
  const unsigned bit = a ^ b, low = a & b;
  if (bit == 1) return std::uint8_t(0 + (low >> 1));
  if (bit == 2) return std::uint8_t(4 + ((low & 1) | (low >> 1 & 2)));
  return std::uint8_t(8 + (low & 3));
}

using Loop = std::vector<std::uint8_t>;

// do two edges of the cube lie in one face?
bool share_a_face(std::uint8_t e, std::uint8_t f) {
  const auto side = [](std::uint8_t edge, int dimension) {  // 0, 1; -1: the edge runs along it
    const int axis = edge / 4, k = edge % 4;
    if (dimension == axis) return -1;
    const bool is_low_bit = axis == 0 ? dimension == 1 : dimension == 0;
    return is_low_bit ? k & 1 : k >> 1;
  };
  for (int dimension = 0; dimension < 3; ++dimension)
    if (side(e, dimension) >= 0 && side(e, dimension) == side(f, dimension)) return true;
  return false;
}

// Cuts a loop into triangles, none of whose inner edges lies within a face; false where that cannot be.
bool cut(const Loop& loop, std::vector<std::uint8_t>& triangles) {
  if (loop.size() == 3) {
    triangles.insert(triangles.end(), loop.begin(), loop.end());
    return true;
  }
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const std::uint8_t before = loop[(i + loop.size() - 1) % loop.size()], after = loop[(i + 1) % loop.size()];
    if (share_a_face(before, after)) continue;
    const std::size_t length = triangles.size();
    triangles.insert(triangles.end(), {before, loop[i], after});
    Loop rest = loop;
    rest.erase(rest.begin() + std::ptrdiff_t(i));
    if (cut(rest, triangles)) return true;
    triangles.resize(length);
  }
  return false;
}

std::vector<std::uint8_t> triangles_of(const Loop& loop) {
  std::vector<std::uint8_t> triangles;
  if (cut(loop, triangles)) return triangles;
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) triangles.insert(triangles.end(), {loop[0], loop[i], loop[i + 1]});
  return triangles;
}

}  // namespace

std::vector<std::uint8_t> marching_cubes_cases() {
  std::vector<std::uint8_t> cases(256 * CASE_LENGTH, END);
  for (unsigned inside = 0; inside < 256; ++inside) {
    const auto is_inside = [&](unsigned corner) { return (inside >> corner & 1) != 0; };
    std::array<std::uint8_t, 12> next;
    next.fill(END);
    for (const auto& face : FACES)
      for (unsigned i = 0; i < 4; ++i) {
        if (is_inside(face[i]) || !is_inside(face[(i + 1) % 4])) continue;
        unsigned j = (i + 1) % 4;  // first corner of a run of inside corners; find its last
        while (is_inside(face[(j + 1) % 4])) j = (j + 1) % 4;
        const std::uint8_t entry = edge_between(face[i], face[(i + 1) % 4]);
        // walking so, the surface's outer side is free space
        next[entry] = edge_between(face[j], face[(j + 1) % 4]);
      }
    unsigned length = 0;
    std::array<bool, 12> is_used{};
    for (unsigned start = 0; start < 12; ++start) {
      if (next[start] == END || is_used[start]) continue;
      Loop loop;
      for (unsigned edge = start; !is_used[edge]; edge = next[edge]) {
        loop.push_back(std::uint8_t(edge));
        is_used[edge] = true;
      }
      const std::vector<std::uint8_t> triangles = triangles_of(loop);
      if (length + triangles.size() >= CASE_LENGTH)
        throw Failure("marching cubes: a case has more than five triangles");
      std::copy(triangles.begin(), triangles.end(), cases.begin() + inside * CASE_LENGTH + length);
      length += unsigned(triangles.size());
    }
  }
  return cases;
}

}  // namespace pvg
