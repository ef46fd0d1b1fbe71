// The excavator on tracks, against closed forms.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include "allocation_counter.h"
#include "bench/track_cases.h"
#include "sim/excavator/excavator.h"

namespace rigwire::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr double kG = 9.80665;
constexpr double kMass_kg = 8000.0 + 7500.0 + 1300.0 + 620.0 + 500.0;
constexpr std::size_t kLeft = 4;
constexpr std::size_t kRight = 5;
constexpr std::size_t kBlade = 6;

ExcavatorParameters on_tracks() {
  ExcavatorParameters parameters;
  parameters.carrier = ExcavatorCarrier::moving;
  parameters.running_gear = RunningGear::tracks;
  // Between its tracks, as its file has it.
  parameters.solid.boxes[0].size_m.x() = 3.0;
  return parameters;
}

/// With its centre of mass over the middle of its tracks, so that they bear evenly.
ExcavatorParameters balanced() {
  ExcavatorParameters p = bench::tracks::balanced(1e-3);
  p.tracks.stations = TrackParameters{}.stations;
  return p;
}

using bench::tracks::centre_of_mass_C;
using bench::tracks::place;
using bench::tracks::Slope;
using bench::tracks::travel;
using bench::tracks::yaw_rad;

double forward_mps(const Excavator& machine) {
  const LinkMotion& carrier = machine.link(Link::undercarriage);
  return carrier.v_WL_W.dot(carrier.X_WL.linear().col(0));
}
double track_mps(const Excavator& machine, std::size_t track) {
  return machine.carrier_drives()[track].rate_mps();
}

TEST(TrackTravel, StandsWithItsWeightOnTheTracks) {
  const Ground ground;
  const Excavator machine(balanced(), Eigen::Isometry3d::Identity(), &ground);
  EXPECT_NEAR(machine.carried()->track_load_n(0), 0.5 * kG * kMass_kg, 1.0);
  EXPECT_NEAR(machine.carried()->track_load_n(1), 0.5 * kG * kMass_kg, 1.0);
  EXPECT_NEAR(place(machine).z(), 0.0, 1e-5);
}

TEST(TrackTravel, StraightWithEqualOilAtTheSpeedOfItsOil) {
  const Ground ground;
  Excavator machine(on_tracks(), Eigen::Isometry3d::Identity(), &ground);
  machine.command(travel(0.52, 0.52));  // Half of what is beyond the dead band.
  machine.step(seconds(3));
  const double oil_mps = 0.5 * 200.0 / 6e4 / on_tracks().tracks.area_m2();
  const std::array<double, 3> before{place(machine).x(), machine.carrier_drives()[0].position_m(),
                                     machine.carrier_drives()[1].position_m()};
  machine.step(seconds(7));
  EXPECT_NEAR((place(machine).x() - before[0]) / 7.0, oil_mps, 2e-3 * oil_mps);
  for (const std::size_t track : {0U, 1U}) {
    EXPECT_NEAR((machine.carrier_drives()[track].position_m() - before[track + 1]) / 7.0, oil_mps,
                1e-3 * oil_mps);
  }
  EXPECT_LT(std::abs(place(machine).y()), 1e-6);
  EXPECT_LT(std::abs(yaw_rad(machine)), 1e-7);
  machine.command(travel(0.0, 0.0));
  machine.step(seconds(20));
  EXPECT_LT(std::abs(forward_mps(machine)), 1e-6);
  EXPECT_TRUE(machine.carrier_drives()[0].braked());
}

TEST(TrackTravel, OneTrackAloneTurnsItAboutTheOther) {
  const Ground ground;
  Excavator machine(balanced(), Eigen::Isometry3d::Identity(), &ground);
  machine.command(travel(0.0, 0.6));
  machine.step(seconds(6));
  EXPECT_GT(yaw_rad(machine), 0.5);
  EXPECT_TRUE(machine.carrier_drives()[0].braked());
  EXPECT_LT(std::abs(machine.carrier_drives()[0].position_m()), 5e-3);
}

