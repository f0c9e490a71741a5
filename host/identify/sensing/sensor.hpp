// What the sensors of one window see of its simulation: the channels' values step by step, and from them the residuals
// at the times of the samples.
#pragma once
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host/identify/sensing/mask_sight.hpp"
#include "host/identify/sensing/rollout.hpp"
#include "host/identify/sensing/video_sight.hpp"
#include "host/physics/step/simulation.hpp"
#include "host/pictures/mask_metrics.hpp"

namespace pvg::diagnose {

// When a sample of a channel was taken, in the simulation of a window [s].
double time_of_sample(const Problem& problem, const Sensing& sensing, const Window& window, std::size_t channel,
                      std::size_t sample);

class SensorTrace : private Pictures {
 public:
  // sight, video: where masks and videos were measured, else null
  SensorTrace(const Problem& problem, const Job& job, MaskSight* sight, VideoSight* video);
  void add(const PhysicalScene& world, const WorldState& state);  // at the next step's end, the start first
  Eigen::VectorXd residual() const;
  std::vector<Phase> phases() const;
  // Intersection over union with the measured masks, mean over those of the window; NaN: there are none.
  double mask_overlap() const { return n_overlaps_ > 0 ? overlap_sum_ / double(n_overlaps_) : std::nan(""); }
  std::vector<std::string> touching() const { return {touching_.begin(), touching_.end()}; }

 private:
  double mask_moment(std::size_t source, std::size_t moment) override;
  double luminance(std::size_t source, std::size_t cell) override;
  std::array<double, N_MASK_MOMENTS> moments_of(std::size_t source);
  PictureCells cells_of(std::size_t source);
  int picture_near(const std::vector<int>& frame_of_row, double time) const;  // within a step; -1: none
  CameraError error_of(int camera) const;
  // trace: of the channel, as filtered() has it  [width], empty: not simulated to there
  std::vector<double> value_at(std::size_t channel, const std::vector<double>& trace, double time) const;
  std::vector<std::vector<double>> filtered() const;              // values_ behind the sensors' own filters
  double time_of(std::size_t channel, std::size_t sample) const;  // as time_of_sample has it
  Phase phase_of(const PhysicalScene& world, const WorldState& state, const Channel& channel) const;

  const Problem* problem_;
  const Job* job_;
  MaskSight* sight_;
  VideoSight* video_;
  double h_;
  std::size_t n_steps_ = 0;
  const WorldState* state_ = nullptr;                                       // of the present step
  std::vector<std::optional<std::array<double, N_MASK_MOMENTS>>> moments_;  // [n_mask_sources] seen in the present step
  std::vector<std::optional<PictureCells>> cells_;                          // [n_video_sources] likewise
  double overlap_sum_ = 0;
  std::size_t n_overlaps_ = 0;
  std::vector<std::vector<double>> values_;  // [n_channels][n_steps x width]
  std::vector<std::vector<Phase>> phase_;    // [n_channels][n_steps]
  std::set<std::string> touching_;
  std::vector<AffineMap> before_;  // rigid bodies one step before
};

}  // namespace pvg::diagnose
