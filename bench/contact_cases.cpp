#include "bench/contact_cases.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "bench/free_body.h"
#include "fields/constants.h"
#include "hil/command_line/config_files.h"
#include "hil/executive/cpu_time.h"
#include "hil/rig/rig.h"
#include "hil/rig/rig_configuration.h"
#include "hil/world/machine_types.h"
#include "sim/contact/loose_bodies.h"
#include "sim/driveline/driveline.h"
#include "sim/excavator/digging_excavator.h"
#include "sim/random.h"
#include "sim/vehicle/wheeled_vehicle.h"

namespace rigwire::bench {
namespace {

using sim::Ground;
using sim::Obstacle;
using Vector = Eigen::Vector3d;

constexpr double kTrunk_m = 0.2;
/// Length of the lane of trees beside the way; longer where they would overlap.
constexpr double kLane_m = 40.0;
constexpr double kSpeed_mps = 5.0;

/// What a report adds to an outcome, step by step.
class Account {
 public:
  void add(const sim::ContactReport& report) {
    outcome_.gave_j = std::max(outcome_.gave_j, most_lost_j_ - report.lost_j);
    most_lost_j_ = std::max(most_lost_j_, report.lost_j);
    outcome_.deepest_m = std::max(outcome_.deepest_m, report.deepest_ever_m);
    outcome_.dent_m = std::max(outcome_.dent_m, report.dent_m);
    outcome_.pressed_m = std::max(outcome_.pressed_m, report.pressed_m);
    outcome_.greatest_n = std::max(outcome_.greatest_n, report.force_n);
  }
  /// What was lost is counted anew.
  void next_run() { most_lost_j_ = 0.0; }
  ContactOutcome& outcome() { return outcome_; }

