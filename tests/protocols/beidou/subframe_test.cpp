#include "protocols/beidou/subframe.h"

#include <gtest/gtest.h>

#include <cmath>

#include "protocols/gps/bits.h"

namespace rigwire::protocols::beidou {
namespace {

double angle(std::int64_t steps, int exponent) {
  return static_cast<double>(steps) * std::ldexp(gps::kSemicircle_rad, exponent);
}

/// Each figure near an end of its field.
gps::Ephemeris example() {
  gps::Ephemeris e;
  e.week = 2421;
  e.issue_of_clock = 31;
  e.issue_of_ephemeris = 30;
  e.accuracy_index = 15;
  e.health = 1;
  e.group_delay_s = -512 * 1e-10;
  e.second_delay_s = 511 * 1e-10;
  e.clock_time_s = 75'599 * 8.0;
  e.clock_bias_s = std::ldexp(-8'388'608, -33);
  e.clock_drift = std::ldexp(2'097'151, -50);
  e.clock_drift_rate = std::ldexp(-1'024, -66);
  e.ephemeris_time_s = 75'599 * 8.0;
  e.sqrt_semi_major_axis = std::ldexp(2'769'612'345.0, -19);
  e.eccentricity = std::ldexp(4'294'967'295.0, -33);
  e.mean_anomaly_rad = angle(-2'147'483'648, -31);
  e.mean_motion_difference = angle(-32'768, -43);
  e.ascending_node_rad = angle(2'147'483'647, -31);
  e.inclination_rad = angle(656'170'123, -31);
  e.argument_of_perigee_rad = angle(-1, -31);
  e.ascending_node_rate = angle(-8'388'608, -43);
  e.inclination_rate = angle(8'191, -43);
  e.latitude_cosine_rad = std::ldexp(-131'072, -31);
  e.latitude_sine_rad = std::ldexp(131'071, -31);
  e.radius_cosine_m = std::ldexp(-131'072, -6);
  e.radius_sine_m = std::ldexp(131'071, -6);
  e.inclination_cosine_rad = std::ldexp(-1, -31);
  e.inclination_sine_rad = std::ldexp(1, -31);
  return e;
}

std::array<Subframe, 3> subframes_of(const gps::Ephemeris& e, std::uint32_t second) {
  std::array<Subframe, 3> made{};
  for (std::uint8_t id = 1; id <= 3; ++id) {
    made[id - 1U] = subframe(id, e, {}, {2421, second + 6U * (id - 1U)});
  }
  return made;
}

TEST(BeidouSubframe, SubframesSayTheOrbitToTheBit) {
  const auto decoded = decode_ephemeris(subframes_of(example(), 604'770));
  ASSERT_TRUE(decoded.ok());
  EXPECT_EQ(*decoded, example());
}

TEST(BeidouSubframe, EveryBitIsInACodeButTheFirstFifteen) {
  const auto sound = subframes_of(example(), 604'770);
  for (std::size_t word = 0; word < 10; ++word) {
    for (unsigned bit = 0; bit < 30; ++bit) {
      auto bent = sound;
      bent[1][word] ^= 1U << bit;
      const bool reserved = word == 0 && bit >= 15 && bit < 19;
      EXPECT_EQ(decode_ephemeris(bent).malformed(), !reserved) << word << ' ' << bit;
    }
  }
}

TEST(BeidouSubframe, SubframesOfTwoFramesAreNoOrbit) {
  auto mixed = subframes_of(example(), 604'740);
  mixed[2] = subframe(3, example(), {}, {2421, 604'782});
  EXPECT_TRUE(decode_ephemeris(mixed).malformed());
}

TEST(BeidouSubframe, TheFrameGoesByBeidousWeek) {
  EXPECT_EQ(id_at(0), 1);
  EXPECT_EQ(id_at(24), 5);
  EXPECT_EQ(id_at(30), 1);
}

}  // namespace
}  // namespace rigwire::protocols::beidou
