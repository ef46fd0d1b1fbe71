#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "bench/carried_machine.h"
#include "bench/gnss_bench.h"
#include "bench/gnss_surroundings.h"
#include "fields/constants.h"
#include "hil/devices/ublox.h"
#include "hil/executive/cpu_time.h"
#include "hil/rig/rig.h"
#include "hil/world/sky.h"
#include "sim/gnss/dilution.h"

namespace rigwire::bench {
namespace {

using Eigen::Vector3d;

constexpr double kSpeed_mps = 2.0;

/// What one receiver after the other adds to a row.
class Measured {
 public:
  /// `only`: epochs of another carrier solution count as without a fix.
  Measured(ModelError& row, const sim::LocalFrame& frame, std::optional<CarrierSolution> only)
      : row_(row), frame_(frame), only_(only) {}

  void begin() { before_.reset(); }
  void add(const GnssSample& sample, double cpu_s, const Vector3d& truth_W) {
    ++epochs_;
    cpu_s_ += cpu_s;
    if ((sample.fix != GnssFix::two_d && sample.fix != GnssFix::three_d) ||
        (only_ && sample.carrier != *only_)) {
      before_.reset();
      step_.reset();
      return;
    }
    const Vector3d error =
        frame_.to_world({sample.latitude_deg, sample.longitude_deg, sample.ellipsoid_height_m}) -
        truth_W;
    const double horizontal_m = error.head<2>().norm();
    errors_.push_back(horizontal_m);
    over_dilution_m_.push_back(horizontal_m / sample.horizontal_dilution);
    squares_ += std::pow(horizontal_m / sample.horizontal_accuracy_m, 2);
    std::vector<Vector3d> directions;
    for (const SatelliteView& view : sample.satellites) {
      if (view.used) {
        directions.emplace_back(std::cos(view.elevation_rad) * std::sin(view.azimuth_rad),
                                std::cos(view.elevation_rad) * std::cos(view.azimuth_rad),
                                std::sin(view.elevation_rad));
      }
    }
    ratios_.push_back(sample.horizontal_dilution / geometry_->reported(directions).horizontal);
    if (before_) {
      const Vector3d step = error - *before_;
      steps_.push_back(step.head<2>().norm());
      variance_ += step.x() * step.x();
      covariance_ += step_ ? *step_ * step.x() : 0.0;
      step_ = step.x();
    } else {
      step_.reset();
    }
    before_ = error;
  }
  void finish() {
    row_.epoch_us = 1e6 * cpu_s_ / static_cast<double>(epochs_);
    row_.fixes = static_cast<double>(errors_.size()) / static_cast<double>(epochs_);
    row_.error_over_accuracy = squares_ / static_cast<double>(errors_.size());
    row_.error_median_m = quantile_of(errors_, 0.5);
    row_.error_95_m = quantile_of(errors_, 0.95);
    row_.over_dilution_50_m = quantile_of(over_dilution_m_, 0.50);
    row_.over_dilution_68_m = quantile_of(over_dilution_m_, 0.68);
    row_.over_dilution_95_m = quantile_of(over_dilution_m_, 0.95);
    row_.step_median_m = quantile_of(steps_, 0.5);
    row_.step_correlation = covariance_ / variance_;
    row_.dilution_ratio = quantile_of(ratios_, 0.5);
  }

