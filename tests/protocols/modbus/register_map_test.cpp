#include "protocols/modbus/register_map.h"

#include <gtest/gtest.h>

#include <array>

namespace rigwire::protocols::modbus {
namespace {

constexpr std::array<RegisterEntry, 3> kMap{
    RegisterEntry{"row", Table::holding_registers, 10, 3, 6, Format::s16, Access::read_write, "%",
                  0.1, -1000, 1000, 0, "a row with a stride"},
    RegisterEntry{"wide", Table::input_registers, 30, 1, 2, Format::s32, Access::read, "deg", 0.001,
                  -360000, 360000, 0, "two registers"},
    RegisterEntry{"after", Table::input_registers, 32, 1, 1, Format::u16, Access::read, "", 1, 0,
                  65535, 7, ""}};

TEST(RegisterMap, FindsRowsByStrideAndSkipsTheRegistersBetween) {
  const auto second = find_register(kMap, Table::holding_registers, 16);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->entry->name, "row");
  EXPECT_EQ(second->index, 1);
  EXPECT_FALSE(find_register(kMap, Table::holding_registers, 11));
  EXPECT_FALSE(find_register(kMap, Table::holding_registers, 28));
  EXPECT_FALSE(find_register(kMap, Table::holding_registers, 9));
  EXPECT_FALSE(find_register(kMap, Table::input_registers, 16));
}

TEST(RegisterMap, FindsBothWordsOfAWideValue) {
  EXPECT_EQ(find_register(kMap, Table::input_registers, 30)->word, 0);
  EXPECT_EQ(find_register(kMap, Table::input_registers, 31)->word, 1);
  EXPECT_EQ(find_register(kMap, Table::input_registers, 32)->entry->name, "after");
}

TEST(RegisterMap, CountsAreRoundedAndHeldInRange) {
  EXPECT_EQ(to_counts(kMap[0], 12.34), 123);
  EXPECT_EQ(to_counts(kMap[0], -12.36), -124);
  EXPECT_EQ(to_counts(kMap[0], 1e12), 1000);
  EXPECT_EQ(to_counts(kMap[0], -1e12), -1000);
  EXPECT_DOUBLE_EQ(to_physical(kMap[0], -124), -12.4);
}

TEST(RegisterMap, SignComesFromTheFormat) {
  EXPECT_EQ(signed_value(kMap[0], 0xFFFF), -1);
  EXPECT_EQ(signed_value(kMap[2], 0xFFFF), 65535);
}

TEST(RegisterMap, MarkdownRowsNameEverything) {
  EXPECT_EQ(markdown_row(kMap[0]),
            "| 10 + 6 k | `row` | s16 | 0.1 % | -1000 .. 1000 | 0 | a row with a stride |");
  EXPECT_EQ(markdown_row(kMap[2]), "| 32 | `after` | u16 | | 0 .. 65535 | 7 | |");
}

}  // namespace
}  // namespace rigwire::protocols::modbus
