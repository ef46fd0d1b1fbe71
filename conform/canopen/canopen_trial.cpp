#include "conform/canopen/canopen_trial.h"

#include <algorithm>
#include <array>
#include <cstdio>

namespace rigwire::conform {

using std::chrono::milliseconds;

namespace {

struct AbortCode {
  std::uint32_t code;
  std::string_view words;
};
// CiA 301 V4.2.0, table 22.
constexpr std::array<AbortCode, 20> kAborts{{{0x05030000, "toggle bit not alternated"},
                                             {0x05040000, "SDO timed out"},
                                             {0x05040001, "command not valid or unknown"},
                                             {0x06010000, "unsupported access"},
                                             {0x06010001, "read of a write-only object"},
                                             {0x06010002, "write of a read-only object"},
                                             {0x06020000, "no such object"},
                                             {0x06040041, "cannot be mapped"},
                                             {0x06040042, "mapping too long"},
                                             {0x06040043, "parameter incompatible"},
                                             {0x06060000, "hardware error"},
                                             {0x06070010, "length does not match"},
                                             {0x06070012, "too long"},
                                             {0x06070013, "too short"},
                                             {0x06090011, "no such sub-index"},
                                             {0x06090030, "value not allowed"},
                                             {0x06090031, "value too high"},
                                             {0x06090032, "value too low"},
                                             {0x08000020, "cannot be stored"},
                                             {0x08000022, "not in this state"}}};

std::string hex_number(std::uint32_t value, int digits) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%0*X", digits, value);
  return text.data();
}

std::uint32_t number_in(std::span<const std::uint8_t> bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(4, bytes.size()); ++i) {
    value |= std::uint32_t{bytes[i]} << (8 * i);
  }
  return value;
}

CanBytes initiate(std::uint8_t command, ObjectName object) {
  return {command, static_cast<std::uint8_t>(object.index),
          static_cast<std::uint8_t>(object.index >> 8U), object.sub};
}

constexpr std::uint8_t kAbort = 0x80;

}  // namespace

