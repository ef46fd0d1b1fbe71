#include "protocols/glonass/string.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigwire::protocols::glonass {
namespace {

/// Each figure near an end of its field.
Ephemeris example() {
  return {.slot = 24,
          .time_of_day_s = 95 * 900,
          .position_m = {std::ldexp(67'108'863e3, -11), std::ldexp(-67'108'863e3, -11), -500.0},
          .velocity_mps = {std::ldexp(-8'388'607e3, -20), std::ldexp(8'388'607e3, -20), 0.0},
          .acceleration_mps2 = {std::ldexp(15e3, -30), std::ldexp(-15e3, -30), 0.0},
          .clock_correction_s = std::ldexp(-2'097'151, -30),
          .frequency_offset = std::ldexp(1'023, -40),
          .second_delay_s = std::ldexp(-15, -30),
          .healthy = false,
          .accuracy = 14};
}

std::array<String, 4> strings_of(const Ephemeris& e) {
  std::array<String, 4> made{};
  for (std::uint8_t number = 1; number <= 4; ++number) {
    made[number - 1U] = string(number, e, {86'370, 1'461, 8});
  }
  return made;
}

TEST(GlonassString, StringsSayTheOrbitToTheBit) {
  const auto decoded = decode_ephemeris(strings_of(example()));
  ASSERT_TRUE(decoded.ok());
  EXPECT_EQ(*decoded, example());
}

TEST(GlonassString, EveryBitIsInTheCode) {
  for (std::uint8_t number = 1; number <= 5; ++number) {
    const String sound = string(number, example(), {86'370, 1'461, 8});
    EXPECT_TRUE(is_sound(sound));
    for (unsigned bit = 0; bit < 85; ++bit) {
      String bent = sound;
      bent[bit / 32] ^= 0x8000'0000U >> bit % 32;
      EXPECT_FALSE(is_sound(bent)) << bit;
    }
  }
}

TEST(GlonassString, StringsInAnotherOrderAreNoOrbit) {
  auto strings = strings_of(example());
  std::swap(strings[1], strings[2]);
  EXPECT_TRUE(decode_ephemeris(strings).malformed());
}

}  // namespace
}  // namespace rigwire::protocols::glonass
