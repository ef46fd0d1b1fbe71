// CFG-PRT, CFG-MSG, CFG-INF and CFG-CFG: what goes over which port, and what is kept.
#include <algorithm>

#include "emulators/ublox/configuration.h"

namespace rigwire::emulators {
namespace {

using namespace protocols::ubx;
using Payload = std::span<const std::uint8_t>;

constexpr std::uint32_t kFraming8N1 = 0x08C0;
constexpr std::uint32_t kFramingMask = 0x3EC0;

}  // namespace

bool UbloxConfiguration::set_port(const CfgPrt& port) {
  if (port.port >= present_.ports.size()) {
    return false;
  }
  const bool uart = port.port == kPortUart1;
  if (uart && ((port.mode & kFramingMask) != kFraming8N1 || port.baud > profile_->greatest_baud ||
               std::ranges::find(ublox_bauds(), port.baud) == ublox_bauds().end())) {
    return false;
  }
  CfgPrt& present = present_.ports[port.port];
  present = port;
  present.input_protocols =
      static_cast<std::uint16_t>(port.input_protocols & profile_->input_protocols);
  present.output_protocols =
      static_cast<std::uint16_t>(port.output_protocols & profile_->output_protocols);
  return true;
}

bool UbloxConfiguration::set_ports(Payload payload) {
  if (payload.empty() || payload.size() % CfgPrt::kLength != 0) {
    return false;
  }
  const UbloxConfigurationState before = present_;
  for (std::size_t at = 0; at < payload.size(); at += CfgPrt::kLength) {
    if (!set_port(read_payload<CfgPrt>(payload.subspan(at)))) {
      present_ = before;
      return false;
    }
  }
  return true;
}

bool UbloxConfiguration::set_rate(std::size_t index, std::size_t port, std::uint8_t rate) {
  if (index >= profile_->messages.size() || !profile_->messages[index].periodic || port >= kPorts) {
    return false;
  }
  present_.rates[index][port] = rate;
  return true;
}

bool UbloxConfiguration::set_message(Payload payload) {
  if (payload.size() != 3 && payload.size() != CfgMsg::kLength) {
    return false;
  }
  const std::size_t index = message_index(*profile_, MessageId{payload[0], payload[1]});
  if (payload.size() == 3) {
    return set_rate(index, kPortUart1, payload[2]);
  }
  const auto wanted = read_payload<CfgMsg>(payload);
  if (index == profile_->messages.size() || !profile_->messages[index].periodic) {
    return false;
  }
  present_.rates[index] = wanted.rates;
  return true;
}

bool UbloxConfiguration::set_information(Payload payload) {
  if (payload.empty() || payload.size() % CfgInf::kLength != 0) {
    return false;
  }
  auto wanted = present_.information;
  for (std::size_t at = 0; at < payload.size(); at += CfgInf::kLength) {
    const auto block = read_payload<CfgInf>(payload.subspan(at));
    const auto found = std::ranges::find(wanted, block.protocol, &CfgInf::protocol);
    if (found == wanted.end()) {
      return false;
    }
    *found = block;
  }
  present_.information = wanted;
  return true;
}

bool UbloxConfiguration::set_store(Payload payload) {
  if (payload.size() != CfgCfg::kLength && payload.size() != CfgCfg::kLength + 1 /*devices*/) {
    return false;
  }
  const auto masks = read_payload<CfgCfg>(payload);
  copy_sections(default_, saved_, masks.clear_mask);
  copy_sections(present_, saved_, masks.save_mask);
  copy_sections(saved_, present_, masks.load_mask);
  return true;
}

}  // namespace rigwire::emulators
