// A display in a picture: figures follow the state, and light comes from lit segments alone.
#include "host/model/display.hpp"

#include <gtest/gtest.h>

#include "tests/render/test_scene.hpp"

namespace pvg::test {
namespace {

using DisplayPictures = ManyPaths;

// seen face on, filling the picture
Scene face_on() {
  Scene scene;
  Display display;
  display.width = 0.4;
  display.height = 0.2;
  display.digits = 2;
  display.resolution = 1e-3;
  display.radiance = Vec3f(2, 3, 4);
  display.texture = 0;
  scene.displays = {display};
  scene.textures = {face_picture(display, "0")};
  VisualMaterial shining = material(VisualMaterial::Kind::metallic_roughness, Vec3f::Zero());
  shining.emission = display.radiance;
  shining.emission_texture = 0;
  VisualMesh face = quad({-0.2f, -0.1f, 0}, {0.4f, 0, 0}, {0, 0.2f, 0});
  for (Vec2f& uv : face.uvs) uv.y() = 1 - uv.y();
  add(scene, face, shining);
  look_at(scene, {0, 0, 1}, {0, 0, 0}, 80, 40, 200);
  return scene;
}

RenderedFrame showing(Renderer& renderer, const Scene& scene, double reading) {
  SceneState state = initial_state(scene);
  state.reading = {reading};
  renderer.set_state(state);
  return renderer.render(0, 0);
}

// mean of green over columns [x0, x1) of the picture
double green(const RenderedFrame& frame, int x0, int x1) {
  double sum = 0;
  for (int y = 0; y < frame.height; ++y)
    for (int x = x0; x < x1; ++x) sum += double(frame.rgb[std::size_t(3 * (y * frame.width + x) + 1)]);
  return sum / frame.height / (x1 - x0);
}

// share of a texture's columns that is lit
double lit(const Texture& picture, int x0, int x1) {
  double sum = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = x0; x < x1; ++x) sum += picture.rgba[std::size_t(4 * (y * picture.width + x))] / 255.0;
  return sum / picture.height / (x1 - x0);
}

TEST_F(DisplayPictures, FiguresFollowTheReading) {
  Device device;
  const Scene scene = face_on();
  RenderSettings settings;
  settings.samples = 16;
  Renderer renderer(device, scene, settings);
  for (const double reading : {0.048, 0.001, 0.0, 0.088}) {
    const RenderedFrame frame = showing(renderer, scene, reading);
    const Texture wanted = face_picture(scene.displays[0], shown_figures(scene.displays[0], reading));
    for (const int half : {0, 1}) {
      const double share = lit(wanted, half * wanted.width / 2, (half + 1) * wanted.width / 2);
      EXPECT_NEAR(green(frame, 40 * half, 40 * (half + 1)), 3 * share, 0.03) << reading << " " << half;
    }
  }
}

TEST_F(DisplayPictures, AStateWithoutItsReadingsIsRefused) {
  Device device;
  const Scene scene = face_on();
  Renderer renderer(device, scene, {});
  SceneState state = initial_state(scene);
  state.reading.clear();
  EXPECT_THROW(renderer.set_state(state), UsageError);
}

}  // namespace
}  // namespace pvg::test
