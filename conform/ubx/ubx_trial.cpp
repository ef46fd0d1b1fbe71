#include "conform/ubx/ubx_trial.h"

#include <algorithm>
#include <array>

#include "protocols/rtcm3/frame.h"

namespace rigwire::conform {

namespace ubx = protocols::ubx;
using std::chrono::milliseconds;

namespace {

constexpr UbxId kAck{0x05, 0x01};
constexpr UbxId kNak{0x05, 0x00};
constexpr std::uint8_t kClassConfiguration = 0x06;
constexpr std::size_t kLongestPayload = 8192;
constexpr std::size_t kLongestSentence = 1024;

/// The sentence that `bytes` begin with: its bytes, 0 while its end has not come; nothing where it
/// is none.
std::optional<std::size_t> sentence_in(std::span<const std::uint8_t> bytes) {
  unsigned check = 0;
  std::optional<std::size_t> star;
  for (std::size_t i = 1; i < std::min(bytes.size(), kLongestSentence); ++i) {
    const std::uint8_t byte = bytes[i];
    if (byte == '\n') {
      const std::string_view digits = "0123456789ABCDEF";
      const bool checked = star && i == *star + 4 && bytes[i - 1] == '\r' &&
                           bytes[*star + 1] == static_cast<std::uint8_t>(digits[check >> 4U]) &&
                           bytes[*star + 2] == static_cast<std::uint8_t>(digits[check & 15U]);
      return checked ? std::optional(i + 1) : std::nullopt;
    }
    if (byte != '\r' && (byte < 0x20 || byte > 0x7E)) {
      return std::nullopt;
    }
    if (byte == '*') {
      star = i;
    }
    check ^= star ? 0U : byte;
  }
  return bytes.size() < kLongestSentence ? std::optional<std::size_t>(0) : std::nullopt;
}

bool answers(const UbxHeard& heard, UbxId id) {
  return heard.kind == UbxHeard::Kind::frame && heard.id == id;
}

bool acknowledges(const UbxHeard& heard, UbxId id) {
  return (answers(heard, kAck) || answers(heard, kNak)) &&
         heard.payload() == UbxBytes{id.message_class, id.message_id};
}

}  // namespace

UbxBytes u2(unsigned value) {
  return {static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8U)};
}

UbxBytes u4(std::uint32_t value) {
  return u2(value & 0xFFFFU) + u2(value >> 16U);
}

bool UbxClaims::has(std::string_view message) const {
  return std::ranges::find(messages, message) != messages.end();
}

UbxBytes UbxHeard::payload() const {
  return {bytes.begin() + ubx::kHeaderBytes,
          bytes.end() - static_cast<std::ptrdiff_t>(ubx::kChecksumBytes)};
}

std::string UbxHeard::text() const {
  return {bytes.begin(), bytes.end() - 2 /*CR LF*/};
}

UbxTrial::UbxTrial(CaseIdentity identity, UbxDevice& device)
    : Trial(std::move(identity),
            [&device] { return device.line ? device.line->now() : ByteLine::Clock::time_point(); }),
      device_(&device) {
  if (device_->line == nullptr || device_->line->closed()) {
    device_->line.reset();
    device_->arrived.clear();
    device_->synchronized = false;
    device_->bounds->check();
    device_->line = bounded(device_->open(), device_->bounds);
    restart_clock();
  }
  drain();
}