 private:
  ModelError& row_;
  const sim::LocalFrame& frame_;
  std::optional<CarrierSolution> only_;
  std::unique_ptr<sim::DilutionModel> geometry_ = sim::make_geometric_dilution();
  std::size_t epochs_ = 0;
  double cpu_s_ = 0.0;
  double squares_ = 0.0;
  double variance_ = 0.0;
  double covariance_ = 0.0;
  std::vector<double> errors_;
  std::vector<double> over_dilution_m_;
  std::vector<double> steps_;
  std::vector<double> ratios_;
  std::optional<Vector3d> before_;
  std::optional<double> step_;
};

}  // namespace

std::vector<ModelError> measure_models(const hil::RigConfiguration& rig, int receivers, int seconds,
                                       const ModelRow& wanted) {
  const hil::UbloxConfiguration* ublox = nullptr;
  for (const auto& [name, device] : rig.devices) {
    ublox = ublox == nullptr ? fields::as<hil::UbloxConfiguration>(device) : ublox;
  }
  if (ublox == nullptr) {
    throw std::invalid_argument("the rig has no u-blox receiver to measure");
  }
  const Calendar calendar(rig.start);
  const auto satellites = hil::make_satellites(rig.satellites, calendar);
  const sim::LocalFrame frame = hil::make_local_frame(rig.origin);
  const hil::SensorMount mount = hil::sensor_mount(rig.machine, ublox->mount);
  const std::array<std::pair<const char*, SameSky>, 3> skies{
      {{"open", SameSky([](const Vector3d&) { return sim::SkyPath{}; })},
       {"street", SameSky([](const Vector3d& d) {
          // Walls of 30 degrees along a street that runs east and west.
          const double across = std::abs(d.y());
          return sim::SkyPath{d.z() < std::tan(30.0 * kDegree) * across, 0.0};
        })},
       {"wood", SameSky([](const Vector3d& d) {
          return sim::SkyPath{d.z() < 0.26, 6.0};
        })}}};
  struct Model {
    const char* name;
    sim::ErrorModel errors;
    std::optional<CarrierSolution> carrier;  // with corrections of a base station
  };
  constexpr std::array<Model, 5> kModels{
      {{"paper", sim::ErrorModel::paper, {}},
       {"coloured", sim::ErrorModel::coloured, {}},
       {"engine", sim::ErrorModel::engine, {}},
       {"RTK float", sim::ErrorModel::engine, CarrierSolution::floating},
       {"RTK fixed", sim::ErrorModel::engine, CarrierSolution::fixed}}};

  std::vector<ModelError> rows;
  const auto measure = [&](const char* place, const auto& drive) {
    for (const Model& model : kModels) {
      if (!wanted(place, model.name)) {
        continue;
      }
      ModelError row{.place = place, .model = model.name};
      Measured measured(row, frame, model.carrier);
      for (int i = 0; i < receivers; ++i) {
        sim::GnssParameters parameters = ublox->sensor;
        parameters.error_model = model.errors;
        parameters.raw_measurements = false;
        std::optional<Base> base;
        // A field of errors of its own for each, so that they are as good as so many days.
        const std::uint64_t seed = rig.seed + static_cast<std::uint64_t>(i);
        if (model.carrier) {
          parameters = two_band_receiver(parameters);
          parameters.corrections.kind = sim::CorrectionKind::rtk;
          base.emplace(parameters, satellites, calendar, frame, seed);
        }
        sim::GnssSensor sensor(parameters, satellites, calendar, frame, seed, "bench");
        measured.begin();
        drive([&](SimTime time, const sim::LinkMotion& antenna, const sim::Visibility& sky) {
          if (base) {
            GnssCommand command;
            command.corrections = base->measure(time, model.carrier == CarrierSolution::floating);
            sensor.command(command);
          }
          const double before_s = hil::thread_cpu_seconds();
          const GnssSample sample = sensor.sample(time, antenna, sky);
          measured.add(sample, hil::thread_cpu_seconds() - before_s, antenna.X_WL.translation());
        });
      }
      measured.finish();
      rows.push_back(row);
    }
  };
  for (const auto& [place, sky] : skies) {
    measure(place, [&, &sky = sky](const auto& epoch) {
      for (int i = 0; i < seconds; ++i) {
        epoch(kStart + std::chrono::seconds{i}, sim::LinkMotion{}, sky);
      }
    });
  }
  Canyon canyon(seconds);
  measure("canyon", [&](const auto& epoch) {
    sim::LinkMotion antenna;
    antenna.X_WL.translation() << 0.0, -2.0, 2.0;
    for (int i = 0; i < seconds; ++i) {
      Canyon::drive(i, antenna);
      const SimTime time = kStart + std::chrono::seconds{i};
      epoch(time, antenna, canyon.at(time, antenna));
    }
  });
  CarriedMachine machine(rig, kSpeed_mps);
  measure("campus", [&](const auto& epoch) {
    SimTime time = kStart;
    for (double along_m = 0.0; along_m < machine.length_m(); along_m += kSpeed_mps) {
      machine.place(time, along_m);
      epoch(time, machine.motion(mount), machine.scene());
      time += std::chrono::seconds{1};
    }
  });
  return rows;
}

}  // namespace rigwire::bench
