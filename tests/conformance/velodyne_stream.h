// A stream of packets of any model and return mode whose every return is known: what the tests give
// to decoders that are not ours.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/hdl_64e_calibration.h"
#include "protocols/velodyne/packet_layout.h"
#include "protocols/velodyne/status_channel.h"

namespace rigwire {

/// What the two blocks of a dual return say of one laser.
struct DualChannels {
  protocols::velodyne::Channel last;
  protocols::velodyne::Channel strongest;
};

/// The rule of the manuals: where the strongest echo is also the last, the second strongest stands
/// for it; where there is but one echo, both say the same. Channels without echo are all zero.
[[nodiscard]] inline DualChannels dual_channels(const protocols::velodyne::Channel& strongest,
                                                const protocols::velodyne::Channel& last,
                                                const protocols::velodyne::Channel& second) {
  const bool strongest_is_last = strongest == last;
  return {last, strongest_is_last && second.distance_counts != 0 ? second : strongest};
}

/// One return as it truly was.
struct TrueReturn {
  std::size_t packet = 0;
  std::size_t firing = 0;  ///< In its packet.
  std::size_t laser = 0;
  protocols::velodyne::BlockEcho echo{};
  bool both = false;         ///< Last and strongest are one.
  double time_us = 0.0;      ///< Since the start of the stream.
  double azimuth_deg = 0.0;  ///< Azimuth of the laser, at its own instant.
  double range_m = 0.0;
  double reflectivity = 0.0;
};

/// The rotor turns by a whole number of counts from block to block, so that the azimuth field is
/// exact and what is left is the decoder's own error.
class VelodyneStream {
 public:
  static constexpr std::int64_t kStart_us = 3'599'990'000;  ///< Past the hour; wraps within 10 ms.
  static constexpr int kStartCounts = 35900;                ///< And so does the azimuth.
  static constexpr int kCountsPerFiring = 20;

  VelodyneStream(const protocols::velodyne::Model& model, protocols::velodyne::ReturnMode mode,
                 protocols::velodyne::StatusFormat format)
      : model_(model), mode_(mode) {
    if (model.status_channel) {
      record_.format = format;
      record_.calibration = unit();
      channel_.emplace(record_);
      lasers_ = calibrated_lasers(model, record_.calibration);
    } else {
      lasers_.assign(model.lasers.begin(), model.lasers.end());
    }
  }

  /// Two echoes at most: shot number decides how many and which is the stronger.
  struct Echoes {
    double near_m = 0.0;
    double far_m = 0.0;
    bool far_is_stronger = false;
  };

  static Echoes echoes(std::size_t firing, std::size_t laser) {
    const std::size_t number = firing * 131 + laser * 7;
    Echoes found;
    if (number % 7 != 0) {
      found.near_m = 2.5 + 0.0531 * static_cast<double>(number % 900);
    }
    if (number % 3 == 0 && found.near_m > 0.0) {
      found.far_m = found.near_m + 1.5 + 0.0317 * static_cast<double>(number % 500);
    }
    found.far_is_stronger = number % 2 == 0;
    return found;
  }

