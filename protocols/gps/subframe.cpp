#include "protocols/gps/subframe.h"

#include <cassert>

#include "protocols/gps/bits.h"

namespace rigwire::protocols::gps {
namespace {

constexpr std::size_t kTelemetry = 0;
constexpr std::size_t kHandOver = 1;
constexpr std::size_t kLast = kWords - 1;

constexpr BitRange kPreambleBits{1, 1, 8};
constexpr BitRange kTelemetryMessage{1, 9, 14};
constexpr BitRange kIntegrityStatus{1, 23, 1};
constexpr BitRange kTimeOfWeek{2, 1, 17};
constexpr BitRange kAlert{2, 18, 1};
constexpr BitRange kAntiSpoof{2, 19, 1};
constexpr BitRange kSubframeId{2, 20, 3};

}  // namespace

void set_head(SubframeData& data, const Head& head) {
  assert(head.next_step < kStepsPerWeek && head.subframe_id >= 1 && head.subframe_id <= 5);
  data.words[kTelemetry] = 0;
  data.words[kHandOver] = 0;
  put_bits(data, kPreambleBits, kPreamble);
  put_bits(data, kTelemetryMessage, head.telemetry_message);
  put_bits(data, kIntegrityStatus, head.integrity_status ? 1U : 0U);
  put_bits(data, kTimeOfWeek, head.next_step);
  put_bits(data, kAlert, head.alert ? 1U : 0U);
  put_bits(data, kAntiSpoof, head.anti_spoof ? 1U : 0U);
  put_bits(data, kSubframeId, head.subframe_id);
}

Decoded<Head> head(const SubframeData& data) {
  if (get_bits(data, kPreambleBits) != kPreamble) {
    return Malformed{"preamble of the telemetry word is not 0x8B", kTelemetry};
  }
  Head head;
  head.telemetry_message = static_cast<std::uint16_t>(get_bits(data, kTelemetryMessage));
  head.integrity_status = get_bits(data, kIntegrityStatus) != 0;
  head.next_step = get_bits(data, kTimeOfWeek);
  head.alert = get_bits(data, kAlert) != 0;
  head.anti_spoof = get_bits(data, kAntiSpoof) != 0;
  head.subframe_id = static_cast<std::uint8_t>(get_bits(data, kSubframeId));
  if (head.next_step >= kStepsPerWeek) {
    return Malformed{"time of week beyond the week", kHandOver};
  }
  if (head.subframe_id < 1 || head.subframe_id > 5) {
    return Malformed{"subframe id outside 1..5", kHandOver};
  }
  return {head, kWords};
}

Subframe encode_subframe(const SubframeData& data) {
  Subframe subframe;
  std::uint32_t previous = 0;
  for (std::size_t i = 0; i < kWords; ++i) {
    const bool ends_in_zeros = i == kHandOver || i == kLast;
    const std::uint32_t bits =
        ends_in_zeros ? with_zero_ending(data.words[i], previous) : data.words[i];
    previous = subframe.words[i] = encode_word(bits, previous);
  }
  return subframe;
}

Decoded<SubframeData> decode_subframe(const Subframe& subframe) {
  SubframeData data;
  std::uint32_t previous = 0;
  for (std::size_t i = 0; i < kWords; ++i) {
    const auto bits = decode_word(subframe.words[i], previous);
    if (!bits) {
      return Malformed{"parity of a word", i};
    }
    data.words[i] = *bits;
    previous = subframe.words[i];
  }
  if (get_bits(data, kPreambleBits) != kPreamble) {
    return Malformed{"preamble of the telemetry word is not 0x8B", kTelemetry};
  }
  return {data, kWords};
}

std::array<std::uint32_t, kWords> true_polarity(const Subframe& subframe) {
  std::array<std::uint32_t, kWords> words{};
  std::uint32_t previous = 0;
  for (std::size_t i = 0; i < kWords; ++i) {
    words[i] = true_polarity(subframe.words[i], previous);
    previous = subframe.words[i];
  }
  return words;
}

}  // namespace rigwire::protocols::gps
