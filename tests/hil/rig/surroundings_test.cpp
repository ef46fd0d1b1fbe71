// What goes wrong around the devices: it acts on the machine and the air, and is refused where
// there is nothing that could fail.
#include "hil/world/surroundings.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <boost/asio/io_context.hpp>
#include <string>
#include <vector>

#include "governed_run.h"
#include "hil/rig/rig.h"
#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using test::file_of;
using test::Json;
using test::OneAtATime;
using test::Ran;
using test::run;
using testing::HasSubstr;

/// The excavator's file without the faults that it has there.
std::vector<std::string> excavator(const std::vector<std::string>& more) {
  std::vector<std::string> sets{"surroundings.engine.faults=[]", "surroundings.pumps.faults=[]"};
  sets.insert(sets.end(), more.begin(), more.end());
  return sets;
}

std::string complaint(const std::string& rig, const std::vector<std::string>& sets) {
  try {
    static_cast<void>(load_rig(file_of(rig), sets));
    return {};
  } catch (const ConfigurationError& error) {
    return error.what();
  }
}

/// Speeds of the engine, second by second.
std::vector<double> speeds_radps(const RigConfiguration& configuration, int seconds) {
  SimulatedWorld world = make_world(configuration);
  auto& port = dynamic_cast<sim::PowerUnitDefectPort&>(*world.machine().power_unit_port());
  world.add(make_world_power_unit_faults(0, port, configuration.surroundings));
  std::vector<double> speeds;
  SampleBatch batch;
  for (SimTime second = kStart + 1s; second <= kStart + std::chrono::seconds{seconds};
       second += 1s) {
    do {
      EXPECT_EQ(world.advance({}, batch), std::nullopt);
    } while (batch.until < second);
    speeds.push_back(
        world.machine().power_unit_port()->power_unit_sample(second).engine.speed_radps);
  }
  return speeds;
}

TEST(Surroundings, AnEngineWithoutFuelRunsDownAndUpAgain) {
  const auto speeds = speeds_radps(
      load_rig(file_of("modbus"),
               excavator({"surroundings.engine.faults=[{type: off, at: 2 s, for: 3 s}]"}))
          .configuration,
      12);
  EXPECT_NEAR(speeds[1], speeds[0], 0.02 * speeds[0]);
  EXPECT_LT(speeds[4], 0.5 * speeds[0]);
  EXPECT_NEAR(speeds[11], speeds[0], 0.05 * speeds[0]);
}

TEST(Surroundings, AListedFaultOfAPartIsThatOfItsOwnList) {
  const std::string keys = "type: derate, at: 2 s, for: 3 s, share: 30 %";
  const auto listed =
      load_rig(file_of("modbus"), excavator({"faults=[{on: machine.engine, " + keys + "}]"}));
  const auto own =
      load_rig(file_of("modbus"), excavator({"surroundings.engine.faults=[{" + keys + "}]"}));
  EXPECT_EQ(config_hash(listed.configuration), config_hash(own.configuration));
  const auto windows = fault_windows(listed.configuration);
  EXPECT_EQ(windows.back().where, "machine.engine");
}

TEST(Surroundings, WhatTheMachineHasNotCannotFail) {
  EXPECT_THAT(complaint("gnss", {"faults=[{on: machine.pumps, type: weak, at: 1 s}]"}),
              HasSubstr("no engine that drives pumps"));
  const std::string clock = complaint("gnss", {"faults=[{on: clock, type: slow, at: 1 s}]"});
  EXPECT_THAT(clock, HasSubstr("nothing of that name can have faults"));
  EXPECT_THAT(clock, HasSubstr("machine.engine"));
  EXPECT_THAT(complaint("gnss", {"faults=[{on: air, type: jamming, at: 1 s}]"}),
              HasSubstr("rain, snow, fog"));
}

/// The rig has no weather of its own.
TEST(Surroundings, FogThatComesUpWhileItRunsIsThatOfTheFile) {
  const OneAtATime alone;
  const std::string empty = "surroundings.air.faults=[]";
  const RigConfiguration clear = load_rig(file_of("lidar"), {empty}).configuration;
  const Request fog{FaultAddCommand{"air", "{type: fog, at: 1.5 s, for: 1 s, visibility: 20 m}"},
                    1s};
  const Ran without = run(clear, {}, 3s);
  const Ran begun = run(clear, {fog}, 3s);
  const Ran written =
      run(load_rig(file_of("lidar"),
                   {"surroundings.air.faults=[{type: fog, at: 1.5 s, for: 1 s, visibility: 20 m}]"})
              .configuration,
          {}, 3s);
  EXPECT_TRUE(begun.answers.at(0)["ok"].get<bool>()) << begun.answers.at(0);
  EXPECT_NE(begun.streams.at("lidar"), without.streams.at("lidar"));
  EXPECT_EQ(begun.streams.at("gnss"), without.streams.at("gnss"));
  EXPECT_EQ(begun.streams, written.streams);
}

