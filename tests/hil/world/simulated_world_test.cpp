#include "hil/world/simulated_world.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "allocation_counter.h"
#include "hil/world/gnss.h"
#include "hil/world/imu.h"
#include "hil/world/joint.h"
#include "hil/world/ports.h"
#include "made_up_kind.h"
#include "sim/excavator/bucket_soil.h"
#include "sim/gnss/gnss_sensor.h"
#include "sim/ground/ground.h"
#include "sim/scene/scene_description.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;

/// A sledge that goes 1 m/s along x, its turntable turning at 1 rad/s; with a valve block that
/// remembers what it was told.
class Sledge final : public sim::Machine, public sim::ValvePort {
 public:
  explicit Sledge(bool has_valves) : has_valves_(has_valves) { place(); }

  void step(Duration span) override {
    time_ += span;
    place();
  }
  [[nodiscard]] SimTime time() const override { return time_; }
  [[nodiscard]] std::span<const sim::LinkMotion> links() const override { return links_; }
  [[nodiscard]] std::span<const std::string_view> link_names() const override { return kNames; }
  [[nodiscard]] const std::optional<sim::NonFinite>& non_finite() const override { return none_; }
  [[nodiscard]] std::span<const sim::StatusQuantity> status_quantities() const override {
    return kStatus;
  }
  void read_status(std::span<double> values) const override { values[0] = way_m(); }
  [[nodiscard]] std::span<const sim::TruthField> truth_fields() const override { return kTruth; }
  void read_truth(std::span<double> values) const override { values[0] = way_m(); }
  [[nodiscard]] sim::ValvePort* valve_port() override { return has_valves_ ? this : nullptr; }

  [[nodiscard]] std::span<const std::string_view> actuators() const override { return kActuators; }
  void command(const ValveCommand& command) override {
    commanded_ = command;
    told.push_back(command.opening[0]);
  }
  [[nodiscard]] const ValveCommand& commanded() const override { return commanded_; }
  [[nodiscard]] ValveSample valve_sample(SimTime time) const override {
    ValveSample sample;
    sample.time = time;
    sample.spool_position = commanded_.opening;
    sample.swing_angle_rad = told.empty() ? 0.0 : told.back();
    return sample;
  }

  [[nodiscard]] std::span<const sim::LeaningObstacle> leaning_obstacles() const override {
    return leaning;
  }

  std::vector<double> told;  ///< To the first actuator.
  std::vector<sim::LeaningObstacle> leaning;

 private:
  static constexpr std::array<std::string_view, 2> kNames{"sledge", "turntable"};
  static constexpr std::array<std::string_view, 3> kActuators{"blade", "winch", "hook"};
  static constexpr std::array<sim::StatusQuantity, 1> kStatus{{{"way", "m"}}};
  static constexpr std::array<sim::TruthField, 1> kTruth{{{"way_m", 1}}};

  [[nodiscard]] double way_m() const { return to_seconds(time_); }
  void place() {
    links_[0].X_WL.translation().x() = way_m();
    links_[0].v_WL_W.x() = 1.0;
    links_[1] = links_[0];
    links_[1].X_WL.linear() =
        Eigen::AngleAxisd(way_m(), Eigen::Vector3d::UnitZ()).toRotationMatrix();
    links_[1].w_WL_W.z() = 1.0;
  }

  bool has_valves_;
  ValveCommand commanded_;
  SimTime time_ = kStart;
  std::array<sim::LinkMotion, 2> links_;
  std::optional<sim::NonFinite> none_;
};

struct Content {
  explicit Content(bool has_valves = true) {
    auto machine = std::make_unique<Sledge>(has_valves);
    sledge = machine.get();
    in_scene.scene = std::make_unique<sim::Scene>();
    in_scene.scene->add_body("sledge");
    in_scene.scene->add_body("turntable");
    in_scene.machine = std::move(machine);
  }
  MachineInScene in_scene;
  Sledge* sledge;
};

/// One slice of two steps; fails the test on a fault.
void advance(SimulatedWorld& world, const Shelves& requests, SampleBatch& batch) {
  ASSERT_EQ(world.advance(requests, batch), std::nullopt);
}

/// A kind that the world has never heard of: soil is as moist as the sledge has gone metres.
class Probe final : public StepSensor<test::MoistureSample> {
 public:
  explicit Probe(StationIndex station) : StepSensor(station) {}

