// Hydraulic valves on ISO 11783: bus, valves, levers, amplifier.
#include <fmt/format.h>

#include <array>
#include <memory>
#include <string>
#include <string_view>

#include "emulators/iso_valve/iso_valves.h"
#include "emulators/own_clock.h"
#include "fields/visitor.h"
#include "hil/devices/can_device.h"
#include "hil/devices/device_configuration.h"
#include "hil/devices/device_types.h"
#include "hil/devices/rig_check.h"
#include "hil/devices/valve_source.h"
#include "hil/world/ports.h"

namespace rigwire::hil {
namespace {

class IsoValvesDevice final : public CanDeviceOf<emulators::IsoValves, emulators::ValveBackend> {
 public:
  IsoValvesDevice(Site& site, const std::string& bus, const emulators::OwnClockSettings& clock,
                  const Faults& faults, const emulators::IsoValveSettings& settings)
      : CanDeviceOf(site, bus, clock, faults, settings),
        source_(emulator(), settings.amplifier.sections,
                valve_port(site.world().machine()).actuators()) {}
  [[nodiscard]] const ValveSource* valves() const override { return &source_; }

 private:
  ValveSource source_;
};

/// A block of auxiliary valves on a J1939 bus.
struct IsoValvesConfiguration final : DeviceConfigurationOf<IsoValvesConfiguration> {
  std::string bus = "can";  ///< One of the rig's buses.
  emulators::OwnClockSettings clock;
  std::vector<NodeFault<ValveSample, emulators::SupplyFault, emulators::PaceFault,
                        emulators::RefusalFault, emulators::ValveDefect>>
      faults;
  emulators::IsoValveSettings valves;

  void visit(fields::Visitor& v) override {
    visit_node(v, bus, clock, faults);
    emulators::visit(v, valves);
  }

  void validate() const override {
    emulators::IsoValveSettings settings = valves;
    settings.amplifier.defects = those_of<emulators::ValveDefect>(faults);
    emulators::validate(settings);
  }

  void check(const std::string& at, RigCheck& check) const override {
    check.j1939_node(at, bus, valves.source_address, valves.serial);
    check.valve_block(at, valves.amplifier.sections);
  }

  void each_fault(const FaultEar& take) override {
    show_faults(faults, take,
                [this](const auto& fault) { return valve_fault_name(fault, valves.amplifier); });
  }
  [[nodiscard]] std::vector<fields::Named> fault_kinds() const override {
    return mixed_kinds(faults);
  }
  [[nodiscard]] std::vector<LiveKey> live_keys() const override {
    return hil::live_keys(emulators::IsoValves::live_settings());
  }

  [[nodiscard]] DevicePlan plan(const RigView& rig) const override {
    return j1939_plan(rig, bus, valves.source_address, bus_share({})->frames_hz,
                      fmt::format("{} sections, neutral {} after the last command",
                                  valves.amplifier.sections.size(),
                                  fields::print_duration(valves.command_timeout.count())));
  }

  [[nodiscard]] std::optional<BusShare> bus_share(std::string_view name) const override {
    return asked<emulators::IsoValves>(bus_share_of(bus, name), valves);
  }

  [[nodiscard]] DeviceDescription describe() const override {
    DeviceDescription description;
    description.quantities = asked<emulators::IsoValves>(quantities_of, valves);
    description.wire = "CAN 2.0B at 250 kbit/s, J1939: SocketCAN or slcan on a pty";
    description.document =
        "ISO 11783-7 auxiliary valves as listed by isobus.net; SAE J1939 digital annex "
        "(joysticks); "
        "layouts in docs/devices/iso-valves.md";
    const auto layouts = asked<emulators::IsoValves>(
        [](const emulators::IsoValves& block) { return block.messages("valves"); }, valves);
    for (const auto& layout : layouts) {
      const bool sent = !layout.sender.empty();
      description.messages.push_back({fmt::format("{:08X} {}", layout.id, layout.name),
                                      fmt::format("{:g} Hz", 1e3 / layout.period_ms),
                                      (sent ? "sent: " : "received: ") + layout.text});
    }
    description.messages.push_back({"64982-64985 BJM1, EJM1, BJM2, EJM2", "10 Hz",
                                    "received: joysticks, where they are mapped"});
    description.messages.push_back({"65226 FECA DM1", "1 Hz", "sent: active trouble codes"});
    description.messages.push_back(
        {"65242, 65259, 64965, 64654", "on request",
         "sent: software, component, ECU identification, functionalities"});
    return description;
  }

  [[nodiscard]] std::unique_ptr<Device> make(Site& site) const override {
    emulators::IsoValveSettings settings = with_supply_faults(valves, faults);
    settings.amplifier.defects = those_of<emulators::ValveDefect>(faults);
    auto device = std::make_unique<IsoValvesDevice>(site, bus, clock,
                                                    node_faults<ValveSample>(faults), settings);
    device->hear(emulators::IsoValves::live_settings(), &IsoValvesConfiguration::valves);
    site.world().add(make_world_valves(device->enlist(site.executive()), site.world().machine(),
                                       valves.amplifier.sections));
    return device;
  }
};

}  // namespace

std::unique_ptr<DeviceConfiguration> fresh_iso_valves() {
  return std::make_unique<IsoValvesConfiguration>();
}

}  // namespace rigwire::hil
