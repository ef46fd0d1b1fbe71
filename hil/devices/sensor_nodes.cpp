// Inertial units and encoders as nodes of a CAN bus.
#include "emulators/canopen/rotary_encoder.h"
#include "emulators/openimu/openimu335ri.h"
#include "emulators/xsens/mti_600.h"
#include "hil/devices/bus_node_line.h"
#include "hil/files/settings_file.h"

namespace rigwire::hil {

std::unique_ptr<DeviceLine> make_line(const OpenImuDeviceConfiguration& configuration,
                                      CanLine& bus) {
  return std::make_unique<BusNodeLine<emulators::OpenImu, ImuStation>>(
      bus, configuration.imu, open_settings(configuration.settings_file));
}

std::unique_ptr<DeviceLine> make_line(const XsensMtiConfiguration& configuration,
                                      const LineContext& context, CanLine& bus) {
  return std::make_unique<BusNodeLine<emulators::Mti600, ImuStation>>(bus, configuration.mti,
                                                                      context.calendar);
}

std::unique_ptr<DeviceLine> make_line(const EncoderDeviceConfiguration& configuration,
                                      CanLine& bus) {
  return std::make_unique<BusNodeLine<emulators::RotaryEncoder, EncoderStation>>(
      bus, configuration.encoder, open_settings(configuration.settings_file));
}

}  // namespace rigwire::hil
