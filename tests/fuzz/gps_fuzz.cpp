// Subframes of the GPS navigation message from arbitrary words: what decodes encodes to the same
// bits again.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "protocols/gps/almanac.h"
#include "protocols/gps/ephemeris.h"
#include "protocols/gps/page.h"
#include "protocols/gps/subframe.h"

namespace {

using namespace rigwire::protocols::gps;

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

// Parity made right, so that arbitrary bits come through.
SubframeData data_of(const std::uint8_t* bytes, std::uint8_t id, bool keep_head) {
  SubframeData data;
  for (std::size_t i = 0; i < kWords; ++i) {
    std::uint32_t word = 0;
    std::memcpy(&word, bytes + 4 * i, sizeof word);
    data.words[i] = word & kDataMask;
  }
  if (!keep_head) {
    set_head(data, {.next_step = data.words[1] % kStepsPerWeek, .subframe_id = id});
  }
  const auto decoded = decode_subframe(encode_subframe(data));
  return decoded.ok() ? *decoded : data;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kSubframeBytes = 4 * kWords;
  for (; size >= 3 * kSubframeBytes; data += 3 * kSubframeBytes, size -= 3 * kSubframeBytes) {
    Subframe raw;
    std::memcpy(raw.words.data(), data, kSubframeBytes);
    if (const auto decoded = decode_subframe(raw); decoded.ok()) {
      require(decode_subframe(encode_subframe(*decoded)).ok());
    }
    static_cast<void>(head(data_of(data, 1, true)));
    std::array<SubframeData, 3> three;
    for (std::uint8_t id = 1; id <= 3; ++id) {
      three[id - 1U] = data_of(data + (id - 1U) * kSubframeBytes, id, false);
    }
    if (const auto e = decode_ephemeris(three[0], three[1], three[2], 1, 2300); e.ok()) {
      require(quantised(*e) == *e);
    }
    SubframeData again;
    if (const auto almanac = decode_almanac(three[0], 2300); almanac.ok()) {
      put_almanac(again, *almanac);
      require(*decode_almanac(again, 2300) == *almanac);
    }
    if (const auto page = decode_ionosphere_utc(three[1], 2300); page.ok()) {
      put_ionosphere_utc(again, *page);
      require(*decode_ionosphere_utc(again, 2300) == *page);
    }
    static_cast<void>(decode_health(three[0], three[1], 2300));
  }
  return 0;
}
