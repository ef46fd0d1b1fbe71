#include "protocols/canopen/rotary_encoder.h"

#include <gtest/gtest.h>

namespace rigwire::protocols::canopen {
namespace {

TEST(RotaryEncoderObjects, EveryRowIsFoundAndKeepsItsLimits) {
  for (const ObjectEntry& entry : rotary_encoder_objects()) {
    EXPECT_EQ(find(rotary_encoder_objects(), entry.address), &entry) << entry.name;
    EXPECT_TRUE(has_object(rotary_encoder_objects(), entry.address.index));
    if (entry.access == Access::read_write) {
      EXPECT_LE(entry.lower, entry.upper) << entry.name;
      EXPECT_GE(entry.initial, entry.lower) << entry.name;
      EXPECT_LE(entry.initial, entry.upper) << entry.name;
    }
    if (entry.has(EntryFlag::kMappable)) {
      EXPECT_LE(size_of(entry.type), 4U) << entry.name;
    }
  }
  EXPECT_EQ(find(rotary_encoder_objects(), {0x6004, 1}), nullptr);
  EXPECT_FALSE(has_object(rotary_encoder_objects(), 0x6005));
}

/// CiA 301 and 406: what every encoder has.
TEST(RotaryEncoderObjects, MandatoryObjectsAreThere) {
  for (const int index : {0x1000, 0x1001, 0x1018, 0x6000, 0x6004, 0x6200, 0x6500, 0x6501, 0x6503,
                          0x6504, 0x6505, 0x6506, 0x6507, 0x6508, 0x6509}) {
    EXPECT_TRUE(has_object(rotary_encoder_objects(), static_cast<std::uint16_t>(index)))
        << std::hex << index;
  }
}

TEST(RotaryEncoderLayouts, IdentifiersFollowTheNode) {
  const auto layouts = rotary_encoder_layouts(0x20);
  ASSERT_EQ(layouts.size(), 4U);
  EXPECT_EQ(layouts[0].id, 0x1A0U);
  EXPECT_EQ(layouts[1].id, 0x2A0U);
  EXPECT_EQ(layouts[2].id, 0x720U);
  EXPECT_EQ(layouts[3].id, 0x0A0U);
  EXPECT_EQ(layouts[0].signals.at(0).width, 32);
  EXPECT_EQ(layouts[0].length, 4);
}

}  // namespace
}  // namespace rigwire::protocols::canopen
