// Hashes of text and bytes, the same on every machine. Not against attackers.
#pragma once
#include <cstdint>
#include <string_view>

namespace pvg {

inline constexpr std::uint64_t FNV_START = 0xcbf29ce484222325;

// FNV-1a (Fowler, Noll & Vo). so_far: the hash of the bytes before these
constexpr std::uint64_t fnv1a(std::string_view bytes, std::uint64_t so_far = FNV_START) {
  for (const char byte : bytes) so_far = (so_far ^ static_cast<unsigned char>(byte)) * 0x100000001b3;
  return so_far;
}

// SplitMix64's finaliser (Steele, Lea & Flood 2014): neighbouring numbers become unlike ones
constexpr std::uint64_t mixed_bits(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  return z ^ (z >> 31);
}

}  // namespace pvg