// Speed of its oil, spinning by friction along the slide, sinkage, slip and energy of climbs.
TEST(TrackTravel, DoesWhatClosedFormsSay) {
  for (const bench::TrackCase& each : bench::track_cases()) {
    EXPECT_NEAR(each.run(1e-3) / each.closed_form, 1.0, each.tolerance)
        << each.name << ", " << each.figure;
  }
}

TEST(TrackTravel, StandsOnASlopeWithItsBrakesWithoutCreep) {
  Slope slope(20.0 * M_PI / 180.0);
  Excavator machine(on_tracks(), slope.X_WC, &slope.ground);
  machine.step(seconds(10));
  const Eigen::Vector3d before = place(machine);
  machine.step(seconds(300));
  ASSERT_TRUE(machine.finite());
  EXPECT_LT((place(machine) - before).norm(), 1e-6);
  EXPECT_TRUE(machine.carrier_drives()[0].braked());
}

TEST(TrackTravel, ABrakeTooWeakForTheSlopeLetsItRollDown) {
  Slope slope(20.0 * M_PI / 180.0);
  ExcavatorParameters p = on_tracks();
  // The oil is shut in the motors, too; floating lets it out.
  const double needed_n =
      0.5 * kG * kMass_kg * (std::sin(20.0 * M_PI / 180.0) - 0.04 * std::cos(20.0 * M_PI / 180.0));
  for (const double share : {0.9, 1.1}) {
    p.tracks.brake_nm = share * needed_n * p.tracks.sprocket_radius_m;
    Excavator machine(p, slope.X_WC, &slope.ground);
    ValveCommand command;
    command.floating[kLeft] = command.floating[kRight] = true;
    machine.command(command);
    const Eigen::Vector3d before = place(machine);
    machine.step(seconds(20));
    const double way = (place(machine) - before).norm();
    if (share < 1.0) {
      EXPECT_GT(way, 0.2);
    } else {
      EXPECT_LT(way, 0.01);
    }
  }
}

// Grip: mu cos(a) = sin(a); the rollers' resistance is inside the track.
TEST(TrackTravel, ClimbsToTheSlopeThatItsGripBears) {
  SoilParameters wet;
  wet.friction = 0.4;
  const double limit = std::atan(0.4);
  const auto gained = [&](double share) {
    Slope slope(share * limit, wet);
    Excavator machine(on_tracks(), slope.X_WC, &slope.ground);
    machine.command(travel(0.3, 0.3));
    machine.step(seconds(4));
    const Eigen::Vector3d before = place(machine);
    machine.step(seconds(4));
    return (place(machine) - before).dot(slope.X_WC.linear().col(0));
  };
  EXPECT_GT(gained(0.97), 0.5);
  EXPECT_LT(gained(1.03), -0.2);
}

// Torque: 2 dp D / r = W (sin(a) + f cos(a)).
TEST(TrackTravel, ClimbsToTheSlopeThatItsMotorsPull) {
  ExcavatorParameters p = on_tracks();
  p.supply.relief_pressure_pa = 15e6;
  const double pull_n = 2.0 * (15e6 - p.supply.tank_pressure_pa) * p.tracks.area_m2();
  const double f = p.tracks.resistance;
  double limit = 0.0;
  for (int i = 0; i < 50; ++i) {
    limit = std::asin(pull_n / (kG * kMass_kg) - f * std::cos(limit));
  }
  ASSERT_LT(std::tan(limit), 0.75);  // Grip is 0.8.
  const auto gained = [&](double share) {
    Slope slope(share * limit);
    Excavator machine(p, slope.X_WC, &slope.ground);
    machine.command(travel(0.2, 0.2));
    machine.step(seconds(4));
    const Eigen::Vector3d before = place(machine);
    machine.step(seconds(4));
    return (place(machine) - before).dot(slope.X_WC.linear().col(0));
  };
  EXPECT_GT(gained(0.97), 0.2);
  EXPECT_LT(gained(1.03), 0.02);
}