std::optional<UbxHeard> UbxTrial::take(bool& more) {
  UbxBytes& all = device_->arrived;
  std::size_t at = 0;
  std::size_t size = 0;
  UbxHeard heard;
  more = true;
  for (; at < all.size() && size == 0; ++at) {
    const auto rest = std::span<const std::uint8_t>(all).subspan(at);
    bool incomplete = false;
    if (rest[0] == ubx::kSync1) {
      const auto frame = ubx::decode_frame(rest, kLongestPayload);
      incomplete = frame.incomplete();
      if (frame.ok()) {
        heard.kind = UbxHeard::Kind::frame;
        heard.id = frame->id;
        size = frame.consumed();
      }
    } else if (rest[0] == '$') {
      const auto sentence = sentence_in(rest);
      incomplete = sentence == std::size_t{0};
      heard.kind = UbxHeard::Kind::sentence;
      size = sentence.value_or(0);
    } else if (rest[0] == protocols::rtcm3::kPreamble) {
      const auto frame = protocols::rtcm3::decode_frame(rest);
      incomplete = frame.incomplete();
      heard.kind = UbxHeard::Kind::rtcm;
      size = frame.ok() ? frame.consumed() : 0;
    }
    if (size > 0 || incomplete) {
      break;
    }
  }
  if (at > 0 && device_->synchronized && fine()) {  // Once is enough: noise has no end.
    const UbxBytes between(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(at));
    received(between, "none of UBX, NMEA and RTCM");
    demand(false, "whole frames, sentences and messages with right checks alone",
           hex_text(between, 16));
  }
  if (size > 0) {
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(at);
    heard.bytes.assign(begin, begin + static_cast<std::ptrdiff_t>(size));
    heard.at = now();
    device_->synchronized = true;
  } else {
    more = false;
  }
  all.erase(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(at + size));
  return size > 0 ? std::optional(heard) : std::nullopt;
}

std::optional<UbxHeard> UbxTrial::hear(ByteLine::Clock::time_point deadline) {
  while (true) {
    bool more = false;
    if (auto heard = take(more)) {
      return heard;
    }
    if (!device_->line->receive(device_->arrived, deadline)) {
      return std::nullopt;
    }
  }
}

std::vector<UbxHeard> UbxTrial::listen(std::chrono::nanoseconds span) {
  std::vector<UbxHeard> all;
  const auto deadline = now() + span;
  while (auto heard = hear(deadline)) {
    all.push_back(std::move(*heard));
  }
  return all;
}

void UbxTrial::drain() {
  const auto end = now() + kDrain;
  while (now() < end && hear(now() + milliseconds(1))) {
  }
}

void UbxTrial::show(const UbxHeard& heard) {
  received(heard.bytes, heard.kind == UbxHeard::Kind::frame ? ubx_words(heard.id, heard.payload())
                        : heard.kind == UbxHeard::Kind::sentence ? heard.text()
                                                                 : "RTCM 3");
}

UbxBytes UbxTrial::framed(UbxId id, const UbxBytes& payload) {
  UbxBytes frame(ubx::kOverheadBytes + payload.size());
  static_cast<void>(ubx::encode_frame(id, payload, frame));
  return frame;
}

bool UbxTrial::send(const UbxBytes& bytes, std::string words) {
  sent(bytes, std::move(words));
  asked_ = now();
  return expect(device_->line->send(bytes), "the receiver takes what is sent",
                "the line is closed");
}

bool UbxTrial::send(UbxId id, const UbxBytes& payload) {
  return send(framed(id, payload), ubx_words(id, payload));
}

std::optional<UbxPayload> UbxTrial::poll(std::string_view name) {
  const UbxMessage& message = *ubx_message(name);
  return poll(name, {message.selector.begin(), message.selector.end()});
}

std::optional<UbxPayload> UbxTrial::poll(std::string_view name, const UbxBytes& selector) {
  const UbxMessage& message = *ubx_message(name);
  const std::string asked(name);
  if (!send(framed(message.id, selector), "poll of " + asked)) {
    return std::nullopt;
  }
  const bool configuration = message.id.message_class == kClassConfiguration;
  const auto deadline = asked_ + claims().patience;
  std::optional<UbxPayload> found;
  bool complete = !configuration;
  while (auto heard = hear(deadline)) {
    if (answers(*heard, message.id)) {
      show(*heard);
      took_ = heard->at - asked_;
      if (!found) {
        found.emplace(message, heard->payload());
      }
    } else if (configuration && acknowledges(*heard, message.id)) {
      show(*heard);
      const bool kept = expect(answers(*heard, kAck), "ACK-ACK behind " + asked, "ACK-NAK") &&
                        expect(found.has_value(), asked + " before its acknowledgement",
                               "the acknowledgement first");
      if (!kept) {
        return std::nullopt;
      }
      complete = true;
      break;
    } else {
      continue;
    }
    if (found && !configuration) {
      break;
    }
  }
  const bool came =
      expect(found.has_value(),
             asked + " within " + std::to_string(claims().patience.count()) + " ms", "none");
  if (!came || !expect(complete, "ACK-ACK behind " + asked, "none") ||
      !demand(found->whole(), asked + " of " + found->lengths(),
              std::to_string(found->bytes().size()) + " bytes")) {
    return std::nullopt;
  }
  return found;
}