 private:
  test::MoistureSample measure(const WorldStep& step, SimTime time) override {
    return {time, step.motion({}, time).X_WL.translation().x()};
  }
};

/// Writes down who was asked what.
class Witness final : public WorldSensor {
 public:
  Witness(std::string name, bool casts, std::vector<std::string>& log)
      : name_(std::move(name)), casts_(casts), log_(log) {}
  void take(SimTime frontier, const Shelves& /*requests*/) override { note("take", frontier); }
  void step(const WorldStep& step, Shelves& /*samples*/) override { note("step", step.t1); }
  void slice(const WorldSlice& slice, Shelves& /*samples*/) override { note("slice", slice.t1); }
  [[nodiscard]] bool casts_beams() const override { return casts_; }

 private:
  void note(const std::string& what, SimTime at) {
    log_.push_back(name_ + " " + what + " " +
                   std::to_string(at.time_since_epoch() / Duration{1ms}));
  }
  std::string name_;
  bool casts_;
  std::vector<std::string>& log_;
};

/// Looks at the scene, in the slices in which it is told to.
class Looker final : public WorldSensor {
 public:
  explicit Looker(std::shared_ptr<const bool> looks = std::make_shared<const bool>(true))
      : looks_(std::move(looks)) {}
  void take(SimTime /*frontier*/, const Shelves& /*requests*/) override {}
  [[nodiscard]] bool looks_at_scene() const override { return *looks_; }

 private:
  std::shared_ptr<const bool> looks_;
};

TEST(SimulatedWorld, PlacesNothingForRaysThatNoSensorCasts) {
  SimulatedWorld world({}, Content().in_scene);
  world.add(make_world_imu(0, {}, sim::ImuSensor(sim::perfect_imu(), 1, "imu")));
  const auto looks = std::make_shared<bool>(false);
  world.add(std::make_unique<Looker>(looks));
  SampleBatch batch;
  advance(world, {}, batch);
  EXPECT_EQ(world.scene().slice_end(), std::nullopt);
  *looks = true;
  advance(world, {}, batch);
  EXPECT_EQ(world.scene().slice_end(), kStart + 4ms);
  *looks = false;
  advance(world, {}, batch);
  EXPECT_EQ(world.scene().slice_end(), kStart + 4ms);
}

TEST(SimulatedWorld, RefusesASliceThatIsNoWholeNumberOfSteps) {
  EXPECT_THROW(SimulatedWorld({.step = 2ms, .slice = 3ms}, Content().in_scene),
               std::invalid_argument);
}

TEST(SimulatedWorld, RefusesASceneWithoutTheMachinesLinks) {
  Content content;
  content.in_scene.scene = std::make_unique<sim::Scene>();
  EXPECT_THROW(SimulatedWorld({}, std::move(content.in_scene)), std::invalid_argument);
}

// Finding: lidar and cameras went on seeing a tree upright that had been driven over.
TEST(SimulatedWorld, RaysPassWhereATreeStoodAndMeetItWhereItLies) {
  sim::SceneDescription description;
  description.terrain = sim::LevelTerrain{};
  sim::TreeField& field = description.trees.emplace_back();
  field.count = 1;
  field.centre_m = {20.0, 0.0};
  field.half_lengths_m = {2.0, 2.0};
  field.smallest_m = field.largest_m = 12.0;
  sim::BuiltScene built = sim::build_scene(description, {}, 1);
  Content content;
  content.in_scene.scene = std::move(built.scene);
  content.in_scene.scene->add_body("sledge");
  content.in_scene.scene->add_body("turntable");
  content.in_scene.terrain = built.terrain;
  content.in_scene.ground =
      std::make_unique<sim::Ground>(built.ground, built.soils, built.obstacles);
  content.in_scene.looks = built.looks;
  Sledge& sledge = *content.sledge;
  const Eigen::Vector3d foot = built.obstacles.front().foot_W();
  SimulatedWorld world({}, std::move(content.in_scene));
  world.add(std::make_unique<Looker>());
  const auto seen = [&](double height_m) {
    SampleBatch batch;
    advance(world, {}, batch);
    const auto hit = world.scene().cast({0.0, foot.y(), height_m}, Eigen::Vector3d::UnitX(), 0.1,
                                        60.0, *world.scene().slice_end());
    return hit ? hit->range_m - foot.x() : 100.0;
  };
  EXPECT_NEAR(seen(1.0), -0.225, 0.02);
  // About y, to the east.
  sledge.leaning.push_back({.obstacle = 0, .axis_W = Eigen::Vector3d::UnitY()});
  for (const double angle : {0.1, 0.3, 0.6}) {
    sledge.leaning.front().angle_rad = angle;
    // It turns about its foot, which is in the ground.
    EXPECT_NEAR(seen(1.0), (1.0 - foot.z()) * std::tan(angle) - 0.225 / std::cos(angle), 0.05)
        << angle;
  }
  sledge.leaning.front().angle_rad = 0.5 * std::numbers::pi;
  EXPECT_EQ(seen(2.8), 100.0) << "above what lies";
  EXPECT_LT(seen(0.15), 12.0) << "what lies";
}

