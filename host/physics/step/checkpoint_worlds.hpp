// A checkpoint of many worlds and those of each by itself, in which nodes and sites count from the world's first one:
// what a simulation of that world alone would give and take.
#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "host/model/checkpoint.hpp"
#include "host/physics/energies/system.hpp"

namespace pvg {

// [n_worlds]
std::vector<Checkpoint> split(const Checkpoint& whole, const System& system);

// Puts those that there are in the places of their worlds. False where one is of another scene than its world.
bool put(Checkpoint& whole, std::span<const std::optional<Checkpoint>> worlds, const System& system);

}  // namespace pvg
