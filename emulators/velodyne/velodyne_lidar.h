// A Velodyne spinning lidar on the wire: data packets and position packets, each on its UDP port.
//
// Wire face: 1206-byte data packets, due when the last laser of the twelfth firing has fired plus
// `send_delay`; 512-byte position packets at a rate of their own. The sensor takes nothing in over
// these ports. Backend face: one LidarFiring per firing of the pattern, in order.
//
// The firing clock is integer nanoseconds (HDL-32E: 46 080) and independent of the rotor, so
// packets straddle 0 degrees as real ones do; the timestamp is microseconds past the UTC hour at
// the first firing, because the sensor is taken to be synchronised to a receiver's pulse and
// sentence.
//
// Sources and deviations: docs/devices/velodyne-hdl-32e.md.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "emulators/backends.h"
#include "emulators/device.h"
#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/model.h"
#include "protocols/velodyne/position_packet.h"
#include "sim/samples/calendar.h"

namespace rigwire::emulators {

struct VelodyneSettings {
  std::string model = "HDL-32E";
  double rotor_rpm = 600.0;  ///< Within the model's limits.
  protocols::velodyne::ReturnMode return_mode = protocols::velodyne::ReturnMode::strongest;
  /// Firmware before 2.2.20.0: both factory bytes are zero.
  bool legacy_factory_bytes = false;
  /// False: all beams leave from the origin, for clients that ignore the offsets.
  bool vertical_offsets = true;
  /// Returns outside are reported as none. Zero: the model's own limit.
  double minimum_range_m = 0.0;
  double maximum_range_m = 0.0;
  /// From the last laser's shot to the packet's start on the wire.
  Duration send_delay = std::chrono::microseconds{5};
  /// Zero: as long as 14 data packets last (7.741 44 ms for the HDL-32E).
  Duration position_period{0};
};

/// Throws std::invalid_argument naming the member, the value found and what is allowed.
void validate(const VelodyneSettings& settings);

class VelodyneLidar final : public Device, public LidarBackend {
 public:
  /// Validates. The outputs and the calendar must outlive the device.
  VelodyneLidar(const VelodyneSettings& settings, const Calendar& calendar, ByteOutput& data,
                ByteOutput& position);

  void advance(SimTime now) override;
  /// The next position packet. Data packets are sent, with their due time, by the update() that
  /// completes them.
  [[nodiscard]] SimTime next_event() const override { return next_position_; }
  /// One sample per firing, from one firing period after the start.
  [[nodiscard]] SamplePlan sample_plan() const override;
  [[nodiscard]] ReceiveCounters received() const override { return {}; }
  /// Data and position packets.
  [[nodiscard]] double nominal_rate_hz() const override;
  [[nodiscard]] std::span<const Quantity> quantities() const override { return quantities_; }

  [[nodiscard]] const LidarPattern& pattern() const override { return pattern_; }
  [[nodiscard]] const LidarCommand& command() const override { return command_; }
  /// A firing that does not continue the running packet's clock (a gap, a restart) drops the
  /// unfinished packet and begins a new one.
  void update(const LidarFiring& firing) override;
  [[nodiscard]] SimTime packet_complete_at() const override { return packet_complete_at_; }

  /// What the receiver behind the sensor knows; without it, sentences say "no fix".
  void observe_fix(const GnssSample& sample);

 private:
  void begin_packet(const LidarFiring& firing);
  void add_firing(const LidarFiring& firing);
  void send_data();
  void send_position(SimTime due);
  [[nodiscard]] std::uint32_t microseconds_of_hour(SimTime instant) const;

  struct Fix {
    bool valid = false;
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
    double speed_mps = 0.0;
    double course_deg = 0.0;
  };

  VelodyneSettings settings_;
  const protocols::velodyne::Model& model_;
  const Calendar& calendar_;
  ByteOutput& data_;
  ByteOutput& position_;
  LidarPattern pattern_;
  LidarCommand command_;
  double counts_per_metre_;
  std::array<Quantity, 4> quantities_;

  protocols::velodyne::DataPacket packet_;
  int firings_in_packet_ = 0;
  SimTime packet_start_{};
  SimTime packet_complete_at_ = kNever;
  std::array<std::uint8_t, protocols::velodyne::kDataPacketSize> data_bytes_{};

  Fix fix_;
  Duration position_period_;
  SimTime next_position_;
  std::array<std::uint8_t, protocols::velodyne::kPositionPacketSize> position_bytes_{};
};

}  // namespace rigwire::emulators
