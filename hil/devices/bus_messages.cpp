#include "hil/devices/bus_messages.h"

#include <iterator>
#include <string_view>
#include <variant>

#include "emulators/canopen/rotary_encoder.h"
#include "emulators/iso_valve/iso_valves.h"
#include "emulators/openimu/openimu335ri.h"
#include "emulators/starfire/node.h"
#include "emulators/vehicle_gateway/vehicle_gateway.h"
#include "emulators/xsens/mti_600.h"
#include "sim/samples/calendar.h"

namespace rigwire::hil {
namespace {

using Layouts = std::vector<protocols::can::MessageLayout>;

/// A device is only built to be asked what it says.
class NoFrames final : public emulators::FrameOutput {
 public:
  void send(SimTime, const protocols::can::Frame&) override {}
};

template <class Device, class... Arguments>
Layouts ask(std::string_view name, const Arguments&... arguments) {
  NoFrames nowhere;
  return Device(arguments..., nowhere).messages(name);
}

Layouts messages(const OpenImuDeviceConfiguration& device, std::string_view name) {
  return ask<emulators::OpenImu>(name, device.imu);
}
Layouts messages(const StarFireConfiguration& device, std::string_view name) {
  return ask<emulators::StarFireNode>(name, device.receiver,
                                      Calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0}));
}
Layouts messages(const VehicleGatewayDeviceConfiguration& device, std::string_view name) {
  return ask<emulators::VehicleGateway>(name, settings_of(device));
}

Layouts messages(const XsensMtiConfiguration& device, std::string_view name) {
  return ask<emulators::Mti600>(name, device.mti, Calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0}));
}
Layouts messages(const EncoderDeviceConfiguration& device, std::string_view name) {
  NoFrames nowhere;
  emulators::VolatileMemory memory;
  return emulators::RotaryEncoder(device.encoder, memory, nowhere).messages(name);
}
Layouts messages(const IsoValvesConfiguration& device, std::string_view name) {
  return ask<emulators::IsoValves>(name, device.valves);
}

}  // namespace

Layouts bus_messages(const RigConfiguration& rig, const std::string& bus) {
  Layouts all;
  for (const auto& [name, device] : rig.devices) {
    std::visit(
        [&, device_name = std::string_view(name)](const auto& settings) {
          if constexpr (requires { messages(settings, device_name); }) {
            if (settings.bus == bus) {
              Layouts own = messages(settings, device_name);
              all.insert(all.end(), std::move_iterator(own.begin()), std::move_iterator(own.end()));
            }
          }
        },
        device.settings);
  }
  return all;
}

}  // namespace rigwire::hil
