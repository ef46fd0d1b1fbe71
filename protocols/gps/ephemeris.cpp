#include "protocols/gps/ephemeris.h"

#include <array>
#include <cassert>
#include <cmath>
#include <span>

#include "protocols/gps/bits.h"

namespace rigwire::protocols::gps {
namespace {

using EphemerisField = ScaledField<Ephemeris>;

constexpr Scale plain(std::uint8_t bits, int exponent) {
  return {bits, false, exponent, false};
}
constexpr Scale negative(std::uint8_t bits, int exponent) {
  return {bits, true, exponent, false};
}
constexpr Scale angle(std::uint8_t bits, int exponent) {
  return {bits, true, exponent, true};
}

constexpr std::array kClock{
    EphemerisField{&Ephemeris::group_delay_s, 7, 17, negative(8, -31)},
    EphemerisField{&Ephemeris::clock_time_s, 8, 9, plain(16, 4)},
    EphemerisField{&Ephemeris::clock_drift_rate, 9, 1, negative(8, -55)},
    EphemerisField{&Ephemeris::clock_drift, 9, 9, negative(16, -43)},
    EphemerisField{&Ephemeris::clock_bias_s, 10, 1, negative(22, -31)},
};

constexpr std::array kOrbit2{
    EphemerisField{&Ephemeris::radius_sine_m, 3, 9, negative(16, -5)},
    EphemerisField{&Ephemeris::mean_motion_difference, 4, 1, angle(16, -43)},
    EphemerisField{&Ephemeris::mean_anomaly_rad, 4, 17, angle(32, -31)},
    EphemerisField{&Ephemeris::latitude_cosine_rad, 6, 1, negative(16, -29)},
    EphemerisField{&Ephemeris::eccentricity, 6, 17, plain(32, -33)},
    EphemerisField{&Ephemeris::latitude_sine_rad, 8, 1, negative(16, -29)},
    EphemerisField{&Ephemeris::sqrt_semi_major_axis, 8, 17, plain(32, -19)},
    EphemerisField{&Ephemeris::ephemeris_time_s, 10, 1, plain(16, 4)},
};

constexpr std::array kOrbit3{
    EphemerisField{&Ephemeris::inclination_cosine_rad, 3, 1, negative(16, -29)},
    EphemerisField{&Ephemeris::ascending_node_rad, 3, 17, angle(32, -31)},
    EphemerisField{&Ephemeris::inclination_sine_rad, 5, 1, negative(16, -29)},
    EphemerisField{&Ephemeris::inclination_rad, 5, 17, angle(32, -31)},
    EphemerisField{&Ephemeris::radius_cosine_m, 7, 1, negative(16, -5)},
    EphemerisField{&Ephemeris::argument_of_perigee_rad, 7, 17, angle(32, -31)},
    EphemerisField{&Ephemeris::ascending_node_rate, 9, 1, angle(24, -43)},
    EphemerisField{&Ephemeris::inclination_rate, 10, 9, angle(14, -43)},
};

constexpr BitRange kWeek{3, 1, 10};
constexpr BitRange kL2Code{3, 11, 2};
constexpr BitRange kAccuracy{3, 13, 4};
constexpr BitRange kEphemerisHealth{3, 17, 6};
constexpr BitRange kIssueOfClockHigh{3, 23, 2};
constexpr BitRange kIssueOfClockLow{8, 1, 8};
constexpr BitRange kL2DataFlag{4, 1, 1};
constexpr BitRange kIssueOfEphemeris2{3, 1, 8};
constexpr BitRange kFitInterval{10, 17, 1};
constexpr BitRange kAgeOfDataOffset{10, 18, 5};
constexpr BitRange kIssueOfEphemeris3{10, 1, 8};

constexpr std::int32_t kWordWeekModulus = 1024;

std::span<const EphemerisField> fields_of(std::uint8_t id) {
  switch (id) {
    case 1:
      return kClock;
    case 2:
      return kOrbit2;
    default:
      return kOrbit3;
  }
}

template <class Function>
void for_each_field(Function&& function) {
  for (std::uint8_t id = 1; id <= 3; ++id) {
    for (const EphemerisField& field : fields_of(id)) {
      function(field);
    }
  }
}

// Upper bounds of the indices 0..14.
constexpr std::array<double, 15> kAccuracies_m{2.4,   3.4,   4.85,   6.85,   9.65,
                                               13.65, 24.0,  48.0,   96.0,   192.0,
                                               384.0, 768.0, 1536.0, 3072.0, 6144.0};
constexpr double kNoAccuracy_m = 8192.0;

}  // namespace

void put_ephemeris(SubframeData& data, std::uint8_t id, const Ephemeris& ephemeris,
                   std::int32_t sent_week) {
  assert(id >= 1 && id <= 3);
  for (std::size_t i = 2; i < kWords; ++i) {
    data.words[i] = 0;
  }
  for (const EphemerisField& field : fields_of(id)) {
    field.encode(ephemeris, data);
  }
  switch (id) {
    case 1:
      put_bits(data, kWeek, static_cast<std::uint32_t>(sent_week % kWordWeekModulus));
      put_bits(data, kL2Code, ephemeris.l2_code);
      put_bits(data, kAccuracy, ephemeris.accuracy_index);
      put_bits(data, kEphemerisHealth, ephemeris.health);
      put_bits(data, kIssueOfClockHigh, ephemeris.issue_of_clock >> 8U);
      put_bits(data, kIssueOfClockLow, ephemeris.issue_of_clock);
      put_bits(data, kL2DataFlag, ephemeris.l2_p_data_off ? 1U : 0U);
      break;
    case 2:
      put_bits(data, kIssueOfEphemeris2, ephemeris.issue_of_ephemeris);
      put_bits(data, kFitInterval, ephemeris.long_fit ? 1U : 0U);
      put_bits(data, kAgeOfDataOffset, ephemeris.age_of_data_offset);
      break;
    default:
      put_bits(data, kIssueOfEphemeris3, ephemeris.issue_of_ephemeris);
      break;
  }
}

Ephemeris quantised(const Ephemeris& ephemeris) {
  Ephemeris result = ephemeris;
  for_each_field([&](const EphemerisField& field) {
    const std::uint32_t count = field.scale.count(ephemeris.*field.member);
    result.*field.member = field.scale.value(count);
  });
  return result;
}

Decoded<Ephemeris> decode_ephemeris(const SubframeData& first, const SubframeData& second,
                                    const SubframeData& third, std::uint8_t prn,
                                    std::int32_t week_hint) {
  const std::array<const SubframeData*, 3> subframes{&first, &second, &third};
  Ephemeris ephemeris;
  std::uint32_t next_step = 0;
  for (std::uint8_t id = 1; id <= 3; ++id) {
    const SubframeData& data = *subframes[id - 1U];
    const auto found = head(data);
    if (found.malformed()) {
      return Malformed{found.fault().reason, id - 1U};
    }
    if (found->subframe_id != id) {
      return Malformed{"subframes are not 1, 2, 3", id - 1U};
    }
    if (id == 1) {
      next_step = found->next_step;
    }
    for (const EphemerisField& field : fields_of(id)) {
      field.decode(data, ephemeris);
    }
  }
  ephemeris.prn = prn;
  ephemeris.l2_code = static_cast<std::uint8_t>(get_bits(first, kL2Code));
  ephemeris.accuracy_index = static_cast<std::uint8_t>(get_bits(first, kAccuracy));
  ephemeris.health = static_cast<std::uint8_t>(get_bits(first, kEphemerisHealth));
  ephemeris.issue_of_clock = static_cast<std::uint16_t>((get_bits(first, kIssueOfClockHigh) << 8U) |
                                                        get_bits(first, kIssueOfClockLow));
  ephemeris.l2_p_data_off = get_bits(first, kL2DataFlag) != 0;
  ephemeris.issue_of_ephemeris = static_cast<std::uint8_t>(get_bits(second, kIssueOfEphemeris2));
  ephemeris.long_fit = get_bits(second, kFitInterval) != 0;
  ephemeris.age_of_data_offset = static_cast<std::uint8_t>(get_bits(second, kAgeOfDataOffset));
  if (ephemeris.issue_of_ephemeris != (ephemeris.issue_of_clock & 0xFFU)) {
    return Malformed{"issue of ephemeris differs from issue of clock", 1};
  }
  if (get_bits(third, kIssueOfEphemeris3) != ephemeris.issue_of_ephemeris) {
    return Malformed{"issue of ephemeris differs between subframes 2 and 3", 2};
  }
  if (ephemeris.ephemeris_time_s >= kWeekSeconds || ephemeris.clock_time_s >= kWeekSeconds) {
    return Malformed{"time of ephemeris or clock beyond the week", 0};
  }
  // The week is that of sending; the ephemeris is nearer than half a week.
  const std::uint32_t step = (next_step + kStepsPerWeek - 1U) % kStepsPerWeek;
  const double ahead_s = ephemeris.ephemeris_time_s - static_cast<double>(step) * kStepSeconds;
  ephemeris.week =
      unrolled_week(static_cast<std::int32_t>(get_bits(first, kWeek)), kWordWeekModulus, week_hint);
  if (ahead_s > kWeekSeconds / 2.0) {
    --ephemeris.week;
  } else if (ahead_s < -kWeekSeconds / 2.0) {
    ++ephemeris.week;
  }
  return {ephemeris, 3 * kWords};
}

std::int32_t unrolled_week(std::int32_t rolled, std::int32_t modulus, std::int32_t week_hint) {
  const std::int32_t earliest = week_hint - modulus / 2;
  const std::int32_t ahead = ((rolled - earliest) % modulus + modulus) % modulus;
  return earliest + ahead;
}

double nominal_accuracy_m(std::uint8_t index) {
  if (index >= 15U) {
    return kNoAccuracy_m;
  }
  return index > 6U ? std::ldexp(1.0, index - 2)
                    : std::round(10.0 * std::pow(2.0, 1.0 + index / 2.0)) / 10.0;
}

std::uint8_t accuracy_index(double accuracy_m) {
  std::uint8_t index = 0;
  while (index < 15U && !(accuracy_m <= kAccuracies_m[index])) {
    ++index;
  }
  return index;
}

}  // namespace rigwire::protocols::gps
