#include <algorithm>
#include <charconv>
#include <optional>

#include "emulators/ublox/receiver.h"
#include "protocols/ubx/layout.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
namespace nmea = protocols::nmea;
namespace ubx = protocols::ubx;

constexpr std::uint8_t kClassConfiguration = 0x06;
constexpr Duration kUsualColdStart = 30s;

std::optional<std::uint32_t> to_unsigned(std::string_view text, int base) {
  std::uint32_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value, base);
  return text.empty() || error != std::errc{} || stop != end ? std::nullopt : std::optional(value);
}

}  // namespace

void UbloxReceiver::receive(SimTime now, std::span<const std::uint8_t> bytes) {
  advance(now);
  received_.bytes += bytes.size();
  while (!bytes.empty() && running_) {
    const std::size_t taken = std::min(bytes.size(), kInputBytes - input_size_);
    std::ranges::copy(bytes.first(taken),
                      input_.begin() + static_cast<std::ptrdiff_t>(input_size_));
    input_size_ += taken;
    bytes = bytes.subspan(taken);
    parse(now);
  }
  advance(now);
}

void UbloxReceiver::parse(SimTime now) {
  std::size_t at = 0;
  const auto garbage = [&]() {
    received_.malformed += in_garbage_ ? 0 : 1;
    in_garbage_ = true;
    ++at;
  };
  while (at < input_size_) {
    const auto rest = std::span<const std::uint8_t>(input_).subspan(at, input_size_ - at);
    if (rest[0] == ubx::kSync1) {
      const auto frame = ubx::decode_frame(rest, kMaximumPayload);
      if (frame.incomplete()) {
        break;
      }
      if (frame.ok()) {
        in_garbage_ = false;
        at += frame.consumed();
        handle(now, *frame);
        if (!running_) {  // reset: the rest of the line is lost
          input_size_ = 0;
          return;
        }
        continue;
      }
    } else if (rest[0] == '$') {
      const auto sentence = nmea::decode_sentence(rest);
      if (sentence.incomplete()) {
        break;
      }
      if (sentence.ok()) {
        in_garbage_ = false;
        at += sentence.consumed();
        handle(now, *sentence);
        continue;
      }
    } else if (rest[0] == '\r' || rest[0] == '\n') {
      ++at;
      continue;
    }
    garbage();
  }
  std::copy(input_.begin() + static_cast<std::ptrdiff_t>(at),
            input_.begin() + static_cast<std::ptrdiff_t>(input_size_), input_.begin());
  input_size_ -= at;
}

void UbloxReceiver::handle(SimTime now, const ubx::FrameView& frame) {
  if ((configuration_.uart().input_protocols & ubx::kProtocolUbx) == 0) {
    ++received_.ignored;
    return;
  }
  if (frame.id.message_class == kClassConfiguration) {
    handle_configuration(now, frame);
    return;
  }
  if (frame.id == ubx::MonVerHead::kId && frame.payload.empty()) {
    ++received_.accepted;
    if (speaks(ubx::kProtocolUbx)) {
      std::array<std::uint8_t, ubx::kOverheadBytes + 256> reply{};
      const std::size_t size = ubx::encode_frame(frame.id, version_, reply);
      send(now, std::span(reply).first(size));
    }
    return;
  }
  const std::size_t index = message_index(*settings_.profile, frame.id);
  if (frame.payload.empty() && index < settings_.profile->messages.size() &&
      settings_.profile->messages[index].greatest_bytes > 0) {
    ++received_.accepted;
    send_message(now, settings_.profile->messages[index]);
    return;
  }
  ++received_.ignored;  // acknowledgements exist for configuration only
}

