// camera.yaml: what `calibrate camera` found of a camera. A task's camera takes it by `calibration: camera.yaml`.
#pragma once
#include <filesystem>

#include "host/model/appearance.hpp"

namespace pvg {

// Model, size, intrinsics and distortion; the rest as by default. UsageErrors name file and key.
Camera read_camera_file(const std::filesystem::path& file);

}  // namespace pvg
