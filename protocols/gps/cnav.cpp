#include "protocols/gps/cnav.h"

#include <cassert>
#include <cmath>

#include "protocols/bit_fields.h"
#include "protocols/crc24q.h"
#include "protocols/gps/bits.h"

namespace rigwire::protocols::gps {
namespace {

using enum Sign;

constexpr unsigned kMessageBits = 300;
constexpr unsigned kChecksumBits = 24;
constexpr unsigned kPadBits = 4;  ///< In front, so that what the checksum is of is whole bytes.
constexpr std::size_t kCheckedBytes = (kPadBits + kMessageBits - kChecksumBits) / 8;
using Bits = BitWriter<kCheckedBytes>;

constexpr double kReferenceAxis_m = 26'559'710.0;  // table 30-I
constexpr double kReferenceNodeRate_sc = -2.6e-9;  // semicircles per second
constexpr double kNotAvailable = -(1 << 12);       // of group delays: 1000000000000
constexpr double kL2Ratio = 77.0 / 60.0;           // L1 over L2

double step(int exponent) {
  return std::ldexp(1.0, exponent);
}
double angle(int exponent) {
  return std::ldexp(kSemicircle_rad, exponent);
}

/// Times of week, in steps of 300 s.
void put_time(Bits& bits, double time_s) {
  bits.scaled(11, none, 300.0, time_s);
}

/// Figure 30-1.
void put_first_half(Bits& bits, const Ephemeris& e, std::int32_t week) {
  const bool bad = e.health != 0;
  bits.whole(13, week);
  bits.flag(bad);                      // L1
  bits.flag(bad);                      // L2
  bits.flag(true);                     // L5
  put_time(bits, e.ephemeris_time_s);  // of the prediction
  bits.whole(5, e.accuracy_index);
  put_time(bits, e.ephemeris_time_s);
  bits.scaled(26, twos, step(-9),
              e.sqrt_semi_major_axis * e.sqrt_semi_major_axis - kReferenceAxis_m);
  bits.spare(25);  // its rate
  bits.scaled(17, twos, angle(-44), e.mean_motion_difference);
  bits.spare(23);  // its rate
  bits.scaled(33, twos, angle(-32), e.mean_anomaly_rad);
  bits.scaled(33, none, step(-34), e.eccentricity);
  bits.scaled(33, twos, angle(-32), e.argument_of_perigee_rad);
  bits.spare(1 + 1 + 3);  // integrity, phasing of L2C, reserved
}

/// Figure 30-2.
void put_second_half(Bits& bits, const Ephemeris& e) {
  put_time(bits, e.ephemeris_time_s);
  bits.scaled(33, twos, angle(-32), e.ascending_node_rad);
  bits.scaled(33, twos, angle(-32), e.inclination_rad);
  bits.scaled(17, twos, angle(-44),
              e.ascending_node_rate - kReferenceNodeRate_sc * kSemicircle_rad);
  bits.scaled(15, twos, angle(-44), e.inclination_rate);
  bits.scaled(16, twos, step(-30), e.inclination_sine_rad);
  bits.scaled(16, twos, step(-30), e.inclination_cosine_rad);
  bits.scaled(24, twos, step(-8), e.radius_sine_m);
  bits.scaled(24, twos, step(-8), e.radius_cosine_m);
  bits.scaled(21, twos, step(-30), e.latitude_sine_rad);
  bits.scaled(21, twos, step(-30), e.latitude_cosine_rad);
  bits.spare(7);
}

/// What figures 30-3 to 30-6 begin with.
void put_clock(Bits& bits, const Ephemeris& e) {
  put_time(bits, e.ephemeris_time_s);  // of the prediction
  bits.whole(5, e.accuracy_index);
  bits.spare(3 + 3);  // how it changes
  put_time(bits, e.clock_time_s);
  bits.scaled(26, twos, step(-35), e.clock_bias_s);
  bits.scaled(20, twos, step(-48), e.clock_drift);
  bits.scaled(10, twos, step(-60), e.clock_drift_rate);
}

/// Figure 30-3. L1 C/A is as late as L1 P; by L2C the delay is that of L2.
void put_delays(Bits& bits, const Ephemeris& e, const IonosphereUtc& ionosphere) {
  constexpr unsigned kDelayBits = 13;
  constexpr std::array<int, 4> kAlpha{-30, -27, -24, -24};
  constexpr std::array<int, 4> kBeta{11, 14, 16, 16};
  bits.scaled(kDelayBits, twos, step(-35), e.group_delay_s);
  bits.scaled(kDelayBits, twos, step(-35), 0.0);
  bits.scaled(kDelayBits, twos, step(-35), e.group_delay_s * (1.0 - kL2Ratio * kL2Ratio));
  bits.scaled(kDelayBits, twos, 1.0, kNotAvailable);  // L5 I and Q
  bits.scaled(kDelayBits, twos, 1.0, kNotAvailable);
  for (std::size_t i = 0; i < kAlpha.size(); ++i) {
    bits.scaled(8, twos, step(kAlpha[i]), ionosphere.alpha[i]);
  }
  for (std::size_t i = 0; i < kBeta.size(); ++i) {
    bits.scaled(8, twos, step(kBeta[i]), ionosphere.beta[i]);
  }
  bits.whole(8, e.week);
  bits.spare(12);
}

/// Figure 30-4: four of the 32, those that there are; table 30-VI.
void put_almanacs(Bits& bits, const Broadcast& broadcast, std::size_t first) {
  constexpr std::size_t kPackets = 4;
  constexpr unsigned kPacketBits = 31;
  std::int32_t week = 0;
  double time_s = 0.0;
  for (const auto& almanac : broadcast.almanacs) {
    if (almanac) {
      week = almanac->week;
      time_s = almanac->almanac_time_s;
      break;
    }
  }
  bits.whole(13, week);
  bits.scaled(8, none, step(12), time_s);
  for (std::size_t i = first; i < first + kPackets; ++i) {
    const auto& almanac = broadcast.almanacs[i];
    if (!almanac) {
      bits.spare(kPacketBits);  // PRN 0: no data
      continue;
    }
    const bool bad = almanac->health != 0;
    bits.whole(6, almanac->prn);
    bits.scaled(8, twos, step(9),
                almanac->sqrt_semi_major_axis * almanac->sqrt_semi_major_axis - kReferenceAxis_m);
    bits.scaled(7, twos, angle(-6), almanac->ascending_node_rad);
    bits.scaled(7, twos, angle(-6),
                std::remainder(almanac->mean_anomaly_rad + almanac->argument_of_perigee_rad,
                               2.0 * kSemicircle_rad));
    bits.flag(bad);
    bits.flag(bad);
    bits.flag(true);
  }
  bits.spare(4);
}

/// Figure 30-5.
void put_earth_orientation(Bits& bits, const Ephemeris& e) {
  bits.scaled(16, none, 16.0, e.ephemeris_time_s);
  bits.spare(21 + 15 + 21 + 15 + 31 + 19 + 11);
}

/// Figure 30-6.
void put_utc(Bits& bits, const IonosphereUtc& utc) {
  bits.scaled(16, twos, step(-35), utc.utc_a0_s);
  bits.scaled(13, twos, step(-51), utc.utc_a1);
  bits.spare(7);  // its rate
  bits.whole(8, utc.leap_seconds);
  bits.scaled(16, none, 16.0, utc.utc_reference_time_s);
  bits.whole(13, utc.utc_reference_week);
  bits.whole(13, utc.leap_week);
  bits.whole(4, utc.leap_day);
  bits.whole(8, utc.leap_seconds_future);
  bits.spare(51);
}

// 48 s of four messages, six times: each fourth one in turn.
constexpr std::array<std::uint8_t, 6> kFourth{33, 31, 31, 31, 31, 32};
constexpr std::size_t kOfFrame = 4;
constexpr std::size_t kAlmanacsOfCycle = 4;

std::size_t index_of(std::uint32_t second) {
  return second / static_cast<std::uint32_t>(kCnavSeconds);
}

/// The first, from 0, of the four satellites whose almanacs are in the message of that second.
std::size_t first_almanac(std::uint32_t second) {
  const std::size_t frame = index_of(second) / kOfFrame;
  const std::size_t cycle = frame / kFourth.size();
  const std::size_t message = cycle * kAlmanacsOfCycle + (frame % kFourth.size() + 3) % 4;
  return message % (kSatellites / 4) * 4;
}

}  // namespace

std::uint8_t cnav_type_at(std::uint32_t second) {
  constexpr std::array<std::uint8_t, kOfFrame> kFrame{10, 11, 30, 0};
  const std::size_t index = index_of(second);
  return index % kOfFrame + 1 < kOfFrame ? kFrame[index % kOfFrame]
                                         : kFourth[index / kOfFrame % kFourth.size()];
}

CnavMessage cnav_message(std::uint8_t type, const Broadcast& broadcast, std::uint8_t prn,
                         const CnavTime& time) {
  assert(prn >= 1 && prn <= kSatellites && broadcast.ephemerides[prn - 1U]);
  const Ephemeris& e = *broadcast.ephemerides[prn - 1U];
  Bits bits;
  bits.spare(kPadBits);
  bits.whole(8, kPreamble);
  bits.whole(6, prn);
  bits.whole(6, type);
  // When the next one begins, in steps of 6 s.
  bits.whole(17, (time.second + kCnavSeconds) / kStepSeconds % kStepsPerWeek);
  bits.flag(false);  // no alert
  switch (type) {
    case 10:
      put_first_half(bits, e, time.week);
      break;
    case 11:
      put_second_half(bits, e);
      break;
    default:
      put_clock(bits, e);
      if (type == 30) {
        put_delays(bits, e, broadcast.ionosphere_utc);
      } else if (type == 31) {
        put_almanacs(bits, broadcast, first_almanac(time.second));
      } else if (type == 32) {
        put_earth_orientation(bits, e);
      } else {
        assert(type == 33);
        put_utc(bits, broadcast.ionosphere_utc);
      }
  }
  assert(bits.bytes().size() == kCheckedBytes);
  // The message without the bits in front, its checksum, and zeros.
  BitWriter<sizeof(CnavMessage)> all;
  BitReader checked(bits.bytes());
  checked.spare(kPadBits);
  for (unsigned left = kMessageBits - kChecksumBits; left > 0; left -= kPadBits) {
    std::uint8_t four = 0;
    checked.whole(kPadBits, four);
    all.whole(kPadBits, four);
  }
  all.whole(kChecksumBits, crc24q(bits.bytes()));
  BitReader words(all.bytes());
  CnavMessage message;
  for (std::uint32_t& word : message) {
    words.whole(32, word);
  }
  return message;
}

}  // namespace rigwire::protocols::gps
