// Which photo each triangle of a surface takes its picture from: one that saw it sharply, and the same as its
// neighbours where that costs little. Pure.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "host/geometry/mesh.hpp"

namespace pvg {

// A photo that sees a triangle, and how well: quality > 0, in any unit that is the same for all photos.
struct PhotoCandidate {
  int photo = -1;  // -1: none
  float quality = 0;
};
constexpr std::size_t CANDIDATES = 4;                       // the best ones are kept
using Candidates = std::array<PhotoCandidate, CANDIDATES>;  // by falling quality

// Puts a photo in its place among the candidates, or leaves it out.
void add_candidate(Candidates& candidates, const PhotoCandidate& photo);

// [n_triangles] the photo of each, -1: none sees it. Iterated conditional modes: a triangle takes the candidate with
// the largest quality (as a share of its best one) plus the share of its neighbours that have it, in turns, until none
// changes.
std::vector<int> choose_photos(std::span<const Triangle> triangles, std::span<const Candidates> candidates);

// Connected triangles of one photo. [n_triangles] number of the chart of each, counted from 0.
std::vector<std::uint32_t> find_charts(std::span<const Triangle> triangles, std::span<const int> photos);

}  // namespace pvg