std::optional<UbxTrial::Payloads> UbxTrial::together(const std::vector<std::string_view>& names) {
  constexpr int kTries = 5;
  UbxBytes request;
  std::string words = "polls of";
  for (const std::string_view name : names) {
    const UbxMessage& message = *ubx_message(name);
    request = request + framed(message.id, {message.selector.begin(), message.selector.end()});
    words += " " + std::string(name);
  }
  for (int i = 0; i < kTries && fine(); ++i) {
    if (!send(request, words)) {
      return std::nullopt;
    }
    Payloads all;
    const auto deadline = asked_ + claims().patience;
    while (all.size() < names.size()) {
      const auto heard = hear(deadline);
      if (!heard) {
        break;
      }
      const UbxMessage* const known =
          heard->kind == UbxHeard::Kind::frame ? ubx_message(heard->id) : nullptr;
      if (known != nullptr && std::ranges::find(names, known->name) != names.end()) {
        show(*heard);
        all.insert_or_assign(known->name, UbxPayload(*known, heard->payload()));
      }
    }
    std::optional<double> epoch;
    bool one = true;
    for (const std::string_view name : names) {
      const auto found = all.find(name);
      if (!expect(found != all.end(), "an answer to each poll", "none to " + std::string(name)) ||
          !demand(found->second.whole(), std::string(name) + " of " + found->second.lengths(),
                  std::to_string(found->second.bytes().size()) + " bytes")) {
        return std::nullopt;
      }
      if (found->second.has("iTOW")) {
        const double time = found->second.value("iTOW");
        one = one && (!epoch || *epoch == time);
        epoch = time;
      }
    }
    if (one) {
      return all;
    }
    drain();
  }
  expect(false, "the same iTOW in all messages of one epoch", "never in five tries");
  return std::nullopt;
}

std::optional<bool> UbxTrial::acknowledged(UbxId id, const UbxBytes& payload) {
  if (!send(id, payload)) {
    return std::nullopt;
  }
  const auto deadline = asked_ + claims().patience;
  while (const auto heard = hear(deadline)) {
    if (acknowledges(*heard, id)) {
      show(*heard);
      took_ = heard->at - asked_;
      return answers(*heard, kAck);
    }
  }
  expect(false, "ACK-ACK or ACK-NAK within " + std::to_string(claims().patience.count()) + " ms",
         "neither");
  return std::nullopt;
}

bool UbxTrial::accepts(std::string_view name, const UbxBytes& payload) {
  const auto answer = acknowledged(ubx_message(name)->id, payload);
  return answer && expect(*answer, "ACK-ACK of " + std::string(name), "ACK-NAK");
}

bool UbxTrial::refuses(UbxId id, const UbxBytes& payload) {
  const auto answer = acknowledged(id, payload);
  return answer && expect(!*answer, "ACK-NAK of " + ubx_name(id), "ACK-ACK");
}

std::optional<std::vector<UbxHeard>> UbxTrial::until_version() {
  const UbxId version = ubx_message("MON-VER")->id;
  if (!send(version, {})) {
    return std::nullopt;
  }
  std::vector<UbxHeard> before;
  const auto deadline = asked_ + claims().patience;
  while (auto heard = hear(deadline)) {
    if (answers(*heard, version)) {
      show(*heard);
      return before;
    }
    if (heard->kind == UbxHeard::Kind::frame) {
      before.push_back(std::move(*heard));
    }
  }
  expect(false, "MON-VER within " + std::to_string(claims().patience.count()) + " ms", "none");
  return std::nullopt;
}

bool UbxTrial::ignores(const UbxBytes& bytes, const std::string& words) {
  if (!send(bytes, words)) {
    return false;
  }
  const auto before = until_version();
  if (!before) {
    return false;
  }
  for (const UbxHeard& heard : *before) {
    if (heard.id.message_class == kAck.message_class ||
        heard.id.message_class == kClassConfiguration || heard.id.message_class == 0x0A) {
      show(heard);
      return expect(false, "no answer to " + words, ubx_words(heard.id, heard.payload()));
    }
  }
  return expect(true, "no answer to " + words, "");
}

}  // namespace rigwire::conform