 private:
  ContactOutcome outcome_;
  double most_lost_j_ = 0.0;
};

void take_worst(ContactOutcome& worst, const ContactOutcome& one) {
  worst.finite = worst.finite && one.finite;
  worst.came_with_j = std::max(worst.came_with_j, one.came_with_j);
  worst.gave_j = std::max(worst.gave_j, one.gave_j);
  worst.deepest_m = std::max(worst.deepest_m, one.deepest_m);
  worst.dent_m = std::max(worst.dent_m, one.dent_m);
  worst.pressed_m = std::max(worst.pressed_m, one.pressed_m);
  worst.greatest_n = std::max(worst.greatest_n, one.greatest_n);
}

Vector box_inertia(double mass_kg, const Vector& half) {
  const Vector squares = half.cwiseProduct(half);
  return mass_kg / 3.0 *
         Vector(squares.y() + squares.z(), squares.x() + squares.z(), squares.x() + squares.y());
}

ContactOutcome run_free(sim::FreeBody& body, double step_s, double span_s) {
  Account account;
  const double start_j = body.energy_j();
  for (int i = 0; i < static_cast<int>(span_s / step_s); ++i) {
    body.step(step_s);
    account.add(body.contact().report());
  }
  account.outcome().came_with_j = start_j - body.energy_j();
  account.outcome().finite = body.X_WB.matrix().allFinite();
  return account.outcome();
}

ContactOutcome drop_crate(double step_s, const Vector& axis) {
  const Ground ground = sim::ground_with({sim::box_obstacle({0.0, 0.0, -1.0}, {20.0, 20.0, 1.0})});
  const Vector half(0.5, 0.4, 0.3);
  sim::FreeBody crate(ground, sim::ConvexShape::box(half), 1000.0, box_inertia(1000.0, half), 5e6,
                      4e4);
  crate.X_WB.linear() = Eigen::AngleAxisd(40.0 * kDegree, axis.normalized()).matrix();
  crate.X_WB.translation().z() = 1.5;
  return run_free(crate, step_s, 6.0);
}

constexpr double kSlope_rad = 15.0 * kDegree;
constexpr double kRoll_s = 2.0;

ContactOutcome roll_ball(double step_s) {
  Obstacle slope = sim::box_obstacle({0.0, 0.0, 0.0}, {40.0, 20.0, 1.0}, 0.6);
  slope.X_WO.linear() = Eigen::AngleAxisd(kSlope_rad, Vector::UnitY()).matrix();
  const Ground ground = sim::ground_with({slope});
  constexpr double kMass_kg = 500.0;
  constexpr double kRadius_m = 0.4;
  sim::FreeBody ball(ground, sim::ConvexShape::sphere(kRadius_m), kMass_kg,
                     Vector::Constant(0.4 * kMass_kg * kRadius_m * kRadius_m), 5e6, 3e4);
  ball.X_WB.translation() = slope.X_WO * Vector(-10.0, 0.0, 1.0 + kRadius_m - 1e-4);
  ContactOutcome outcome = run_free(ball, step_s, kRoll_s);
  outcome.found = ball.v_W.norm();
  return outcome;
}

constexpr double kWheel_m = 0.5;
constexpr double kPull = 1.0;  ///< At the axle, over the weight.

/// Maximum step that the wheel climbs, pulled at its axle: by bisection.
ContactOutcome climb(double step_s) {
  constexpr double kMass_kg = 400.0;
  Account account;
  double low = 0.05;
  double high = 0.30;
  while (high - low > 2e-4) {
    const double height = 0.5 * (low + high);
    const Ground ground =
        sim::ground_with({sim::box_obstacle({0.0, 0.0, -1.0}, {20.0, 5.0, 1.0}, 0.9),
                          sim::box_obstacle({11.0, 0.0, height - 1.0}, {10.0, 5.0, 1.0}, 0.9)});
    const double across = kMass_kg * (0.25 * kWheel_m * kWheel_m + 0.1 * 0.1 / 3.0);
    sim::FreeBody wheel(ground, sim::ConvexShape::cylinder(kWheel_m, 0.1), kMass_kg,
                        {across, across, 0.5 * kMass_kg * kWheel_m * kWheel_m}, 5e7, 2e5);
    // The cylinder's z along y, its rim at rest against the edge.
    wheel.X_WB.linear() = Eigen::AngleAxisd(-0.5 * std::numbers::pi, Vector::UnitX()).matrix();
    const double away = std::sqrt(kWheel_m * kWheel_m - std::pow(kWheel_m - height, 2.0));
    wheel.X_WB.translation() << 1.0 - away - 1e-4, 0.0, kWheel_m;
    for (int i = 0; i < static_cast<int>(6.0 / step_s); ++i) {
      // Drawn on slowly: a pull at once would lift by its overshoot.
      const double pull = kPull * std::min(1.0, 0.5 + 0.125 * i * step_s);
      wheel.push_W.x() = pull * kMass_kg * kGravity_mps2;
      wheel.step(step_s);
      account.add(wheel.contact().report());
      if (wheel.X_WB.translation().x() > 1.0) {
        break;
      }
    }
    (wheel.X_WB.translation().x() > 1.0 ? low : high) = height;
    account.next_run();
  }
  account.outcome().found = 0.5 * (low + high);
  return account.outcome();
}

Ground firm(std::vector<Obstacle> obstacles) {
  sim::HeightField field;
  field.origin_m = {-200.0, -200.0};
  field.cell_m = 5.0;
  field.columns = field.rows = 81;
  field.heights_m.assign(field.columns * field.rows, 0.0);
  sim::SoilParameters soil;
  soil.friction = 0.8;
  return Ground(field, sim::SoilMap{{soil}, {}}, std::move(obstacles));
}

std::unique_ptr<sim::WheeledVehicle> unimog(const Ground& ground, double step_s,
                                            sim::VehicleLevel level = sim::VehicleLevel::full,
                                            const sim::VehiclePlace& place = {}) {
  sim::WheeledVehicleParameters parameters;
  parameters.level = level;
  parameters.step_s = step_s;
  auto machine = sim::make_wheeled_vehicle(parameters, ground,
                                           sim::make_driveline(sim::DrivelineParameters{}), place);
  VehicleCommand command;
  command.parking_brake = false;
  machine->command(command);
  return machine;
}

ContactOutcome drive(sim::WheeledVehicle& machine, double step_s, double span_s) {
  Account account;
  for (int i = 0; i < static_cast<int>(span_s / step_s); ++i) {
    machine.step(from_seconds(step_s));
    account.add(*machine.contact_report());
  }
  account.outcome().finite = !machine.non_finite();
  return account.outcome();
}

ContactOutcome hit_wall(double step_s) {
  constexpr double kFast_mps = 50.0 / 3.6;
  const Ground ground = firm({sim::box_obstacle({15.0, 0.0, 1.5}, {1.0, 8.0, 1.5})});
  const auto machine = unimog(ground, step_s);
  machine->start_rolling(kFast_mps);
  ContactOutcome outcome = drive(*machine, step_s, 3.0);
  outcome.came_with_j = 0.5 * sim::WheeledVehicleParameters{}.mass_kg() * kFast_mps * kFast_mps;
  return outcome;
}

ContactOutcome wedge(double step_s) {
  const Ground ground =
      firm({sim::trunk_at(9.0, 0.95, 0.3, 12.0), sim::trunk_at(9.0, -0.95, 0.3, 12.0)});
  const auto machine = unimog(ground, step_s);
  VehicleCommand command;
  command.parking_brake = false;
  command.gear = 1;
  command.engine_torque_share = 1.0;
  machine->command(command);
  return drive(*machine, step_s, 15.0);
}

sim::ExcavatorParameters low_bucket() {
  sim::ExcavatorParameters parameters;
  parameters.initial.boom_rad = 0.25;
  parameters.initial.stick_rad = -1.1;
  parameters.initial.bucket_rad = -0.35;
  return parameters;
}

/// Runs the machine with the swing's valve open; whether something was thrown.
bool swing(sim::DiggingExcavator& machine, double opening, double step_s, double span_s,
           Account& account) {
  ValveCommand command;
  command.opening = {opening, 0.0, 0.0, 0.0};
  machine.valve_port()->command(command);
  const sim::Excavator& excavator = machine.excavator();
  const std::uint64_t touches_before = excavator.contact_report()->touches;
  double before_mps = 0.0;
  double after_mps = 0.0;
  Vector tip = excavator.tip_W();
  for (int i = 0; i < static_cast<int>(span_s / step_s); ++i) {
    machine.step(from_seconds(step_s));
    const double speed = (excavator.tip_W() - tip).norm() / step_s;
    tip = excavator.tip_W();
    const sim::ContactReport& report = *excavator.contact_report();
    (report.touches > touches_before ? after_mps : before_mps) =
        std::max(report.touches > touches_before ? after_mps : before_mps, speed);
    account.add(report);
  }
  account.outcome().finite = account.outcome().finite && excavator.finite();
  return after_mps > 1.1 * before_mps + 0.3;
}

ContactOutcome swing_into_rock(double opening, double step_s) {
  sim::SoilParameters sand;
  sand.soft = true;
  sim::HeightField field;
  field.cell_m = 0.4;
  field.columns = field.rows = 101;
  field.origin_m = {-20.0, -20.0};
  field.heights_m.assign(field.columns * field.rows, 0.0);
  sim::ExcavatorParameters parameters = low_bucket();
  parameters.step_s = step_s;
  const Vector beside = Eigen::AngleAxisd(50.0 * kDegree, Vector::UnitZ()) *
                        sim::Excavator(low_bucket(), Eigen::Isometry3d::Identity()).tip_W();
  Account account;
  for (const double height : {-0.5, -0.2, 0.0, 0.3, 0.6}) {
    Ground ground(field, sim::SoilMap{{sand}, {}},
                  {sim::rock_at({beside.x(), beside.y(), height}, 0.7)});
    sim::DiggingExcavator machine(parameters, {}, Eigen::Isometry3d::Identity(), ground);
    swing(machine, opening, step_s, 4.0, account);
    account.next_run();
  }
  return account.outcome();
}

}  // namespace

std::vector<ContactCost> measure_contact_cost(int runs) {
  // Tyres and trunks apart by 0.1 m along the way.
  const sim::WheeledVehicleParameters parameters;
  const double beside =
      0.5 * parameters.front.track_m + 0.5 * parameters.front.tyre.width_m + 0.1 + kTrunk_m;
  std::vector<ContactCost> costs;
  for (const bool along : {false, true}) {
    for (const std::size_t trees : {0, 10, 100, 1000}) {
      if (along && trees == 0) {
        continue;
      }
      sim::RandomStream random(1, "bench/trees");
      const double lane_m = std::max(kLane_m, kTrunk_m * static_cast<double>(trees));
      std::vector<Obstacle> obstacles;
      for (std::size_t i = 0; i < trees; ++i) {
        const double side = i % 2 == 0 ? 1.0 : -1.0;
        const double x = along
                             ? lane_m * (static_cast<double>(i) + 0.5) / static_cast<double>(trees)
                             : random.uniform(-100.0, 100.0);
        const double y = along ? side * beside : side * random.uniform(2.5, 100.0);
        obstacles.push_back(sim::trunk_at(x, y, kTrunk_m, 10.0));
      }
      const Ground ground = firm(std::move(obstacles));
      double least_us = std::numeric_limits<double>::max();
      constexpr int kSteps = 6000;
      for (int run = 0; run < runs; ++run) {
        const auto machine = unimog(ground, 1e-3);
        machine->start_rolling(kSpeed_mps);
        const double begin_s = hil::thread_cpu_seconds();
        for (int i = 0; i < kSteps; ++i) {
          machine->step(std::chrono::milliseconds(1));
        }
        least_us = std::min(least_us, 1e6 * (hil::thread_cpu_seconds() - begin_s) / kSteps);
      }
      costs.push_back({along ? "along" : "about", trees, least_us});
    }
  }
  return costs;
}

std::vector<ContactCase> contact_cases() {
  std::vector<ContactCase> cases{
      {"crate on an edge", "", 0.0, [](double h) { return drop_crate(h, Vector::UnitX()); }},
      {"crate on a corner", "", 0.0,
       [](double h) {
         return drop_crate(h, {1.0, 0.6, 0.2});
       }},
      // a = g sin / (1 + 2/5).
      {"ball down 15 deg", "m/s after 2 s", kRoll_s * kGravity_mps2 * std::sin(kSlope_rad) / 1.4,
       roll_ball},
      // Moments about the edge: F (r - h) = W sqrt(r^2 - (r - h)^2).
      {"wheel over a step", "m, highest", kWheel_m * (1.0 - std::cos(std::atan(kPull))), climb},
      {"Unimog wedged", "", 0.0, wedge},
      {"Unimog, wall, 50 km/h", "", 0.0, hit_wall}};
  for (const double opening : {0.2, 0.5, 0.8}) {
    cases.push_back({"bucket, rock, valve " + std::to_string(opening).substr(0, 3), "", 0.0,
                     [opening](double h) { return swing_into_rock(opening, h); }});
  }
  return cases;
}

/// Runs the stack for 3 s to settle, then measures drift and energy gain: the maximum drop of
/// lost_j from its maximum so far.
StackRest rest_stack(bool awake, double span_s) {
  constexpr double kStep_s = 1e-3;
  constexpr double kSettling_s = 3.0;
  const Vector half(0.5, 0.4, 0.3);
  std::vector<sim::LooseBody> crates;
  for (const Vector& at :
       {Vector(0.0, 0.0, 0.3), Vector(0.05, 0.02, 0.9), Vector(-0.03, 0.0, 1.5)}) {
    sim::LooseBody& crate = crates.emplace_back(
        sim::LooseBody{.name = "crate", .shape = sim::ConvexShape::box(half), .mass_kg = 1000.0});
    crate.inertia_kgm2 = box_inertia(crate.mass_kg, half);
    crate.X_WB.translation() = at;
  }
  const Ground ground = firm({});
  sim::LooseBodies bodies(crates, ground);
  StackRest rest{.awake = awake, .span_s = span_s};
  double most_lost_j = 0.0;
  const auto run = [&](double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds / kStep_s)); ++i) {
      if (awake) {
        bodies.ground_changed({-5.0, -5.0}, {5.0, 5.0});
      }
      (void)bodies.advance(kStep_s);
      rest.gave_j = std::max(rest.gave_j, most_lost_j - bodies.report().lost_j);
      most_lost_j = std::max(most_lost_j, bodies.report().lost_j);
    }
  };
  run(kSettling_s);
  std::vector<Vector> before;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    before.push_back(bodies.motion(i).X_WL.translation());
  }
  rest.gave_j = 0.0;
  const double begin_s = hil::thread_cpu_seconds();
  run(span_s);
  rest.us_per_step = 1e6 * (hil::thread_cpu_seconds() - begin_s) * kStep_s / span_s;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    rest.drift_m = std::max(rest.drift_m, (bodies.motion(i).X_WL.translation() - before[i]).norm());
  }
  return rest;
}

