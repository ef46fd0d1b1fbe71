// What clients say in UBX.
#include <algorithm>

#include "emulators/ublox/receiver.h"
#include "protocols/ubx/layout.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
namespace nmea = protocols::nmea;
namespace ubx = protocols::ubx;

constexpr std::uint8_t kClassConfiguration = 0x06;

}  // namespace

void UbloxReceiver::receive(SimTime now, std::span<const std::uint8_t> bytes) {
  advance(now);
  received_.bytes += bytes.size();
  if (!running_) {
    return;
  }
  port_.bytes += static_cast<std::uint32_t>(bytes.size());
  if (!quality_.matched()) {
    port_.framing_errors = static_cast<std::uint16_t>(port_.framing_errors + bytes.size());
    ++received_.malformed;
    return;
  }
  follow_line_noise(now);
  if (!quality_.noisy()) {
    take_in(now, bytes);
  }
  std::array<std::uint8_t, 256> disturbed{};
  while (quality_.noisy() && !bytes.empty()) {
    const std::size_t taken = std::min(bytes.size(), disturbed.size());
    std::ranges::copy(bytes.first(taken), disturbed.begin());
    const auto piece = std::span(disturbed).first(taken);
    quality_.disturb(piece);
    take_in(now, piece);
    bytes = bytes.subspan(taken);
  }
  advance(now);
}

void UbloxReceiver::take_in(SimTime now, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty() && running_) {
    const std::size_t taken = std::min(bytes.size(), kInputBytes - input_size_);
    std::ranges::copy(bytes.first(taken),
                      input_.begin() + static_cast<std::ptrdiff_t>(input_size_));
    input_size_ += taken;
    port_.peak_bytes = std::max(port_.peak_bytes, input_size_);
    bytes = bytes.subspan(taken);
    parse(now);
  }
}

void UbloxReceiver::parse(SimTime now) {
  std::size_t at = 0;
  const auto garbage = [&]() {
    received_.malformed += in_garbage_ ? 0 : 1;
    in_garbage_ = true;
    ++port_.skipped;
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
  const std::size_t index = message_index(profile_, frame.id);
  if (frame.payload.empty() && index < profile_.messages.size() &&
      profile_.messages[index].greatest_bytes > 0) {
    ++received_.accepted;
    send_message(now, profile_.messages[index]);
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
    set_baud(configuration_.uart().baud);
    if (configuration_.rate() != before) {
      plan_from(now + 1ns);
    }
  }
  answer(now, frame.id, accepted);
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
  const UbloxMemory memory = UbloxMemory::after_clearing(request.clear_mask);
  ++counters_.resets;
  switch (request.mode) {
    case 0:
    case 1:
    case 4:
      configuration_.reload();
      start(now, memory);
      return;
    case kGnssOnly:
      pending_count_ = 0;
      navigator_.begin(now, memory, configuration_);
      return;
    case kStopGnss:
      navigating_ = false;
      pending_count_ = 0;
      plan_ = {};
      return;
    case kStartGnss:
      navigating_ = true;
      navigator_.begin(now, memory, configuration_);
      plan_from(now + 1ns);
      return;
    default:
      --counters_.resets;
      answer(now, ubx::CfgRst::kId, false);
  }
}

}  // namespace rigwire::emulators
