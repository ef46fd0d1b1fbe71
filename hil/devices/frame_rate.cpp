#include "hil/devices/frame_rate.h"

#include <bit>

#include "emulators/iso_valve/iso_valves.h"
#include "emulators/starfire/node.h"
#include "sim/samples/calendar.h"

namespace rigwire::hil {
namespace {

/// A device is only built to be asked how much it sends.
class NoFrames final : public emulators::FrameOutput {
 public:
  void send(SimTime, const protocols::can::Frame&) override {}
};

}  // namespace

double frame_rate_hz(const OpenImuDeviceConfiguration& device) {
  constexpr double kBaseRate_hz = 100.0;
  const unsigned divider = device.imu.configuration.rate_divider;
  const int messages = std::popcount(device.imu.configuration.packet_mask);
  return divider == 0 ? 0.0 : kBaseRate_hz / divider * messages;
}

double frame_rate_hz(const XsensMtiConfiguration& device) {
  NoFrames nowhere;
  const Calendar calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0});
  return emulators::Mti600(device.mti, calendar, nowhere).nominal_rate_hz();
}

double frame_rate_hz(const EncoderDeviceConfiguration& device) {
  NoFrames nowhere;
  emulators::VolatileMemory memory;
  return emulators::RotaryEncoder(device.encoder, memory, nowhere).nominal_rate_hz();
}

double frame_rate_hz(const StarFireConfiguration& device) {
  if (device.bus.empty()) {
    return 0.0;
  }
  NoFrames nowhere;
  const Calendar calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0});
  return emulators::StarFireNode(device.receiver, calendar, nowhere).nominal_rate_hz();
}

double frame_rate_hz(const VehicleGatewayDeviceConfiguration& device) {
  NoFrames nowhere;
  return emulators::VehicleGateway(settings_of(device), nowhere).nominal_rate_hz();
}

double frame_rate_hz(const IsoValvesConfiguration& device) {
  NoFrames nowhere;
  return emulators::IsoValves(device.valves, nowhere).nominal_rate_hz();
}

}  // namespace rigwire::hil
