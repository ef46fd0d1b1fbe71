#include "protocols/slcan/bit_rate.h"

#include <gtest/gtest.h>

namespace rigwire::protocols::slcan {
namespace {

TEST(SlcanRates, CodesOfTheProtocol) {
  EXPECT_EQ(rate_code(250'000), 5U);
  EXPECT_EQ(rate_code(1'000'000), 8U);
  EXPECT_FALSE(rate_code(333'333));
  for (unsigned code = 0; code < kBitRates_bps.size(); ++code) {
    EXPECT_EQ(rate_of_code(code, 250'000), kBitRates_bps[code]);
  }
}

TEST(SlcanRates, DigitsThatProgramsDisagreeAbout) {
  EXPECT_EQ(rate_of_code(7, 750'000), 750'000U);
  EXPECT_EQ(rate_of_code(7, 800'000), 800'000U);
  EXPECT_EQ(rate_of_code(9, 250'000), 83'300U);
}

// The values that LAWICEL's manual and the CAN in Automation table for a 16 MHz SJA1000 give.
TEST(SlcanRates, RegistersOfTheUsualRates) {
  EXPECT_EQ(rate_of_registers(0x311C), 10'000U);
  EXPECT_EQ(rate_of_registers(0x181C), 20'000U);
  EXPECT_EQ(rate_of_registers(0x091C), 50'000U);
  EXPECT_EQ(rate_of_registers(0x041C), 100'000U);
  EXPECT_EQ(rate_of_registers(0x031C), 125'000U);
  EXPECT_EQ(rate_of_registers(0x011C), 250'000U);
  EXPECT_EQ(rate_of_registers(0x001C), 500'000U);
  EXPECT_EQ(rate_of_registers(0x0016), 800'000U);
  EXPECT_EQ(rate_of_registers(0x0014), 1'000'000U);
}

TEST(SlcanRates, JumpWidthAndSamplingDoNotChangeTheRate) {
  EXPECT_EQ(rate_of_registers(0xC19C), rate_of_registers(0x011C));
}

TEST(SlcanRates, RegistersBeyondAnyBusAreRefused) {
  EXPECT_FALSE(rate_of_registers(0x0000));       // 2.67 Mbit/s
  EXPECT_EQ(rate_of_registers(0x3F7F), 5'000U);  // the slowest that they can say
}

TEST(SlcanRates, NeighboursWithinHalfAPercentAgree) {
  EXPECT_TRUE(rates_agree(83'300, 83'333));
  EXPECT_TRUE(rates_agree(250'000, 251'250));
  EXPECT_FALSE(rates_agree(250'000, 251'300));
  EXPECT_FALSE(rates_agree(250'000, 500'000));
}

}  // namespace
}  // namespace rigwire::protocols::slcan