TEST(SimulatedWorld, AsksSensorsInTheOrderThatTheHeaderTells) {
  std::vector<std::string> log;
  SimulatedWorld world({}, Content().in_scene);
  world.add(std::make_unique<Witness>("a", false, log));
  world.add(std::make_unique<Witness>("b", true, log));
  world.add(std::make_unique<Witness>("c", false, log));
  world.add(std::make_unique<Witness>("d", true, log));
  SampleBatch batch;
  advance(world, {}, batch);
  EXPECT_THAT(log, ElementsAre("a take 0", "b take 0", "c take 0", "d take 0",  //
                               "a step 1", "b step 1", "c step 1", "d step 1",  //
                               "a step 2", "b step 2", "c step 2", "d step 2",  //
                               "b slice 2", "d slice 2", "a slice 2", "c slice 2"));
}

TEST(SimulatedWorld, CarriesAKindThatItHasNeverHeardOf) {
  SimulatedWorld world({}, Content().in_scene);
  world.add(std::make_unique<Probe>(4));
  SampleBatch batch;
  std::vector<test::MoistureSample> all;
  const auto run = [&](const Shelves& requests, int slices) {
    const Shelves none;
    for (int i = 0; i < slices; ++i) {
      advance(world, i == 0 ? requests : none, batch);
      if (const auto* some = batch.samples.find<test::MoistureSample>(4)) {
        all.insert(all.end(), some->begin(), some->end());
      }
    }
  };
  Shelves plan;
  plan.of<SamplePlan>(4).push_back({kStart, 750us});
  plan.of<SamplePlan>(3).push_back({kStart, 1us});
  run(plan, 3);
  ASSERT_EQ(all.size(), 9U) << "0, 0.75 ... 6 ms";
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].time, kStart + static_cast<int>(i) * 750us);
    EXPECT_NEAR(all[i].share, to_seconds(all[i].time), 1e-12);
  }
  all.clear();
  plan.clear();
  plan.of<SamplePlan>(4) = {{kStart, 100us}, {kStart, 2ms}};  // the newest counts
  run(plan, 2);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].time, kStart + 8ms);
  EXPECT_EQ(all[1].time, kStart + 10ms);
  EXPECT_THAT(batch.state, ElementsAre(testing::DoubleNear(0.010, 1e-12)));
}

TEST(SimulatedWorld, ImuFeelsGravityAndTheJointItsAngle) {
  SimulatedWorld world({.gravity_mps2 = 9.5}, Content().in_scene);
  world.add(make_world_imu(0, {}, sim::ImuSensor(sim::perfect_imu(), 1, "imu")));
  world.add(make_world_joint(1, 0, 1, sim::JointAngle(2)));
  Shelves plans;
  plans.of<SamplePlan>(0).push_back({kStart + 1500us, 1s});
  plans.of<SamplePlan>(1).push_back({kStart + 1500us, 1s});
  SampleBatch batch;
  advance(world, plans, batch);
  ASSERT_EQ(batch.samples.size(), 2U);
  const ImuSample& felt = batch.samples.find<ImuSample>(0)->at(0);
  EXPECT_EQ(felt.time, kStart + 1500us);
  EXPECT_NEAR(felt.specific_force_mps2.z, 9.5, 1e-9);
  EXPECT_TRUE(std::isnan(felt.magnetic_field_t.x));
  EXPECT_NEAR(batch.samples.find<EncoderSample>(1)->at(0).angle_rad, 0.0015, 1e-9);
}

