// A hand on the sticks beside a client: what holds, and what the client finds when it is gone.
#include "hil/world/hand.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;

constexpr std::array<std::string_view, 2> kActuators{"swing", "boom"};

/// Keeps what it is told.
class Puppet final : public sim::Machine, public sim::ValvePort, public sim::VehiclePort {
 public:
  explicit Puppet(bool steers_rear = false) : steers_rear_(steers_rear) {}
  void step(Duration) override {}
  [[nodiscard]] SimTime time() const override { return kStart; }
  [[nodiscard]] std::span<const sim::LinkMotion> links() const override { return {}; }
  [[nodiscard]] std::span<const std::string_view> link_names() const override { return {}; }
  [[nodiscard]] const std::optional<sim::NonFinite>& non_finite() const override { return none_; }
  [[nodiscard]] std::span<const sim::StatusQuantity> status_quantities() const override {
    return {};
  }
  void read_status(std::span<double>) const override {}
  [[nodiscard]] std::span<const sim::TruthField> truth_fields() const override { return {}; }
  void read_truth(std::span<double>) const override {}
  [[nodiscard]] sim::ValvePort* valve_port() override { return this; }
  [[nodiscard]] sim::VehiclePort* vehicle_port() override { return this; }

  [[nodiscard]] std::span<const std::string_view> actuators() const override { return kActuators; }
  void command(const ValveCommand& command) override { valves = command; }
  [[nodiscard]] const ValveCommand& commanded() const override { return valves; }
  [[nodiscard]] ValveSample valve_sample(SimTime) const override { return {}; }
  void command(const VehicleCommand& command) override {
    vehicle = command;
    ++vehicle_commands;
  }
  [[nodiscard]] VehicleSample vehicle_sample(SimTime) const override { return {}; }
  [[nodiscard]] EngineData engine_data() const override { return {}; }
  [[nodiscard]] bool steers_rear() const override { return steers_rear_; }

  ValveCommand valves;
  VehicleCommand vehicle;
  int vehicle_commands = 0;

 private:
  bool steers_rear_;
  std::optional<sim::NonFinite> none_;
};

class HandTest : public testing::Test {
 protected:
  void order(const std::string& name, std::optional<double> value) {
    asked_.of<Hand::Order>(0).push_back({*hand_.settings().find(name), value});
  }
  /// One slice, in which the client may command its valves or its vehicle.
  void slice(std::optional<double> boom = {}, std::optional<double> brake = {}) {
    hand_.lift();
    Shelves requests;
    if (boom) {
      ValveCommand block = machine_.commanded();
      block.opening[1] = *boom;
      machine_.command(block);
    }
    if (brake) {
      VehicleCommand command;
      command.brake_share = *brake;
      machine_.command(command);
      requests.of<VehicleCommand>(3).push_back(command);
    }
    asked_.move_to(requests);
    hand_.lay(kStart, requests);
  }

  Puppet machine_;
  Hand hand_{machine_};
  Shelves asked_;  ///< By a hand.
};

TEST_F(HandTest, TheHandsValueHoldsAndTheClientsGoesOnUnderIt) {
  slice(0.2);
  order("boom", 0.7);
  EXPECT_EQ(machine_.valves.opening[1], 0.2) << "acts with the next slice";
  slice();
  EXPECT_EQ(machine_.valves.opening[1], 0.7);
  EXPECT_EQ(hand_.held(), std::vector<std::string_view>{"boom"});
  slice(-0.4);
  EXPECT_EQ(machine_.valves.opening[1], 0.7) << "a client's command went through";
  slice();
  order("boom", {});
  slice();
  EXPECT_EQ(machine_.valves.opening[1], -0.4) << "what the client asked for meanwhile is gone";
  EXPECT_TRUE(hand_.held().empty());
}

TEST_F(HandTest, OtherActuatorsStayTheClients) {
  order("swing", -1.0);
  slice(0.3);
  EXPECT_EQ(machine_.valves.opening[0], -1.0);
  EXPECT_EQ(machine_.valves.opening[1], 0.3);
  slice(0.5);
  EXPECT_EQ(machine_.valves.opening[1], 0.5);
}

TEST_F(HandTest, TheClientsFloatingSectionIsNotLost) {
  machine_.valves.floating[1] = true;
  order("boom", 0.1);
  slice();
  EXPECT_FALSE(machine_.valves.floating[1]);
  order("boom", {});
  slice();
  EXPECT_TRUE(machine_.valves.floating[1]);
}

// Finding: a hand could not steer the roller's rear drum.
TEST_F(HandTest, TheRearIsSteeredWhereItSteers) {
  EXPECT_EQ(hand_.settings().find("rear_steer"), nullptr);
  Puppet roller(true);
  Hand hand(roller);
  const HandSettings::Row* row = hand.settings().find("rear_steer");
  ASSERT_NE(row, nullptr);
  Shelves requests;
  requests.of<Hand::Order>(0).push_back({*row, -0.3});
  hand.lift();
  hand.lay(kStart, requests);
  EXPECT_EQ(roller.vehicle.rear_steer_rad, -0.3);
  EXPECT_EQ(roller.vehicle.front_steer_rad, 0.0) << "the client's";
}

TEST_F(HandTest, AVehiclesDriverAndItsControllerShareTheMachine) {
  slice({}, 0.25);
  order("travel_speed", 2.0);
  order("parking_brake", 0.0);
  slice();
  EXPECT_EQ(machine_.vehicle.travel_speed_mps, 2.0);
  EXPECT_TRUE(machine_.vehicle.automatic_gear);
  EXPECT_FALSE(machine_.vehicle.parking_brake);
  EXPECT_EQ(machine_.vehicle.brake_share, 0.25) << "the client's";
  slice({}, 0.5);
  EXPECT_EQ(machine_.vehicle.travel_speed_mps, 2.0);
  EXPECT_EQ(machine_.vehicle.brake_share, 0.5);
  order("travel_speed", {});
  order("parking_brake", {});
  slice();
  EXPECT_FALSE(machine_.vehicle.travel_speed_mps.has_value());
  EXPECT_TRUE(machine_.vehicle.parking_brake);
}

TEST_F(HandTest, AHandThatHoldsNothingCommandsNothing) {
  for (int i = 0; i < 3; ++i) {
    slice();
  }
  EXPECT_EQ(machine_.vehicle_commands, 0);
}

}  // namespace
}  // namespace rigwire::hil
