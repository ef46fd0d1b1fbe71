#include "protocols/canopen/inclinometer.h"

#include <gtest/gtest.h>

namespace rigwire::protocols::canopen {
namespace {

TEST(InclinometerObjects, EveryRowIsFoundAndKeepsItsLimits) {
  for (const ObjectEntry& entry : inclinometer_objects()) {
    EXPECT_EQ(find(inclinometer_objects(), entry.address), &entry) << entry.name;
    EXPECT_TRUE(has_object(inclinometer_objects(), entry.address.index));
    if (entry.access == Access::read_write) {
      EXPECT_GE(entry.initial, entry.lower) << entry.name;
      EXPECT_LE(entry.initial, entry.upper) << entry.name;
    }
  }
  EXPECT_EQ(find(inclinometer_objects(), {0x6010, 1}), nullptr);
  EXPECT_FALSE(has_object(inclinometer_objects(), 0x6015));
}

/// CiA 410 gives each slope the same five objects, in the width of its value.
TEST(InclinometerObjects, EachSlopeHasItsFiveObjects) {
  for (const SlopeObjects& slope : kSlopes) {
    for (const std::uint16_t part :
         {kSlopeValue, kSlopePreset, kSlopeOffset, kSlopeDifferentialOffset}) {
      const ObjectEntry* entry = find(inclinometer_objects(), slope.address(part));
      ASSERT_NE(entry, nullptr) << std::hex << slope.value + part;
      EXPECT_EQ(entry->type, slope.type) << entry->name;
      EXPECT_EQ(entry->has(EntryFlag::kMappable), part == kSlopeValue) << entry->name;
      EXPECT_EQ(entry->has(EntryFlag::kStored), part != kSlopeValue) << entry->name;
    }
    const ObjectEntry* operation = find(inclinometer_objects(), slope.address(kSlopeOperation));
    ASSERT_NE(operation, nullptr);
    EXPECT_EQ(operation->type, DataType::unsigned8);
    EXPECT_EQ(operation->upper, 3);
  }
}

/// The mapping words of the tables say what the rows say of themselves, and fill their messages.
TEST(InclinometerObjects, DeliveredMappingIsThatOfTheSlopes) {
  const auto mapped = [](std::uint16_t index, std::uint8_t sub) {
    return find(inclinometer_objects(), {index, sub})->initial;
  };
  for (std::size_t i = 0; i < kSlopes.size(); ++i) {
    const auto pdo = static_cast<std::uint16_t>(object::kTransmitMapping + i / 2);
    const ObjectEntry* value = find(inclinometer_objects(), kSlopes[i].address(kSlopeValue));
    EXPECT_EQ(mapped(pdo, 0), 2);
    EXPECT_EQ(mapped(pdo, static_cast<std::uint8_t>(1 + i % 2)), mapping_of(*value));
  }
}

TEST(InclinometerLayouts, IdentifiersFollowTheNodeAndScalesTheResolution) {
  const auto layouts = inclinometer_layouts(10, 100);
  ASSERT_EQ(layouts.size(), 4U);
  EXPECT_EQ(layouts[0].id, 0x18AU);
  EXPECT_EQ(layouts[1].id, 0x28AU);
  EXPECT_EQ(layouts[2].id, 0x70AU);
  EXPECT_EQ(layouts[3].id, 0x08AU);
  EXPECT_EQ(layouts[0].length, 4);
  EXPECT_EQ(layouts[1].length, 8);
  const can::OwnedSignal& lateral = layouts[0].signals.at(1);
  EXPECT_EQ(lateral.name, "slope_lateral");
  EXPECT_EQ(lateral.bit, 16);
  EXPECT_EQ(lateral.width, 16);
  EXPECT_TRUE(lateral.is_signed);
  EXPECT_DOUBLE_EQ(lateral.scale, 0.1);
  EXPECT_DOUBLE_EQ(lateral.lower, -3276.8);
  EXPECT_DOUBLE_EQ(lateral.upper, 3276.7);
  EXPECT_EQ(lateral.unit, "deg");
  EXPECT_EQ(layouts[1].signals.at(1).bit, 32);
  EXPECT_EQ(layouts[1].signals.at(1).width, 32);
}

}  // namespace
}  // namespace rigwire::protocols::canopen
