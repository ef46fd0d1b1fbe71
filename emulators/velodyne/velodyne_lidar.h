// A Velodyne spinning lidar on the wire: data packets and position packets, each on its UDP port.
//
// Wire face: 1206-byte data packets, due when the last laser of their last firing has fired plus
// `send_delay`; 512-byte position packets at a rate of their own. The sensor takes nothing in over
// these ports; what its web interface changes comes through VelodyneControl. Backend face: the
// firings of the pattern, bank by bank, in order.
//
// The firing clock is integer nanoseconds (HDL-32E: 46 080) and independent of the rotor, so
// packets straddle 0 degrees as real ones do. Each block carries the rotor's azimuth at its first
// firing, rounded, never backward. Firings outside the view make no blocks; a packet is filled up
// across the gap. A gap in the firing clock itself drops the unfinished packet.
//
// Changed settings act on the next firing, a changed return mode on the next packet. Without supply
// the rotor runs down; when it comes back the sensor starts as after a reset, with what it has
// saved.
//
// Sources and deviations: docs/devices/velodyne.md.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "emulators/backends.h"
#include "emulators/device.h"
#include "emulators/random_bits.h"
#include "emulators/supply.h"
#include "emulators/velodyne/faulty_cable.h"
#include "emulators/velodyne/packet_assembly.h"
#include "emulators/velodyne/return_encoder.h"
#include "emulators/velodyne/sensor_clock.h"
#include "emulators/velodyne/time_input.h"
#include "emulators/velodyne/unit_report.h"
#include "emulators/velodyne/velodyne_control.h"
#include "emulators/velodyne/velodyne_settings.h"
#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/model.h"
#include "protocols/velodyne/position_packet.h"
#include "sim/samples/calendar.h"
#include "sim/samples/imu_sample.h"

namespace rigwire::emulators {

/// What the HDL-32E's three gyroscopes, accelerometer pairs and thermometers read.
using InertialWords =
    std::array<protocols::velodyne::InertialGroup, protocols::velodyne::kInertialGroups>;

/// Where the sensor's host settings want packets to go.
struct VelodyneDestination {
  std::string address;  ///< IPv4
  std::uint16_t port = 0;
};

class VelodyneLidar final : public Device, public LidarBackend, public VelodyneControl {
 public:
  /// Validates. The outputs and the calendar must outlive the device.
  VelodyneLidar(const VelodyneSettings& settings, const Calendar& calendar, ByteOutput& data,
                ByteOutput& position);

  void advance(SimTime now) override;
  /// Data packets are sent, with their due time, by the update() that completes them.
  [[nodiscard]] SimTime next_event() const override;
  /// One sample per firing, from one firing period after the start, whatever the settings.
  [[nodiscard]] SamplePlan sample_plan() const override;
  [[nodiscard]] ReceiveCounters received() const override { return {}; }
  /// Data and position packets.
  [[nodiscard]] double nominal_rate_hz() const override;
  [[nodiscard]] std::span<const Quantity> quantities() const override { return quantities_; }

  [[nodiscard]] const LidarPattern& pattern() const override { return pattern_; }
  [[nodiscard]] const LidarCommand& command() const override { return command_; }
  /// A bank out of turn, or an azimuth that is not a number, counts as a gap in the firing clock.
  void update(const LidarFiring& bank) override;
  /// With a narrowed view: the earliest instant at which that can be. Without firings: a packet's
  /// period after the last time that the device lived, so that firings never pile up.
  [[nodiscard]] SimTime packet_complete_at() const override { return packet_complete_at_; }

  /// What the receiver behind the sensor measures; without it, sentences say "no fix".
  void observe_fix(const GnssSample& sample) { time_input_.observe(sample); }
  /// What the sensor's housing feels, in its own frame. Only the HDL-32E reports it.
  void observe_motion(const ImuSample& sample);

