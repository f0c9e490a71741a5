// How far a room is from frames that did not make it.
#include <algorithm>
#include <cmath>

#include "host/capture/room.hpp"
#include "host/formats/picture_files.hpp"
#include "host/pictures/lut.hpp"
#include "host/pictures/picture_metrics.hpp"
#include "host/pictures/srgb.hpp"
#include "host/render/renderer.hpp"

namespace pvg {
namespace {

constexpr std::size_t LUT_FRAMES = 8;  // that the table is fitted to

Scene scene_of(const VisualMesh& mesh, VisualMaterial::Kind kind, std::span<const CaptureFrame> frames, bool is_color) {
  Scene scene;
  VisualMaterial material;
  material.name = "room";
  material.kind = kind;
  material.color = Vec3f::Ones();
  scene.materials.push_back(material);
  scene.visual_meshes.push_back(mesh);
  Visual visual;
  visual.name = "room";
  visual.mesh = visual.material = 0;
  visual.casts_shadow_on_receivers = false;
  scene.visuals.push_back(visual);
  for (const CaptureFrame& frame : frames) scene.cameras.push_back(is_color ? frame.color_camera : frame.depth_camera);
  if (kind == VisualMaterial::Kind::diffuse) scene.environment = Vec3f::Ones();
  return scene;
}

struct View {
  int width = 0, height = 0;
  std::vector<float> rendered, photo;  // linear [height x width x 3]
  std::vector<bool> is_covered;        // [height x width]
};

std::vector<View> render_views(Device& device, std::span<const CaptureFrame> frames, const VisualMesh& mesh,
                               VisualMaterial::Kind kind) {
  const Scene scene = scene_of(mesh, kind, frames, true);
  RenderSettings settings;
  settings.samples = 8;
  settings.max_depth = 3;
  Renderer renderer(device, scene, settings);
  renderer.set_state(initial_state(scene));
  std::vector<View> views;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].color.empty()) continue;
    const RenderedFrame frame = renderer.render(int(i), 0);
    View view{frame.width, frame.height, frame.rgb, {}, {}};
    const Picture8 photo = read_picture(frames[i].color);
    for (const std::uint8_t byte : photo.rgb) view.photo.push_back(srgb_to_linear(float(byte) / 255));
    for (const float z : frame.depth) view.is_covered.push_back(std::isfinite(z));
    views.push_back(std::move(view));
  }
  return views;
}

std::vector<float> coded(const std::vector<float>& linear) {
  std::vector<float> out(linear.size());
  for (std::size_t i = 0; i < linear.size(); ++i) out[i] = linear_to_srgb(std::clamp(linear[i], 0.0f, 1.0f));
  return out;
}

struct Score {
  double psnr = 0, ssim = 0, psnr_covered = 0;
};

// means over the views
Score score(const std::vector<View>& views) {
  Score mean;
  for (const View& view : views) {
    const std::vector<float> a = coded(view.rendered), b = coded(view.photo);
    std::vector<float> a_covered, b_covered;
    for (std::size_t i = 0; i < view.is_covered.size(); ++i)
      for (std::size_t k = 0; view.is_covered[i] && k < 3; ++k) {
        a_covered.push_back(a[3 * i + k]);
        b_covered.push_back(b[3 * i + k]);
      }
    mean.psnr += psnr(a, b) / double(views.size());
    mean.ssim += ssim(a, b, view.width, view.height) / double(views.size());
    mean.psnr_covered += psnr(a_covered, b_covered) / double(views.size());
  }
  return mean;
}

Lut lut_for(const std::vector<View>& views) {
  std::vector<PicturePair> pairs;
  std::vector<std::vector<bool>> uses;
  for (const View& view : views) {
    pairs.push_back({view.width, view.height, view.rendered, view.photo});
    std::vector<bool> use = valid_pixels(pairs.back());
    for (std::size_t i = 0; i < use.size(); ++i) use[i] = use[i] && view.is_covered[i];
    uses.push_back(std::move(use));
  }
  return fit_lut(pairs, uses);
}

// every n-th, so that at most `most` are taken
std::vector<CaptureFrame> some(std::span<const CaptureFrame> frames, std::size_t most) {
  std::vector<CaptureFrame> out;
  const std::size_t every = (frames.size() + most - 1) / most;
  for (std::size_t i = 0; i < frames.size(); i += every) out.push_back(frames[i]);
  return out;
}

}  // namespace

DepthErrors measure_depth(Device& device, const Capture& capture, std::span<const CaptureFrame> frames,
                          const VisualMesh& mesh, double max_depth) {
  const Scene scene = scene_of(mesh, VisualMaterial::Kind::shadow_receiver, frames, false);
  RenderSettings settings;
  settings.samples = 1;
  settings.max_depth = 1;
  Renderer renderer(device, scene, settings);
  renderer.set_state(initial_state(scene));
  DepthErrors out;
  out.n_frames = frames.size();
  std::vector<float> errors;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const DepthPicture measured = depth_of(capture, frames[i]);
    const RenderedFrame frame = renderer.render(int(i), 0);
    for (std::size_t k = 0; k < measured.depth.size(); ++k) {
      if (!(measured.depth[k] > 0 && measured.depth[k] < max_depth)) continue;
      ++out.n_pixels;
      if (std::isfinite(frame.depth[k])) errors.push_back(std::abs(frame.depth[k] - measured.depth[k]));
    }
  }
  if (errors.empty()) return out;
  std::sort(errors.begin(), errors.end());
  const auto at = [&](double share) { return double(errors[std::size_t(share * double(errors.size() - 1))]); };
  for (const float e : errors) out.mean += double(e) / double(errors.size());
  out.covered = double(errors.size()) / double(out.n_pixels);
  out.median = at(0.5);
  out.p90 = at(0.9);
  out.p95 = at(0.95);
  out.max = at(1);
  return out;
}

PhotoErrors measure_photos(Device& device, std::span<const CaptureFrame> held_out, std::span<const CaptureFrame> others,
                           const VisualMesh& mesh) {
  using Kind = VisualMaterial::Kind;
  PhotoErrors out;
  out.n_frames = held_out.size();
  std::vector<View> views = render_views(device, held_out, mesh, Kind::shadow_receiver);
  const Score raw = score(views);
  const Lut lut = lut_for(render_views(device, some(others, LUT_FRAMES), mesh, Kind::shadow_receiver));
  for (View& view : views) apply_lut(lut, view.rendered);
  const Score tabled = score(views);
  out.psnr = raw.psnr;
  out.ssim = raw.ssim;
  out.psnr_covered = raw.psnr_covered;
  out.psnr_lut = tabled.psnr;
  out.ssim_lut = tabled.ssim;
  out.psnr_covered_lut = tabled.psnr_covered;
  std::vector<View> diffuse = render_views(device, held_out, mesh, Kind::diffuse);
  // the sky's radiance that makes the mean brightness that of the photos
  double rendered = 0, photo = 0;
  for (const View& view : diffuse)
    for (std::size_t i = 0; i < view.is_covered.size(); ++i)
      for (std::size_t k = 0; view.is_covered[i] && k < 3; ++k) {
        rendered += double(view.rendered[3 * i + k]);
        photo += double(view.photo[3 * i + k]);
      }
  for (View& view : diffuse)
    for (std::size_t i = 0; i < view.is_covered.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        view.rendered[3 * i + k] = view.is_covered[i] ? float(double(view.rendered[3 * i + k]) * photo / rendered) : 0;
  const Score lit = score(diffuse);
  out.psnr_diffuse = lit.psnr;
  out.ssim_diffuse = lit.ssim;
  return out;
}

}  // namespace pvg
