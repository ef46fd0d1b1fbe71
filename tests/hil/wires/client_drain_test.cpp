// Waiting for clients, with ends that say what they have not taken.
#include "hil/wires/client_drain.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rigwire::hil {
namespace {

class SlowEnd final : public QueuedOutlet {
 public:
  SlowEnd() : QueuedOutlet(16, 64) {}
  void send() {
    push(kStart, 0, statistics_, {});
    transmit_front({});
  }
  [[nodiscard]] WireKind kind() const override { return WireKind::serial; }
  [[nodiscard]] std::optional<std::size_t> untaken() const override {
    ++looks;
    return waiting;
  }
  std::optional<std::size_t> waiting;
  mutable int looks = 0;

 private:
  bool transmit(std::uint64_t, std::span<const std::uint8_t>) override { return true; }
  void tell_of(WireTap&, SimTime, std::uint64_t, std::span<const std::uint8_t>) override {}
  WireStatistics statistics_;
};

class ClientDrainTest : public testing::Test {
 protected:
  ClientDrainTest() { drain_.watch("gnss", end_); }
  SlowEnd end_;
  ClientDrain drain_;
};

TEST_F(ClientDrainTest, NobodyIsAskedBeforeSomethingHasLeft) {
  end_.waiting = 5;
  EXPECT_TRUE(drain_.taken());
  EXPECT_EQ(end_.looks, 0);
}

TEST_F(ClientDrainTest, WhatIsNotTakenIsWaitedForUntilItIs) {
  end_.send();
  end_.waiting = 100;
  EXPECT_FALSE(drain_.taken());
  end_.waiting = 0;
  EXPECT_TRUE(drain_.taken());
  end_.waiting = 7;  // not this run's: nothing has left since
  EXPECT_TRUE(drain_.taken());
}

TEST_F(ClientDrainTest, AWireThatTellsNothingHoldsNobodyUp) {
  end_.send();
  EXPECT_TRUE(drain_.taken());
}

TEST_F(ClientDrainTest, AClientThatStoppedCostsThePatienceOnce) {
  end_.send();
  end_.waiting = 100;
  EXPECT_FALSE(drain_.taken());
  EXPECT_EQ(drain_.give_up(), std::vector<std::string>{"gnss"});
  EXPECT_TRUE(drain_.taken());
  end_.send();
  end_.waiting = 200;
  EXPECT_TRUE(drain_.taken()) << "it was waited for again, though it takes nothing";
  end_.waiting = 150;
  EXPECT_FALSE(drain_.taken()) << "it reads again and was not waited for";
  EXPECT_EQ(drain_.give_up().size(), 1U);
  end_.waiting = 0;
  EXPECT_TRUE(drain_.taken());
  end_.send();
  end_.waiting = 1;
  EXPECT_FALSE(drain_.taken());
}

}  // namespace
}  // namespace rigwire::hil
