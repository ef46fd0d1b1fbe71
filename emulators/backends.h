// The backend face of each device class: SI samples in, actuator commands out. One class of device,
// one interface, whatever the make; a test that drives a backend works on every emulator of the
// class.
//
// update() first lets the device live up to sample.time (as advance() does), then takes the sample.
//
// Sample and, where the device asks something of the machine or of its sensor, Command name what
// goes in and out; command() is what holds at present. A station (hil/executive/station.h) is made
// of these alone.
#pragma once

#include "sim/samples/encoder_sample.h"
#include "sim/samples/gnss_sample.h"
#include "sim/samples/imu_sample.h"
#include "sim/samples/joystick_sample.h"
#include "sim/samples/lidar_sample.h"
#include "sim/samples/power_unit_sample.h"
#include "sim/samples/valve_sample.h"
#include "sim/samples/vehicle_sample.h"

namespace rigwire::emulators {

class GnssBackend {
 public:
  using Sample = GnssSample;
  using Command = GnssCommand;

  virtual ~GnssBackend() = default;
  /// What its settings ask of the navigation engine; devices without such settings ask nothing.
  [[nodiscard]] virtual const Command& command() const {
    static const Command kNothing;
    return kNothing;
  }
  virtual void update(const Sample& sample) = 0;
};

class ImuBackend {
 public:
  using Sample = ImuSample;

  virtual ~ImuBackend() = default;
  virtual void update(const Sample& sample) = 0;
};

class EncoderBackend {
 public:
  using Sample = EncoderSample;

  virtual ~EncoderBackend() = default;
  virtual void update(const Sample& sample) = 0;
};

class LidarBackend {
 public:
  using Sample = LidarFiring;
  using Command = LidarCommand;

  virtual ~LidarBackend() = default;
  /// The firing pattern that the caster must follow.
  [[nodiscard]] virtual const LidarPattern& pattern() const = 0;
  /// What the device asks of its head at present.
  [[nodiscard]] virtual const Command& command() const = 0;
  virtual void update(const Sample& firing) = 0;
  /// The earliest instant at which a firing can complete the packet in work, or the next one; later
  /// than the time that the device has lived up to. The executive takes firings at that instant,
  /// not one by one.
  [[nodiscard]] virtual SimTime packet_complete_at() const = 0;
};

class ValveBackend {
 public:
  using Sample = ValveSample;
  using Command = ValveCommand;

  virtual ~ValveBackend() = default;
  virtual void update(const Sample& sample) = 0;
  /// The set points that the driver's output stage holds at present.
  [[nodiscard]] virtual const Command& command() const = 0;
};

/// An engine that drives pumps: readings of both in, what its controller asks of it out.
class PowerUnitBackend {
 public:
  using Sample = PowerUnitSample;
  using Command = PowerUnitCommand;

  virtual ~PowerUnitBackend() = default;
  virtual void update(const Sample& sample) = 0;
  [[nodiscard]] virtual const Command& command() const = 0;
};

class VehicleBackend {
 public:
  using Sample = VehicleSample;
  using Command = VehicleCommand;

  virtual ~VehicleBackend() = default;
  virtual void update(const Sample& sample) = 0;
  /// What the controllers on the bus ask of the machine at present.
  [[nodiscard]] virtual const Command& command() const = 0;
};

class JoystickBackend {
 public:
  using Sample = JoystickSample;

  virtual ~JoystickBackend() = default;
  virtual void update(const Sample& sample) = 0;
};

}  // namespace rigwire::emulators
