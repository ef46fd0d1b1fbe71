#include "hil/configuration/can_fault.h"

#include "emulators/can/can_node.h"
#include "protocols/can/frame_text.h"

namespace rigwire::hil {
namespace {

using emulators::CanBusFault;
using emulators::CanBusFaultKind;
using protocols::can::Frame;

std::string node_name(const std::string& device) {
  return device == kClientNode ? emulators::kCanOutsideName : device;
}

/// Address claimed (SAE J1939-81, 4.2.2): the NAME, least significant byte first, to everybody.
Frame address_claimed(unsigned address, std::uint64_t name) {
  constexpr std::uint32_t kAddressClaimed = 0x18EEFF00;
  Frame frame{kAddressClaimed | address, true, false, 8, {}};
  for (std::uint8_t& byte : frame.data) {
    byte = static_cast<std::uint8_t>(name);
    name >>= 8U;
  }
  return frame;
}

struct Converter {
  CanBusFault& fault;

  void operator()(const BitErrorsFault& p) const {
    fault.kind = CanBusFaultKind::bit_errors;
    fault.probability = p.probability;
  }
  void operator()(const DisturbanceFault& p) const {
    fault.kind = CanBusFaultKind::disturbance;
    if (p.bit >= 0) {
      fault.bit = static_cast<std::uint8_t>(p.bit);
    }
  }
  void operator()(const ShortCircuitFault&) const { fault.kind = CanBusFaultKind::short_circuit; }
  void operator()(const WrongRateFault& p) const {
    fault.kind = CanBusFaultKind::wrong_rate;
    fault.node = node_name(p.device);
    fault.bit_rate_bps = p.bit_rate_bps;
  }
  void operator()(const DisconnectedFault& p) const {
    fault.kind = CanBusFaultKind::disconnected;
    fault.node = node_name(p.device);
  }
  void operator()(const IntruderFault& p) const {
    fault.kind = CanBusFaultKind::intruder;
    fault.frame = protocols::can::parse_frame_text(p.frame).value_or(Frame{});
    fault.period = p.period;
  }
  void operator()(const DuplicateAddressFault& p) const {
    fault.kind = CanBusFaultKind::intruder;
    fault.frame = address_claimed(p.address, p.name);
    fault.period = p.period;
  }
};

}  // namespace

std::string device_of(const CanFaultConfiguration& fault) {
  return std::visit(
      [](const auto& settings) -> std::string {
        if constexpr (requires { settings.device; }) {
          return settings.device;
        } else {
          return {};
        }
      },
      fault.settings);
}

emulators::CanBusFaults can_bus_faults(const std::vector<CanFaultConfiguration>& faults,
                                       std::uint64_t seed) {
  emulators::CanBusFaults converted;
  converted.seed = seed;
  for (const CanFaultConfiguration& configuration : faults) {
    CanBusFault fault;
    fault.begin = configuration.at;
    fault.end = configuration.at + configuration.length;
    std::visit(Converter{fault}, configuration.settings);
    converted.list.push_back(std::move(fault));
  }
  return converted;
}

}  // namespace rigwire::hil
