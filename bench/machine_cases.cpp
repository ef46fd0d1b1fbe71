#include "bench/machine_cases.h"

#include <array>
#include <cmath>
#include <numbers>

#include "bench/machine_files.h"
#include "sim/driveline/driveline.h"
#include "sim/excavator/excavator.h"
#include "sim/roller/tandem_roller.h"
#include "sim/vehicle/wheeled_vehicle.h"

namespace rigwire::bench {
namespace {

constexpr double kSlope_rad = 5.0 * std::numbers::pi / 180.0;
constexpr double kCoasting_mps = 3.0;
constexpr std::array kStiffnessFactors{1.0, 100.0, 1e4};

enum class Scene { smooth, switches };
constexpr std::array kScenes{Scene::smooth, Scene::switches};

const char* name_of(Scene scene) {
  return scene == Scene::smooth ? "smooth" : "switches";
}

/// The ground of a case, kept for as long as one of its makers lives.
std::shared_ptr<const sim::Ground> slope() {
  return std::make_shared<const sim::Ground>(sim::Ground::plane(
      {-std::sin(kSlope_rad), 0.0, std::cos(kSlope_rad)}, sim::SoilParameters{}));
}

double wave(double hz, double t_s) {
  return std::sin(2.0 * std::numbers::pi * hz * t_s);
}

void dig_gently(sim::Machine& machine, SimTime now) {
  const double t = to_seconds(now);
  const double opening = (0.25 - 0.08 * wave(0.35, t)) * -std::expm1(-t / 0.3);
  ValveCommand command;
  command.opening = {opening, opening, -opening, opening};
  machine.valve_port()->command(command);
}

void dig_hard(sim::Machine& machine, SimTime now) {
  const double t = to_seconds(now);
  ValveCommand command;
  command.opening = {0.5 * wave(0.3, t), 0.5 * wave(0.4, t), -0.5 * wave(0.5, t),
                     0.5 * wave(0.6, t)};
  machine.valve_port()->command(command);
}

/// Drive that follows a speed command: the roller's has no accelerator and no neutral. Vehicles get
/// none, because their kinematic level would follow it without a drive line.
enum class Drive { accelerator, hydrostatic };

template <Drive kDrive>
void coast(sim::Machine& machine, SimTime now) {
  const double t = to_seconds(now);
  VehicleCommand command;
  command.parking_brake = false;
  if (kDrive == Drive::hydrostatic) {
    command.travel_speed_mps = 0.6 * (1.0 - std::cos(std::numbers::pi * t / 1.5));
  }
  command.front_steer_rad = 0.05 * wave(0.4, t);
  command.rear_steer_rad = -command.front_steer_rad;
  machine.vehicle_port()->command(command);
}

template <Drive kDrive>
void start_swerve_stop(sim::Machine& machine, SimTime now) {
  const double t = to_seconds(now);
  VehicleCommand command;
  command.parking_brake = false;
  const bool going = t < 2.2;
  if (kDrive == Drive::hydrostatic) {
    command.travel_speed_mps = going ? 1.5 : 0.0;
  } else {
    command.gear = going ? 1 : 0;
    command.engine_torque_share = t < 2.0 ? 0.5 : 0.0;
  }
  command.brake_share = going ? 0.0 : 0.5;
  command.front_steer_rad = 0.2 * wave(0.5, t);
  command.rear_steer_rad = -command.front_steer_rad;
  machine.vehicle_port()->command(command);
}

using Change = std::function<void(sim::ExcavatorParameters&)>;

void stiffen(sim::DriveParameters& drives, double factor) {
  drives.swing_stiffness_nmprad *= factor;
  drives.boom_stiffness_npm *= factor;
  drives.stick_stiffness_npm *= factor;
  drives.bucket_stiffness_npm *= factor;
}

MachineCase excavator(sim::ExcavatorLevel level, const char* level_name, Scene scene, double factor,
                      sim::ExcavatorCarrier carrier = sim::ExcavatorCarrier::fixed,
                      const Change& change = {}) {
  const bool moving = carrier == sim::ExcavatorCarrier::moving;
  const auto ground = moving ? slope() : nullptr;
  const auto make = [=](double step_s) -> std::unique_ptr<sim::Machine> {
    sim::ExcavatorParameters parameters;
    parameters.level = level;
    parameters.step_s = step_s;
    parameters.carrier = carrier;
    stiffen(parameters.drives, factor);
    if (change) {
      change(parameters);
    }
    Eigen::Isometry3d X_WC = Eigen::Isometry3d::Identity();
    if (moving) {
      X_WC.rotate(Eigen::AngleAxisd(-kSlope_rad, Eigen::Vector3d::UnitY()));
    }
    return std::make_unique<sim::Excavator>(parameters, X_WC, ground.get());
  };
  return {.machine = moving ? "excavator on tyres" : "excavator",
          .level = level_name,
          .scene = name_of(scene),
          .stiffness_factor = factor,
          .make = make,
          .drive = scene == Scene::smooth ? dig_gently : dig_hard};
}

void add_excavators(std::vector<MachineCase>& cases) {
  using sim::ExcavatorLevel;
  for (const Scene scene : kScenes) {
    cases.push_back(excavator(ExcavatorLevel::kinematic, "kinematic", scene, 1.0));
    cases.push_back(excavator(ExcavatorLevel::quasi_static, "quasi_static", scene, 1.0));
    for (const double factor : kStiffnessFactors) {
      cases.push_back(excavator(ExcavatorLevel::dynamic, "dynamic", scene, factor));
    }
    cases.push_back(excavator(ExcavatorLevel::chambers, "chambers", scene, 1.0));
    cases.push_back(
        excavator(ExcavatorLevel::dynamic, "dynamic", scene, 1.0, sim::ExcavatorCarrier::moving));
  }
}

/// Stiffness of springs and tyres, with dampers that keep their ratio. The tyre's lateral and
/// longitudinal stiffness too; stops and brakes stay.
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

struct Vehicle {
  const char* name;
  sim::WheeledVehicleParameters parameters;
  sim::DrivelineParameters driveline;
};

Vehicle unimog() {
  return {"Unimog", {}, {}};  // The defaults.
}
Vehicle gator() {
  return {"Gator", gator_855d().vehicle, gator_855d().driveline};
}

MachineCase wheeled(const Vehicle& vehicle, sim::VehicleLevel level, const char* level_name,
                    Scene scene, double factor) {
  const auto make = [=, ground = slope()](double step_s) -> std::unique_ptr<sim::Machine> {
    sim::WheeledVehicleParameters parameters = vehicle.parameters;
    parameters.level = level;
    parameters.step_s = step_s;
    stiffen(parameters.front, factor);
    stiffen(parameters.rear, factor);
    auto machine =
        sim::make_wheeled_vehicle(parameters, *ground, sim::make_driveline(vehicle.driveline), {});
    if (scene == Scene::smooth) {
      machine->start_rolling(kCoasting_mps);
    }
    return machine;
  };
  return {.machine = vehicle.name,
          .level = level_name,
          .scene = name_of(scene),
          .stiffness_factor = factor,
          .make = make,
          .drive = scene == Scene::smooth ? coast<Drive::accelerator>
                                          : start_swerve_stop<Drive::accelerator>};
}

void add_vehicle(std::vector<MachineCase>& cases, const Vehicle& vehicle) {
  using sim::VehicleLevel;
  for (const Scene scene : kScenes) {
    cases.push_back(wheeled(vehicle, VehicleLevel::kinematic, "kinematic", scene, 1.0));
    cases.push_back(wheeled(vehicle, VehicleLevel::planar, "planar", scene, 1.0));
    for (const double factor : kStiffnessFactors) {
      cases.push_back(wheeled(vehicle, VehicleLevel::full, "full", scene, factor));
    }
  }
}

/// The drums' bristles, whose damping ratio stays, and the brakes.
void stiffen(sim::RollerParameters& parameters, double factor) {
  parameters.drum.slip_stiffness_n *= factor;
  parameters.drum.cornering_stiffness_nprad *= factor;
  parameters.brake_stiffness_nmprad *= factor;
}

MachineCase roller(sim::RollerLevel level, const char* level_name, Scene scene, double factor,
                   const std::function<void(sim::RollerParameters&)>& change = {}) {
  const auto make = [=, ground = slope()](double step_s) -> std::unique_ptr<sim::Machine> {
    sim::RollerParameters parameters;
    parameters.level = level;
    parameters.step_s = step_s;
    stiffen(parameters, factor);
    if (change) {
      change(parameters);
    }
    return std::make_unique<sim::TandemRoller>(parameters, *ground, Eigen::Vector2d::Zero(), 0.0);
  };
  return {.machine = "roller",
          .level = level_name,
          .scene = name_of(scene),
          .stiffness_factor = factor,
          .make = make,
          .drive = scene == Scene::smooth ? coast<Drive::hydrostatic>
                                          : start_swerve_stop<Drive::hydrostatic>};
}

void add_rollers(std::vector<MachineCase>& cases) {
  for (const Scene scene : kScenes) {
    cases.push_back(roller(sim::RollerLevel::kinematic, "kinematic", scene, 1.0));
    for (const double factor : kStiffnessFactors) {
      cases.push_back(roller(sim::RollerLevel::dynamic, "dynamic", scene, factor));
    }
  }
}

MachineCase varied_vehicle(Vehicle vehicle,
                           const std::function<void(sim::WheeledVehicleParameters&)>& change) {
  if (change) {
    change(vehicle.parameters);
  }
  return wheeled(vehicle, sim::VehicleLevel::full, "full", Scene::switches, 1.0);
}

}  // namespace

std::vector<MachineCase> machine_cases() {
  std::vector<MachineCase> cases;
  add_excavators(cases);
  add_vehicle(cases, unimog());
  add_vehicle(cases, gator());
  add_rollers(cases);
  return cases;
}

std::vector<MachineVariation> machine_variations() {
  std::vector<MachineVariation> variations;
  const auto digging = [&](const char* quantity, const Change& change) {
    const auto one = [](const Change& of) {
      return excavator(sim::ExcavatorLevel::dynamic, "dynamic", Scene::smooth, 1.0,
                       sim::ExcavatorCarrier::fixed, of);
    };
    variations.push_back({quantity, one({}), one(change)});
  };
  digging("stiffness of the oil", [](sim::ExcavatorParameters& p) { stiffen(p.drives, 1.2); });
  digging("damping ratio", [](sim::ExcavatorParameters& p) { p.drives.damping_ratio *= 1.2; });

  for (const Vehicle& vehicle : {unimog(), gator()}) {
    const auto driving = [&](const char* quantity,
                             const std::function<void(sim::WheeledVehicleParameters&)>& change) {
      variations.push_back(
          {quantity, varied_vehicle(vehicle, {}), varied_vehicle(vehicle, change)});
    };
    driving("mass of the body", [](auto& p) { p.body.mass_kg *= 1.2; });
    driving("springs", [](auto& p) {
      for (sim::VehicleAxleParameters* axle : {&p.front, &p.rear}) {
        axle->beam.spring_npm *= 1.2;
        axle->independent.spring_npm *= 1.2;
      }
    });
    driving("lateral stiffness of the tyres", [](auto& p) {
      p.front.tyre.lateral_stiffness_npm *= 1.2;
      p.rear.tyre.lateral_stiffness_npm *= 1.2;
    });
  }

  const auto rolling = [&](const char* quantity,
                           const std::function<void(sim::RollerParameters&)>& change) {
    const auto one = [](const std::function<void(sim::RollerParameters&)>& of) {
      return roller(sim::RollerLevel::dynamic, "dynamic", Scene::switches, 1.0, of);
    };
    variations.push_back({quantity, one({}), one(change)});
  };
  rolling("slip stiffness of the drums", [](sim::RollerParameters& p) {
    p.drum.slip_stiffness_n *= 1.2;
    p.drum.cornering_stiffness_nprad *= 1.2;
  });
  return variations;
}

}  // namespace rigwire::bench
