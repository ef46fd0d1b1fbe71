#include "emulators/supply.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <utility>
#include <vector>

#include "emulators/canopen/rotary_encoder.h"
#include "emulators/nonvolatile_memory.h"
#include "recorder.h"
#include "supply_cuts.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;

/// When it is switched, until nothing more is planned.
std::vector<std::pair<Duration, bool>> changes(Supply supply) {
  std::vector<std::pair<Duration, bool>> list;
  while (supply.next_change() != kNever) {
    const SimTime instant = supply.next_change();
    supply.change();
    list.emplace_back(instant - kStart, supply.on());
  }
  return list;
}

using Changes = std::vector<std::pair<Duration, bool>>;
constexpr bool kOn = true;
constexpr bool kOff = false;

SupplySettings cut_at(const std::vector<Duration>& cuts) {
  return {.power_on = 100ms, .faults = rigwire::test::cuts(cuts)};
}

TEST(Supply, FaultsOfTheSettingsAreThoseOfTheBook) {
  const Supply supply(cut_at({1s, 3s}));
  ASSERT_EQ(supply.book().list().size(), 2U);
  EXPECT_EQ(supply.book().list()[1].fault.when, (FaultPeriod{3s, 500ms}));
  EXPECT_EQ(changes(supply),
            (Changes{{100ms, kOn}, {1s, kOff}, {1500ms, kOn}, {3s, kOff}, {3500ms, kOn}}));
}

TEST(Supply, FaultsThatOverlapOrTouchAreOneOutage) {
  Supply supply(cut_at({1s}));
  supply.begin({{1200ms, 1s}, NoSupplyFault{}});
  supply.begin({{2200ms, 300ms}, NoSupplyFault{}});
  EXPECT_EQ(changes(supply), (Changes{{100ms, kOn}, {1s, kOff}, {2500ms, kOn}}));
}

TEST(Supply, OutageAtPowerOnDelaysIt) {
  Supply supply(cut_at({}));
  supply.begin({{50ms, 1s}, NoSupplyFault{}});
  EXPECT_EQ(changes(supply), (Changes{{1050ms, kOn}}));
}

TEST(Supply, FaultEndsWhenToldBegunOrNot) {
  Supply supply(cut_at({1s, 3s}));
  supply.change();  // On.
  supply.change();  // The first cut.
  EXPECT_TRUE(supply.end(1, kStart + 1100ms));
  EXPECT_TRUE(supply.end(2, kStart + 1100ms));
  EXPECT_FALSE(supply.end(1, kStart + 1200ms)) << "it is over";
  EXPECT_EQ(changes(supply), (Changes{{1100ms, kOn}}));
  EXPECT_EQ(supply.book().list()[0].fault.when, (FaultPeriod{1s, 100ms})) << "the past stands";
}

TEST(Supply, FaultOutOfRangeIsRefused) {
  Supply supply(cut_at({}));
  EXPECT_THROW(supply.begin({{-1s, 1s}, NoSupplyFault{}}), std::invalid_argument);
  EXPECT_TRUE(supply.book().empty());
}

/// What an encoder sends that is cut by its settings, or live at the same instants.
std::vector<std::pair<SimTime, protocols::can::Frame>> frames(bool live) {
  RotaryEncoderSettings settings;
  settings.heartbeat_ms = 100;
  if (!live) {
    settings.supply.faults = rigwire::test::cuts({1s, 2003ms}, 321ms);
  }
  VolatileMemory memory;
  rigwire::test::FrameRecorder output;
  RotaryEncoder encoder(settings, memory, output);
  FaultBook<SupplyFault>::Id last = 0;
  for (SimTime now = kStart; now <= kStart + 4s; now += 1ms) {
    if (live && (now == kStart + 1s || now == kStart + 2003ms)) {
      last = encoder.supply().begin({{now - kStart, std::nullopt}, NoSupplyFault{}});
    }
    if (live && (now == kStart + 1321ms || now == kStart + 2324ms)) {
      EXPECT_TRUE(encoder.supply().end(last, now));
    }
    encoder.advance(now);
    encoder.update({now, 0.1, 0.0});
  }
  return output.frames;
}

TEST(Supply, CutBegunAndEndedInTheRunIsThatOfTheFile) {
  const auto by_settings = frames(false);
  EXPECT_GT(by_settings.size(), 20U);
  EXPECT_EQ(by_settings, frames(true));
}

}  // namespace
}  // namespace rigwire::emulators