TEST(SimulatedWorld, CommandsReachTheValveBlockBeforeTheSlice) {
  Content content;
  const Sledge& sledge = *content.sledge;
  SimulatedWorld world({}, std::move(content.in_scene));
  const std::vector<std::string> sections{"blade"};
  world.add(make_world_valves(0, world.machine(), sections));
  world.add(make_world_valves(1, world.machine(), sections));
  const auto opened = [](double opening) {
    ValveCommand command;
    command.opening[0] = opening;
    return command;
  };
  Shelves requests;
  requests.of<SamplePlan>(1).push_back({kStart, 1ms});
  requests.of<ValveCommand>(1) = {opened(0.3)};
  requests.of<ValveCommand>(0) = {opened(0.1), opened(0.2)};
  requests.of<ValveCommand>(2) = {opened(0.9)};
  SampleBatch batch;
  advance(world, requests, batch);
  EXPECT_THAT(sledge.told, ElementsAre(0.1, 0.2, 0.3)) << "the last that was added counts";
  ASSERT_EQ(batch.samples.find<ValveSample>(0), nullptr);
  ASSERT_EQ(batch.samples.find<ValveSample>(1)->size(), 3U);
  EXPECT_EQ(batch.samples.find<ValveSample>(1)->at(0).swing_angle_rad, 0.3);
}

TEST(SimulatedWorld, SectionsMoveTheActuatorsThatTheyName) {
  Content content;
  const Sledge& sledge = *content.sledge;
  SimulatedWorld world({}, std::move(content.in_scene));
  world.add(make_world_valves(0, world.machine(), std::vector<std::string>{"hook", "blade"}));
  world.add(make_world_valves(1, world.machine(), std::vector<std::string>{"winch"}));
  ValveCommand first;
  first.opening = {0.1, 0.2, 0.9};
  first.floating[0] = true;
  ValveCommand second;
  second.opening = {0.3, 0.9};
  Shelves requests;
  requests.of<SamplePlan>(0).push_back({kStart, 1s});
  requests.of<SamplePlan>(1).push_back({kStart, 1s});
  requests.of<ValveCommand>(0) = {first};
  requests.of<ValveCommand>(1) = {second};
  SampleBatch batch;
  advance(world, requests, batch);
  EXPECT_THAT(sledge.commanded().opening, ElementsAre(0.2, 0.3, 0.1, 0, 0, 0, 0, 0));
  EXPECT_TRUE(sledge.commanded().floating[2]);
  EXPECT_FALSE(sledge.commanded().floating[0]);
  EXPECT_THAT(batch.samples.find<ValveSample>(0)->at(0).spool_position,
              ElementsAre(0.1, 0.2, 0, 0, 0, 0, 0, 0));
  EXPECT_THAT(batch.samples.find<ValveSample>(1)->at(0).spool_position,
              ElementsAre(0.3, 0, 0, 0, 0, 0, 0, 0));
}

TEST(SimulatedWorld, RefusesSectionsOfNoActuator) {
  SimulatedWorld world({}, Content().in_scene);
  const auto make = [&](const std::vector<std::string>& sections) {
    return [&world, sections] { (void)make_world_valves(0, world.machine(), sections); };
  };
  EXPECT_THAT(make({"blade", "lid"}),
              testing::ThrowsMessage<std::invalid_argument>(HasSubstr("'lid'")));
  EXPECT_THAT(make({"blade", "hook", "blade"}),
              testing::ThrowsMessage<std::invalid_argument>(HasSubstr("named twice")));
}

TEST(SimulatedWorld, RefusesSensorsOfPortsThatTheMachineHasNot) {
  SimulatedWorld world({}, Content(false).in_scene);
  EXPECT_THAT([&] { (void)make_world_valves(0, world.machine(), {}); },
              testing::ThrowsMessage<std::invalid_argument>(HasSubstr("no valve block")));
  EXPECT_THAT(
      [&] {
        (void)make_world_vehicle(0, world.machine(), sim::VehicleSensors({}, {}, 1, "vehicle"));
      },
      testing::ThrowsMessage<std::invalid_argument>(HasSubstr("no drive train")));
}

