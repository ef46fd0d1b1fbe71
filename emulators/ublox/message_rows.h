// How UbloxProfile::messages is written: single rows, and runs of rows that several types have in
// common, in the order in which one epoch puts them out.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "emulators/ublox/profile.h"
#include "protocols/ubx/identity.h"
#include "protocols/ubx/monitor.h"
#include "protocols/ubx/navigation.h"

namespace rigwire::emulators {

/// Returns the row of a message of fixed length.
template <class Message>
[[nodiscard]] constexpr UbloxMessage produced(std::string_view name, std::size_t repeated = 0) {
  return {Message::kId, name, protocols::ubx::frame_size<Message>() + repeated, false};
}
/// Returns the row of a message whose payload varies; `payload` is its maximum.
[[nodiscard]] constexpr UbloxMessage listed(protocols::ubx::MessageId id, std::string_view name,
                                            std::size_t payload) {
  return {id, name, protocols::ubx::kOverheadBytes + payload, false};
}
/// Returns the row of a message with a head and at most `blocks` blocks.
template <class Head, class Block>
[[nodiscard]] constexpr UbloxMessage listed(std::string_view name, std::size_t blocks) {
  return listed(Head::kId, name, Head::kLength + blocks * Block::kLength);
}
[[nodiscard]] constexpr UbloxMessage sentence(std::uint8_t id, std::string_view name,
                                              std::size_t bytes) {
  return {{0xF0, id}, name, bytes, true};
}
[[nodiscard]] constexpr UbloxMessage proprietary(std::uint8_t id, std::string_view name,
                                                 std::size_t bytes) {
  return {{0xF1, id}, name, bytes, true};
}
/// Returns the row without a rate in CFG-MSG: the message is sent only as an answer.
[[nodiscard]] constexpr UbloxMessage on_demand(UbloxMessage message) {
  message.periodic = false;
  return message;
}
/// Returns the row without an answer to a poll: the message is sent only by its rate or with its
/// event.
[[nodiscard]] constexpr UbloxMessage unasked(UbloxMessage message) {
  message.polled = false;
  return message;
}
/// An RTCM 3 message, by its rate only.
[[nodiscard]] constexpr UbloxMessage correction(std::uint8_t id, std::string_view name,
                                                std::size_t payload) {
  constexpr std::size_t kFrame = 3 /*header*/ + 3 /*checksum*/;
  return {{0xF5, id}, name, kFrame + payload, false, true, false, true};
}
[[nodiscard]] constexpr UbloxMessage version_row() {
  return listed(protocols::ubx::MonVerHead::kId, "MON-VER",
                protocols::ubx::MonVerHead::kLength +
                    7 /*extensions*/ * protocols::ubx::MonVerExtension::kLength);
}
/// A message that has a rate in CFG-MSG but is never sent: its content is not emulated.
[[nodiscard]] constexpr UbloxMessage silent(std::uint8_t message_class, std::uint8_t id) {
  return {{message_class, id}, {}, 0, message_class >= 0xF0, true, false};
}

/// Bytes of the longest forms that are not the same for all types: they follow the version of NMEA
/// and the number of systems and satellites.
struct SentenceLengths {
  std::size_t rmc = 0;
  std::size_t gga = 0;
  std::size_t gsa = 0;  ///< All sentences of one epoch; so gsv and grs.
  std::size_t gsv = 0;
  std::size_t gll = 0;
  std::size_t gbs = 0;
  std::size_t grs = 0;
  std::size_t gns = 0;
  std::size_t pubx03 = 0;
};
[[nodiscard]] constexpr std::array<UbloxMessage, 15> all_sentences(const SentenceLengths& longest) {
  return {sentence(0x04, "RMC", longest.rmc), sentence(0x05, "VTG", 46),
          sentence(0x00, "GGA", longest.gga), sentence(0x02, "GSA", longest.gsa),
          sentence(0x03, "GSV", longest.gsv), sentence(0x01, "GLL", longest.gll),
          sentence(0x07, "GST", 72),          sentence(0x08, "ZDA", 40),
          sentence(0x09, "GBS", longest.gbs), sentence(0x06, "GRS", longest.grs),
          sentence(0x0A, "DTM", 48),          sentence(0x0D, "GNS", longest.gns),
          proprietary(0x00, "PUBX,00", 130),  proprietary(0x03, "PUBX,03", longest.pubx03),
          proprietary(0x04, "PUBX,04", 72)};
}

/// Tracking channels of u-blox 8, and the usual most of u-blox 9.
inline constexpr std::size_t kModernSatellites = 32;

/// From u-blox 8 on.
inline constexpr std::array kModernTimes{
    produced<protocols::ubx::NavTimegps>("NAV-TIMEGPS"),
    produced<protocols::ubx::NavTimeutc>("NAV-TIMEUTC"),
    produced<protocols::ubx::NavTimeglo>("NAV-TIMEGLO"),
    produced<protocols::ubx::NavTimebds>("NAV-TIMEBDS"),
    produced<protocols::ubx::NavTimegal>("NAV-TIMEGAL"),
    produced<protocols::ubx::NavTimels>("NAV-TIMELS"),
    produced<protocols::ubx::NavClock>("NAV-CLOCK"),
    listed<protocols::ubx::NavSbasHead, protocols::ubx::NavSbasBlock>("NAV-SBAS",
                                                                      kModernSatellites),
};

/// Hardware and buffers.
inline constexpr std::array kHardware{
    produced<protocols::ubx::MonHw>("MON-HW"),
    produced<protocols::ubx::MonHw2>("MON-HW2"),
    listed<protocols::ubx::MonIoHead, protocols::ubx::MonIoPort>("MON-IO",
                                                                 protocols::ubx::kMonitorPorts),
    produced<protocols::ubx::MonMsgpp>("MON-MSGPP"),
    produced<protocols::ubx::MonRxbuf>("MON-RXBUF"),
    produced<protocols::ubx::MonTxbuf>("MON-TXBUF"),
    unasked(produced<protocols::ubx::MonRxr>("MON-RXR")),
};

/// What a receiver is, from u-blox 8 on.
inline constexpr std::array kModernIdentity{
    on_demand(version_row()),
    on_demand(produced<protocols::ubx::MonGnss>("MON-GNSS")),
    on_demand(produced<protocols::ubx::MonPatchHead>("MON-PATCH")),
    on_demand(produced<protocols::ubx::SecUniqid>("SEC-UNIQID")),
};

/// The rows of several arrays in one.
template <std::size_t... kRows>
[[nodiscard]] constexpr auto joined(const std::array<UbloxMessage, kRows>&... runs) {
  std::array<UbloxMessage, (kRows + ...)> all{};
  auto at = all.begin();
  ((at = std::ranges::copy(runs, at).out), ...);
  return all;
}

}  // namespace rigwire::emulators