TEST(TrackTravel, ASecondPassFeelsTheRut) {
  SoilParameters loam;
  loam.soft = true;
  loam.friction_modulus = 2e5;
  loam.exponent = 0.8;
  HeightField field;
  field.columns = field.rows = 81;
  field.cell_m = 0.5;
  field.origin_m = {-20.0, -20.0};
  field.heights_m.assign(81 * 81, 0.0F);
  const Ground ground(field, {.soils = {loam}, .cells = {}}, {});
  Excavator machine(balanced(), Eigen::Isometry3d::Identity(), &ground);
  machine.command(travel(0.52, 0.52));
  machine.step(seconds(8));
  const double virgin_n = machine.carried()->ploughing_n(0);
  machine.command(travel(-0.52, -0.52));
  machine.step(seconds(3));
  EXPECT_GT(virgin_n, 1e3);
  EXPECT_LT(machine.carried()->ploughing_n(0), 0.2 * virgin_n);
}

// Pump 400 l/min: both tracks at full ask for all of it; the swing takes its share.
TEST(TrackTravel, SwingingWhileItTravelsSharesTheOil) {
  const Ground ground;
  ExcavatorParameters p = on_tracks();
  p.supply.power_limit_w = 1e6;
  p.pumps = ExcavatorPumps::constant;
  Excavator machine(p, Eigen::Isometry3d::Identity(), &ground);
  machine.command(travel(1.0, 1.0));
  machine.step(seconds(4));
  const double alone = track_mps(machine, 0);
  EXPECT_NEAR(alone, 200.0 / 6e4 / p.tracks.area_m2(), 2e-3 * alone);
  ValveCommand both = travel(1.0, 1.0);
  both.opening[0] = 1.0;
  machine.command(both);
  machine.step(seconds(4));
  const double share = 400.0 / (400.0 + 148.0);
  EXPECT_NEAR(track_mps(machine, 0) / alone, share, 0.01);
  EXPECT_NEAR(machine.joint_rates_radps()[0], share * 148.0 / 6e4 / p.swing_displacement_m3prad,
              0.02 * machine.joint_rates_radps()[0]);
}

// In one call, as a program of its own may step it.
TEST(TrackTravel, AWallStopsIt) {
  std::vector<Obstacle> walls(1);
  walls[0].name = "wall";
  walls[0].half_lengths_m = {0.3, 5.0, 1.5};
  walls[0].X_WO.translation() = Eigen::Vector3d(6.0, 0.0, 1.5);
  HeightField field;
  field.columns = field.rows = 41;
  field.cell_m = 1.0;
  field.origin_m = {-20.0, -20.0};
  field.heights_m.assign(41 * 41, 0.0F);
  const Ground ground(field, {}, walls);
  ExcavatorParameters p = on_tracks();
  p.initial.swing_rad = M_PI;  // The arm behind.
  p.initial.boom_rad = 0.9;
  Excavator machine(p, Eigen::Isometry3d::Identity(), &ground);
  machine.command(travel(0.7, 0.7));
  machine.step(seconds(12));
  ASSERT_TRUE(machine.finite());
  // The counterweight, 2.3 m behind the swing axis, is what meets it; its motors stall.
  EXPECT_NEAR(place(machine).x(), 5.7 - 2.3, 0.02);
  EXPECT_LT(std::abs(forward_mps(machine)), 1e-3);
  ASSERT_NE(machine.contact_report(), nullptr);
  EXPECT_EQ(machine.contact_report()->body, "house");
  EXPECT_GT(machine.contact_report()->force_n, 1e5);
  EXPECT_LT(machine.contact_report()->deepest_ever_m, 5e-3);
  EXPECT_NEAR(machine.carrier_drives()[0].drive_n(),
              (p.supply.relief_pressure_pa - p.supply.tank_pressure_pa) * p.tracks.area_m2(), 1.0);
}