ContactSweep sweep_pit(int seeds) {
  ContactSweep sweep;
  sweep.name = "low swings in the pit";
  Account account;
  for (int seed = 1; seed <= seeds; ++seed) {
    hil::RigConfiguration rig =
        hil::load_rig(hil::find_rig("excavator_pit"), {"seed=" + std::to_string(seed)})
            .configuration;
    const hil::MachineInScene built = hil::build_machine_in_scene(rig);
    const auto& configured = *fields::as<hil::ExcavatorMachine>(rig.machine.model);
    sim::ExcavatorParameters parameters = configured.excavator;
    const sim::ExcavatorPose low = low_bucket().initial;
    for (int i = 0; i < 24; ++i) {
      parameters.initial = low;
      parameters.initial.swing_rad = 2.0 * std::numbers::pi * i / 24.0;
      Ground ground = *built.ground;
      sim::DiggingExcavator machine(parameters, configured.digging,
                                    built.machine->links().front().X_WL, ground);
      machine.step(std::chrono::milliseconds(1));
      const sim::ContactReport& start = *machine.contact_report();
      if (start.points > 0 || start.deepest_m > 0.0) {
        continue;  // Within the truck or its heap: not a valid start of a rig.
      }
      sweep.thrown += swing(machine, i % 2 == 0 ? 0.8 : -0.8, 1e-3, 3.0, account) ? 1 : 0;
      sweep.touched += machine.contact_report()->touches > 0 ? 1 : 0;
      account.next_run();
      ++sweep.runs;
    }
  }
  sweep.worst = account.outcome();
  return sweep;
}