void UbloxReceiver::handle_configuration(SimTime now, const ubx::FrameView& frame) {
  ++received_.accepted;
  if (const auto request = ubx::decode<ubx::CfgRst>(frame); request.ok()) {
    reset(now, *request);
    return;
  }
  if (configuration_.is_poll(frame)) {
    const auto payload = configuration_.poll(frame);
    if (payload && speaks(ubx::kProtocolUbx)) {
      std::array<std::uint8_t, ubx::kOverheadBytes + 1024> reply{};
      const std::size_t size = ubx::encode_frame(frame.id, *payload, reply);
      send(now, std::span(reply).first(size));
    }
    answer(now, frame.id, payload.has_value());
    return;
  }
  const ubx::CfgRate before = configuration_.rate();
  const bool accepted = configuration_.set(frame);
  if (accepted) {
    transmitter_.set_baud(configuration_.uart().baud);
    if (configuration_.rate() != before) {
      apply_configuration(now);
    }
  }
  answer(now, frame.id, accepted);
}

void UbloxReceiver::apply_configuration(SimTime now) {
  plan_from(now + 1ns);
}

void UbloxReceiver::answer(SimTime now, ubx::MessageId request, bool accepted) {
  accepted ? ++counters_.acknowledged : ++counters_.refused;
  if (!speaks(ubx::kProtocolUbx)) {
    return;
  }
  if (accepted) {
    send(now, ubx::encode(ubx::AckAck{request.message_class, request.message_id}));
  } else {
    send(now, ubx::encode(ubx::AckNak{request.message_class, request.message_id}));
  }
}

void UbloxReceiver::reset(SimTime now, const ubx::CfgRst& request) {
  constexpr std::uint8_t kGnssOnly = 2;
  constexpr std::uint8_t kStopGnss = 8;
  constexpr std::uint8_t kStartGnss = 9;
  const bool hot = request.clear_mask == 0;
  const Duration cold =
      settings_.time_to_first_fix > 0s ? settings_.time_to_first_fix : kUsualColdStart;
  const Duration time_to_first_fix = hot ? Duration{0} : cold;
  ++counters_.resets;
  switch (request.mode) {
    case 0:
    case 1:
    case 4:
      configuration_.reload();
      start(now, time_to_first_fix);
      transmitter_.set_baud(configuration_.uart().baud);
      return;
    case kGnssOnly:
      begin_navigation(now, time_to_first_fix);
      return;
    case kStopGnss:
      navigating_ = false;
      pending_count_ = 0;
      plan_ = {};
      return;
    case kStartGnss:
      navigating_ = true;
      begin_navigation(now, time_to_first_fix);
      plan_from(now + 1ns);
      return;
    default:
      --counters_.resets;
      answer(now, ubx::CfgRst::kId, false);
  }
}

void UbloxReceiver::handle(SimTime now, const nmea::SentenceView& sentence) {
  if ((configuration_.uart().input_protocols & ubx::kProtocolNmea) == 0) {
    ++received_.ignored;
    return;
  }
  bool known = false;
  if (sentence.address == "PUBX") {
    known = sentence.field(0) == "40"   ? handle_rate_command(sentence)
            : sentence.field(0) == "41" ? handle_port_command(sentence)
                                        : false;
  } else if (sentence.address.size() == 5 && sentence.type() == "GPQ") {
    const std::size_t index = message_index(*settings_.profile, sentence.field(0));
    known =
        index < settings_.profile->messages.size() && settings_.profile->messages[index].sentence;
    if (known) {
      send_message(now, settings_.profile->messages[index]);
    }
  }
  if (known) {
    ++received_.accepted;
  } else {
    ++received_.ignored;
    send_text(now, nmea::TextKind::warning, "NMEA unknown msg");
  }
}

bool UbloxReceiver::handle_rate_command(const nmea::SentenceView& s) {
  const std::size_t index = message_index(*settings_.profile, s.field(1));
  constexpr std::size_t kFirstRate = 2;
  if (index == settings_.profile->messages.size() || !settings_.profile->messages[index].sentence ||
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
  transmitter_.set_baud(configuration_.uart().baud);
  return true;
}

}  // namespace rigwire::emulators
