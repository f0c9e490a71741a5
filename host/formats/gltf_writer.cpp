#include "host/formats/gltf_writer.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/atomic_files.hpp"
#include "host/base/error.hpp"
#include "host/formats/picture_files.hpp"

namespace pvg {

namespace fs = std::filesystem;

GltfWriter::GltfWriter(const std::string& scene_name) {
  model.asset.version = "2.0";
  model.buffers.emplace_back();
  tinygltf::Node root;
  root.name = scene_name;
  root.rotation = {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)};  // z up to y up
  model.nodes.push_back(root);
  model.scenes.emplace_back();
  model.scenes[0].nodes = {0};
  model.defaultScene = 0;
}

int GltfWriter::add_bytes(const void* bytes, std::size_t n, int target) {
  std::vector<unsigned char>& data = model.buffers[0].data;
  data.resize((data.size() + 3) / 4 * 4);  // accessors stand at multiples of their component's size
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = data.size();
  view.byteLength = n;
  view.target = target;
  data.resize(data.size() + n);
  if (n) std::memcpy(data.data() + view.byteOffset, bytes, n);
  model.bufferViews.push_back(view);
  return int(model.bufferViews.size()) - 1;
}

int GltfWriter::add_scalars(const Floats& values) {
  const int accessor = add(values, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_SCALAR, 1);
  if (values.empty()) return accessor;
  model.accessors[accessor].minValues = {*std::min_element(values.begin(), values.end())};
  model.accessors[accessor].maxValues = {*std::max_element(values.begin(), values.end())};
  return accessor;
}

int GltfWriter::add_vectors(const Floats& values, int target) {
  const int accessor = add(values, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, 3, target);
  std::vector<double> low(3, INFINITY), high(3, -INFINITY);
  for (std::size_t i = 0; i < values.size(); ++i) {
    low[i % 3] = std::min(low[i % 3], double(values[i]));
    high[i % 3] = std::max(high[i % 3], double(values[i]));
  }
  model.accessors[accessor].minValues = low;
  model.accessors[accessor].maxValues = high;
  return accessor;
}

int GltfWriter::add_triangles(const std::vector<Triangle>& triangles) {
  std::vector<std::uint32_t> indices;
  for (const Triangle& t : triangles) indices.insert(indices.end(), t.begin(), t.end());
  return add(indices, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR, 1,
             TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
}

int GltfWriter::add_texture(const Texture& texture) {
  const std::vector<std::uint8_t> png = encode_png(texture);
  tinygltf::Image image;
  image.mimeType = "image/png";
  image.bufferView = add_bytes(png.data(), png.size());
  model.images.push_back(image);
  tinygltf::Texture entry;
  entry.source = int(model.images.size()) - 1;
  model.textures.push_back(entry);
  return int(model.textures.size()) - 1;
}

int GltfWriter::add_node(const tinygltf::Node& node) {
  model.nodes.push_back(node);
  model.nodes[0].children.push_back(int(model.nodes.size()) - 1);
  return int(model.nodes.size()) - 1;
}

void GltfWriter::write(const fs::path& file) {
  PartialFile partial(fs::absolute(file));
  tinygltf::TinyGLTF writer;
  std::error_code ignored;
  // the writer says that all is well where there is no folder or no room, so the file itself is asked
  const std::size_t n_bytes = model.buffers[0].data.size();
  const bool said_yes = writer.WriteGltfSceneToFile(&model, partial.path().string(), false, true, false, true);
  const bool is_whole =
      said_yes && fs::exists(partial.path(), ignored) && fs::file_size(partial.path(), ignored) > n_bytes;
  if (!is_whole) throw Failure(file.string() + " cannot be written; see that its folder exists and has room");
  partial.finish();
}

}  // namespace pvg