// Both at full against each other, without and with the arm at work, on every level.
TEST(TrackTravel, BothTracksAgainstEachOtherAtFullStaySoundAndAllocateNothing) {
  const Ground ground;
  for (const ExcavatorLevel level :
       {ExcavatorLevel::quasi_static, ExcavatorLevel::dynamic, ExcavatorLevel::chambers}) {
    for (const double step_ms : {1.0, 10.0}) {
      ExcavatorParameters p = on_tracks();
      p.supports.emplace_back();
      p.level = level;
      p.step_s = step_ms * 1e-3;
      Excavator machine(p, Eigen::Isometry3d::Identity(), &ground);
      const auto before = rigwire::test::allocations();
      for (int i = 0; i < 300; ++i) {
        const double sign = i % 100 < 50 ? 1.0 : -1.0;
        ValveCommand command = travel(sign, -sign);
        command.opening[0] = 0.5 * sign;
        command.opening[1] = 0.4 * sign;
        command.opening[kBlade] = i < 150 ? 1.0 : -1.0;
        machine.command(command);
        machine.step(milliseconds(20));
      }
      EXPECT_EQ(rigwire::test::allocations(), before);
      ASSERT_TRUE(machine.finite()) << static_cast<int>(level);
      EXPECT_LT(place(machine).norm(), 1.5) << static_cast<int>(level) << " " << step_ms;
      EXPECT_GT(machine.link(Link::undercarriage).X_WL.linear()(2, 2), 0.95);
      EXPECT_LT(machine.link(Link::undercarriage).w_WL_W.norm(), 2.0);
    }
  }
}

// Nothing but friction acts: what the machine had is only lost.
TEST(TrackTravel, CoastingNeverGainsEnergy) {
  const Ground ground;
  Excavator machine(on_tracks(), Eigen::Isometry3d::Identity(), &ground);
  machine.command(travel(1.0, 1.0));
  machine.step(seconds(3));
  ValveCommand float_both;
  float_both.floating[kLeft] = float_both.floating[kRight] = true;
  machine.command(float_both);
  machine.step(milliseconds(100));  // The spools.
  // Kinetic energy of everything, about, with the belts'.
  const auto energy_j = [&] {
    double sum = 0.0;
    const ExcavatorParameters p = on_tracks();
    const std::array<const RigidBodyParameters*, kLinks> bodies{&p.undercarriage, &p.upper, &p.boom,
                                                                &p.stick, &p.bucket};
    for (std::size_t i = 0; i < kLinks; ++i) {
      const LinkMotion& link = machine.links()[i];
      const Eigen::Vector3d to = link.X_WL.linear() * bodies[i]->center_of_mass_m;
      sum += 0.5 * bodies[i]->mass_kg * (link.v_WL_W + link.w_WL_W.cross(to)).squaredNorm();
    }
    for (const CarrierDrive& drive : machine.carrier_drives()) {
      sum += 0.5 * p.tracks.moving_mass_kg * drive.rate_mps() * drive.rate_mps();
    }
    return sum;
  };
  // Greatest of each second, in which arm, tracks and soil have swung to and fro.
  double last_j = 1e300;
  for (int second = 0; second < 10; ++second) {
    double greatest_j = 0.0;
    for (int i = 0; i < 200; ++i) {
      machine.step(milliseconds(5));
      greatest_j = std::max(greatest_j, energy_j());
    }
    EXPECT_LT(greatest_j, last_j) << second;
    last_j = greatest_j;
  }
  EXPECT_LT(last_j, 10.0);
  EXPECT_LT(std::abs(forward_mps(machine)), 1e-3);
}

TEST(TrackTravel, ClimbsAKerbThatItsEndWheelsCanAndNeverJumps) {
  std::vector<Obstacle> kerbs(1);
  kerbs[0].name = "kerb";
  kerbs[0].half_lengths_m = {2.0, 5.0, 0.1};
  kerbs[0].X_WO.translation() = Eigen::Vector3d(5.0, 0.0, 0.1);
  HeightField field;
  field.columns = field.rows = 41;
  field.cell_m = 1.0;
  field.origin_m = {-20.0, -20.0};
  field.heights_m.assign(41 * 41, 0.0F);
  const Ground ground(field, {}, kerbs);
  Excavator machine(on_tracks(), Eigen::Isometry3d::Identity(), &ground);
  machine.command(travel(0.4, 0.4));
  double greatest = 0.0;
  for (int i = 0; i < 12000; ++i) {
    machine.step(milliseconds(1));
    greatest = std::max(greatest, machine.link(Link::undercarriage).a_WL_W.norm());
  }
  EXPECT_GT(place(machine).x(), 4.5);
  EXPECT_NEAR(place(machine).z(), 0.2, 0.02);
  EXPECT_LT(greatest, 3.0 * kG);
}

