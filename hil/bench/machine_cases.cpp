#include "hil/bench/machine_cases.h"

#include <array>
#include <cmath>
#include <numbers>

#include "hil/bench/excavator_bench.h"
#include "sim/driveline/make_driveline.h"
#include "sim/excavator/excavator.h"
#include "sim/roller/tandem_roller.h"
#include "sim/vehicle/wheeled_vehicle.h"

namespace rigwire::hil {
namespace {

constexpr double kSlope_rad = 5.0 * std::numbers::pi / 180.0;

/// A machine with the ground that it stands on.
class OnPlane {
 public:
  OnPlane()
      : ground_(std::make_shared<sim::Ground>(sim::Ground::plane(
            {-std::sin(kSlope_rad), 0.0, std::cos(kSlope_rad)}, sim::SoilParameters{}))) {}
  [[nodiscard]] const sim::Ground& operator*() const { return *ground_; }

 private:
  std::shared_ptr<sim::Ground> ground_;
};

void dig_motion(sim::Machine& machine, SimTime now) {
  const double t = to_seconds(now);
  ValveCommand command;
  const auto wave = [t](double hz) { return std::sin(2.0 * std::numbers::pi * hz * t); };
  command.opening = {0.5 * wave(0.3), 0.5 * wave(0.4), -0.5 * wave(0.5), 0.5 * wave(0.6)};
  machine.valve_port()->command(command);
}

/// Pulls away, swerves, brakes to a stop.
void drive_motion(sim::Machine& machine, SimTime now) {
  const double t = to_seconds(now);
  VehicleCommand command;
  command.parking_brake = false;
  command.gear = t < 3.0 ? 1 : 0;
  command.engine_torque_share = t < 2.5 ? 0.5 : 0.0;
  command.travel_speed_mps = t < 3.0 ? 1.5 : 0.0;
  command.brake_share = t < 3.0 ? 0.0 : 0.5;
  command.front_steer_rad = 0.2 * std::sin(std::numbers::pi * t);
  command.rear_steer_rad = -command.front_steer_rad;
  machine.vehicle_port()->command(command);
}

sim::ExcavatorParameters excavator(sim::ExcavatorLevel level, sim::IntegrationScheme scheme,
                                   double factor, double step_s) {
  sim::ExcavatorParameters parameters;
  parameters.level = level;
  parameters.scheme = scheme;
  parameters.step_s = step_s;
  parameters.drives.swing_stiffness_nmprad *= factor;
  parameters.drives.boom_stiffness_npm *= factor;
  parameters.drives.stick_stiffness_npm *= factor;
  parameters.drives.bucket_stiffness_npm *= factor;
  return parameters;
}

void add_excavators(std::vector<MachineCase>& cases) {
  using sim::ExcavatorLevel;
  using sim::IntegrationScheme;
  const auto add = [&](const char* name, ExcavatorLevel level, IntegrationScheme scheme,
                       double factor) {
    MachineCase entry{.machine = "excavator",
                      .level = name,
                      .method = name_of(scheme),
                      .stiffness_factor = factor,
                      .make = {},
                      .drive = dig_motion};
    entry.make = [=](double step_s) -> std::unique_ptr<sim::Machine> {
      return std::make_unique<sim::Excavator>(excavator(level, scheme, factor, step_s),
                                              Eigen::Isometry3d::Identity());
    };
    cases.push_back(std::move(entry));
  };
  const auto implicit = IntegrationScheme::linearly_implicit_euler;
  add("kinematic", ExcavatorLevel::kinematic, implicit, 1.0);
  add("quasi_static", ExcavatorLevel::quasi_static, implicit, 1.0);
  for (const double factor : {1.0, 100.0, 1e4}) {
    for (const auto scheme :
         {implicit, IntegrationScheme::rosenbrock2, IntegrationScheme::runge_kutta4}) {
      add("dynamic", ExcavatorLevel::dynamic, scheme, factor);
    }
  }
  add("chambers", ExcavatorLevel::chambers, implicit, 1.0);

  const OnPlane ground;
  MachineCase carried{.machine = "excavator on tyres",
                      .level = "dynamic",
                      .method = name_of(implicit),
                      .make = {},
                      .drive = dig_motion};
  carried.make = [=](double step_s) -> std::unique_ptr<sim::Machine> {
    auto parameters = excavator(ExcavatorLevel::dynamic, implicit, 1.0, step_s);
    parameters.carrier = sim::ExcavatorCarrier::moving;
    return std::make_unique<sim::Excavator>(parameters, Eigen::Isometry3d::Identity(), &*ground);
  };
  cases.push_back(std::move(carried));
}

/// Stiffness of springs, stops and tyres, with dampers that keep their ratio.
void stiffen(sim::VehicleAxleParameters& axle, double factor) {
  const double damping = std::sqrt(factor);
  axle.beam.spring_npm *= factor;
  axle.beam.damper_nspm *= damping;
  axle.independent.spring_npm *= factor;
  axle.independent.damper_nspm *= damping;
  axle.tyre.carcass_stiffness_npm *= factor;
  axle.tyre.stiffness_per_pressure_m *= factor;
  axle.tyre.vertical_damping_nspm *= damping;
  axle.tyre.longitudinal_stiffness_npm *= factor;
  axle.tyre.lateral_stiffness_npm *= factor;
}

void add_vehicle(std::vector<MachineCase>& cases, const char* machine,
                 const sim::WheeledVehicleParameters& parameters,
                 const sim::DrivelineParameters& driveline) {
  using sim::VehicleLevel;
  constexpr std::array kLevels{std::pair{VehicleLevel::kinematic, "kinematic"},
                               std::pair{VehicleLevel::planar, "planar"},
                               std::pair{VehicleLevel::full, "full"}};
  const OnPlane ground;
  for (const auto& [level, name] : kLevels) {
    for (const double factor : {1.0, 100.0, 1e4}) {
      if (level == VehicleLevel::kinematic && factor != 1.0) {
        continue;
      }
      MachineCase entry{.machine = machine,
                        .level = name,
                        .method = "linearly_implicit_euler",
                        .stiffness_factor = factor,
                        .make = {},
                        .drive = drive_motion};
      entry.make = [=, level = level](double step_s) -> std::unique_ptr<sim::Machine> {
        sim::WheeledVehicleParameters stiffened = parameters;
        stiffened.level = level;
        stiffened.step_s = step_s;
        stiffen(stiffened.front, factor);
        stiffen(stiffened.rear, factor);
        return sim::make_wheeled_vehicle(stiffened, *ground, sim::make_driveline(driveline), {});
      };
      cases.push_back(std::move(entry));
    }
  }
}

void add_rollers(std::vector<MachineCase>& cases) {
  const OnPlane ground;
  for (const auto level : {sim::RollerLevel::kinematic, sim::RollerLevel::dynamic}) {
    MachineCase entry{.machine = "roller",
                      .level = level == sim::RollerLevel::kinematic ? "kinematic" : "dynamic",
                      .method = "linearly_implicit_euler",
                      .make = {},
                      .drive = drive_motion};
    entry.make = [=](double step_s) -> std::unique_ptr<sim::Machine> {
      sim::RollerParameters parameters;
      parameters.level = level;
      parameters.step_s = step_s;
      return std::make_unique<sim::TandemRoller>(parameters, *ground, Eigen::Vector2d::Zero(), 0.0);
    };
    cases.push_back(std::move(entry));
  }
}

}  // namespace

std::vector<MachineCase> machine_cases() {
  std::vector<MachineCase> cases;
  add_excavators(cases);
  add_vehicle(cases, "Unimog", sim::WheeledVehicleParameters{}, sim::unimog_u5023_driveline());
  add_vehicle(cases, "Gator", sim::gator_855d(), sim::gator_855d_driveline());
  add_rollers(cases);
  return cases;
}

}  // namespace rigwire::hil
