// What a page of `view` shows, as JSON for its script (data/view/report.js).
#pragma once
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

namespace pvg {

// The bytes in base 64 (RFC 4648).
std::string base64(std::span<const std::uint8_t> bytes);

// An episode's folder: summary, drawn numbers, curves over time and, if `whole`, the videos and the motion in 3D.
//   curves: [{title, unit, lines: [{name, values [T]}]}], times [T]
//   motion: {times [K], bodies: [{name, points, triangles, poses | low, high, frames}]}, arrays in base 64:
//     points f32 [V x 3], triangles u32 [n x 3]; of rigid bodies poses f32 [K x 12], row by row; of soft ones and
//     cloths frames u16 [K x V x 3], from low to high
nlohmann::ordered_json episode_report(const std::filesystem::path& folder, bool whole);

}  // namespace pvg
