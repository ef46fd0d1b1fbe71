#include "bench/contact_traces.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "bench/free_body.h"
#include "sim/driveline/driveline.h"
#include "sim/excavator/digging_excavator.h"
#include "sim/vehicle/wheeled_vehicle.h"

namespace rigwire::bench {
namespace {

using sim::Ground;
using Vector = Eigen::Vector3d;

Outline circle(double x_m, double z_m, double radius_m) {
  constexpr int kCorners = 48;
  Outline outline;
  for (int i = 0; i <= kCorners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kCorners;
    outline.emplace_back(x_m + radius_m * std::cos(angle), z_m + radius_m * std::sin(angle));
  }
  return outline;
}

Outline upright(double x_m, double half_m, double height_m) {
  return {{x_m - half_m, 0.0},
          {x_m - half_m, height_m},
          {x_m + half_m, height_m},
          {x_m + half_m, 0.0},
          {x_m - half_m, 0.0}};
}

Ground level_ground(bool soft, std::vector<sim::Obstacle> obstacles) {
  sim::HeightField field;
  field.cell_m = 0.4;
  field.columns = field.rows = 151;
  field.origin_m = {-30.0, -30.0};
  field.heights_m.assign(field.columns * field.rows, 0.0);
  sim::SoilParameters soil;
  soil.soft = soft;
  return Ground(field, sim::SoilMap{{soil}, {}}, std::move(obstacles));
}

/// Boxes of the body, and the left wheels.
std::vector<Outline> side_of(const sim::WheeledVehicle& machine,
                             const sim::WheeledVehicleParameters& parameters) {
  const Eigen::Isometry3d& body = machine.links()[0].X_WL;
  std::vector<Outline> outlines;
  for (const sim::ContactBox& box : parameters.solid.boxes) {
    const Vector half = 0.5 * box.size_m;
    Outline outline;
    for (const auto& [x, z] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {-1, -1}}) {
      const Vector corner = body * (box.position_m + Vector(x * half.x(), 0.0, z * half.z()));
      outline.emplace_back(corner.x(), corner.z());
    }
    outlines.push_back(std::move(outline));
  }
  for (const auto& [link, axle] :
       {std::pair{"front_left_wheel", &parameters.front}, {"rear_left_wheel", &parameters.rear}}) {
    const auto at = std::ranges::find(machine.link_names(), std::string_view(link));
    const Vector hub = machine.links()[static_cast<std::size_t>(at - machine.link_names().begin())]
                           .X_WL.translation();
    outlines.push_back(circle(hub.x(), hub.z(), axle->tyre.unloaded_radius_m));
  }
  return outlines;
}

/// Boom, stick and bucket from pin to pin.
std::vector<Outline> side_of(const sim::DiggingExcavator& machine) {
  std::vector<Outline> outlines;
  std::string_view last;
  for (const sim::BodyPoint& point : machine.excavator().body_points()) {
    if (point.body != last) {
      outlines.emplace_back();
      last = point.body;
    }
    outlines.back().emplace_back(point.p_W.x(), point.p_W.z());
  }
  return outlines;
}

/// Steps of 1 ms; `front` is where the machine is, `side` how it looks.
template <class Machine, class Front, class Side>
void follow(Machine& machine, double span_s, ContactTrace& trace, Front front, Side side) {
  double most_n = 0.0;
  double farthest_m = 0.0;
  for (int i = 0; i < static_cast<int>(1e3 * span_s); ++i) {
    machine.step(std::chrono::milliseconds(1));
    const sim::ContactReport& report = *machine.contact_report();
    const Vector at = front();
    trace.instants.push_back({1e-3 * (i + 1), at.x(), at.z(), report.force_n, report.deepest_m,
                              report.dent_m, report.pressed_m});
    if (trace.at_touch.empty() && report.touches > 0) {
      trace.at_touch = trace.at_end = side();
      most_n = report.force_n;
    }
    // The farthest is where it has bent most in; of what does not bend, where it is pushed most.
    if (report.dent_m > farthest_m || (report.dent_m == 0.0 && report.force_n > most_n)) {
      farthest_m = report.dent_m;
      most_n = report.force_n;
      trace.at_end = side();
    }
  }
}

/// A Unimog at level full, out of gear, with that speed along x.
void roll_on(const Ground& ground, double speed_mps, double span_s, ContactTrace& trace) {
  sim::WheeledVehicleParameters parameters;
  parameters.level = sim::VehicleLevel::full;
  parameters.step_s = 1e-3;
  const auto machine = sim::make_wheeled_vehicle(
      parameters, ground, sim::make_driveline(sim::DrivelineParameters{}), {});
  VehicleCommand command;
  command.parking_brake = false;
  machine->command(command);
  machine->start_rolling(speed_mps);
  const sim::ContactBox& cab = parameters.solid.boxes.front();
  const Vector nose = cab.position_m + 0.5 * Vector(cab.size_m.x(), 0.0, -cab.size_m.z());
  follow(
      *machine, span_s, trace, [&] { return Vector(machine->links()[0].X_WL * nose); },
      [&] { return side_of(*machine, parameters); });
}

}  // namespace

