// CNAV messages read by a plain decoder of bit numbers, signs and scales as IS-GPS-200 section 30
// and its figures have them, which shares nothing with the encoder.
#include "protocols/gps/cnav.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace rigwire::protocols::gps {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::int32_t kWeek = 2421;

/// Bits by the numbers of the document, 1 to 300.
class Read {
 public:
  explicit Read(const CnavMessage& message) : message_(message) {}
  [[nodiscard]] std::uint64_t whole(unsigned first, unsigned last) const {
    std::uint64_t value = 0;
    for (unsigned bit = first; bit <= last; ++bit) {
      value = value << 1U | (message_[(bit - 1U) / 32U] >> (31U - (bit - 1U) % 32U) & 1U);
    }
    return value;
  }
  [[nodiscard]] double scaled(unsigned first, unsigned last, int exponent) const {
    return std::ldexp(static_cast<double>(whole(first, last)), exponent);
  }
  [[nodiscard]] double twos(unsigned first, unsigned last, int exponent) const {
    const auto value = static_cast<double>(whole(first, last));
    const double range = std::ldexp(1.0, static_cast<int>(last - first) + 1);
    return std::ldexp(value >= range / 2.0 ? value - range : value, exponent);
  }

 private:
  CnavMessage message_;
};

/// Section 30.3.5: the remainder of a division by the polynomial, bit by bit.
std::uint32_t remainder_of(const Read& read) {
  std::uint32_t remainder = 0;
  for (unsigned bit = 1; bit <= 276; ++bit) {
    const bool out = (remainder >> 23U & 1U) != read.whole(bit, bit);
    remainder = remainder << 1U & 0xFFFFFFU;
    remainder ^= out ? 0x864CFBU : 0U;
  }
  return remainder;
}

