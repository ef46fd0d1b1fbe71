// The backend face of each device class: SI samples in, actuator commands out. One class of device,
// one interface, whatever the make; a test that drives a backend works on every emulator of the
// class.
//
// update() first lets the device live up to sample.time (as advance() does), then takes the sample.
#pragma once

#include "sim/samples/encoder_sample.h"
#include "sim/samples/gnss_sample.h"
#include "sim/samples/imu_sample.h"
#include "sim/samples/joystick_sample.h"
#include "sim/samples/lidar_sample.h"
#include "sim/samples/valve_sample.h"
#include "sim/samples/vehicle_sample.h"

namespace rigwire::emulators {

class GnssBackend {
 public:
  virtual ~GnssBackend() = default;
  virtual void update(const GnssSample& sample) = 0;
};

class ImuBackend {
 public:
  virtual ~ImuBackend() = default;
  virtual void update(const ImuSample& sample) = 0;
};

class EncoderBackend {
 public:
  virtual ~EncoderBackend() = default;
  virtual void update(const EncoderSample& sample) = 0;
};

class LidarBackend {
 public:
  virtual ~LidarBackend() = default;
  /// The firing pattern that the caster must follow.
  [[nodiscard]] virtual const LidarPattern& pattern() const = 0;
  /// What the device asks of its head at present.
  [[nodiscard]] virtual const LidarCommand& command() const = 0;
  virtual void update(const LidarFiring& firing) = 0;
  /// The earliest instant at which a firing can complete the packet in work, or the next one; later
  /// than the time that the device has lived up to. The executive takes firings at that instant,
  /// not one by one.
  [[nodiscard]] virtual SimTime packet_complete_at() const = 0;
};

class ValveBackend {
 public:
  virtual ~ValveBackend() = default;
  virtual void update(const ValveSample& sample) = 0;
  /// The set points that the driver's output stage holds at present.
  [[nodiscard]] virtual const ValveCommand& command() const = 0;
};

class VehicleBackend {
 public:
  virtual ~VehicleBackend() = default;
  virtual void update(const VehicleSample& sample) = 0;
  /// What the controllers on the bus ask of the machine at present.
  [[nodiscard]] virtual const VehicleCommand& command() const = 0;
};

class JoystickBackend {
 public:
  virtual ~JoystickBackend() = default;
  virtual void update(const JoystickSample& sample) = 0;
};

}  // namespace rigwire::emulators
