// The dig cycle's decisions against the machine and scene of a rig's file, in simulated time: the
// valves carry out what it asked for one control period ago, its beliefs are the truth, and what it
// sees are rays cast as an HDL-32E would, one revolution each 100 ms. No wires, no clock.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "dig_cycle/cycle.h"
#include "dig_cycle/surroundings.h"
#include "hil/rig/rig.h"
#include "hil/rig/rig_configuration.h"
#include "sim/samples/time.h"

namespace rigwire::dig_cycle {

class PitRun {
 public:
  static constexpr double kControl_s = 0.026;  ///< Thirteen slices of the world.

  PitRun(const std::string& rig, const std::vector<std::string>& sets,
         const CycleSettings& settings)
      : world_(hil::make_world(hil::load_rig(rig, sets).configuration)), cycle_({}, settings) {
    std::size_t place = 0;
    for (const sim::TruthField& field : world_.machine().truth_fields()) {
      if (field.key == "bucket_soil_m3") {
        soil_ = place;
      } else if (field.key == "dumped_elsewhere_m3") {
        dumped_ = place;
      }
      place += field.count;
    }
    truth_.resize(place);
  }

  [[nodiscard]] bool over() const { return cycle_.done() || cycle_.fault(); }
  [[nodiscard]] const Cycle& cycle() const { return cycle_; }
  [[nodiscard]] double seconds() const { return static_cast<double>(ticks_) * kControl_s; }
  /// What was in the bucket as it set out for the truck, of all swings that have ended.
  [[nodiscard]] double lifted_m3() const { return lifted_m3_; }
  /// What an object of the scene caught.
  [[nodiscard]] double in_truck_m3() const { return truth_[dumped_]; }
  [[nodiscard]] double in_bucket_m3() const { return truth_[soil_]; }
  [[nodiscard]] const PerJoint& angles_rad() const { return belief_.angles_rad; }
  [[nodiscard]] const CycleOutput& output() const { return output_; }
  [[nodiscard]] const View& view() const { return seen_; }
  /// The hardest that it met rocks or the truck so far.
  [[nodiscard]] double most_contact_n() const { return most_contact_n_; }
  [[nodiscard]] sim::Machine& machine() { return world_.machine(); }

  /// Adds a sensor of the test's own, which measures with that period from the start on.
  void attach(std::unique_ptr<hil::WorldSensor> sensor, hil::StationIndex station,
              Duration period) {
    world_.add(std::move(sensor));
    requests_.of<SamplePlan>(station).push_back({kStart, period});
  }
  /// Is called with every slice of the world, 2 ms.
  std::function<void(const hil::SampleBatch&)> on_slice = [](const hil::SampleBatch&) {};

  /// Lets that time pass without the program: the valves keep their last command.
  void wait(double span_s) {
    hil::SampleBatch batch;
    for (double done_s = 0.0; done_s < span_s - 1e-6; done_s += 0.002) {
      if (const auto fault = world_.advance(requests_, batch)) {
        throw std::runtime_error(*fault);
      }
      requests_.clear();
      on_slice(batch);
    }
  }

  void tick() {
    sim::Machine& machine = world_.machine();
    ValveCommand command;
    std::copy_n(output_.openings.begin(), kJoints, command.opening.begin());
    machine.valve_port()->command(command);
    wait(kControl_s);
    if (const sim::ContactReport* report = machine.contact_report(); report && report->obstacle) {
      most_contact_n_ = std::max(most_contact_n_, report->force_n);
    }
    machine.read_truth(truth_);
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      belief_.rates_radps[joint] = (truth_[joint] - belief_.angles_rad[joint]) / kControl_s;
      belief_.angles_rad[joint] = truth_[joint];
    }
    belief_.ready = true;
    if (ticks_++ % 4 == 0) {
      look();
    }
    seen_ = surroundings_.view();
    const ValveSample valves = machine.valve_port()->valve_sample(machine.time());
    const Machine data;
    seen_.boom_force_n = valves.port_a_pressure_pa[boom] * data.boom_bottom_area_m2 -
                         valves.port_b_pressure_pa[boom] * data.boom_rod_side_area_m2;
    const Phase before = cycle_.phase();
    output_ = cycle_.update(belief_, seen_, kControl_s);
    if (before == Phase::lift && cycle_.phase() == Phase::swing_to_truck) {
      carried_m3_ = in_bucket_m3();
    } else if (before == Phase::dump && cycle_.phase() == Phase::swing_back) {
      lifted_m3_ += carried_m3_;
    }
  }

 private:
  void look() {
    constexpr double kDeg = std::numbers::pi / 180.0;
    constexpr std::size_t kUpper = 1;
    const Eigen::Isometry3d& X_WU = world_.machine().links()[kUpper].X_WL;
    const SurroundingsSettings settings;
    const double bearing_m =
        1.25;  // From the ground, where the program's frame is, to the upper's.
    const Eigen::Vector3d from_U(settings.mount.x_m, settings.mount.y_m,
                                 settings.mount.z_m - bearing_m);
    const auto now = world_.scene().slice_end();
    const ArmShape arm = arm_shape({}, belief_.angles_rad);
    for (double azimuth = -60.0; azimuth < 60.0; azimuth += 0.5) {
      for (int beam = 0; beam < 32; ++beam) {
        const double up = (-30.67 + 4.0 / 3.0 * beam) * kDeg;
        const LidarPoint along{std::cos(up) * std::cos(azimuth * kDeg),
                               std::cos(up) * std::sin(azimuth * kDeg), std::sin(up)};
        const LidarPoint in_body = settings.mount.to_body(along);
        const Eigen::Vector3d direction_U(in_body.x_m - settings.mount.x_m,
                                          in_body.y_m - settings.mount.y_m,
                                          in_body.z_m - settings.mount.z_m);
        const auto hit =
            world_.scene().cast(X_WU * from_U, X_WU.linear() * direction_U, 1.0, 70.0, *now);
        if (hit) {
          surroundings_.add(
              {along.x_m * hit->range_m, along.y_m * hit->range_m, along.z_m * hit->range_m}, arm);
        }
      }
    }
    surroundings_.finish_revolution();
  }

  hil::SimulatedWorld world_;
  hil::TruthRequests requests_;  ///< Taken with the next slice.
  Cycle cycle_;
  Surroundings surroundings_;
  Belief belief_;
  View seen_;
  CycleOutput output_;
  std::vector<double> truth_;
  std::size_t soil_ = 0;
  std::size_t dumped_ = 0;
  std::size_t ticks_ = 0;
  double carried_m3_ = 0.0;
  double lifted_m3_ = 0.0;
  double most_contact_n_ = 0.0;
};

}  // namespace rigwire::dig_cycle
