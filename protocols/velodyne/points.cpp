#include "protocols/velodyne/points.h"

#include <cmath>
#include <span>

#include "protocols/angle.h"

namespace rigwire::protocols::velodyne {
namespace {

constexpr double kTurn_deg = 360.0;
constexpr double kCount_deg = 0.01;
constexpr std::uint32_t kHour_us = 3'600'000'000U;

/// A rotor that the model's limits allow may run somewhat faster for a moment.
constexpr double kSpeedMargin = 1.25;

int step_counts(std::uint16_t from, std::uint16_t to) {
  return (to + kAzimuthCounts - from) % kAzimuthCounts;
}

double fastest_counts_per_ns(const Model& model) {
  return kSpeedMargin * model.maximum_rotor_rpm / 60.0 * kAzimuthCounts * 1e-9;
}

/// Wraps an azimuth that is at most one turn out of range to [0, 360).
double wrapped_deg(double azimuth_deg) {
  return azimuth_deg < 0.0          ? azimuth_deg + kTurn_deg
         : azimuth_deg >= kTurn_deg ? azimuth_deg - kTurn_deg
                                    : azimuth_deg;
}

}  // namespace

PointReader::PointReader(const Model& model, const std::optional<Hdl64eCalibration>& calibration)
    : model_(&model), calibration_(calibration) {
  const std::vector<Laser> lasers =
      calibration ? calibrated_lasers(model, *calibration)
                  : std::vector<Laser>(model.lasers.begin(), model.lasers.end());
  for (const Laser& laser : lasers) {
    const double elevation = laser.elevation_deg * kDegree;
    const double azimuth = laser.azimuth_offset_deg * kDegree;
    optics_.push_back(
        {laser.azimuth_offset_deg,
         elevation,
         {std::cos(elevation), std::sin(elevation), std::cos(azimuth), std::sin(azimuth)},
         laser.horizontal_offset_mm * 1e-3,
         laser.vertical_offset_mm * 1e-3});
  }
}

void PointReader::lay_out(ReturnMode mode) {
  mode_ = mode;
  shots_.assign(kBlocksPerPacket * kChannelsPerBlock, {});
  for (std::size_t place = 0; place < shots_.size(); ++place) {
    const std::size_t block = place / kChannelsPerBlock;
    if (block_place(*model_, mode, block).echo == BlockEcho::none) {
      shots_[place].echo = BlockEcho::none;
    } else {
      shots_[place] = shot(*model_, mode, block, place % kChannelsPerBlock);
    }
  }
}

// Returns the rotor's mean speed in the packet, azimuth counts per nanosecond: the sum of the
// azimuth steps between firings over their times, without steps that are too fast for the model
// (the gap of a narrowed view). Without such a step it is taken from the previous packet by the
// timestamps; else 0.
double PointReader::counts_per_ns(const DataPacket& packet, ReturnMode mode) const {
  const double fastest = fastest_counts_per_ns(*model_);
  std::int64_t turned_counts = 0;
  std::int64_t lasted_ns = 0;
  std::size_t before = 0;
  for (std::size_t b = 1; b < kBlocksPerPacket; ++b) {
    const BlockPlace place = block_place(*model_, mode, b);
    const BlockPlace place_before = block_place(*model_, mode, before);
    if (place.echo == BlockEcho::none || place.first_firing == place_before.first_firing) {
      continue;
    }
    const int step =
        step_counts(packet.blocks[before].azimuth_counts, packet.blocks[b].azimuth_counts);
    const std::int64_t period_ns =
        static_cast<std::int64_t>(place.first_firing - place_before.first_firing) *
        model_->firing_period_ns;
    if (step <= fastest * static_cast<double>(period_ns) + 1.0) {
      turned_counts += step;
      lasted_ns += period_ns;
    }
    before = b;
  }
  if (lasted_ns > 0) {
    return static_cast<double>(turned_counts) / static_cast<double>(lasted_ns);
  }
  if (!previous_azimuth_counts_) {
    return 0.0;
  }
  const std::uint32_t lasted_us =
      (packet.timestamp_us % kHour_us + kHour_us - previous_timestamp_us_ % kHour_us) % kHour_us;
  const int step = step_counts(*previous_azimuth_counts_, packet.blocks[0].azimuth_counts);
  const double rate = lasted_us == 0 ? 0.0 : step / (lasted_us * 1e3);
  return rate <= fastest ? rate : 0.0;
}

// Turns the beam by the rotor's azimuth (angle sum) and converts range, elevation and the offsets
// of the beam's exit to Cartesian coordinates; with a calibration by corrected().
Point PointReader::point(const Channel& channel, std::size_t laser, const Heading& heading) const {
  const Optics& optics = optics_[laser];
  BeamDirection beam = optics.direction;
  beam.cos_azimuth =
      optics.direction.cos_azimuth * heading.cos - optics.direction.sin_azimuth * heading.sin;
  beam.sin_azimuth =
      optics.direction.sin_azimuth * heading.cos + optics.direction.cos_azimuth * heading.sin;
  Point point;
  point.laser = static_cast<std::uint8_t>(laser);
  point.azimuth_rad = static_cast<float>(wrapped_deg(heading.deg + optics.azimuth_deg) * kDegree);
  point.elevation_rad = static_cast<float>(optics.elevation_rad);
  if (calibration_) {
    const Hdl64eLaser& unit = calibration_->lasers[laser];
    const CorrectedPoint at = corrected(unit, channel.distance_counts, beam);
    point.x_m = static_cast<float>(at.x_m);
    point.y_m = static_cast<float>(at.y_m);
    point.z_m = static_cast<float>(at.z_m);
    point.range_m = static_cast<float>(at.range_m);
    point.reflectivity = static_cast<std::uint8_t>(
        std::lround(corrected_intensity(unit, channel.reflectivity, channel.distance_counts)));
    return point;
  }
  const double range_m = channel.distance_counts * model_->distance_unit_mm * 1e-3;
  const double level_m = range_m * beam.cos_elevation;
  point.x_m = static_cast<float>(level_m * beam.cos_azimuth - optics.right_m * beam.sin_azimuth);
  point.y_m = static_cast<float>(-level_m * beam.sin_azimuth - optics.right_m * beam.cos_azimuth);
  point.z_m = static_cast<float>(range_m * beam.sin_elevation + optics.up_m);
  point.range_m = static_cast<float>(range_m);
  point.reflectivity = channel.reflectivity;
  return point;
}

void PointReader::append(const DataPacket& packet, std::vector<Point>& points) {
  const ReturnMode mode = return_mode(packet, *model_);
  if (shots_.empty() || mode != mode_) {
    lay_out(mode);
  }
  const double speed_degpns = counts_per_ns(packet, mode) * kCount_deg;
  // In a dual return the other echo of a block is so many blocks further on.
  const std::size_t partner = model_->status_channel ? 2 : 1;
  const BlockEcho first = model_->status_channel ? BlockEcho::strongest : BlockEcho::last;
  for (std::size_t b = 0; b < kBlocksPerPacket; ++b) {
    const Block& block = packet.blocks[b];
    const auto shots = std::span(shots_).subspan(b * kChannelsPerBlock, kChannelsPerBlock);
    const BlockEcho echo = shots.front().echo;
    if (echo == BlockEcho::none) {
      continue;
    }
    const bool has_partner = echo == first;
    const bool is_partner = echo != BlockEcho::single && !has_partner;
    const double block_deg = block.azimuth_counts * kCount_deg;
    const double block_cos = std::cos(block_deg * kDegree);
    const double block_sin = std::sin(block_deg * kDegree);
    for (std::size_t c = 0; c < kChannelsPerBlock; ++c) {
      const Channel& channel = block.channels[c];
      const bool said_before =
          is_partner &&
          packet.blocks[b - partner].channels[c].distance_counts == channel.distance_counts;
      if (channel.distance_counts == 0 || said_before) {
        continue;
      }
      const Shot& fired = shots[c];
      // The rotor turns by less than 2 degrees in a block: series, to 1e-8 rad.
      const double turned_deg = speed_degpns * fired.block_offset_ns;
      const double turned = turned_deg * kDegree;
      const double turned_cos = 1.0 - 0.5 * turned * turned;
      const double turned_sin = turned - turned * turned * turned / 6.0;
      Point found = point(channel, fired.laser,
                          {block_deg + turned_deg, block_cos * turned_cos - block_sin * turned_sin,
                           block_sin * turned_cos + block_cos * turned_sin});
      found.packet_offset_ns = fired.packet_offset_ns;
      if (has_partner &&
          packet.blocks[b + partner].channels[c].distance_counts == channel.distance_counts) {
        found.echo = PointEcho::both;
      } else if (echo == BlockEcho::last ||
                 (echo == BlockEcho::single && mode == ReturnMode::last)) {
        found.echo = PointEcho::last;
      }
      points.push_back(found);
    }
  }
  previous_azimuth_counts_ = packet.blocks[0].azimuth_counts;
  previous_timestamp_us_ = packet.timestamp_us;
}

}  // namespace rigwire::protocols::velodyne
