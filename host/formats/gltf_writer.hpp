// A glTF model with one buffer, filled from front to back, and the file it goes to. Internal to the writers.
#pragma once
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "host/formats/tinygltf.hpp"
#include "host/geometry/mesh.hpp"
#include "host/pictures/picture.hpp"

namespace pvg {

struct GltfWriter {
  using Floats = std::vector<float>;
  tinygltf::Model model;

  // A scene with one root node of this name, which turns z up to glTF's y up.
  explicit GltfWriter(const std::string& scene_name);

  // index of the new accessor; target: TINYGLTF_TARGET_..., 0: none
  template <class T>
  int add(const std::vector<T>& values, int component, int type, std::size_t per_element, int target = 0) {
    tinygltf::Accessor accessor;
    accessor.bufferView = add_bytes(values.data(), values.size() * sizeof(T), target);
    accessor.componentType = component;
    accessor.type = type;
    accessor.count = values.size() / per_element;
    model.accessors.push_back(accessor);
    return int(model.accessors.size()) - 1;
  }
  int add_scalars(const Floats& values);
  int add_vectors(const Floats& values, int target = 0);  // with the bounds that the format asks for
  int add_triangles(const std::vector<Triangle>& triangles);
  int add_texture(const Texture& texture);                          // as PNG inside the file
  int add_bytes(const void* bytes, std::size_t n, int target = 0);  // index of the new buffer view
  int add_node(const tinygltf::Node& node);                         // under the root

  // The whole file or none; a Failure names it where it cannot be written.
  void write(const std::filesystem::path& file);
};

}  // namespace pvg
