// What the vehicle gateway sends by itself: which message when, and how a sample becomes bytes.
//
// The schedule counts ticks of 10 ms. Every message has its period and a phase of its own, so that
// they do not crowd into one tick. Without a sample, or with one older than kStale, everything that
// comes from the machine is sent as not available; a reading that is no number is sent as error.
// J1939 speeds have no sign: they are sent as magnitudes, the direction is in the machine selected
// speed and in the gear.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "emulators/device.h"
#include "emulators/j1939/engine_report.h"
#include "emulators/vehicle_gateway/control.h"
#include "emulators/vehicle_gateway/settings.h"
#include "protocols/can/frame.h"
#include "protocols/vehicle/message.h"
#include "sim/samples/vehicle_sample.h"

namespace rigwire::emulators {

/// What becomes of the supply when the key is switched off (ISO 11783-7, maintain power; ISO
/// 11783-9 as far as isobus.net describes it).
///
/// The key goes off once, at key_off from the start of the run; 0: never. From then on power stays
/// for kLeast, and for kLeast more after each request of an implement ("maintain power" that
/// requires ECU or actuator power), but no longer than maximum_power_time in all. Then it is gone.
class TractorPower {
 public:
  static constexpr Duration kLeast = std::chrono::seconds{2};

  explicit TractorPower(const VehicleGatewaySettings& settings)
      : key_off_(settings.key_off == Duration{0} ? kNever : kStart + settings.key_off),
        longest_(settings.maximum_power_time),
        off_(key_off_ == kNever ? kNever : key_off_ + std::min(kLeast, longest_)) {}

  [[nodiscard]] bool key_on(SimTime now) const { return now < key_off_; }
  [[nodiscard]] bool supplied(SimTime now) const { return now < off_; }
  [[nodiscard]] SimTime key_off_at() const { return key_off_; }
  [[nodiscard]] SimTime off_at() const { return off_; }
  /// An implement asks for more time; without effect while the key is on.
  void maintain(SimTime now) {
    if (!key_on(now) && supplied(now)) {
      off_ = std::max(off_, std::min(now + kLeast, key_off_ + longest_));
    }
  }
  /// For how long power would last, or lasts, at most.
  [[nodiscard]] Duration longest(SimTime now) const {
    return key_on(now) ? longest_ : std::max(Duration{0}, key_off_ + longest_ - now);
  }

 private:
  SimTime key_off_;
  Duration longest_;
  SimTime off_;
};

class VehicleReport {
 public:
  static constexpr Duration kTick = std::chrono::milliseconds{10};
  static constexpr Duration kStale = std::chrono::milliseconds{100};
  static constexpr std::size_t kGreatestFrames = 4;  ///< One for each tyre.

  /// One message of the schedule.
  struct Entry {
    protocols::vehicle::Group group;
    unsigned phase = 0;  ///< Ticks; below the period.
  };
  /// In the order in which messages of one tick leave.
  [[nodiscard]] static std::span<const Entry> schedule();
  /// Whether the entry is due at tick number `tick`; never for groups without a period.
  [[nodiscard]] static bool is_due(const Entry& entry, std::uint64_t tick);

  explicit VehicleReport(const VehicleGatewaySettings& settings);

  [[nodiscard]] EngineReport& engine() { return engine_; }
  /// Key and supply, which the wheel-based speed reports.
  [[nodiscard]] TractorPower& power() { return power_; }
  [[nodiscard]] const TractorPower& power() const { return power_; }

  /// Whether the entry's message is sent by itself: the machine has what it is about, and a power
  /// take-off is engaged.
  [[nodiscard]] bool sends(const Entry& entry) const;

  /// Takes a sample, and adds up distances, the engine's hours and its revolutions.
  void take(const VehicleSample& sample);
  /// Until the next sample nothing is known; sums stay.
  void forget() { sample_.reset(); }
  [[nodiscard]] double distance_m() const { return distance_m_; }
  /// Speed of the machine as its odometry has it; NaN when it is not known at `now`.
  [[nodiscard]] double speed_mps(SimTime now) const;

  /// The frames of group `pgn` at `now`; empty when it is none of schedule(). Valid until the next
  /// call.
  [[nodiscard]] std::span<const protocols::can::Frame> frames(SimTime now, std::uint32_t pgn,
                                                              std::uint8_t source,
                                                              const VehicleControl& control);
  /// Frames that frames() gives for the group.
  [[nodiscard]] std::size_t count(std::uint32_t pgn) const;

  [[nodiscard]] static std::span<const Quantity> quantities();

 private:
  [[nodiscard]] const VehicleSample* fresh(SimTime now) const;
  template <class Message>
  void put(const Message& message, std::uint8_t source) {
    frames_[frame_count_++] = protocols::vehicle::encode(message, source);
  }
  /// The requested group, its source address, and its content.
  struct Wanted {
    SimTime now;
    std::uint32_t pgn;
    std::uint8_t source;
    const VehicleSample* sample;  ///< Null: everything is not available.
    const VehicleControl& control;
  };
  /// Puts the message if it is the one that is wanted: fill(message, sample) where there is one.
  template <class Message, class Fill>
  void report(const Wanted& wanted, const Fill& fill) {
    if (wanted.pgn == Message::kGroup.pgn) {
      Message message;
      if (wanted.sample != nullptr) {
        fill(message, *wanted.sample);
      }
      put(message, wanted.source);
    }
  }
  void put_engine(const Wanted& wanted);
  void put_gearbox(const Wanted& wanted);
  void put_speed(const Wanted& wanted);
  void put_steering(const Wanted& wanted);
  void put_tyres(const Wanted& wanted);
  void put_channels(const Wanted& wanted);
  void put_machine(const Wanted& wanted);
  void put_implements(const Wanted& wanted);

  VehicleGatewaySettings settings_;
  TractorPower power_;
  std::optional<VehicleSample> sample_;
  double distance_m_ = 0.0;
  double ground_distance_m_ = 0.0;
  EngineReport engine_;
  std::uint8_t sensor_counter_ = 0;  ///< Message counter of SAS; 4 bits.
  std::array<protocols::can::Frame, kGreatestFrames> frames_{};
  std::size_t frame_count_ = 0;
};

}  // namespace rigwire::emulators
