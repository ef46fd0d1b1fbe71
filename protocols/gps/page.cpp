#include "protocols/gps/page.h"

#include <cassert>

#include "protocols/gps/bits.h"
#include "protocols/gps/ephemeris.h"

namespace rigwire::protocols::gps {
namespace {

constexpr BitRange kDataId{3, 1, 2};
constexpr BitRange kPageId{3, 3, 6};
constexpr std::uint32_t kDataIdOfNow = 1;

struct Place {
  BitRange bits;
  Scale scale;
};

constexpr Place place(std::uint8_t word, std::uint8_t first, std::uint8_t bits, bool negative,
                      int exponent) {
  return {{word, first, bits}, {bits, negative, exponent, false}};
}

constexpr std::array kAlpha{place(3, 9, 8, true, -30), place(3, 17, 8, true, -27),
                            place(4, 1, 8, true, -24), place(4, 9, 8, true, -24)};
constexpr std::array kBeta{place(4, 17, 8, true, 11), place(5, 1, 8, true, 14),
                           place(5, 9, 8, true, 16), place(5, 17, 8, true, 16)};
constexpr Place kA1 = place(6, 1, 24, true, -50);
constexpr Place kA0 = place(7, 1, 32, true, -30);
constexpr Place kReferenceTime = place(8, 9, 8, false, 12);
constexpr BitRange kReferenceWeek{8, 17, 8};
constexpr Place kLeap = place(9, 1, 8, true, 0);
constexpr BitRange kLeapWeek{9, 9, 8};
constexpr BitRange kLeapDay{9, 17, 8};
constexpr Place kLeapFuture = place(10, 1, 8, true, 0);
constexpr std::int32_t kPageWeekModulus = 256;

void put(SubframeData& data, const Place& place, double value) {
  put_bits(data, place.bits, place.scale.count(value));
}
double get(const SubframeData& data, const Place& place) {
  return place.scale.value(get_bits(data, place.bits));
}

}  // namespace

void begin_page(SubframeData& data, std::uint8_t id) {
  for (std::size_t i = 2; i < kWords; ++i) {
    data.words[i] = 0;
  }
  put_bits(data, kDataId, kDataIdOfNow);
  put_bits(data, kPageId, id);
}

std::uint8_t page_id(const SubframeData& data) {
  return static_cast<std::uint8_t>(get_bits(data, kPageId));
}

void put_ionosphere_utc(SubframeData& data, const IonosphereUtc& parameters) {
  begin_page(data, kPageIonosphereUtc);
  for (std::size_t i = 0; i < 4; ++i) {
    put(data, kAlpha[i], parameters.alpha[i]);
    put(data, kBeta[i], parameters.beta[i]);
  }
  put(data, kA1, parameters.utc_a1);
  put(data, kA0, parameters.utc_a0_s);
  put(data, kReferenceTime, parameters.utc_reference_time_s);
  put_bits(data, kReferenceWeek,
           static_cast<std::uint32_t>(parameters.utc_reference_week % kPageWeekModulus));
  put(data, kLeap, parameters.leap_seconds);
  put_bits(data, kLeapWeek, static_cast<std::uint32_t>(parameters.leap_week % kPageWeekModulus));
  put_bits(data, kLeapDay, static_cast<std::uint32_t>(parameters.leap_day));
  put(data, kLeapFuture, parameters.leap_seconds_future);
}

Decoded<IonosphereUtc> decode_ionosphere_utc(const SubframeData& data, std::int32_t week_hint) {
  if (page_id(data) != kPageIonosphereUtc) {
    return Malformed{"page id is not 56", 2};
  }
  const auto week = [&](BitRange bits) {
    return unrolled_week(static_cast<std::int32_t>(get_bits(data, bits)), kPageWeekModulus,
                         week_hint);
  };
  IonosphereUtc parameters;
  for (std::size_t i = 0; i < 4; ++i) {
    parameters.alpha[i] = get(data, kAlpha[i]);
    parameters.beta[i] = get(data, kBeta[i]);
  }
  parameters.utc_a1 = get(data, kA1);
  parameters.utc_a0_s = get(data, kA0);
  parameters.utc_reference_time_s = get(data, kReferenceTime);
  parameters.utc_reference_week = week(kReferenceWeek);
  parameters.leap_seconds = static_cast<std::int32_t>(get(data, kLeap));
  parameters.leap_week = week(kLeapWeek);
  parameters.leap_day = static_cast<std::int32_t>(get_bits(data, kLeapDay));
  parameters.leap_seconds_future = static_cast<std::int32_t>(get(data, kLeapFuture));
  return {parameters, kWords};
}

void put_filler(SubframeData& data, std::uint8_t id) {
  constexpr std::uint32_t kAlternating = 0xAAAAAA;
  constexpr std::uint32_t kBlanks = 0x202020;
  for (std::size_t i = 2; i < kWords; ++i) {
    data.words[i] = id == kPageSpecialMessage ? kBlanks : kAlternating;
  }
  put_bits(data, kDataId, kDataIdOfNow);
  put_bits(data, kPageId, id);
}

std::uint8_t page_id_of(std::uint8_t subframe, std::uint8_t page) {
  assert((subframe == 4 || subframe == 5) && page >= 1 && page <= 25);
  constexpr std::array<std::uint8_t, 25> kSubframe4{57, 25, 26, 27, 28, 57, 29, 30, 31,
                                                    32, 57, 62, 52, 53, 54, 57, 55, 56,
                                                    58, 59, 57, 60, 61, 62, 63};
  if (subframe == 4) {
    return kSubframe4[page - 1U];
  }
  return page == 25 ? kPageHealthOfFirst : page;
}

}  // namespace rigwire::protocols::gps