// Blade down: the front of the tracks leaves the ground, with the oil's pressure of the levers.
TEST(TrackTravel, TheBladeLiftsTheFrontWithTheForceOfTheLevers) {
  const Ground ground;
  ExcavatorParameters p = balanced();
  p.supports.emplace_back();
  Excavator machine(p, Eigen::Isometry3d::Identity(), &ground);
  ValveCommand command;
  command.opening[kBlade] = 0.5;
  machine.command(command);
  machine.step(seconds(20));
  ASSERT_TRUE(machine.finite());
  const auto pads = machine.carried()->pad_loads_n();
  // About the tracks' rear ends, where the tilted machine has its weight.
  const Eigen::Matrix3d R = machine.link(Link::undercarriage).X_WL.linear();
  const Eigen::Vector3d rear_C(-0.5 * p.tracks.length_m, 0.0, 0.0);
  const Eigen::Vector3d pad_C(p.supports[0].x_m, 0.0, p.supports[0].raised_m - 0.85);
  const double weight_m = (R * (centre_of_mass_C(machine, p) - rear_C)).x();
  const double expected = kG * kMass_kg * weight_m / (R * (pad_C - rear_C)).x();
  EXPECT_NEAR(pads[0] + pads[1], expected, 0.03 * expected);
  EXPECT_GT(R(2, 0), 0.05);
  const auto stations = machine.carried()->station_loads_n();
  EXPECT_GT(stations.front(), 1e4);  // The rear end bears.
  EXPECT_EQ(stations[stations.size() / 2 - 1], 0.0);
  machine.command(ValveCommand{});
  const Eigen::Vector3d before = place(machine);
  machine.step(seconds(60));
  EXPECT_LT((place(machine) - before).norm(), 1e-3) << "held by its oil";
}

TEST(TrackTravel, ABladeWhoseOilIsTooWeakLiftsNothing) {
  const Ground ground;
  ExcavatorParameters p = balanced();
  p.supports.emplace_back();
  p.supports[0].bore_m = 0.040;
  p.supports[0].rod_m = 0.025;
  Excavator machine(p, Eigen::Isometry3d::Identity(), &ground);
  ValveCommand command;
  command.opening[kBlade] = 1.0;
  machine.command(command);
  machine.step(seconds(10));
  const auto pads = machine.carried()->pad_loads_n();
  const double most =
      (p.supply.relief_pressure_pa - p.supply.tank_pressure_pa) * p.supports[0].lowering_area_m2();
  EXPECT_LT(pads[0] + pads[1], 1.02 * (most + 450.0 * kG));
  EXPECT_GT(pads[0] + pads[1], 0.9 * most);
  EXPECT_LT(machine.link(Link::undercarriage).X_WL.linear()(2, 0), 0.01);
  EXPECT_NEAR(machine.valve_sample(machine.time()).port_a_pressure_pa[kBlade], 35e6, 1e5);
}

// On tyres, where the reference machine has them.
TEST(TrackTravel, OutriggersLiftTheWheels) {
  const Ground ground;
  ExcavatorParameters p;
  p.carrier = ExcavatorCarrier::moving;
  p.supports.resize(2);
  p.supports[0] = {.name = "blade", .x_m = 2.2};
  p.supports[1] = {.name = "outriggers", .x_m = -2.2, .spread_m = 3.4};
  Excavator machine(p, Eigen::Isometry3d::Identity(), &ground);
  ASSERT_EQ(machine.actuators().size(), 6U);
  EXPECT_EQ(machine.actuators()[5], "outriggers");
  ValveCommand command;
  command.opening[4] = command.opening[5] = 0.5;
  machine.command(command);
  machine.step(seconds(25));
  ASSERT_TRUE(machine.finite());
  double sum = 0.0;
  for (const double load : machine.carried()->pad_loads_n()) {
    sum += load;
  }
  EXPECT_NEAR(sum, kG * kMass_kg, 0.02 * kG * kMass_kg);
  for (const double load : machine.carried()->wheel_loads_n()) {
    EXPECT_EQ(load, 0.0);
  }
}

