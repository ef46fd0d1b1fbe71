#include "hil/executive/station.h"

#include <gtest/gtest.h>

#include "allocation_counter.h"
#include "emulators/device.h"
#include "made_up_kind.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using test::HeaterCommand;
using test::MoistureProbe;
using test::MoistureSample;

TEST(SampleInbox, KeepsOrderAndGivesTheNextInstant) {
  SampleInbox<MoistureSample> inbox;
  EXPECT_EQ(inbox.next(), kNever);
  inbox.put({kStart + 1ms, 0.0});
  inbox.put({kStart + 2ms, 0.0});
  EXPECT_EQ(inbox.take().time, kStart + 1ms);
  inbox.put({kStart + 3ms, 0.0});
  EXPECT_EQ(inbox.take().time, kStart + 2ms);
  EXPECT_EQ(inbox.next(), kStart + 3ms);
}

TEST(SampleInbox, DoesNotGrowWhileItIsNeverQuiteEmpty) {
  SampleInbox<MoistureSample> inbox;
  for (int i = 0; i < 5; ++i) {
    inbox.put({kStart + i * 1ms, 0.0});
  }
  for (int i = 5; i < 1'000'000; ++i) {
    inbox.put({kStart + i * 1ms, 0.0});
    ASSERT_EQ(inbox.take().time, kStart + (i - 5) * 1ms);
  }
  EXPECT_LE(inbox.capacity(), 32U);
}

TEST(Station, TakesWhatIsOfItsTypeOnItsShelfAndGivesItInTime) {
  emulators::NullByteOutput output;
  MoistureProbe probe(1ms, output);
  StationOf<test::MoistureBackend> station(probe, probe);
  Shelves samples;
  samples.of<MoistureSample>(3) = {{kStart + 1ms, 0.1}, {kStart + 2ms, 0.2}};
  samples.of<MoistureSample>(2) = {{kStart + 1ms, 0.9}};
  samples.of<double>(3) = {5.0};
  EXPECT_EQ(station.take(3, samples), 2U);
  EXPECT_EQ(station.take(4, samples), 0U);
  EXPECT_EQ(station.next_event(), kStart + 1ms);
  EXPECT_EQ(station.next_wakeup(), kStart + 1ms);
  station.advance(kStart + 1ms);
  ASSERT_EQ(probe.samples.size(), 1U);
  EXPECT_EQ(probe.samples[0].share, 0.1);
  station.advance(kStart + 5ms);
  ASSERT_EQ(probe.samples.size(), 2U);
  EXPECT_EQ(station.next_event(), kNever);
}

TEST(Station, AsksOnceForEachPlanAndCommand) {
  emulators::NullByteOutput output;
  MoistureProbe probe(5ms, output);
  StationOf<test::MoistureBackend> station(probe, probe);
  Shelves requests;
  station.collect(7, requests);
  ASSERT_NE(requests.find<SamplePlan>(7), nullptr);
  EXPECT_EQ(requests.find<SamplePlan>(7)->at(0), (SamplePlan{kStart, 5ms}));
  EXPECT_EQ(requests.size(), 1U) << "the command that holds at the start is nothing new";

  probe.heater.power_w = 3.0;
  station.collect(7, requests);
  station.collect(7, requests);
  EXPECT_EQ(requests.size(), 2U);
  EXPECT_EQ(requests.find<HeaterCommand>(7)->at(0).power_w, 3.0);

  probe.plan.period = 1ms;
  probe.heater.power_w = 0.0;
  station.collect(7, requests);
  EXPECT_EQ(requests.size(), 4U);
  EXPECT_EQ(requests.find<HeaterCommand>(7)->back().power_w, 0.0);
  EXPECT_EQ(requests.find<SamplePlan>(7)->back().period, 1ms);
}

/// Commands nothing; its samples belong together by 10 ms.
struct Gatherer final : emulators::Device {
  struct Sample {
    SimTime time{};
  };
  void advance(SimTime /*now*/) override {}
  [[nodiscard]] SimTime next_event() const override { return kStart + 40ms; }
  [[nodiscard]] SamplePlan sample_plan() const override { return {}; }
  [[nodiscard]] emulators::ReceiveCounters received() const override { return {}; }
  [[nodiscard]] double nominal_rate_hz() const override { return 0.0; }
  [[nodiscard]] std::span<const emulators::Quantity> quantities() const override { return {}; }
  void update(const Sample& /*sample*/) { ++taken; }
  [[nodiscard]] SimTime packet_complete_at() const { return kStart + 10ms * (1 + taken / 10); }
  int taken = 0;
};

TEST(Station, WakesUpForTheWholeAndNotForEachSample) {
  Gatherer device;
  StationOf<Gatherer> station(device, device);
  Shelves samples;
  for (int i = 1; i <= 10; ++i) {
    samples.of<Gatherer::Sample>(0).push_back({kStart + i * 1ms});
  }
  station.take(0, samples);
  EXPECT_EQ(station.next_event(), kStart + 1ms);
  EXPECT_EQ(station.next_wakeup(), kStart + 10ms);
  station.advance(kStart + 10ms);
  EXPECT_EQ(device.taken, 10);
  EXPECT_EQ(station.next_wakeup(), kStart + 20ms);
  Shelves requests;
  station.collect(0, requests);
  EXPECT_TRUE(requests.empty()) << "no plan, no command";
}

TEST(Station, DoesNotAllocateOnceItsShelvesAndInboxAreThere) {
  emulators::NullByteOutput output;
  MoistureProbe probe(1ms, output);
  probe.samples.reserve(100'000);
  StationOf<test::MoistureBackend> station(probe, probe);
  Shelves samples;
  Shelves requests;
  SimTime now = kStart;
  const auto slice = [&] {
    samples.clear();
    requests.clear();
    for (int i = 0; i < 10; ++i) {
      now += 1ms;
      samples.of<MoistureSample>(0).push_back({now, 0.5});
    }
    station.take(0, samples);
    station.advance(now - 3ms);
    probe.heater.power_w += 1.0;
    probe.plan.period += 1ns;
    station.collect(0, requests);
  };
  for (int i = 0; i < 10; ++i) {
    slice();
  }
  const auto before = rigwire::test::allocations();
  for (int i = 0; i < 1000; ++i) {
    slice();
  }
  EXPECT_EQ(rigwire::test::allocations(), before);
  EXPECT_EQ(probe.samples.size(), 10'097U);
}

}  // namespace
}  // namespace rigwire::hil
