#include "host/capture/photo_choice.hpp"

#include <algorithm>
#include <tuple>

namespace pvg {
namespace {

constexpr int CHOICE_ROUNDS = 20;
constexpr float AGREEMENT = 1.5f;  // worth of having all neighbours' photo, beside a share of the best quality
constexpr std::uint32_t NONE = 0xffffffffu;

// [n_triangles] the triangles across its edges, NONE: there is no other, or more than one
std::vector<std::array<std::uint32_t, 3>> neighbours_of(std::span<const Triangle> triangles) {
  struct Side {
    Edge edge;
    std::uint32_t triangle, corner;
  };
  std::vector<Side> sides;
  for (std::uint32_t f = 0; f < triangles.size(); ++f)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[f][k], b = triangles[f][(k + 1) % 3];
      sides.push_back({{std::min(a, b), std::max(a, b)}, f, k});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.edge, a.triangle, a.corner) < std::tie(b.edge, b.triangle, b.corner);
  });
  std::vector<std::array<std::uint32_t, 3>> neighbours(triangles.size(), {NONE, NONE, NONE});
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].edge == sides[i].edge) ++end;
    if (end - i == 2) {
      neighbours[sides[i].triangle][sides[i].corner] = sides[i + 1].triangle;
      neighbours[sides[i + 1].triangle][sides[i + 1].corner] = sides[i].triangle;
    }
    i = end;
  }
  return neighbours;
}

}  // namespace

void add_candidate(Candidates& candidates, const PhotoCandidate& photo) {
  PhotoCandidate moved = photo;
  for (PhotoCandidate& place : candidates)
    if (moved.quality > place.quality) std::swap(moved, place);
}

std::vector<int> choose_photos(std::span<const Triangle> triangles, std::span<const Candidates> candidates) {
  const auto neighbours = neighbours_of(triangles);
  std::vector<int> photos;
  for (const Candidates& of_triangle : candidates) photos.push_back(of_triangle[0].photo);
  for (int round = 0; round < CHOICE_ROUNDS; ++round) {
    bool has_changed = false;
    for (std::size_t f = 0; f < triangles.size(); ++f) {
      float most = 0;
      int best = photos[f];
      for (const PhotoCandidate& candidate : candidates[f]) {
        if (candidate.photo < 0) break;
        float worth = candidate.quality / candidates[f][0].quality;
        for (const std::uint32_t other : neighbours[f])
          if (other != NONE && photos[other] == candidate.photo) worth += AGREEMENT / 3;
        if (worth <= most) continue;
        most = worth;
        best = candidate.photo;
      }
      has_changed |= best != photos[f];
      photos[f] = best;
    }
    if (!has_changed) break;
  }
  return photos;
}

std::vector<std::uint32_t> find_charts(std::span<const Triangle> triangles, std::span<const int> photos) {
  const auto neighbours = neighbours_of(triangles);
  std::vector<std::uint32_t> charts(triangles.size(), NONE), open;
  std::uint32_t n = 0;
  for (std::uint32_t first = 0; first < triangles.size(); ++first) {
    if (charts[first] != NONE) continue;
    charts[first] = n;
    open = {first};
    while (!open.empty()) {
      const std::uint32_t f = open.back();
      open.pop_back();
      for (const std::uint32_t other : neighbours[f])
        if (other != NONE && charts[other] == NONE && photos[other] == photos[first]) {
          charts[other] = n;
          open.push_back(other);
        }
    }
    ++n;
  }
  return charts;
}

}  // namespace pvg