TEST(TrackTravel, SectionsTransducersAndTruthTellOfTheTracks) {
  const Ground ground;
  ExcavatorParameters p = on_tracks();
  p.supports.emplace_back();
  Excavator machine(p, Eigen::Isometry3d::Identity(), &ground);
  EXPECT_EQ(machine.actuators().size(), 7U);
  EXPECT_EQ(machine.actuators()[kLeft], "left_track");
  EXPECT_EQ(machine.actuators()[kRight], "right_track");
  EXPECT_EQ(machine.actuators()[kBlade], "blade");
  machine.command(travel(0.5, 0.25));
  machine.step(seconds(2));
  const ValveSample sample = machine.valve_sample(machine.time());
  EXPECT_NEAR(sample.spool_position[kLeft], 0.5, 1e-6);
  EXPECT_NEAR(sample.spool_position[kRight], 0.25, 1e-6);
  EXPECT_GT(sample.port_a_pressure_pa[kLeft], sample.port_b_pressure_pa[kLeft]);
  std::size_t count = 0;
  std::size_t at = 0;
  for (const TruthField& field : machine.truth_fields()) {
    at = field.key == "track_mps" ? count : at;
    count += field.count;
  }
  std::vector<double> truth(count);
  machine.read_truth(truth);
  EXPECT_EQ(truth[at], track_mps(machine, 0));
  EXPECT_EQ(truth[at + 1], track_mps(machine, 1));
  EXPECT_EQ(truth[count - 2], 0.0) << "the blade is up; the last is what it does to itself";
  // Without them nothing of it is told.
  const Excavator fixed(ExcavatorParameters{}, Eigen::Isometry3d::Identity());
  EXPECT_EQ(fixed.actuators().size(), 4U);
  EXPECT_EQ(fixed.truth_fields().size(), 8U);
}

TEST(TrackTravel, NumbersThatNoMachineHasAreRefused) {
  const auto refusal = [](auto&& change) {
    ExcavatorParameters p = on_tracks();
    p.supports.emplace_back();
    change(p);
    try {
      validate(p);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  using P = ExcavatorParameters;
  EXPECT_EQ(refusal([](P&) {}), "");
  EXPECT_NE(refusal([](P& p) { p.tracks.stations = 6; }).find("stations"), std::string::npos);
  EXPECT_NE(refusal([](P& p) { p.tracks.shoe_width_m = 2.5; }).find("overlap"), std::string::npos);
  EXPECT_NE(refusal([](P& p) { p.tracks.length_m = 1e9; }).find("length"), std::string::npos);
  EXPECT_NE(refusal([](P& p) { p.tracks.displacement_m3prad = 0.0; }).find("displacement"),
            std::string::npos);
  EXPECT_NE(refusal([](P& p) { p.tracks.moving_mass_kg = 1e-300; }).find("moving_mass"),
            std::string::npos);
  EXPECT_NE(refusal([](P& p) { p.tracks.stiffness_npm = std::nan(""); }).find("stiffness"),
            std::string::npos);
  EXPECT_NE(refusal([](P& p) { p.supports[0].name = "boom"; }).find("twice"), std::string::npos);
  EXPECT_NE(refusal([](P& p) { p.supports[0].name = "My Blade"; }).find("lower-case"),
            std::string::npos);
  EXPECT_NE(refusal([](P& p) { p.supports[0].rod_m = 0.2; }).find("bore"), std::string::npos);
  EXPECT_NE(refusal([](P& p) {
              p.supports.assign(3, {});
              p.supports[1].name = "a";
              p.supports[2].name = "b";
            }).find("at most 8 sections"),
            std::string::npos);
}

}  // namespace
}  // namespace rigwire::sim
