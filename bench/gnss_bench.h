// What the satellite receiver's models cost and how far each is from the better one, side by side.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/rig/rig_configuration.h"

namespace rigwire::bench {

/// The paper's regression over the count against the exact geometry, over a day of nominal GPS at
/// the rig's origin with part of the sky closed.
struct DilutionCost {
  std::string sky{};           ///< "mask 10 deg", "street, 45 deg walls".
  std::size_t epochs = 0;      ///< With four satellites or more.
  double satellites = 0.0;     ///< Mean.
  double regression_ns = 0.0;  ///< CPU time of one, minimum of several runs.
  double geometric_ns = 0.0;
  /// Regression / geometry: exp of the mean and of the standard deviation of the logarithm.
  double horizontal_ratio = 0.0;
  double horizontal_scatter = 0.0;
  double vertical_ratio = 0.0;
  double vertical_scatter = 0.0;
  double position_ratio = 0.0;
  double position_scatter = 0.0;
};
[[nodiscard]] std::vector<DilutionCost> measure_dilution(double latitude_deg, double longitude_deg);

/// Degrees from metres by the radii of curvature at the origin alone, as small simulators do it,
/// against the world frame's own, exact conversion.
struct TangentCost {
  double distance_m = 0.0;  ///< From the origin.
  double plane_ns = 0.0;    ///< CPU time of one point, minimum of several runs.
  double frame_ns = 0.0;
  double plane_error_m = 0.0;         ///< Worst over all directions, horizontal.
  double plane_height_error_m = 0.0;  ///< Worst: the earth falls away below the plane.
  double frame_error_m = 0.0;         ///< There and back again.
};
[[nodiscard]] std::vector<TangentCost> measure_tangent(double latitude_deg,
                                                       const std::vector<double>& distances_m);

/// Rays per satellite near the edges of a scene: cost of an epoch and the share of satellites whose
/// state differs from that of the densest sampling, over places along the rig's first track.
struct SkySampling {
  int samples = 0;            ///< Directions per satellite.
  double epoch_us = 0.0;      ///< CPU time of one navigation epoch, median.
  std::size_t views = 0;      ///< Satellites above the mask, all epochs.
  double differing = 0.0;     ///< Share of them that is tracked here and not there, or reverse.
  double cn0_error_db = 0.0;  ///< Root mean square, where both track.
};
[[nodiscard]] std::vector<SkySampling> measure_sky_sampling(const hil::RigConfiguration& rig,
                                                            const std::vector<int>& samples);

/// One model of a receiver beside the others, at a place. RTK: all systems on both bands, with the
/// measurements of a reference station 500 m away, a second late.
struct ModelError {
  /// "open", "street", "wood": at rest; "canyon": a street that mirrors signals, stop and go at
  /// 7 m/s; "campus": a lap at 2 m/s.
  std::string place{};
  std::string model{};          ///< "paper", "coloured", "engine", "RTK float", "RTK fixed".
  double epoch_us = 0.0;        ///< CPU time of one navigation epoch of the sensor, mean.
  double fixes = 0.0;           ///< Share of the epochs; for RTK, of epochs with that solution.
  double error_median_m = 0.0;  ///< Horizontal error, median ...
  double error_95_m = 0.0;      ///< ... and 95 %.
  /// Ratio of each epoch's error to its reported HDOP.
  double over_dilution_50_m = 0.0;
  double over_dilution_68_m = 0.0;
  double over_dilution_95_m = 0.0;
  double step_median_m = 0.0;     ///< Horizontal change of the error from second to second.
  double step_correlation = 0.0;  ///< Autocorrelation of its east part at lag 1.
  /// Error squared over accuracy squared, mean.
  double error_over_accuracy = 0.0;
  double dilution_ratio = 0.0;  ///< Reported HDOP over that of the satellites used, median.
};
/// Whether a row is measured.
using ModelRow = std::function<bool(std::string_view place, std::string_view model)>;
inline bool every_row(std::string_view /*place*/, std::string_view /*model*/) {
  return true;
}
[[nodiscard]] std::vector<ModelError> measure_models(const hil::RigConfiguration& rig,
                                                     int receivers, int seconds,
                                                     const ModelRow& wanted = every_row);

/// A type of receiver as its configuration has it, and what it says of its own error, at 1 Hz over
/// several days.
struct ReceiverAccuracy {
  /// "open", "wood": at rest, under crowns of 6 m over everything above 15 degrees; "deep canyon":
  /// a street of 21 m between walls of 35 to 55 m, stop and go at 7 m/s; "campus", "forest": a lap
  /// of the rig at 2 m/s.
  std::string place{};
  std::string receiver{};
  int days = 0;
  double fixes = 0.0;                     ///< Share of the epochs with a 2D or 3D fix.
  double error_50_m = 0.0;                ///< Horizontal error: median ...
  double error_95_m = 0.0;                ///< ... 95 % ...
  double error_most_m = 0.0;              ///< ... and the largest.
  double up_deviation_m = 0.0;            ///< Standard deviation of 3D fixes.
  double horizontal_accuracy_m = 0.0;     ///< Accuracy reported by the receiver, median.
  double vertical_over_horizontal = 0.0;  ///< Ratio of its reported accuracies, median.
  double inside_horizontal = 0.0;         ///< Share of epochs whose error is within its accuracy.
  double inside_vertical = 0.0;  ///< Share of 3D fixes whose vertical error is within its accuracy.
  /// Autocorrelation of the horizontal error in motion, after 1, 5 and 10 s.
  double correlation_1s = 0.0;
  double correlation_5s = 0.0;
  double correlation_10s = 0.0;
  double satellites = 0.0;  ///< Satellites used, mean.
  double rtk_fixed = 0.0;   ///< Share of the epochs.
};
/// `campus`, `forest`: rigs whose machines are carried along their tracks.
[[nodiscard]] std::vector<ReceiverAccuracy> measure_accuracies(const hil::RigConfiguration& campus,
                                                               const hil::RigConfiguration& forest,
                                                               int days,
                                                               const ModelRow& wanted = every_row);

/// Many receivers on one core: sensors in the rig's scene and their emulators.
struct ReceiverLoad {
  /// Errors, and the receiver's messages: "engine", "engine, raw", "engine, ZED-F9P, RAWX, SFRBX".
  std::string model{};
  int receivers = 0;
  double rate_hz = 0.0;
  double sensor_us = 0.0;    ///< CPU time per epoch.
  double emulator_us = 0.0;  ///< CPU time per epoch, all messages of the rig's receiver.
  double core_share = 0.0;   ///< Share of one core, in real time.
};
[[nodiscard]] std::vector<ReceiverLoad> measure_receivers(const hil::RigConfiguration& rig,
                                                          int receivers, double rate_hz,
                                                          int epochs);

/// Positions through a message and back.
struct PositionEncoding {
  std::string message{};
  double half_unit = 0.0;
  double worst = 0.0;
  std::string unit{};
  std::size_t positions = 0;
};
[[nodiscard]] std::vector<PositionEncoding> measure_position_encoding(std::size_t positions);

}  // namespace rigwire::bench
