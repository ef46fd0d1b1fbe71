#include "protocols/gps/almanac.h"

#include <cmath>

#include "protocols/gps/bits.h"
#include "protocols/gps/page.h"

namespace rigwire::protocols::gps {
namespace {

using Field = ScaledField<Almanac>;

constexpr double kReferenceInclination_rad = 0.30 * kSemicircle_rad;
constexpr double kEarthGravity_m3ps2 = 3.986005e14;
constexpr double kEarthRate_radps = 7.2921151467e-5;
constexpr std::int32_t kWeekModulus = 256;

// Clock first: af0 is split around af1 and kept apart.
constexpr Scale kClockBias{11, true, -20, false};
constexpr BitRange kClockBiasHigh{10, 1, 8};
constexpr BitRange kClockBiasLow{10, 20, 3};
constexpr Scale kInclination{16, true, -19, true};
constexpr BitRange kInclinationBits{4, 9, 16};
constexpr BitRange kHealth{5, 17, 8};

constexpr std::array kFields{
    Field{&Almanac::eccentricity, 3, 9, {16, false, -21, false}},
    Field{&Almanac::almanac_time_s, 4, 1, {8, false, 12, false}},
    Field{&Almanac::ascending_node_rate, 5, 1, {16, true, -38, true}},
    Field{&Almanac::sqrt_semi_major_axis, 6, 1, {24, false, -11, false}},
    Field{&Almanac::ascending_node_rad, 7, 1, {24, true, -23, true}},
    Field{&Almanac::argument_of_perigee_rad, 8, 1, {24, true, -23, true}},
    Field{&Almanac::mean_anomaly_rad, 9, 1, {24, true, -23, true}},
    Field{&Almanac::clock_drift, 10, 9, {11, true, -38, false}},
};

constexpr Scale kHealthTime{8, false, 12, false};
constexpr BitRange kHealthTimeBits{3, 9, 8};
constexpr BitRange kHealthWeek{3, 17, 8};

constexpr std::size_t kFirst = 24;  // Satellites of subframe 5.

constexpr BitRange health_of_first(std::size_t satellite) {
  return {static_cast<std::uint8_t>(4U + satellite / 4U),
          static_cast<std::uint8_t>(1U + 6U * (satellite % 4U)), 6};
}

// 32 nibbles without a gap from bit 9 of word 3, then two reserved bits, then eight times six bits.
constexpr BitRange configuration_of(std::size_t satellite) {
  const std::size_t at = 8U + 4U * satellite;
  return {static_cast<std::uint8_t>(3U + at / kDataBits),
          static_cast<std::uint8_t>(1U + at % kDataBits), 4};
}
constexpr BitRange health_of_last(std::size_t satellite) {
  const std::size_t at = 8U + 4U * kSatellites + 2U + 6U * (satellite - kFirst);
  return {static_cast<std::uint8_t>(3U + at / kDataBits),
          static_cast<std::uint8_t>(1U + at % kDataBits), 6};
}
static_assert(health_of_last(24).word == 8 && health_of_last(24).first == 19);
static_assert(health_of_last(31).word == 10 && health_of_last(31).first == 13);

double wrapped_angle(double angle_rad) {
  return std::remainder(angle_rad, 2.0 * kSemicircle_rad);
}

}  // namespace

void put_almanac(SubframeData& data, const Almanac& almanac) {
  begin_page(data, almanac.prn);
  for (const Field& field : kFields) {
    field.encode(almanac, data);
  }
  const std::uint32_t bias = kClockBias.count(almanac.clock_bias_s);
  put_bits(data, kClockBiasHigh, bias >> 3U);
  put_bits(data, kClockBiasLow, bias);
  put_bits(data, kInclinationBits,
           kInclination.count(almanac.inclination_rad - kReferenceInclination_rad));
  put_bits(data, kHealth, almanac.health);
}

Almanac quantised(const Almanac& almanac) {
  SubframeData data;
  put_almanac(data, almanac);
  const auto found = decode_almanac(data, almanac.week);
  return found.ok() ? *found : almanac;
}

Decoded<Almanac> decode_almanac(const SubframeData& data, std::int32_t week) {
  const std::uint8_t id = page_id(data);
  if (id < 1 || id > kSatellites) {
    return Malformed{"satellite id of an almanac page outside 1..32", 2};
  }
  Almanac almanac;
  almanac.prn = id;
  almanac.week = week;
  for (const Field& field : kFields) {
    field.decode(data, almanac);
  }
  if (almanac.almanac_time_s >= kWeekSeconds) {
    return Malformed{"time of almanac beyond the week", 3};
  }
  almanac.clock_bias_s =
      kClockBias.value((get_bits(data, kClockBiasHigh) << 3U) | get_bits(data, kClockBiasLow));
  almanac.inclination_rad =
      kReferenceInclination_rad + kInclination.value(get_bits(data, kInclinationBits));
  almanac.health = static_cast<std::uint8_t>(get_bits(data, kHealth));
  return {almanac, kWords};
}

Almanac reduced(const Ephemeris& ephemeris, std::int32_t week, double almanac_time_s) {
  const double weeks_s = static_cast<double>(week - ephemeris.week) * kWeekSeconds;
  const double orbit_s = weeks_s + almanac_time_s - ephemeris.ephemeris_time_s;
  const double clock_s = weeks_s + almanac_time_s - ephemeris.clock_time_s;
  const double root = ephemeris.sqrt_semi_major_axis;
  const double gravity_root = std::sqrt(kEarthGravity_m3ps2);
  // n = n_0 + delta n; the almanac has no delta n, its axis is that of n.
  const double motion =
      root > 0.0 ? gravity_root / (root * root * root) + ephemeris.mean_motion_difference : 0.0;
  Almanac almanac;
  almanac.prn = ephemeris.prn;
  almanac.week = week;
  almanac.health = ephemeris.health;
  almanac.almanac_time_s = almanac_time_s;
  almanac.clock_bias_s = ephemeris.clock_bias_s + ephemeris.clock_drift * clock_s;
  almanac.clock_drift = ephemeris.clock_drift;
  almanac.sqrt_semi_major_axis = motion > 0.0 ? std::cbrt(gravity_root / motion) : root;
  almanac.eccentricity = ephemeris.eccentricity;
  almanac.mean_anomaly_rad = wrapped_angle(ephemeris.mean_anomaly_rad + motion * orbit_s);
  almanac.ascending_node_rad =
      wrapped_angle(ephemeris.ascending_node_rad + ephemeris.ascending_node_rate * orbit_s -
                    kEarthRate_radps * weeks_s);
  almanac.inclination_rad = ephemeris.inclination_rad + ephemeris.inclination_rate * orbit_s;
  almanac.argument_of_perigee_rad = wrapped_angle(ephemeris.argument_of_perigee_rad);
  almanac.ascending_node_rate = ephemeris.ascending_node_rate;
  return quantised(almanac);
}

Ephemeris extended(const Almanac& almanac) {
  Ephemeris ephemeris;
  ephemeris.prn = almanac.prn;
  ephemeris.week = almanac.week;
  ephemeris.health = almanac.health & 0x3FU;
  ephemeris.issue_of_ephemeris =
      static_cast<std::uint8_t>(kHealthTime.count(almanac.almanac_time_s));
  ephemeris.issue_of_clock = ephemeris.issue_of_ephemeris;
  ephemeris.clock_time_s = almanac.almanac_time_s;
  ephemeris.clock_bias_s = almanac.clock_bias_s;
  ephemeris.clock_drift = almanac.clock_drift;
  ephemeris.ephemeris_time_s = almanac.almanac_time_s;
  ephemeris.sqrt_semi_major_axis = almanac.sqrt_semi_major_axis;
  ephemeris.eccentricity = almanac.eccentricity;
  ephemeris.mean_anomaly_rad = wrapped_angle(almanac.mean_anomaly_rad);
  ephemeris.ascending_node_rad = wrapped_angle(almanac.ascending_node_rad);
  ephemeris.inclination_rad = almanac.inclination_rad;
  ephemeris.argument_of_perigee_rad = wrapped_angle(almanac.argument_of_perigee_rad);
  ephemeris.ascending_node_rate = almanac.ascending_node_rate;
  return ephemeris;
}

void put_health_of_first(SubframeData& data, const AlmanacHealth& health) {
  begin_page(data, kPageHealthOfFirst);
  put_bits(data, kHealthTimeBits, kHealthTime.count(health.almanac_time_s));
  put_bits(data, kHealthWeek, static_cast<std::uint32_t>(health.week % kWeekModulus));
  for (std::size_t i = 0; i < kFirst; ++i) {
    put_bits(data, health_of_first(i), health.health[i]);
  }
}

void put_health_of_last(SubframeData& data, const AlmanacHealth& health) {
  begin_page(data, kPageHealthOfLast);
  for (std::size_t i = 0; i < kSatellites; ++i) {
    put_bits(data, configuration_of(i), health.configuration[i]);
  }
  for (std::size_t i = kFirst; i < kSatellites; ++i) {
    put_bits(data, health_of_last(i), health.health[i]);
  }
}

Decoded<AlmanacHealth> decode_health(const SubframeData& first, const SubframeData& last,
                                     std::int32_t week_hint) {
  if (page_id(first) != kPageHealthOfFirst) {
    return Malformed{"page id is not 51", 0};
  }
  if (page_id(last) != kPageHealthOfLast) {
    return Malformed{"page id is not 63", 1};
  }
  AlmanacHealth health;
  health.almanac_time_s = kHealthTime.value(get_bits(first, kHealthTimeBits));
  health.week = unrolled_week(static_cast<std::int32_t>(get_bits(first, kHealthWeek)), kWeekModulus,
                              week_hint);
  for (std::size_t i = 0; i < kSatellites; ++i) {
    health.configuration[i] = static_cast<std::uint8_t>(get_bits(last, configuration_of(i)));
    health.health[i] = static_cast<std::uint8_t>(i < kFirst ? get_bits(first, health_of_first(i))
                                                            : get_bits(last, health_of_last(i)));
  }
  return {health, 2 * kWords};
}

}  // namespace rigwire::protocols::gps
