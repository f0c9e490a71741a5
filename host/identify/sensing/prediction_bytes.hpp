// Predictions as bytes, for files and pipes of this program on this machine.
#pragma once
#include <cstddef>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

#include "host/identify/sensing/rollout.hpp"

namespace pvg::diagnose {

// Appends the bytes of one value.
template <class T>
void put(std::vector<char>& bytes, const T& value) {
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof value);
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

std::vector<char> packed(std::span<const Prediction> predictions);

// What is at the beginning of `bytes`, and how many of them it is; nothing where they are cut short.
struct Unpacked {
  std::vector<Prediction> predictions;
  std::size_t n_bytes = 0;
};
std::optional<Unpacked> unpacked(std::span<const char> bytes);

}  // namespace pvg::diagnose
