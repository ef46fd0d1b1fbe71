// What the vehicle gateway sends by itself: which message when, and how a sample becomes bytes.
//
// The schedule counts ticks of 10 ms. Every message has its period and a phase of its own, so that
// they do not crowd into one tick. Without a sample, or with one older than kStale, everything that
// comes from the machine is sent as not available; a reading that is no number is sent as error.
// J1939 speeds have no sign: they are sent as magnitudes, the direction is in the machine selected
// speed and in the gear.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "emulators/device.h"
#include "emulators/j1939/engine_report.h"
#include "emulators/vehicle_gateway/control.h"
#include "emulators/vehicle_gateway/tractor_power.h"
#include "protocols/can/frame.h"
#include "protocols/vehicle/message.h"
#include "sim/samples/vehicle_sample.h"

namespace rigwire::emulators {

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
  void put_engine(std::uint32_t pgn, std::uint8_t source, const VehicleSample* sample,
                  const VehicleControl& control);
  void put_gearbox(std::uint32_t pgn, std::uint8_t source, const VehicleSample* sample,
                   const VehicleControl& control);
  void put_speed(SimTime now, std::uint32_t pgn, std::uint8_t source, const VehicleSample* sample,
                 const VehicleControl& control);
  void put_steering(std::uint32_t pgn, std::uint8_t source, const VehicleSample* sample,
                    const VehicleControl& control);
  void put_tyres(std::uint32_t pgn, std::uint8_t source, const VehicleSample* sample,
                 const VehicleControl& control);
  void put_channels(std::uint32_t pgn, std::uint8_t source, const VehicleSample* sample);
  void put_machine(std::uint32_t pgn, std::uint8_t source, const VehicleSample* sample);
  void put_implements(std::uint32_t pgn, std::uint8_t source, const VehicleSample* sample,
                      const VehicleControl& control);

  VehicleGatewaySettings settings_;
  TractorPower power_;
  std::optional<VehicleSample> sample_;
  double distance_m_ = 0.0;
  double ground_distance_m_ = 0.0;
  EngineReport engine_;
  std::uint8_t sensor_counter_ = 0;  ///< Of SAS; 4 bits.
  std::array<protocols::can::Frame, kGreatestFrames> frames_{};
  std::size_t frame_count_ = 0;
};

}  // namespace rigwire::emulators