CanBytes little(std::uint32_t value, std::size_t bytes) {
  CanBytes all;
  for (std::size_t i = 0; i < bytes; ++i) {
    all.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
  return all;
}

std::string text_of(ObjectName object) {
  return hex_number(object.index, 4) + ":" + std::to_string(object.sub);
}

std::string abort_text(std::uint32_t code) {
  const auto* const known = std::ranges::find(kAborts, code, &AbortCode::code);
  return hex_number(code, 8) +
         (known == kAborts.end() ? "" : " (" + std::string(known->words) + ")");
}

bool CanopenClaims::has(ObjectName object) const {
  return std::ranges::find(objects, object) != objects.end();
}

std::uint32_t SdoResult::number() const {
  return number_in(data);
}

std::string SdoResult::text() const {
  return abort ? "abort " + abort_text(*abort) : hex_text(data, 16);
}

CanopenTrial::CanopenTrial(CaseIdentity identity, CanopenDevice& device)
    : Trial(std::move(identity), [&device] { return device.line->now(); }), device_(&device) {
  drain();
}

void CanopenTrial::drain() {
  const auto end = now() + kDrain;
  while (now() < end && device_->line->receive(now())) {
  }
}

bool CanopenTrial::send(const Frame& frame, std::string words) {
  sent(step_bytes(frame), frame_text(frame) + ": " + std::move(words));
  return expect(device_->line->send(frame), "the bus takes a frame", "it does not");
}

bool CanopenTrial::send(std::uint32_t id, CanBytes bytes, std::string words) {
  Frame frame;
  frame.id = id;
  frame.length = static_cast<std::uint8_t>(bytes.size());
  std::ranges::copy(bytes, frame.data.begin());
  return send(frame, std::move(words));
}

bool CanopenTrial::request(CanBytes bytes, std::string words) {
  bytes.resize(8);
  return send(with_node(0x600), std::move(bytes), std::move(words));
}

std::optional<Frame> CanopenTrial::hear(std::uint32_t id, std::chrono::nanoseconds within) {
  const auto deadline = now() + within;
  while (const auto frame = device_->line->receive(deadline)) {
    if (!frame->extended && !frame->remote && frame->id == id) {
      received(step_bytes(*frame), frame_text(*frame));
      return frame;
    }
  }
  return std::nullopt;
}

std::vector<CanopenTrial::Heard> CanopenTrial::listen(std::uint32_t id,
                                                      std::chrono::nanoseconds span) {
  constexpr std::size_t kShown = 8;
  std::vector<Heard> all;
  drain();
  const auto begin = now();
  while (const auto frame = device_->line->receive(begin + span)) {
    if (!frame->extended && !frame->remote && frame->id == id) {
      if (all.size() < kShown) {
        received(step_bytes(*frame), frame_text(*frame));
      }
      all.push_back({*frame, now() - begin});
    }
  }
  return all;
}

std::optional<CanBytes> CanopenTrial::answer() {
  const auto frame = hear(with_node(0x580), claims().patience);
  if (!expect(frame.has_value(),
              "an answer of SDO within " + std::to_string(claims().patience.count()) + " ms",
              "none") ||
      !demand(frame->length == 8, "eight bytes", std::to_string(frame->length))) {
    return std::nullopt;
  }
  return CanBytes(frame->data.begin(), frame->data.end());
}

bool CanopenTrial::unanswered(const std::string& about) {
  const auto frame = hear(with_node(0x580), milliseconds(200));
  return expect(!frame.has_value(), "no answer to " + about, frame ? frame_text(*frame) : "");
}

bool CanopenTrial::segments(ObjectName object, std::optional<std::uint32_t> announced,
                            CanBytes& data) {
  constexpr std::size_t kMost = 100'000;
  std::uint8_t toggle = 0;
  while (data.size() < kMost) {
    if (!request({static_cast<std::uint8_t>(0x60U | toggle)}, "next segment")) {
      return false;
    }
    const auto segment = answer();
    if (!segment) {
      return false;
    }
    const std::uint8_t command = segment->front();
    if (!expect((command & 0xE0U) == 0, "a segment of " + text_of(object), hex_text(*segment)) ||
        !expect((command & 0x10U) == toggle, "the toggle bit of the request", hex_text(*segment))) {
      return false;
    }
    const std::size_t count = 7U - (command >> 1U & 7U);
    data.insert(data.end(), segment->begin() + 1,
                segment->begin() + 1 + static_cast<std::ptrdiff_t>(count));
    toggle ^= 0x10U;
    if ((command & 1U) != 0) {
      return !announced || expect(data.size() == *announced,
                                  "as many bytes as were announced: " + std::to_string(*announced),
                                  std::to_string(data.size()));
    }
  }
  return expect(false, "an end of the segments", "none after " + std::to_string(kMost) + " bytes");
}

// Reads an object by an SDO upload, expedited or in segments (CiA 301, 7.2.4.3).
std::optional<SdoResult> CanopenTrial::upload(ObjectName object) {
  const CanBytes asked = initiate(0x40, object);
  if (!request(asked, "read " + text_of(object))) {
    return std::nullopt;
  }
  const auto first = answer();
  if (!first || !demand(std::equal(asked.begin() + 1, asked.end(), first->begin() + 1),
                        "index and sub-index of " + text_of(object), hex_text(*first))) {
    return std::nullopt;
  }
  const std::uint8_t command = first->front();
  SdoResult result;
  if (command == kAbort) {
    result.abort = number_in(std::span(*first).subspan(4));
    return result;
  }
  if (!expect((command & 0xE0U) == 0x40, "an answer to reading", hex_text(*first))) {
    return std::nullopt;
  }
  const bool sized = (command & 1U) != 0;
  if ((command & 2U) != 0) {
    const std::size_t count = sized ? 4U - (command >> 2U & 3U) : 4U;
    result.data.assign(first->begin() + 4, first->begin() + 4 + static_cast<std::ptrdiff_t>(count));
    return result;
  }
  const std::uint32_t announced = number_in(std::span(*first).subspan(4));
  if (!segments(object, sized ? std::optional(announced) : std::nullopt, result.data)) {
    return std::nullopt;
  }
  return result;
}

std::optional<SdoResult> CanopenTrial::download(ObjectName object, const CanBytes& data) {
  const auto command = static_cast<std::uint8_t>(0x23U | (4U - data.size()) << 2U);
  CanBytes bytes = initiate(command, object);
  bytes.insert(bytes.end(), data.begin(), data.end());
  if (!request(bytes, "write " + text_of(object) + " = " + hex_text(data))) {
    return std::nullopt;
  }
  const auto found = answer();
  if (!found || !demand(CanBytes(found->begin() + 1, found->begin() + 4) ==
                            CanBytes(bytes.begin() + 1, bytes.begin() + 4),
                        "index and sub-index of " + text_of(object), hex_text(*found))) {
    return std::nullopt;
  }
  SdoResult result;
  if (found->front() == kAbort) {
    result.abort = number_in(std::span(*found).subspan(4));
  } else if (!expect(found->front() == 0x60, "60, the answer to writing", hex_text(*found))) {
    return std::nullopt;
  }
  return result;
}

std::optional<std::uint32_t> CanopenTrial::number(ObjectName object) {
  const auto result = upload(object);
  if (!result || !expect(!result->abort, text_of(object) + " is read", result->text()) ||
      !expect(!result->data.empty() && result->data.size() <= 4, "1 to 4 bytes", result->text())) {
    return std::nullopt;
  }
  return result->number();
}

bool CanopenTrial::write(ObjectName object, const CanBytes& data) {
  const auto result = download(object, data);
  return result && expect(!result->abort, text_of(object) + " is written", result->text());
}

bool CanopenTrial::aborts(const std::optional<SdoResult>& result,
                          std::initializer_list<std::uint32_t> codes) {
  if (!result) {
    return false;
  }
  std::string wanted;
  for (const std::uint32_t code : codes) {
    wanted += (wanted.empty() ? "abort " : " or ") + abort_text(code);
  }
  return expect(result->abort && std::ranges::find(codes, *result->abort) != codes.end(), wanted,
                result->abort ? result->text() : "it is taken");
}

bool CanopenTrial::command(std::uint8_t code, const std::string& words) {
  return send(0x000, {code, claims().node}, words);
}

void CanopenTrial::with_heartbeat(const std::function<void()>& run) {
  constexpr ObjectName kHeartbeat{0x1017, 0};
  const auto before = number(kHeartbeat);
  if (before && write(kHeartbeat, little(100, 2))) {
    run();
    // The node must be able to receive this in whatever state the case has left it.
    static_cast<void>(command(0x80, "be pre-operational"));
    static_cast<void>(hear(with_node(0x700), milliseconds(300)));
    write(kHeartbeat, little(*before, 2));
  }
}

bool CanopenTrial::expect_state(std::uint8_t state, const std::string& name) {
  // The first heartbeat may have been on its way.
  static_cast<void>(hear(with_node(0x700), milliseconds(300)));
  const auto beat = hear(with_node(0x700), milliseconds(400));
  return expect(beat.has_value(), "a heartbeat", "none") &&
         expect(beat->length == 1 && (beat->data[0] & 0x7FU) == state,
                "state " + hex_number(state, 2) + " (" + name + ")", frame_text(*beat));
}

}  // namespace rigwire::conform
