// What clients say in NMEA: PUBX commands and queries.
#include <algorithm>
#include <charconv>
#include <optional>

#include "emulators/ublox/receiver.h"

namespace rigwire::emulators {
namespace {

namespace nmea = protocols::nmea;
namespace ubx = protocols::ubx;

std::optional<std::uint32_t> to_unsigned(std::string_view text, int base) {
  std::uint32_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value, base);
  return text.empty() || error != std::errc{} || stop != end ? std::nullopt : std::optional(value);
}

}  // namespace

void UbloxReceiver::handle(SimTime now, const nmea::SentenceView& sentence) {
  if ((configuration_.uart().input_protocols & ubx::kProtocolNmea) == 0) {
    ++received_.ignored;
    return;
  }
  ++port_.messages[1];
  note_request(now, sentence);
  const bool known =
      sentence.address == "PUBX" ? handle_proprietary(now, sentence) : handle_query(now, sentence);
  if (known) {
    ++received_.accepted;
  } else {
    ++received_.ignored;
    send_text(now, nmea::TextKind::warning, "NMEA unknown msg");
  }
}

void UbloxReceiver::note_request(SimTime now, const nmea::SentenceView& sentence) {
  std::array<std::uint8_t, LastRequest::kHeadBytes> head{'$'};
  std::size_t size = 1;
  for (const std::string_view part : {sentence.address, std::string_view(","), sentence.field(0)}) {
    const std::size_t count = std::min(part.size(), head.size() - size);
    std::copy_n(part.begin(), count, head.begin() + static_cast<std::ptrdiff_t>(size));
    size += count;
  }
  last_request_.note(now, std::span(head).first(size));
}

bool UbloxReceiver::handle_proprietary(SimTime now, const nmea::SentenceView& s) {
  const std::string_view number = s.field(0);
  if (number == "40") return handle_rate_command(s);
  if (number == "41") return handle_port_command(s);
  if (s.field_count == 1 && (number == "00" || number == "03" || number == "04")) {
    send_sentence(now, number == "00" ? "PUBX,00" : number == "03" ? "PUBX,03" : "PUBX,04");
    return true;
  }
  return false;
}

bool UbloxReceiver::handle_query(SimTime now, const nmea::SentenceView& s) {
  if (s.address.size() != 5 || s.type() != "GPQ") {
    return false;
  }
  const std::size_t index = message_index(profile_, s.field(0));
  if (index == profile_.messages.size() || !profile_.messages[index].sentence) {
    return false;
  }
  send_message(now, profile_.messages[index]);
  return true;
}

bool UbloxReceiver::handle_rate_command(const nmea::SentenceView& s) {
  const std::size_t index = message_index(profile_, s.field(1));
  constexpr std::size_t kFirstRate = 2;
  if (index == profile_.messages.size() || !profile_.messages[index].sentence ||
      s.field_count < kFirstRate + ubx::kPorts) {
    return false;
  }
  std::array<std::uint8_t, ubx::kPorts> rates{};
  for (std::size_t port = 0; port < rates.size(); ++port) {
    const auto rate = to_unsigned(s.field(kFirstRate + port), 10);
    if (!rate || *rate > 255) {
      return false;
    }
    rates[port] = static_cast<std::uint8_t>(*rate);
  }
  for (std::size_t port = 0; port < rates.size(); ++port) {
    configuration_.set_rate(index, port, rates[port]);
  }
  return true;
}

bool UbloxReceiver::handle_port_command(const nmea::SentenceView& s) {
  const auto port = to_unsigned(s.field(1), 10);
  const auto input = to_unsigned(s.field(2), 16);
  const auto output = to_unsigned(s.field(3), 16);
  const auto baud = to_unsigned(s.field(4), 10);
  if (!port || !input || !output || !baud || *port != ubx::kPortUart1) {
    return false;
  }
  ubx::CfgPrt wanted = configuration_.uart();
  wanted.baud = *baud;
  wanted.input_protocols = static_cast<std::uint16_t>(*input & 0xFFFFU);
  wanted.output_protocols = static_cast<std::uint16_t>(*output & 0xFFFFU);
  if (!configuration_.set_port(wanted)) {
    return false;
  }
  set_baud(configuration_.uart().baud);
  return true;
}

}  // namespace rigwire::emulators