ContactSweep sweep_forest(sim::VehicleLevel level, int drives) {
  const hil::RigConfiguration rig = hil::load_rig(hil::find_rig("unimog_forest"), {}).configuration;
  const hil::MachineInScene built = hil::build_machine_in_scene(rig);
  ContactSweep sweep;
  constexpr std::array<const char*, 3> kLevels{"kinematic", "planar", "full"};
  sweep.name =
      std::string("straight drives in the forest, ") + kLevels[static_cast<std::size_t>(level)];
  for (int i = 0; i < drives; ++i) {
    const auto machine = unimog(
        *built.ground, 1e-3, level,
        {rig.machine.position_m.x, rig.machine.position_m.y, 2.0 * std::numbers::pi * i / drives});
    machine->start_rolling(kSpeed_mps);
    Account account;
    bool thrown = false;
    for (int k = 0; k < 10000; ++k) {
      const double before = machine->links()[0].v_WL_W.norm();
      machine->step(std::chrono::milliseconds(1));
      account.add(*machine->contact_report());
      // Within a step in contact nothing gains a tenth of what it came with.
      thrown = thrown || (machine->contact_report()->points > 0 &&
                          machine->links()[0].v_WL_W.norm() > before + 0.1 * kSpeed_mps);
    }
    account.outcome().finite = !machine->non_finite();
    take_worst(sweep.worst, account.outcome());
    sweep.thrown += thrown ? 1 : 0;
    sweep.touched += machine->contact_report()->touches > 0 ? 1 : 0;
    ++sweep.runs;
  }
  return sweep;
}

}  // namespace rigwire::bench