  [[nodiscard]] std::string_view model_name() const override { return model_.name; }
  [[nodiscard]] std::string_view serial_number() const override { return settings_.serial_number; }
  [[nodiscard]] const VelodyneLiveSettings& live_settings() const override { return live_; }
  void apply(SimTime now, const VelodyneLiveSettings& settings) override;
  void save(SimTime now) override;
  void reset(SimTime now) override;
  [[nodiscard]] VelodyneReadings readings(SimTime now) const override;

  /// Without supply, and from power-up or reset until the start-up time is over: no packets, no web
  /// interface.
  [[nodiscard]] bool starting_up(SimTime now) const { return now < running_from_; }
  [[nodiscard]] Supply& supply() { return supply_; }
  [[nodiscard]] const Supply& supply() const { return supply_; }
  [[nodiscard]] VelodyneDestination data_destination() const;
  [[nodiscard]] VelodyneDestination position_destination() const;
  /// Rises whenever a destination may have changed.
  [[nodiscard]] std::uint32_t destination_changes() const { return destination_changes_; }
  /// One more fault; it begins no earlier than the device was advanced to. Throws
  /// std::invalid_argument.
  VelodyneFaults::Id begin(const VelodyneFault& fault);
  /// Ends a fault like FaultBook::end().
  bool end(VelodyneFaults::Id id, SimTime now);
  /// Packets that the faults have swallowed.
  [[nodiscard]] std::uint64_t packets_lost() const { return data_.lost() + position_.lost(); }

 private:
  struct RotorReading {
    SimTime time{};
    double azimuth_rad = 0.0;
    double rate_radps = 0.0;
  };

  void build_pattern();
  void power_up(SimTime now, Duration start_up);
  void power_down(SimTime now);
  /// What was being put together is forgotten.
  void begin_packets(SimTime now);
  void restart(SimTime now);
  /// But for the supply.
  void live_until(SimTime now);
  [[nodiscard]] SimTime next_work() const;
  void take(const VelodyneLiveSettings& settings);
  void command_head(SimTime now);
  void handle_time_input();
  [[nodiscard]] bool in_view(double azimuth_rad) const;
  [[nodiscard]] bool continues(const LidarFiring& bank) const;
  [[nodiscard]] std::uint16_t azimuth_of(const LidarFiring& bank, bool continued);
  void add(const LidarFiring& bank);
  void begin_packet(SimTime first_firing);
  void send_data(SimTime last_firing);
  void send_position(SimTime due);
  /// The instant of the next position packet: its slot, and how long it waits.
  void plan_position();
  [[nodiscard]] std::uint32_t microseconds_of_hour(SimTime instant) const;

  const VelodyneSettings settings_;
  const protocols::velodyne::Model& model_;
  VelodyneFaults faults_;
  Supply supply_;
  bool was_on_ = false;
  FaultyCable data_;
  FaultyCable position_;
  LidarPattern pattern_;
  double reference_range_m_ = 0.0;
  Duration last_shot_after_{0};
  std::array<Quantity, 4> quantities_;

  VelodyneLiveSettings live_;
  VelodyneLiveSettings saved_;
  LidarCommand command_;
  std::uint32_t destination_changes_ = 0;
  SimTime running_from_ = kStart;
  SimTime next_command_ = kNever;

  SensorClock clock_;
  TimeInput time_input_;
  RotorReading rotor_;
  int phase_centideg_ = 0;
  bool phase_locked_ = false;

  std::optional<protocols::velodyne::Hdl64eCalibration> calibration_;
  ReturnEncoder encode_;
  PacketAssembly assembly_;
  SimTime expected_time_ = kNever;
  std::size_t expected_laser_ = 0;
  bool firing_taken_ = false;
  std::uint16_t azimuth_counts_ = 0;
  SimTime packet_complete_at_ = kNever;
  LidarFiring defective_;

  std::optional<UnitReport> report_;
  InertialWords inertial_{};
  protocols::velodyne::UnitStatus unit_status_;
  SimTime powered_up_{};
  Duration position_period_;
  RandomBits position_waits_;
  SimTime position_slot_{};
  SimTime next_position_ = kNever;
  std::array<std::uint8_t, protocols::velodyne::kPositionPacketSize> position_bytes_{};
};

}  // namespace rigwire::emulators