  /// The next packet. What it holds is added to `truth`, unless `empty`.
  protocols::velodyne::DataPacket next(std::vector<TrueReturn>& truth, bool empty = false) {
    namespace velodyne = protocols::velodyne;
    velodyne::DataPacket packet;
    const std::size_t firings = firings_per_packet(model_, mode_);
    for (std::size_t b = 0; b < velodyne::kBlocksPerPacket; ++b) {
      const velodyne::BlockPlace place = block_place(model_, mode_, b);
      velodyne::Block& block = packet.blocks[b];
      block.azimuth_counts = counts_of(packets_ * firings + place.first_firing);
      if (place.echo == velodyne::BlockEcho::none) {
        block.flag = velodyne::kFlagEmpty;
        continue;
      }
      block.flag = velodyne::block_flag(place.first_laser);
      for (std::size_t c = 0; c < velodyne::kChannelsPerBlock && !empty; ++c) {
        block.channels[c] = channel(velodyne::shot(model_, mode_, b, c), truth);
      }
    }
    const auto first_ns = static_cast<std::int64_t>(packets_ * firings) * model_.firing_period_ns;
    packet.timestamp_us = static_cast<std::uint32_t>(
        (kStart_us + (first_ns + model_.timestamp_lag_ns) / 1000) % 3'600'000'000);
    packet.return_mode_byte = static_cast<std::uint8_t>(mode_);
    packet.product_id = model_.product_id;
    if (channel_) {
      const velodyne::StatusByte status = channel_->at(packets_, {});
      packet.return_mode_byte = status.type;
      packet.product_id = status.value;
    }
    ++packets_;
    return packet;
  }

  [[nodiscard]] std::size_t packets() const { return packets_; }
  [[nodiscard]] const std::vector<protocols::velodyne::Laser>& lasers() const { return lasers_; }
  [[nodiscard]] const protocols::velodyne::StatusRecord& record() const { return record_; }

 private:
  protocols::velodyne::Hdl64eCalibration unit() const {
    protocols::velodyne::Hdl64eCalibration calibration = nominal_calibration(model_);
    for (std::size_t i = 0; i < calibration.lasers.size(); ++i) {
      protocols::velodyne::Hdl64eLaser& laser = calibration.lasers[i];
      const double phase = 2.4 * static_cast<double>(i);
      laser.rot_correction_deg += 0.2 * std::sin(phase);
      laser.dist_correction_m += 0.15 * std::sin(phase + 1.0);
      laser.dist_correction_x_m = laser.dist_correction_m + 0.03 * std::sin(phase + 2.0);
      laser.dist_correction_y_m = laser.dist_correction_m + 0.04 * std::cos(phase + 3.0);
      laser.focal_slope = 0.5 + 0.5 * std::cos(phase);
    }
    return as_sent(calibration);
  }

  static std::uint16_t counts_of(std::size_t firing) {
    return static_cast<std::uint16_t>(
        (kStartCounts + kCountsPerFiring * static_cast<std::int64_t>(firing)) %
        protocols::velodyne::kAzimuthCounts);
  }

  protocols::velodyne::Channel encoded(double range_m, double reflectivity, double rotor_deg,
                                       std::size_t laser) const {
    if (range_m == 0.0) {
      return {};
    }
    if (channel_) {
      const auto& unit = record_.calibration.lasers[laser];
      const double counts = raw_counts(unit, range_m, rotor_deg);
      return {static_cast<std::uint16_t>(std::lround(counts)),
              raw_intensity(unit, reflectivity, counts)};
    }
    return {static_cast<std::uint16_t>(std::lround(range_m * 1e3 / model_.distance_unit_mm)),
            static_cast<std::uint8_t>(std::lround(reflectivity))};
  }

  protocols::velodyne::Channel channel(const protocols::velodyne::Shot& shot,
                                       std::vector<TrueReturn>& truth) const {
    using protocols::velodyne::BlockEcho;
    const std::size_t firing = packets_ * firings_per_packet(model_, mode_) + shot.firing;
    const double since_first_ns =
        static_cast<double>(shot.packet_offset_ns + model_.timestamp_lag_ns);
    const double packet_ns = static_cast<double>(firing - shot.firing) * model_.firing_period_ns;
    const double rotor_deg =
        0.01 *
        (kStartCounts + kCountsPerFiring * (packet_ns + since_first_ns) / model_.firing_period_ns);
    const Echoes found = echoes(firing, shot.laser);
    const double last_m = found.far_m > 0.0 ? found.far_m : found.near_m;
    const double near_percent = channel_ ? 150.0 : 10.0 + static_cast<double>(shot.laser % 90);
    const double far_percent = near_percent + 7.0;
    const auto near = encoded(found.near_m, near_percent, rotor_deg, shot.laser);
    const auto last =
        found.far_m > 0.0 ? encoded(last_m, far_percent, rotor_deg, shot.laser) : near;
    const bool last_is_stronger = found.far_m > 0.0 && found.far_is_stronger;
    const auto sent =
        last_is_stronger ? dual_channels(last, last, near) : dual_channels(near, last, last);
    const bool wants_last =
        shot.echo == BlockEcho::last ||
        (shot.echo == BlockEcho::single && mode_ == protocols::velodyne::ReturnMode::last);
    const bool single_strongest = shot.echo == BlockEcho::single && !wants_last;
    const bool is_far = found.far_m > 0.0 && (wants_last || (single_strongest && last_is_stronger));
    if (found.near_m > 0.0) {
      truth.push_back({.packet = packets_,
                       .firing = shot.firing,
                       .laser = shot.laser,
                       .echo = wants_last ? BlockEcho::last : BlockEcho::strongest,
                       .both = shot.echo != BlockEcho::single && found.far_m == 0.0,
                       .time_us = (packet_ns + since_first_ns) * 1e-3,
                       .azimuth_deg = rotor_deg + lasers_[shot.laser].azimuth_offset_deg,
                       .range_m = is_far ? found.far_m : found.near_m,
                       .reflectivity = is_far ? far_percent : near_percent});
    }
    if (single_strongest) {
      return last_is_stronger ? last : near;
    }
    return wants_last ? sent.last : sent.strongest;
  }

  const protocols::velodyne::Model& model_;
  protocols::velodyne::ReturnMode mode_;
  std::vector<protocols::velodyne::Laser> lasers_;
  protocols::velodyne::StatusRecord record_;
  std::optional<protocols::velodyne::StatusChannel> channel_;
  std::size_t packets_ = 0;
};

}  // namespace rigwire
