// How far a room is from frames that did not make it.
#include <algorithm>
#include <cmath>

#include "host/capture/room.hpp"
#include "host/capture/surface_views.hpp"
#include "host/formats/picture_files.hpp"
#include "host/pictures/lut.hpp"
#include "host/pictures/picture_metrics.hpp"
#include "host/pictures/srgb.hpp"
#include "host/render/renderer.hpp"

namespace pvg {
namespace {

constexpr std::size_t FEWEST_PIXELS = 1000;  // that a photo's table is fitted to

struct View {
  int width = 0, height = 0;
  std::vector<float> rendered, photo;  // linear [height x width x 3]
  std::vector<bool> is_covered;        // by the measured surface  [height x width]
  std::vector<bool> is_drawn;          // or by the guessed one  [height x width]
};

std::vector<Camera> cameras_of(std::span<const CaptureFrame> frames, Camera CaptureFrame::*which) {
  std::vector<Camera> cameras;
  for (const CaptureFrame& frame : frames) cameras.push_back(frame.*which);
  return cameras;
}

// surfaces: the measured one, and the guessed one behind it
std::vector<View> render_views(Device& device, std::span<const CaptureFrame> frames,
                               std::span<const CapturedSurface> surfaces, VisualMaterial::Kind kind) {
  const Scene scene = scene_of(surfaces, kind, cameras_of(frames, &CaptureFrame::color_camera));
  RenderSettings settings;
  settings.samples = 8;
  settings.max_depth = 3;
  Renderer renderer(device, scene, settings);
  renderer.set_state(initial_state(scene));
  std::vector<View> views;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].color.empty()) continue;
    const RenderedFrame frame = renderer.render(int(i), 0);
    View view{frame.width, frame.height, frame.rgb, {}, {}, {}};
    const Picture8 photo = read_picture(frames[i].color);
    for (const std::uint8_t byte : photo.rgb) view.photo.push_back(srgb_to_linear(float(byte) / 255));
    for (const std::uint32_t instance : frame.instance) {
      view.is_covered.push_back(instance == 1);
      view.is_drawn.push_back(instance != 0);
    }
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
  std::vector<double> psnr_each, ssim_each;
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
    mean.psnr_each.push_back(psnr(a, b));
    mean.ssim_each.push_back(ssim(a, b, view.width, view.height));
    mean.psnr += mean.psnr_each.back() / double(views.size());
    mean.ssim += mean.ssim_each.back() / double(views.size());
    mean.psnr_covered += psnr(a_covered, b_covered) / double(views.size());
  }
  return mean;
}

// Exposure and white balance of a left-out photo are its camera's own and can only be told from the photo itself.
void apply_own_lut(View& view) {
  const PicturePair pair{view.width, view.height, view.rendered, view.photo};
  std::vector<bool> use = valid_pixels(pair);
  for (std::size_t i = 0; i < use.size(); ++i) use[i] = use[i] && view.is_drawn[i];
  if (std::size_t(std::count(use.begin(), use.end(), true)) < FEWEST_PIXELS) return;
  apply_lut(fit_lut({&pair, 1}, {&use, 1}), view.rendered);
  for (std::size_t i = 0; i < view.is_drawn.size(); ++i)
    for (std::size_t k = 0; !view.is_drawn[i] && k < 3; ++k) view.rendered[3 * i + k] = 0;
}

double share_of(const std::vector<View>& views, const std::vector<bool> View::*mask) {
  double n = 0, all = 0;
  for (const View& view : views) {
    n += double(std::count((view.*mask).begin(), (view.*mask).end(), true));
    all += double((view.*mask).size());
  }
  return n / all;
}

}  // namespace

DepthErrors measure_depth(Device& device, const Capture& capture, std::span<const CaptureFrame> frames,
                          const VisualMesh& mesh, double max_depth) {
  SurfaceViews views(device, {&mesh, 1}, cameras_of(frames, &CaptureFrame::depth_camera));
  DepthErrors out;
  out.n_frames = frames.size();
  std::vector<float> errors;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const DepthPicture measured = depth_of(capture, frames[i]);
    const DepthPicture seen = views.depth(i);
    for (std::size_t k = 0; k < measured.depth.size(); ++k) {
      if (!(measured.depth[k] > 0 && measured.depth[k] < max_depth)) continue;
      ++out.n_pixels;
      if (seen.depth[k] > 0) errors.push_back(std::abs(seen.depth[k] - measured.depth[k]));
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

PhotoErrors measure_photos(Device& device, std::span<const CaptureFrame> held_out,
                           std::span<const CapturedSurface> surfaces) {
  using Kind = VisualMaterial::Kind;
  PhotoErrors out;
  out.n_frames = held_out.size();
  std::vector<View> views = render_views(device, held_out, surfaces, Kind::shadow_receiver);
  out.covered = share_of(views, &View::is_covered);
  out.drawn = share_of(views, &View::is_drawn);
  const Score raw = score(views);
  for (View& view : views) apply_own_lut(view);
  const Score tabled = score(views);
  out.psnr = raw.psnr;
  out.ssim = raw.ssim;
  out.psnr_covered = raw.psnr_covered;
  out.psnr_lut = tabled.psnr;
  out.ssim_lut = tabled.ssim;
  out.psnr_covered_lut = tabled.psnr_covered;
  for (const CaptureFrame& frame : held_out)
    if (!frame.color.empty())
      out.each.push_back({frame.color.filename().string(), frame.color_camera, tabled.psnr_each[out.each.size()],
                          tabled.ssim_each[out.each.size()]});
  std::vector<View> diffuse = render_views(device, held_out, surfaces, Kind::diffuse);
  // the sky's radiance that makes the mean brightness that of the photos
  double rendered = 0, photo = 0;
  for (const View& view : diffuse)
    for (std::size_t i = 0; i < view.is_drawn.size(); ++i)
      for (std::size_t k = 0; view.is_drawn[i] && k < 3; ++k) {
        rendered += double(view.rendered[3 * i + k]);
        photo += double(view.photo[3 * i + k]);
      }
  for (View& view : diffuse)
    for (std::size_t i = 0; i < view.is_drawn.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        view.rendered[3 * i + k] = view.is_drawn[i] ? float(double(view.rendered[3 * i + k]) * photo / rendered) : 0;
  const Score lit = score(diffuse);
  out.psnr_diffuse = lit.psnr;
  out.ssim_diffuse = lit.ssim;
  for (View& view : diffuse) apply_own_lut(view);
  const Score lit_and_tabled = score(diffuse);
  out.psnr_diffuse_lut = lit_and_tabled.psnr;
  out.ssim_diffuse_lut = lit_and_tabled.ssim;
  return out;
}

}  // namespace pvg
