// What clients say in UBX.
#include <algorithm>
#include <array>
#include <cmath>

#include "emulators/ublox/receiver.h"
#include "protocols/ubx/aiding.h"
#include "protocols/ubx/identity.h"
#include "protocols/ubx/layout.h"
#include "protocols/ubx/navigation.h"
#include "protocols/ubx/raw_measurements.h"

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
    } else if (rest[0] == protocols::rtcm3::kPreamble &&
               (configuration_.uart().input_protocols & ubx::kProtocolRtcm3) != 0) {
      const auto frame = protocols::rtcm3::decode_frame(rest);
      if (frame.incomplete()) {
        break;
      }
      if (frame.ok()) {
        in_garbage_ = false;
        at += frame.consumed();
        handle(now, *frame);
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
  ++port_.messages[0];
  last_request_.note(now, std::array{frame.id.message_class, frame.id.message_id});
  if (frame.id.message_class == kClassConfiguration) {
    handle_configuration(now, frame);
    return;
  }
  if (handle_command(now, frame) || handle_aiding(now, frame) || answer_poll(now, frame)) {
    ++received_.accepted;
  } else {
    // Acknowledgements exist for configuration only (R28, 32.5.1). A ZED-F9P stays silent, too: in
    // u-center's log it leaves polls of 0A 05 and 0C 35 without any answer.
    ++received_.ignored;
  }
}

/// Commands of other classes that are acknowledged.
bool UbloxReceiver::handle_command(SimTime now, const ubx::FrameView& frame) {
  if (profile_.odometer && frame.id == ubx::kNavResetodo && frame.payload.empty()) {
    navigator_.reset_odometer();
    answer(now, frame.id, true);
    return true;
  }
  constexpr std::array kOfLogger{ubx::kLogErase, ubx::kLogCreate, ubx::kLogRetrieve};
  if (profile_.logger && std::ranges::find(kOfLogger, frame.id) != kOfLogger.end()) {
    answer(now, frame.id, false);  // no data logger is emulated
    return true;
  }
  return false;
}

void UbloxReceiver::handle(SimTime now, const protocols::rtcm3::FrameView& frame) {
  constexpr std::size_t kProtocol = 5;
  ++port_.messages[kProtocol];
  ++received_.ignored;  // taken in, but no solution is made of it
  const std::size_t index = message_index(profile_, ubx::RxmRtcm::kId);
  if (index == profile_.messages.size() || configuration_.message_rate(index) == 0 ||
      !speaks(ubx::kProtocolUbx)) {
    return;
  }
  constexpr std::uint16_t kProprietary = 4072;
  constexpr std::uint16_t kNoStation = 0xFFFF;
  constexpr std::uint8_t kNotUsed = 1 << 1;
  const bool subtyped = frame.message() == kProprietary;
  const std::uint16_t second = frame.second_field();
  send(now, ubx::encode(ubx::RxmRtcm{.flags = kNotUsed,
                                     .subtype = subtyped ? second : std::uint16_t{0},
                                     .station = subtyped ? kNoStation : second,
                                     .message = frame.message()}));
}

bool UbloxReceiver::answer_raw(SimTime now, const ubx::FrameView& frame) {
  const std::size_t answers = raw_.answers(frame.id, frame.payload);
  std::array<std::uint8_t, kLongestRawFrame> answer{};
  for (std::size_t i = 0; i < answers && speaks(ubx::kProtocolUbx); ++i) {
    const std::size_t size = raw_.encode_answer(frame.id, frame.payload, i, answer);
    send(now, std::span(answer).first(size));
  }
  return answers > 0;
}

/// Only what the type has is answered: UbloxProfile::messages says it.
bool UbloxReceiver::answer_poll(SimTime now, const ubx::FrameView& frame) {
  const UbloxMessage* const message = polled_message(profile_, frame.id);
  if (message == nullptr) {
    return false;
  }
  if (UbloxRawMessages::handles(frame.id)) {
    return answer_raw(now, frame);
  }
  if (!frame.payload.empty()) {
    return false;
  }
  if (frame.id != ubx::MonVerHead::kId) {
    send_message(now, *message);
  } else if (speaks(ubx::kProtocolUbx)) {
    std::array<std::uint8_t, ubx::kOverheadBytes + 256> reply{};
    const std::size_t size = ubx::encode_frame(frame.id, version_, reply);
    send(now, std::span(reply).first(size));
  }
  return true;
}

bool UbloxReceiver::handle_aiding(SimTime now, const ubx::FrameView& frame) {
  const auto aid = ubx::decode<ubx::AidIni>(frame);
  if (!aid.ok() || polled_message(profile_, frame.id) == nullptr) {
    return false;
  }
  const auto has = [&](unsigned bit) { return (aid->flags >> bit & 1U) != 0; };
  if (has(0)) {
    const bool geodetic = has(5);
    const auto& p = aid->position;
    const Geodetic given = geodetic ? Geodetic{p[0] * 1e-7, p[1] * 1e-7, p[2] * 0.01}
                                    : geodetic_from_ecef({p[0] * 0.01, p[1] * 0.01, p[2] * 0.01});
    if (std::abs(given.latitude_deg) <= 90.0 && std::abs(given.longitude_deg) <= 180.0) {
      navigator_.aid_position(given, aid->position_accuracy_cm * 0.01);
    }
  }
  if (has(1)) {
    navigator_.aid_time(now, configuration_);
  }
  if (configuration_.expert().acknowledge_aiding != 0) {
    answer(now, frame.id, true);
  }
  return true;
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
      begin_navigation(now, memory);
      return;
    case kStopGnss:
      navigating_ = false;
      pending_count_ = 0;
      plan_ = {};
      return;
    case kStartGnss:
      navigating_ = true;
      begin_navigation(now, memory);
      plan_from(now + 1ns);
      return;
    default:
      --counters_.resets;
      answer(now, ubx::CfgRst::kId, false);
  }
}

}  // namespace rigwire::emulators