ContactTrace drive_into_trunk() {
  constexpr double kTrunk_m = 0.4;
  constexpr double kAt_m = 9.0;
  ContactTrace trace;
  trace.name = "Unimog, trunk of 0.8 m, 50 km/h";
  trace.obstacle = {upright(kAt_m, kTrunk_m, 3.5)};
  roll_on(level_ground(false, {sim::trunk_at(kAt_m, 0.0, kTrunk_m, 12.0)}), 50.0 / 3.6, 0.6, trace);
  return trace;
}

ContactTrace roll_at_fallen_trunk() {
  constexpr double kTrunk_m = 0.65;
  constexpr double kAt_m = 5.0;
  const Ground ground = level_ground(false, {sim::trunk_at(kAt_m, -6.0, kTrunk_m, 12.0)});
  // Across the way, its middle in it.
  Eigen::Isometry3d lies = Eigen::Isometry3d::Identity();
  lies.translation() << kAt_m, 0.0, 0.0;
  lies.linear() = Eigen::AngleAxisd(-0.5 * std::numbers::pi, Vector::UnitX()).toRotationMatrix();
  (void)ground.lay(0, lies);
  ContactTrace trace;
  trace.name = "Unimog, fallen trunk of 1.3 m, 3 m/s";
  trace.obstacle = {circle(kAt_m, 0.0, kTrunk_m)};
  roll_on(ground, 3.0, 1.5, trace);
  return trace;
}

ContactTrace lower_onto_rock() {
  constexpr double kRock_m = 0.7;
  sim::ExcavatorParameters parameters;
  parameters.step_s = 1e-3;
  parameters.initial.boom_rad = 0.55;
  parameters.initial.stick_rad = -1.1;
  parameters.initial.bucket_rad = -0.35;
  // Where the tip comes down.
  sim::ExcavatorParameters low = parameters;
  low.initial.boom_rad = 0.3;
  const Vector under = sim::Excavator(low, Eigen::Isometry3d::Identity()).tip_W();
  Ground ground = level_ground(true, {sim::rock_at({under.x(), 0.0, 0.0}, kRock_m)});
  sim::DiggingExcavator machine(parameters, {}, Eigen::Isometry3d::Identity(), ground);
  ValveCommand command;
  command.opening = {0.0, -0.5, 0.0, 0.0};
  machine.valve_port()->command(command);
  ContactTrace trace;
  trace.name = "bucket, rock of 0.7 m radius, boom lowered";
  trace.obstacle = {circle(under.x(), 0.0, kRock_m)};
  follow(
      machine, 0.9, trace, [&] { return machine.excavator().tip_W(); },
      [&] { return side_of(machine); });
  return trace;
}

}  // namespace rigwire::bench
