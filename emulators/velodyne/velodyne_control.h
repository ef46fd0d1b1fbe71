// What can be set on a running sensor and what it reports of itself: the interface of the device
// for its web interface (emulators/velodyne/web_interface.h).
//
// Sources: VLP-16 user's manual 63-9243 Rev. D, chapter 10 "Sensor communication" and appendix E;
// JSON members and their types as recorded from real sensors (docs/devices/velodyne-web.md).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/position_packet.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// Settings that a client can change while the sensor runs.
struct VelodyneLiveSettings {
  /// Whole; 0 (motor off) or within the model's limits; VLP family: steps of 60.
  double rotor_rpm = 600.0;
  protocols::velodyne::ReturnMode return_mode = protocols::velodyne::ReturnMode::strongest;
  bool laser_on = true;
  int view_start_deg = 0;  ///< 0 .. 359, clockwise; the window may contain 0.
  int view_end_deg = 359;  ///< 0 .. 359, included; 0 and 359 together: all round.
  bool phase_lock = false;
  int phase_lock_offset_centideg = 0;  ///< 0 .. 35999
  std::string host_address = "255.255.255.255";
  std::uint16_t data_port = 2368;
  std::uint16_t telemetry_port = 8308;
  /// Address of the sensor's own interface: stored and reported, without effect on this machine's
  /// network.
  std::string net_address = "192.168.1.201";
  std::string net_mask = "255.255.255.0";
  std::string net_gateway = "192.168.1.1";
  bool net_dhcp = false;

  friend bool operator==(const VelodyneLiveSettings&, const VelodyneLiveSettings&) = default;
};

/// What the sensor measures of itself.
struct VelodyneReadings {
  bool motor_on = true;
  double motor_rpm = 0.0;
  bool motor_locked = false;     ///< Phase lock holds.
  int motor_phase_centideg = 0;  ///< Rotor's azimuth at the last top of a second.
  bool laser_on = true;
  protocols::velodyne::PulseState pulse_state = protocols::velodyne::PulseState::absent;
  std::string gps_position;  ///< Text on the status page; empty without a fix.
  double top_temperature_c = 35.0;
  double bottom_temperature_c = 35.0;
  double input_voltage_v = 12.0;
  double input_current_a = 0.65;
};

class VelodyneControl {
 public:
  virtual ~VelodyneControl() = default;
  [[nodiscard]] virtual std::string_view model_name() const = 0;
  [[nodiscard]] virtual std::string_view serial_number() const = 0;
  [[nodiscard]] virtual const VelodyneLiveSettings& live_settings() const = 0;
  /// Takes effect from `now` on. Precondition: every member within the limits above.
  virtual void apply(SimTime now, const VelodyneLiveSettings& settings) = 0;
  /// The settings that hold after a reset.
  virtual void save(SimTime now) = 0;
  /// Starts anew with the saved settings: silent for the start-up time, rotor spins up.
  virtual void reset(SimTime now) = 0;
  [[nodiscard]] virtual VelodyneReadings readings(SimTime now) const = 0;
};

}  // namespace rigwire::emulators
