// A measured channel, found in its scene, and what its kind of sensor does. Each kind is one file of this folder, which
// defines its row of functions; the list of kinds is in host/load/recording/channel_kinds.hpp, their keys in
// host/load/recording/channels.cpp.
#pragma once
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/identify/channels/sensing.hpp"
#include "host/load/recording/recording.hpp"

namespace pvg {
struct WorldState;
}

namespace pvg::diagnose {

struct SensorKind;
const SensorKind& sensor_of(ChannelKind kind);

struct Channel {
  const SensorKind* sensor = &sensor_of({});
  std::string name;                                     // "position of joint hinge", for people
  std::string subject;                                  // the body that moves
  std::string unit;                                     // SI
  int joint = -1, rigid = -1, soft = -1, cloth = -1;    // which of them
  Vec3 point = Vec3::Zero();                            // on a rigid body, in its frame [m]
  std::vector<std::pair<std::uint32_t, double>> nodes;  // of a soft body or cloth, with weights
  bool is_joint_load = false;                           // of a torque: what the joint transmits, not its drive's effort
  bool has_axis = false;
  Vec3 axis = Vec3::Zero();         // the part along it is measured
  int other = -1;                   // of a distance or contact: the other body, a rigid one; -1: any
  Vec3 other_point = Vec3::Zero();  // on it, in its frame [m]
  double constant = 1;              // of a current [N m/A or N/A]; of a contact: the force at which it is felt [N]
  int width = 1;                    // numbers in the recording and of a prediction: 1, 3, or 4 for x, y, z, w
  int trace_width = 1;              // numbers that are kept of each step, from which predictions are made
  int n = 1;                        // numbers that are compared: 1 or 3
  double sigma = 0;                 // one standard deviation of the noise [unit]; measured by stage 1 if unknown
  double jitter = 0;                // of the time stamps, one standard deviation [s]
  bool is_noise_known = false;
  bool is_noise_of_repeats = false;  // measured as what runs of the same commands do not share
  bool is_noise_assumed = false;     // unknown, and there are too few neighbouring samples to measure it
  // The noise may be as small as this [unit]; 0: it is as small as `sigma`. A spectrum that is not flat is one of a
  // sensor that smooths, or of what trembles, which is no noise.
  double least_sigma = 0;
  Readout readout;             // in `unit`
  int source = -1, part = -1;  // of pictures, as in RecordedChannel
};

// One standard deviation of what a sensor with a stated resolution rounds off.
inline double rounding_noise(const Readout& readout) { return readout.resolution / std::sqrt(12.0); }

// A channel as it was resolved, and the factor from the recorded unit to SI.
struct Resolved {
  Channel channel;
  double to_si = 1;
};

// Where a channel is looked up.
struct ChannelPlace {
  const Recording& recording;
  const PhysicalScene& scene;
  const Scene& seen;  // the same with all that a picture needs
  std::string entry;  // of the channel in the file, for messages
};

// What the cameras see in the present step, each picture taken once; NaN where no picture was taken near it.
class Pictures {
 public:
  virtual double mask_moment(std::size_t source, std::size_t moment) = 0;
  virtual double luminance(std::size_t source, std::size_t cell) = 0;

 protected:
  ~Pictures() = default;
};

// What a sensor looks at in one step.
struct Look {
  const PhysicalScene& world;
  const WorldState& state;
  const Sensing& sensing;
  std::size_t number;  // of the channel
  Pictures& pictures;
};

// What is kept of a channel's steps, one after the other from the window's start.
struct Steps {
  std::span<const double> values;  // [n x trace_width of the channel]
  std::size_t width = 1;
  double h = 0;  // length of a step [s]
  std::size_t n() const { return values.size() / width; }
};

// How the noise of this kind differs from white noise on a smooth motion.
struct NoiseModel {
  double per_number = 1;                           // noise of a compared number over that of a recorded one
  double (*rounding)(double brightest) = nullptr;  // sigma of what the format rounds off [unit]
};

// What a channel says about the start of its joint or body.
enum class StartRole { nothing, place, rate, turn };

// The row of a kind. A function that is left out does not compile.
struct SensorKind {
  ChannelKind kind;
  // Finds what was measured in the scene. Throws a UsageError that names the entry and what to do.
  Resolved (&resolve)(const ChannelPlace&, const RecordedChannel&);
  // What is kept of a simulated state [trace_width]: mostly what the sensor would say.
  std::vector<double> (&predict)(const Channel&, const Look&);
  // The prediction [width] at a time between the steps, at least four of them; times before the start too.
  std::vector<double> (&interpolate)(const Channel&, const Steps&, double time);
  // Measured less predicted, of the n numbers that are compared; divided by the noise this is the residual.
  Vec3 (&difference)(const double* measured, const double* predicted, int n);
  // what most kinds are not is left out of their rows
  NoiseModel noise = {};
  StartRole start = StartRole::nothing;
  bool is_of_pictures = false;         // a step costs more to look at than to simulate
  bool is_length = false;              // of a body: scales with the unit of length
  bool has_mounting_place = false;     // sits on its body at a place that may be wrong
  bool takes_bias = false;             // a constant may be added to it
  bool is_known_after_a_step = false;  // as forces are: at the start it is taken for what it is after the first step
  bool is_shown_as_deviation = false;  // its numbers say nothing to a reader, their differences do
};

#define PVG_DECLARE(name) extern const SensorKind name##_sensor;
PVG_CHANNEL_KINDS(PVG_DECLARE)
#undef PVG_DECLARE

}  // namespace pvg::diagnose
