#include "protocols/vehicle/diagnostics.h"

#include <algorithm>

namespace rigwire::protocols::vehicle {
namespace {

constexpr std::size_t kFrameBytes = 8;

constexpr std::uint8_t lamp(bool on, unsigned bit) {
  return static_cast<std::uint8_t>((on ? 1U : 0U) << bit);
}
constexpr bool is_on(std::uint8_t lamps, unsigned bit) {
  return ((lamps >> bit) & 3U) == 1U;
}

}  // namespace

TroubleReport make_trouble_report(const Lamps& lamps, std::span<const TroubleCode> codes) {
  TroubleReport report;
  report.bytes[0] =
      static_cast<std::uint8_t>(lamp(lamps.malfunction, 6) | lamp(lamps.red_stop, 4) |
                                lamp(lamps.amber_warning, 2) | lamp(lamps.protect, 0));
  report.bytes[1] = 0xFF;
  report.size = kLampBytes;
  const TroubleCode none;
  const auto sent = codes.empty() ? std::span(&none, 1) : codes;
  for (const TroubleCode& code : sent.first(std::min(sent.size(), kGreatestCodes))) {
    std::uint8_t* at = report.bytes.data() + report.size;
    at[0] = static_cast<std::uint8_t>(code.spn & 0xFFU);
    at[1] = static_cast<std::uint8_t>((code.spn >> 8U) & 0xFFU);
    at[2] = static_cast<std::uint8_t>(((code.spn >> 11U) & 0xE0U) | (code.failure_mode & 0x1FU));
    at[3] = static_cast<std::uint8_t>(code.occurrences & 0x7FU);
    report.size += kCodeBytes;
  }
  for (; report.size < kFrameBytes; ++report.size) {
    report.bytes[report.size] = 0xFF;
  }
  return report;
}

Decoded<TroubleCodes> decode_trouble_report(std::span<const std::uint8_t> payload) {
  if (payload.size() < kLampBytes + kCodeBytes) {
    return Incomplete{kLampBytes + kCodeBytes, payload.size()};
  }
  TroubleCodes result;
  result.lamps = {is_on(payload[0], 6), is_on(payload[0], 4), is_on(payload[0], 2),
                  is_on(payload[0], 0)};
  std::size_t at = kLampBytes;
  for (; at + kCodeBytes <= payload.size(); at += kCodeBytes) {
    const auto b = payload.subspan(at, kCodeBytes);
    const TroubleCode code{
        static_cast<std::uint32_t>(b[0]) | (static_cast<std::uint32_t>(b[1]) << 8U) |
            (static_cast<std::uint32_t>(b[2] & 0xE0U) << 11U),
        static_cast<std::uint8_t>(b[2] & 0x1FU), static_cast<std::uint8_t>(b[3] & 0x7FU)};
    if (code != TroubleCode{} && result.count < kGreatestCodes) {
      result.codes[result.count++] = code;
    }
  }
  return {result, at};
}

}  // namespace rigwire::protocols::vehicle
