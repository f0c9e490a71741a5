// The cameras and punctual lights of a glTF file. Internal to the readers of glTF.
#pragma once
#include "host/formats/tinygltf.hpp"
#include "host/model/scene.hpp"

namespace pvg {

// A perspective camera, 360 pixels high; to_world: of its node, z up. `name`: what it shall be called.
Camera read_gltf_camera(const tinygltf::Camera& from, const Eigen::Affine3d& to_world, const std::string& name,
                        const std::string& file);

// KHR_lights_punctual as balls, so small that they act as points, or far away with the sun's disc, whose light is even
// within 1 %: candela count as W/sr, lux as W/m^2. `size` of what is lit, about `center` [m].
SphereLight read_gltf_light(const tinygltf::Light& from, const Eigen::Affine3d& to_world, const Vec3& center,
                            double size, const std::string& name, const std::string& file);

}  // namespace pvg
