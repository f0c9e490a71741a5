// The cases of marching cubes, from the rule alone.
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
      is_used[start] = true;
      for (unsigned b = next[start], c = next[b]; c != start; b = c, c = next[c]) {
        if (length + 3 >= CASE_LENGTH) throw Failure("marching cubes: a case has more than five triangles");
        for (const unsigned edge : {start, b, c}) cases[inside * CASE_LENGTH + length++] = std::uint8_t(edge);
        is_used[b] = is_used[c] = true;
      }
    }
  }
  return cases;
}

}  // namespace pvg
