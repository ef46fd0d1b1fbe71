// What "save" wrote down is taken back exactly when the settings could hold it, too.
#include "emulators/openimu/settings.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace rigwire::emulators {
namespace {

constexpr OpenImuVariant kVariants[] = {OpenImuVariant::openimu300ri, OpenImuVariant::openimu335ri};

bool is_setting(const OpenImuMemory& memory, OpenImuVariant variant) {
  OpenImuSettings settings;
  settings.variant = variant;
  settings.source_address = memory.address;
  settings.configuration = memory.configuration;
  try {
    validate(settings);
  } catch (const std::invalid_argument&) {
    return false;
  }
  return true;
}

/// Every value up to `most` of what `change` sets; how many of them are right.
template <class Change>
int taken_back(OpenImuVariant variant, unsigned most, Change change) {
  int taken = 0;
  for (unsigned value = 0; value <= most; ++value) {
    OpenImuMemory memory{.address = 0x80, .configuration = {}};
    memory.configuration.packet_mask &= packets_of(variant);
    change(memory, value);
    const auto read = unsealed(sealed(memory), variant);
    EXPECT_EQ(read.has_value(), is_setting(memory, variant)) << value;
    taken += read == memory ? 1 : 0;
  }
  return taken;
}

TEST(OpenImuMemoryTest, HoldsWhatTheSettingsAllowAndNothingElse) {
  const auto byte = [](unsigned value) { return static_cast<std::uint8_t>(value); };
  const auto word = [](unsigned value) { return static_cast<std::uint16_t>(value); };
  for (const OpenImuVariant variant : kVariants) {
    const auto count = [&](unsigned most, auto change) {
      return taken_back(variant, most, change);
    };
    EXPECT_EQ(count(255, [&](auto& m, unsigned n) { m.address = byte(n); }), 120);
    EXPECT_EQ(count(255, [&](auto& m, unsigned n) { m.configuration.rate_divider = byte(n); }), 9);
    EXPECT_EQ(count(255, [&](auto& m, unsigned n) { m.configuration.rate_cut_off_hz = byte(n); }),
              7);
    EXPECT_EQ(
        count(255, [&](auto& m, unsigned n) { m.configuration.acceleration_cut_off_hz = byte(n); }),
        7);
    EXPECT_EQ(count(511, [&](auto& m, unsigned n) { m.configuration.orientation = word(n); }), 24);
    EXPECT_EQ(count(63, [&](auto& m, unsigned n) { m.configuration.packet_mask = word(n); }),
              variant == OpenImuVariant::openimu300ri ? 16 : 32);
    EXPECT_EQ(count(255, [&](auto& m, unsigned n) { m.configuration.slope_priority = byte(n); }),
              4);
    EXPECT_GT(count(65535, [&](auto& m, unsigned n) { m.configuration.behaviour = word(n); }), 1);
  }
}

}  // namespace
}  // namespace rigwire::emulators
