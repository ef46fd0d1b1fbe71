// The boom watch on a simulated excavator: as fast as it goes, without a wire of the system, the
// same in every run.
#include "boom_watch.h"

#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "drivers/endpoints.h"
#include "hil/record/run_log.h"
#include "hil/rig/rig.h"

namespace {

using namespace std::chrono_literals;
using rigwire::kStart;
using rigwire::protocols::can::Frame;

/// The end of the bus in this process: what the devices send goes to the software under test.
class BusEnd final : public rigwire::drivers::CanBus {
 public:
  explicit BusEnd(BoomWatch& watch) : watch_(watch) {}
  void start(Receiver to_the_bus) override { to_the_bus_ = std::move(to_the_bus); }
  bool deliver(const Frame& frame, Stamp stamp) override {
    heard_.emplace_back(stamp, frame);
    watch_.receive(stamp, frame.id, frame.data);
    return true;
  }
  bool send(const Frame& /*frame*/) override { return true; }
  [[nodiscard]] rigwire::drivers::EndpointStatus status() const override {
    rigwire::drivers::EndpointStatus status;
    status.address = "this process";
    return status;
  }
  [[nodiscard]] const std::vector<std::pair<Stamp, Frame>>& heard() const { return heard_; }

 private:
  BoomWatch& watch_;
  Receiver to_the_bus_;  // for software that sends, too
  std::vector<std::pair<Stamp, Frame>> heard_;
};

/// The machine, its device and the software under test on one bus.
struct Bench {
  explicit Bench(const std::vector<std::string>& changes = {})
      : rig(rigwire::hil::load_rig(RIG_FILE, changes).configuration, io, {}, &log,
            {.buses = {{"can", &bus}}}) {}

  void run_to(rigwire::Duration time) {
    const auto outcome = rig.executive().run_free(kStart + time);
    ASSERT_FALSE(outcome.fault) << *outcome.fault;
  }
  /// The truth, from the machine's state and from no device.
  [[nodiscard]] double true_boom_deg() const {
    const auto quantities = rig.truth().state_quantities();
    const auto state = rig.status().machine;
    for (std::size_t i = 0; i < quantities.size(); ++i) {
      if (quantities[i].name == "boom") {
        return state[i];
      }
    }
    ADD_FAILURE() << "the machine has no boom";
    return std::nan("");
  }

  boost::asio::io_context io;
  rigwire::hil::RunLog log{rigwire::hil::LogLevel::warning};
  BoomWatch watch;
  BusEnd bus{watch};
  rigwire::hil::Rig rig;
};

TEST(BoomWatch, KnowsTheInclinationAsWellAsItsUnitDoes) {
  Bench bench;
  EXPECT_FALSE(bench.watch.inclination_deg(0s)) << "before the first message";
  bench.run_to(2s);
  const auto inclination_deg = bench.watch.inclination_deg(2s);
  ASSERT_TRUE(inclination_deg);
  constexpr double kUnit_deg = 0.5;  // static accuracy of the unit
  EXPECT_NEAR(*inclination_deg, bench.true_boom_deg(), kUnit_deg);
}

TEST(BoomWatch, DoesNotKnowItWhileTheBusIsDisturbed) {
  Bench bench({"buses.can.faults=[{type: disturbance, at: 1 s, for: 500 ms}]"});
  bench.run_to(990ms);
  EXPECT_TRUE(bench.watch.inclination_deg(990ms));
  bench.run_to(1400ms);
  EXPECT_FALSE(bench.watch.inclination_deg(1400ms));
  bench.run_to(3s);
  EXPECT_TRUE(bench.watch.inclination_deg(3s)) << "the unit has come back";
}

TEST(BoomWatch, HearsTheSameFramesAtTheSameInstantsInEveryRun) {
  Bench first;
  Bench second;
  first.run_to(1s);
  second.run_to(1s);
  EXPECT_GT(first.bus.heard().size(), 100U);
  EXPECT_EQ(first.bus.heard(), second.bus.heard());
}

TEST(BoomWatch, FindsTheInstalledRigsToo) {
  EXPECT_NO_THROW((void)rigwire::hil::load_rig(RIGS "/excavator_pit.yaml", {}));
}

}  // namespace