class Cnav : public testing::Test {
 protected:
  Cnav() {
    Ephemeris e;
    e.prn = 7;
    e.week = kWeek;
    e.accuracy_index = 2;
    e.group_delay_s = std::ldexp(-23.0, -31);
    e.clock_time_s = e.ephemeris_time_s = 208'800.0;
    e.clock_bias_s = std::ldexp(-1'234'567.0, -31);
    e.clock_drift = std::ldexp(-77.0, -43);
    e.clock_drift_rate = std::ldexp(3.0, -55);
    e.sqrt_semi_major_axis = std::ldexp(2'702'023'456.0, -19);
    e.eccentricity = std::ldexp(98'765'432.0, -33);
    e.mean_anomaly_rad = std::ldexp(-1'987'654'321.0, -31) * kPi;
    e.mean_motion_difference = std::ldexp(12'345.0, -43) * kPi;
    e.ascending_node_rad = std::ldexp(1'357'924'680.0, -31) * kPi;
    e.inclination_rad = std::ldexp(653'456'789.0, -31) * kPi;
    e.argument_of_perigee_rad = std::ldexp(-555'666'777.0, -31) * kPi;
    e.ascending_node_rate = std::ldexp(-23'456.0, -43) * kPi;
    e.inclination_rate = std::ldexp(-789.0, -43) * kPi;
    e.latitude_cosine_rad = std::ldexp(-1234.0, -29);
    e.latitude_sine_rad = std::ldexp(4321.0, -29);
    e.radius_cosine_m = std::ldexp(7654.0, -5);
    e.radius_sine_m = std::ldexp(-3210.0, -5);
    e.inclination_cosine_rad = std::ldexp(-98.0, -29);
    e.inclination_sine_rad = std::ldexp(76.0, -29);
    broadcast_.ephemerides[6] = e;
    e.prn = 21;
    e.health = 63;
    broadcast_.ephemerides[20] = e;
    broadcast_.ionosphere_utc = {
        .alpha = {std::ldexp(12.0, -30), std::ldexp(-3.0, -27), std::ldexp(5.0, -24), 0.0},
        .beta = {std::ldexp(44.0, 11), std::ldexp(-7.0, 14), 0.0, std::ldexp(2.0, 16)},
        .utc_a0_s = std::ldexp(9.0, -30),
        .utc_a1 = std::ldexp(-2.0, -50),
        .utc_reference_time_s = 147'456.0,
        .utc_reference_week = kWeek,
        .leap_seconds = 18,
        .leap_week = kWeek + 3,
        .leap_day = 7,
        .leap_seconds_future = 19};
    derive_almanac(broadcast_);
  }
  [[nodiscard]] Read message(std::uint8_t type, std::uint32_t second = 207'612,
                             std::uint8_t prn = 7) const {
    return Read(cnav_message(type, broadcast_, prn, {kWeek, second}));
  }

  Broadcast broadcast_;
};

TEST_F(Cnav, EveryMessageHasItsHeadAndItsChecksum) {
  for (const auto type : std::to_array<std::uint8_t>({10, 11, 30, 31, 32, 33})) {
    for (const std::uint32_t second : {0U, 207'612U, 604'788U}) {
      const Read read = message(type, second);
      EXPECT_EQ(read.whole(1, 8), 0x8BU);
      EXPECT_EQ(read.whole(9, 14), 7U);
      EXPECT_EQ(read.whole(15, 20), type);
      // The count of time is that of the message after it; in the last message of a week it is the
      // next week's start.
      EXPECT_EQ(read.whole(21, 37), second == 604'788U ? 0U : second / 6U + 2U);
      EXPECT_EQ(read.whole(38, 38), 0U);
      EXPECT_EQ(read.whole(277, 300), remainder_of(read)) << int{type};
    }
  }
  EXPECT_EQ(cnav_message(10, broadcast_, 7, {kWeek, 0})[9] & 0xFFFFFU, 0U) << "padding";
}

TEST_F(Cnav, OrbitOfTypes10And11IsThatOfTheLegacyMessage) {
  const Ephemeris& e = *broadcast_.ephemerides[6];
  const Read first = message(10);
  EXPECT_EQ(first.whole(39, 51), static_cast<unsigned>(kWeek));
  EXPECT_EQ(first.whole(52, 54), 0b001U) << "L1 and L2 are well, L5 is not sent";
  EXPECT_EQ(300.0 * static_cast<double>(first.whole(55, 65)), e.ephemeris_time_s);
  EXPECT_EQ(first.twos(66, 70, 0), 2.0);
  EXPECT_EQ(300.0 * static_cast<double>(first.whole(71, 81)), e.ephemeris_time_s);
  const double axis_m = 26'559'710.0 + first.twos(82, 107, -9);
  EXPECT_NEAR(axis_m, std::pow(e.sqrt_semi_major_axis, 2), std::ldexp(1.0, -10));
  EXPECT_EQ(first.whole(108, 132), 0U);
  EXPECT_NEAR(first.twos(133, 149, -44) * kPi, e.mean_motion_difference, 1e-21);
  EXPECT_EQ(first.whole(150, 172), 0U);
  EXPECT_NEAR(first.twos(173, 205, -32) * kPi, e.mean_anomaly_rad, 1e-12);
  EXPECT_EQ(first.scaled(206, 238, -34), e.eccentricity);
  EXPECT_NEAR(first.twos(239, 271, -32) * kPi, e.argument_of_perigee_rad, 1e-12);
  EXPECT_EQ(first.whole(272, 276), 0U);

  const Read second = message(11);
  EXPECT_EQ(300.0 * static_cast<double>(second.whole(39, 49)), e.ephemeris_time_s);
  EXPECT_NEAR(second.twos(50, 82, -32) * kPi, e.ascending_node_rad, 1e-12);
  EXPECT_NEAR(second.twos(83, 115, -32) * kPi, e.inclination_rad, 1e-12);
  EXPECT_NEAR((-2.6e-9 + second.twos(116, 132, -44)) * kPi, e.ascending_node_rate,
              std::ldexp(kPi, -45));
  EXPECT_NEAR(second.twos(133, 147, -44) * kPi, e.inclination_rate, 1e-21);
  EXPECT_EQ(second.twos(148, 163, -30), e.inclination_sine_rad);
  EXPECT_EQ(second.twos(164, 179, -30), e.inclination_cosine_rad);
  EXPECT_EQ(second.twos(180, 203, -8), e.radius_sine_m);
  EXPECT_EQ(second.twos(204, 227, -8), e.radius_cosine_m);
  EXPECT_EQ(second.twos(228, 248, -30), e.latitude_sine_rad);
  EXPECT_EQ(second.twos(249, 269, -30), e.latitude_cosine_rad);
  EXPECT_EQ(message(10, 207'612, 21).whole(52, 54), 0b111U) << "a satellite that is not well";
}

TEST_F(Cnav, ClockAndDelaysOfType30) {
  const Ephemeris& e = *broadcast_.ephemerides[6];
  for (const auto type : std::to_array<std::uint8_t>({30, 31, 32, 33})) {
    const Read read = message(type);
    EXPECT_EQ(300.0 * static_cast<double>(read.whole(39, 49)), e.ephemeris_time_s);
    EXPECT_EQ(read.twos(50, 54, 0), 2.0);
    EXPECT_EQ(300.0 * static_cast<double>(read.whole(61, 71)), e.clock_time_s);
    EXPECT_EQ(read.twos(72, 97, -35), e.clock_bias_s);
    EXPECT_EQ(read.twos(98, 117, -48), e.clock_drift);
    EXPECT_EQ(read.twos(118, 127, -60), e.clock_drift_rate);
  }
  const Read read = message(30);
  EXPECT_EQ(read.twos(128, 140, -35), e.group_delay_s);
  EXPECT_EQ(read.twos(141, 153, -35), 0.0);
  // A receiver of L2C alone takes TGD less this off, which is what the legacy message says of L2.
  const double of_l2_s = read.twos(128, 140, -35) - read.twos(154, 166, -35);
  EXPECT_NEAR(of_l2_s, std::pow(77.0 / 60.0, 2) * e.group_delay_s, std::ldexp(1.0, -36));
  EXPECT_EQ(read.whole(167, 179), 0x1000U) << "L5 is not available";
  EXPECT_EQ(read.whole(180, 192), 0x1000U);
  const IonosphereUtc& i = broadcast_.ionosphere_utc;
  EXPECT_EQ(read.twos(193, 200, -30), i.alpha[0]);
  EXPECT_EQ(read.twos(201, 208, -27), i.alpha[1]);
  EXPECT_EQ(read.twos(209, 216, -24), i.alpha[2]);
  EXPECT_EQ(read.twos(217, 224, -24), i.alpha[3]);
  EXPECT_EQ(read.twos(225, 232, 11), i.beta[0]);
  EXPECT_EQ(read.twos(233, 240, 14), i.beta[1]);
  EXPECT_EQ(read.twos(241, 248, 16), i.beta[2]);
  EXPECT_EQ(read.twos(249, 256, 16), i.beta[3]);
  EXPECT_EQ(read.whole(257, 264), static_cast<unsigned>(kWeek % 256));
}

TEST_F(Cnav, UtcOfType33) {
  const IonosphereUtc& u = broadcast_.ionosphere_utc;
  const Read read = message(33);
  EXPECT_EQ(read.twos(128, 143, -35), u.utc_a0_s);
  EXPECT_EQ(read.twos(144, 156, -51), u.utc_a1);
  EXPECT_EQ(read.whole(157, 163), 0U);
  EXPECT_EQ(read.whole(164, 171), 18U);
  EXPECT_EQ(16.0 * static_cast<double>(read.whole(172, 187)), u.utc_reference_time_s);
  EXPECT_EQ(read.whole(188, 200), static_cast<unsigned>(kWeek));
  EXPECT_EQ(read.whole(201, 213), static_cast<unsigned>(kWeek + 3));
  EXPECT_EQ(read.whole(214, 217), 7U);
  EXPECT_EQ(read.whole(218, 225), 19U);
}

// Reduced almanacs of four in each message of type 31: in twenty minutes those of all.
TEST_F(Cnav, AlmanacsOfAllSatellitesComeWithinTwentyMinutes) {
  std::map<std::uint64_t, std::uint64_t> seen;  // satellite, health
  for (std::uint32_t second = 0; second < 1200; second += 12) {
    if (cnav_type_at(second) != 31) {
      continue;
    }
    const Read read = message(31, second);
    const Almanac& of7 = *broadcast_.almanacs[6];
    EXPECT_EQ(read.whole(128, 140), static_cast<unsigned>(of7.week));
    EXPECT_EQ(read.scaled(141, 148, 12), of7.almanac_time_s);
    for (unsigned packet = 0; packet < 4; ++packet) {
      const unsigned at = 149 + 31 * packet;
      const std::uint64_t prn = read.whole(at, at + 5);
      if (prn == 0) {
        continue;
      }
      seen[prn] = read.whole(at + 28, at + 30);
      const Almanac& a = *broadcast_.almanacs[prn - 1];
      EXPECT_NEAR(26'559'710.0 + read.twos(at + 6, at + 13, 9), std::pow(a.sqrt_semi_major_axis, 2),
                  256.0);
      EXPECT_NEAR(read.twos(at + 14, at + 20, -6) * kPi, a.ascending_node_rad, kPi / 128.0);
      EXPECT_NEAR(std::remainder(read.twos(at + 21, at + 27, -6) * kPi - a.mean_anomaly_rad -
                                     a.argument_of_perigee_rad,
                                 2.0 * kPi),
                  0.0, kPi / 64.0);
    }
  }
  EXPECT_EQ(seen, (std::map<std::uint64_t, std::uint64_t>{{7, 0b001}, {21, 0b111}}));
}

// Table 30-XII: orbit and clock within 48 s, ionosphere, delays and UTC within 288 s, earth
// orientation within half an hour.
TEST_F(Cnav, EveryTypeComesAsOftenAsTheTableAsks) {
  std::map<int, std::uint32_t> last;
  std::map<int, std::uint32_t> longest;
  std::uint32_t clock = 0;
  for (std::uint32_t second = 0; second < 7200; second += 12) {
    const int type = cnav_type_at(second);
    longest[type] = std::max(longest[type], second - last[type]);
    last[type] = second;
    if (type >= 30) {
      EXPECT_LE(second - clock, 48U);
      clock = second;
    }
  }
  EXPECT_LE(longest[10], 48U);
  EXPECT_LE(longest[11], 48U);
  EXPECT_LE(longest[30], 288U);
  EXPECT_LE(longest[33], 288U);
  EXPECT_LE(longest[32], 1800U);
  EXPECT_EQ(longest.size(), 6U) << "and no other";
}

}  // namespace
}  // namespace rigwire::protocols::gps
