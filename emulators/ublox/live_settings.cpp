// Settings of a u-blox receiver that can be changed at run time: by the UBX-CFG messages of its own
// software.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "emulators/ublox/receiver.h"
#include "protocols/ubx/configuration.h"

namespace rigwire::emulators {

namespace ubx = protocols::ubx;

namespace {

template <class Message>
std::string_view tell(UbloxReceiver& receiver, SimTime now, const Message& message) {
  const auto frame = ubx::encode(message);
  return receiver.configure(
      now, {Message::kId, std::span(frame).subspan(ubx::kHeaderBytes, Message::kLength)});
}

/// CFG-MSG for each message of that kind whose being on at the port differs.
template <class IsOf>
std::string_view switch_messages(UbloxReceiver& receiver, SimTime now, std::size_t port,
                                 const std::vector<std::string>& wanted, const IsOf& is_of) {
  const UbloxConfiguration& present = receiver.configuration();
  const auto& messages = present.profile().messages;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const UbloxMessage& message = messages[i];
    const bool on = std::ranges::count(wanted, message.name) > 0;
    if (!message.periodic || !is_of(message) || on == (present.message_rate(i, port) != 0)) {
      continue;
    }
    ubx::CfgMsg rates{message.id.message_class, message.id.message_id, present.present().rates[i]};
    rates.rates[port] = on ? 1 : 0;
    if (const std::string_view why = tell(receiver, now, rates); !why.empty()) {
      return why;
    }
  }
  return "";
}

std::string_view change_speed(UbloxReceiver& receiver, SimTime now, std::size_t port,
                              std::uint32_t baud) {
  ubx::CfgPrt wanted = receiver.configuration().present().ports[port];
  wanted.baud = baud;
  return tell(receiver, now, wanted);
}

}  // namespace

std::string_view UbloxReceiver::configure(SimTime now, const ubx::FrameView& frame) {
  advance(now);
  if (!running_) {
    return "it has no supply, or starts up";
  }
  return !refuses(now) && set(now, frame) ? "" : "it refuses the message";
}

std::span<const UbloxReceiver::Live> UbloxReceiver::live_settings() {
  using Settings = UbloxSettings;
  static constexpr std::array<Live, 6> kRows{{
      {"rate", "CFG-RATE",
       [](UbloxReceiver& receiver, SimTime now, const Settings& wanted) {
         ubx::CfgRate rate = receiver.configuration_.rate();
         rate.measurement_period_ms =
             static_cast<std::uint16_t>(wanted.measurement_period / std::chrono::milliseconds{1});
         rate.navigation_ratio = 1;
         return tell(receiver, now, rate);
       }},
      {"baud", "CFG-PRT",
       [](UbloxReceiver& receiver, SimTime now, const Settings& wanted) {
         return change_speed(receiver, now, ubx::kPortUart1, wanted.baud);
       }},
      {"nmea_sentences", "CFG-MSG",
       [](UbloxReceiver& receiver, SimTime now, const Settings& wanted) {
         return switch_messages(receiver, now, ubx::kPortUart1, wanted.nmea_sentences,
                                [](const UbloxMessage& message) { return message.sentence; });
       }},
      {"ubx_messages", "CFG-MSG",
       [](UbloxReceiver& receiver, SimTime now, const Settings& wanted) {
         return switch_messages(receiver, now, ubx::kPortUart1, wanted.ubx_messages,
                                [](const UbloxMessage& message) { return !message.sentence; });
       }},
      {"uart2_messages", "CFG-MSG",
       [](UbloxReceiver& receiver, SimTime now, const Settings& wanted) {
         return switch_messages(receiver, now, ubx::kPortUart2, wanted.uart2_messages,
                                [](const UbloxMessage& message) { return message.rtcm; });
       }},
      {"uart2_baud", "CFG-PRT",
       [](UbloxReceiver& receiver, SimTime now, const Settings& wanted) {
         return change_speed(receiver, now, ubx::kPortUart2, wanted.uart2_baud);
       }},
  }};
  return kRows;
}

}  // namespace rigwire::emulators
