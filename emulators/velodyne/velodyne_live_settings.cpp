// The VelodyneControl face of the sensor.
#include <numbers>

#include "emulators/velodyne/velodyne_lidar.h"

namespace rigwire::emulators {

void VelodyneLidar::take(const VelodyneLiveSettings& settings) {
  if (settings.host_address != live_.host_address || settings.data_port != live_.data_port ||
      settings.telemetry_port != live_.telemetry_port) {
    ++destination_changes_;
  }
  live_ = settings;
  if (report_) {
    report_->settings_changed(live_);
  }
}

void VelodyneLidar::apply(SimTime now, const VelodyneLiveSettings& settings) {
  advance(now);
  take(settings);
  command_head(now);
}

void VelodyneLidar::save(SimTime now) {
  advance(now);
  saved_ = live_;
}

void VelodyneLidar::reset(SimTime now) {
  advance(now);
  take(saved_);
  power_up(now, settings_.start_up == Duration::zero() ? kResetTime : settings_.start_up);
}

VelodyneReadings VelodyneLidar::readings(SimTime now) const {
  VelodyneReadings readings;
  readings.motor_on = live_.rotor_rpm > 0 && !starting_up(now);
  readings.motor_rpm = rotor_.rate_radps * 60.0 / (2.0 * std::numbers::pi);
  readings.motor_locked = phase_locked_;
  readings.motor_phase_centideg = phase_centideg_;
  readings.laser_on = command_.laser_on;
  readings.pulse_state = time_input_.state(now);
  readings.gps_position = time_input_.position();
  return readings;
}

VelodyneDestination VelodyneLidar::data_destination() const {
  return {live_.host_address, live_.data_port};
}

VelodyneDestination VelodyneLidar::position_destination() const {
  return {live_.host_address, live_.telemetry_port};
}

}  // namespace rigwire::emulators
