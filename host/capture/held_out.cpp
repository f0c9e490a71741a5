// How far a room is from frames that did not make it.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "host/capture/room.hpp"
#include "host/capture/surface_views.hpp"
#include "host/pictures/picture_metrics.hpp"
#include "host/pictures/srgb.hpp"

namespace pvg {
namespace {

std::vector<Camera> depth_cameras(std::span<const CaptureFrame> frames) {
  std::vector<Camera> cameras;
  for (const CaptureFrame& frame : frames) cameras.push_back(frame.depth_camera);
  return cameras;
}

std::vector<PhotoView> views_of(PhotoViews& views, std::span<const CaptureFrame> frames) {
  std::vector<PhotoView> out;
  for (std::size_t i = 0; i < frames.size(); ++i) out.push_back(views.at(i, frames[i].color_camera.pose));
  return out;
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
Score score(const std::vector<PhotoView>& views) {
  Score mean;
  for (const PhotoView& view : views) {
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
void apply_own_luts(std::vector<PhotoView>& views) {
  for (PhotoView& view : views)
    if (const std::optional<Lut> lut = own_lut(view)) apply_lut(*lut, view);
}

double share_of(const std::vector<PhotoView>& views, const std::vector<bool> PhotoView::*mask) {
  double n = 0, all = 0;
  for (const PhotoView& view : views) {
    n += double(std::count((view.*mask).begin(), (view.*mask).end(), true));
    all += double((view.*mask).size());
  }
  return n / all;
}

RenderSettings receiver_settings() {
  RenderSettings settings;
  settings.samples = 8;
  settings.max_depth = 3;
  return settings;
}

// filtered, so that its noise does not count against it
RenderSettings diffuse_settings() {
  RenderSettings settings = receiver_settings();
  settings.samples = 16;
  settings.denoises = true;
  return settings;
}

// The sky's radiance becomes the one that makes the mean brightness that of the photos.
void light_evenly(std::vector<PhotoView>& views) {
  double rendered = 0, photo = 0;
  for (const PhotoView& view : views)
    for (std::size_t i = 0; i < view.is_drawn.size(); ++i)
      for (std::size_t k = 0; view.is_drawn[i] && k < 3; ++k) {
        rendered += double(view.rendered[3 * i + k]);
        photo += double(view.photo[3 * i + k]);
      }
  for (PhotoView& view : views)
    for (std::size_t i = 0; i < view.is_drawn.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        view.rendered[3 * i + k] = view.is_drawn[i] ? float(double(view.rendered[3 * i + k]) * photo / rendered) : 0;
}

// Moves the photos' cameras onto the surface and tells how far.
PhotoPlacement place(Device& device, std::span<const CapturedSurface> surfaces, std::vector<CaptureFrame>& frames) {
  const std::vector<Pose> poses = place_photos(device, frames, surfaces);
  PhotoPlacement out;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    Pose& pose = frames[i].color_camera.pose;
    const double shift = (poses[i].translation() - pose.translation()).norm(),
                 turn = Eigen::AngleAxisd(pose.linear().transpose() * poses[i].linear()).angle();
    out.mean_shift += shift / double(frames.size());
    out.mean_turn += turn / double(frames.size());
    out.largest_shift = std::max(out.largest_shift, shift);
    out.largest_turn = std::max(out.largest_turn, turn);
    pose = poses[i];
  }
  return out;
}

}  // namespace

DepthErrors measure_depth(Device& device, const Capture& capture, std::span<const CaptureFrame> frames,
                          const VisualMesh& mesh, double max_depth) {
  SurfaceViews views(device, {&mesh, 1}, depth_cameras(frames));
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
  std::vector<CaptureFrame> frames;
  for (const CaptureFrame& frame : held_out)
    if (!frame.color.empty()) frames.push_back(frame);
  if (frames.empty()) return out;
  PhotoViews receiver(device, frames, surfaces, Kind::shadow_receiver, receiver_settings());
  std::vector<PhotoView> views = views_of(receiver, frames);
  apply_own_luts(views);
  const Score as_given = score(views);
  out.placement = place(device, surfaces, frames);
  out.placement.psnr_lut = as_given.psnr;
  out.placement.ssim_lut = as_given.ssim;

  views = views_of(receiver, frames);
  out.covered = share_of(views, &PhotoView::is_covered);
  out.drawn = share_of(views, &PhotoView::is_drawn);
  const Score raw = score(views);
  apply_own_luts(views);
  const Score tabled = score(views);
  out.psnr = raw.psnr;
  out.ssim = raw.ssim;
  out.psnr_covered = raw.psnr_covered;
  out.psnr_lut = tabled.psnr;
  out.ssim_lut = tabled.ssim;
  out.psnr_covered_lut = tabled.psnr_covered;
  for (std::size_t i = 0; i < frames.size(); ++i)
    out.each.push_back(
        {frames[i].color.filename().string(), frames[i].color_camera, tabled.psnr_each[i], tabled.ssim_each[i]});

  PhotoViews lit_by_sky(device, frames, surfaces, Kind::diffuse, diffuse_settings());
  std::vector<PhotoView> diffuse = views_of(lit_by_sky, frames);
  light_evenly(diffuse);
  const Score lit = score(diffuse);
  apply_own_luts(diffuse);
  const Score lit_and_tabled = score(diffuse);
  out.psnr_diffuse = lit.psnr;
  out.ssim_diffuse = lit.ssim;
  out.psnr_diffuse_lut = lit_and_tabled.psnr;
  out.ssim_diffuse_lut = lit_and_tabled.ssim;
  return out;
}

}  // namespace pvg