/// A hand's fog is the fault with its instants, and goes when it lets go.
TEST(Surroundings, WeatherByHandIsThatOfAFault) {
  const OneAtATime alone;
  const std::string empty = "surroundings.air.faults=[]";
  const RigConfiguration clear = load_rig(file_of("lidar"), {empty}).configuration;
  const auto set = [](const std::string& keys, Duration at) {
    return Request{SetCommand{"air", keys}, at};
  };
  const Ran held = run(
      clear,
      {set("{fog: 50 m}", 1s), set("{fog: 20 m}", 1500ms), set("{rain: 400 mm/h}", 1600ms),
       set("{rain: 5 mm/h, snow: [1]}", 1600ms), set("{hail: 1}", 1600ms),
       set("{fog: 10 m, rain: 0 mm/h}", 1700ms), set("{fog: ''}", 1800ms), set("{fog: null}", 2s)},
      3s);
  for (const std::size_t done : std::array<std::size_t, 3>{0, 1, 7}) {
    EXPECT_TRUE(held.answers.at(done)["ok"].get<bool>()) << held.answers.at(done);
  }
  EXPECT_EQ(held.answers.at(2)["path"], "rain");
  EXPECT_THAT(held.answers.at(2)["allowed"].get<std::string>(), HasSubstr("200"));
  EXPECT_EQ(held.answers.at(3)["path"], "snow");
  EXPECT_EQ(held.answers.at(4)["allowed"], "rain, snow, fog");
  EXPECT_EQ(held.answers.at(5)["path"], "rain") << "all of it is refused";
  EXPECT_EQ(held.answers.at(6)["path"], "fog") << "no value lets nothing go";
  const auto instant = [&](std::size_t answer) {
    return fmt::format("{} ns", held.answers.at(answer)["acts_from_ns"].get<std::int64_t>());
  };
  const auto written =
      run(load_rig(file_of("lidar"),
                   {fmt::format("surroundings.air.faults=[{{type: fog, at: {}, until: {}, "
                                "visibility: 50 m}}, {{type: fog, at: {}, until: {}, "
                                "visibility: 20 m}}]",
                                instant(0), instant(1), instant(1), instant(7))})
              .configuration,
          {}, 3s);
  EXPECT_EQ(held.streams, written.streams);
  EXPECT_NE(held.streams.at("lidar"), run(clear, {}, 3s).streams.at("lidar"));
}

TEST(Surroundings, RainAndSnowFromTheStartAreThoseOfACourse) {
  const OneAtATime alone;
  const auto ran = [](const std::string& air, const std::string& course) {
    return run(load_rig(file_of("lidar"), {"surroundings.air.faults=[" + air + "]",
                                           "scene.weather.course=[" + course + "]"})
                   .configuration,
               {}, 400ms)
        .streams;
  };
  const auto both = ran("", "{rain: 20 mm/h, snow: 5 mm/h}");
  EXPECT_EQ(ran("{type: rain, rate: 20 mm/h}, {type: snow, rate: 5 mm/h}", ""), both);
  EXPECT_NE(ran("", ""), both);
}

TEST(Surroundings, ARunningMachineOffersThePartsThatItHas) {
  const OneAtATime alone;
  const RigConfiguration gator = load_rig(file_of("gnss"), {}).configuration;
  const Ran ran = run(gator, {{FaultAddCommand{"machine.pumps", "{type: weak}"}, 100ms}}, 200ms);
  EXPECT_EQ(ran.answers.at(0)["path"], "on");
  EXPECT_EQ(ran.answers.at(0)["allowed"], "gnss, starfire, bus can, air, machine.engine");
}

/// Speed of machine and engine at those instants, of a gator that is asked for 4 m/s.
struct Drive {
  double speed_mps = 0.0;
  double engine_radps = 0.0;
};
std::vector<Drive> drive(const std::string& faults, std::vector<Duration> instants) {
  const RigConfiguration configuration =
      load_rig(file_of("gnss"), {"surroundings.engine.faults=[" + faults + "]"}).configuration;
  SimulatedWorld world = make_world(configuration);
  sim::VehiclePort& vehicle = *world.machine().vehicle_port();
  world.add(make_world_power_unit_faults(0, dynamic_cast<sim::PowerUnitDefectPort&>(vehicle),
                                         configuration.surroundings));
  VehicleCommand command;
  command.parking_brake = false;
  command.automatic_gear = true;
  command.travel_speed_mps = 4.0;
  vehicle.command(command);
  std::vector<Drive> seen;
  SampleBatch batch;
  for (const Duration instant : instants) {
    do {
      EXPECT_EQ(world.advance({}, batch), std::nullopt);
    } while (batch.until < kStart + instant);
    const VehicleSample sample = vehicle.vehicle_sample(batch.until);
    seen.push_back({sample.ground_speed_mps, sample.engine.speed_radps});
  }
  return seen;
}

TEST(Surroundings, AVehiclesEngineFailsAndComesBack) {
  const auto well = drive("", {3s, 10s});
  EXPECT_NEAR(well[1].speed_mps, 4.0, 0.15);
  const auto weak = drive("{type: derate, at: 0 s, for: 4 s, share: 25 %}", {3s, 14s});
  EXPECT_LT(weak[0].speed_mps, 0.8 * well[0].speed_mps);
  EXPECT_GT(weak[0].speed_mps, 0.05 * well[0].speed_mps);
  EXPECT_NEAR(weak[1].speed_mps, 4.0, 0.15);
  const auto none = drive("{type: off, at: 4 s, for: 8 s}", {4s, 12s, 37s});
  EXPECT_LT(none[1].engine_radps, 0.1 * none[0].engine_radps);
  EXPECT_LT(none[1].speed_mps, 0.8 * none[0].speed_mps);
  EXPECT_NEAR(none[2].speed_mps, 4.0, 0.15);
}

/// A roller that moves as it is told has an engine that moves nothing.
TEST(Surroundings, AMachineThatNoEngineMovesHasNone) {
  const std::string roller = RIGWIRE_SOURCE_DIR "/configs/rigs/roller_road.yaml";
  const std::string fault = "faults=[{on: machine.engine, type: off, at: 1 s}]";
  EXPECT_NO_THROW(static_cast<void>(load_rig(roller, {fault})));
  try {
    static_cast<void>(load_rig(roller, {fault, "machine.roller.level=kinematic"}));
    ADD_FAILURE() << "it was taken";
  } catch (const ConfigurationError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no engine by which it moves"));
  }
}

}  // namespace
}  // namespace rigwire::hil