/// Keeps what it is told.
struct Notebook final : TruthObserver {
  struct Line {
    SimTime time;
    double way_m;
    std::vector<std::string> antennas;
    double first_longitude_deg;
  };
  explicit Notebook(std::vector<Line>& into) : lines(into) {}
  void record(const TruthRecord& record) override {
    Line line{record.time, record.machine.at(0), {}, record.antennas.at(0).place.longitude_deg};
    for (const AntennaTruth& antenna : record.antennas) {
      line.antennas.emplace_back(antenna.device);
    }
    lines.push_back(std::move(line));
  }
  std::vector<Line>& lines;
};

/// Keeps the quantities of the newest record.
struct StateKeeper final : TruthObserver {
  explicit StateKeeper(std::vector<std::pair<std::string, double>>& into) : state(into) {}
  void record(const TruthRecord& record) override {
    state.clear();
    for (const StateTruth& quantity : record.state) {
      state.emplace_back(quantity.name, quantity.value);
    }
  }
  std::vector<std::pair<std::string, double>>& state;
};

// Criteria and plots had other names and units than `read` and `wait`.
TEST(SimulatedWorld, TheTruthHasTheQuantitiesOfReadWithItsValues) {
  SimulatedWorld world({}, Content().in_scene);
  std::vector<std::pair<std::string, double>> state;
  world.add_truth_observer(std::make_unique<StateKeeper>(state), 2ms);
  SimulatedWorld moved = std::move(world);
  SampleBatch batch;
  advance(moved, {}, batch);
  ASSERT_EQ(batch.state.size(), 1U);
  ASSERT_EQ(moved.state_quantities().size(), 1U);
  EXPECT_THAT(state, ElementsAre(std::pair<std::string, double>("way", batch.state[0])));
  EXPECT_EQ(moved.state_quantities()[0].unit, "m");
  EXPECT_NEAR(batch.state[0], 0.002, 1e-12);
}

TEST(SimulatedWorld, TellsWhereTheAntennasAreInTheOrderOfTheSensors) {
  const Calendar calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0});
  const sim::LocalFrame frame({49.0, 7.0, 200.0, 48.0});
  SimulatedWorld world({}, Content().in_scene);
  const auto antenna = [&](StationIndex station, const std::string& name, double x_m) {
    SensorMount mount;
    mount.X_LS.translation().x() = x_m;
    world.add(make_world_gnss(station, name, mount, frame,
                              sim::GnssSensor({}, calendar, frame, 1, name)));
  };
  antenna(0, "right", 1.0);
  antenna(1, "left", -1.0);
  std::vector<Notebook::Line> lines;
  world.add_truth_observer(std::make_unique<Notebook>(lines), 3ms);
  Shelves plans;
  plans.of<SamplePlan>(1).push_back({kStart + 4ms, 1s});
  SampleBatch batch;
  advance(world, plans, batch);
  EXPECT_TRUE(batch.samples.empty());
  advance(world, {}, batch);
  ASSERT_EQ(batch.samples.size(), 1U);
  EXPECT_EQ(batch.samples.find<GnssSample>(1)->at(0).time, kStart + 4ms);
  advance(world, {}, batch);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].time, kStart + 3ms);
  EXPECT_EQ(lines[1].time, kStart + 6ms);
  EXPECT_NEAR(lines[1].way_m, 0.006, 1e-12);
  EXPECT_THAT(lines[1].antennas, ElementsAre("right", "left"));
  EXPECT_NEAR(lines[1].first_longitude_deg, frame.to_geodetic({1.006, 0.0, 0.0}).longitude_deg,
              1e-12);
}

TEST(StepSensor, DoesNotAllocateOnceItsShelfIsThere) {
  Probe probe(0);
  Shelves requests;
  requests.of<SamplePlan>(0).push_back({kStart, 100us});
  Shelves samples;
  const std::array<sim::LinkMotion, 1> links;
  SimTime now = kStart;
  std::size_t made = 0;
  const auto slice = [&] {
    samples.clear();
    probe.take(now, requests);
    probe.step({now, now + 1ms, links, links, 9.8}, samples);
    now += 1ms;
    made += samples.size();
  };
  slice();
  const auto before = rigwire::test::allocations();
  for (int i = 0; i < 100; ++i) {
    slice();
  }
  EXPECT_EQ(rigwire::test::allocations(), before);
  EXPECT_EQ(made, 11U + 100U * 10U);
}

}  // namespace
}  // namespace rigwire::hil
