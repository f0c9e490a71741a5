#include "host/load/camera_file.hpp"

#include "host/load/fields/yaml_section.hpp"

namespace pvg {

Camera read_camera_file(const std::filesystem::path& file) {
  YamlSection section = YamlSection::load(file, "camera file");
  section.integer("schema", 1, 1);
  Camera camera;
  camera.model = Camera::Model(section.choice("model", {"pinhole", "fisheye"}));
  camera.width = section.integer("width", 16, 16384);
  camera.height = section.integer("height", 16, 16384);
  const std::vector<double> k = section.numbers("intrinsics", Unit::none, -1e7, 1e7);
  if (k.size() != 4 || !(k[0] > 1e-3 && k[1] > 1e-3)) section.fail("intrinsics", "must be [fx, fy, cx, cy] in pixels");
  camera.fx = k[0];
  camera.fy = k[1];
  camera.cx = k[2];
  camera.cy = k[3];
  camera.distortion = section.numbers("distortion", Unit::none, -1e4, 1e4);
  for (const char* key : {"sigma", "residual_px", "board", "photos"}) section.skip(key);
  section.done();
  return camera;
}

}  // namespace pvg
