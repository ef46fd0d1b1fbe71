#include "bench/gnss_lap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <type_traits>

#include "bench/carried_machine.h"
#include "hil/devices/starfire.h"
#include "hil/devices/ublox.h"
#include "hil/rig/rig.h"
#include "hil/world/sky.h"
#include "sim/gnss/gnss_sensor.h"
#include "sim/scene/track.h"

namespace rigwire::bench {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A receiver of whatever type: everything that has an antenna and a GnssParameters.
struct Receiver {
  Lap lap;
  hil::SensorMount mount;
  sim::GnssSensor sensor;
};

std::vector<Receiver> receivers(const hil::RigConfiguration& rig, const sim::LocalFrame& frame) {
  const Calendar calendar(rig.start);
  const auto satellites = hil::make_satellites(rig.satellites, calendar);
  std::vector<Receiver> found;
  for (const auto& [name, device] : rig.devices) {
    const auto add = [&, &name = name, type = std::string(device.type())](const auto& settings) {
      found.push_back(
          {{name, type, {}},
           sensor_mount(rig.machine, settings.mount),
           sim::GnssSensor(settings.sensor, satellites, calendar, frame, rig.seed, name)});
    };
    if (const auto* ublox = fields::as<hil::UbloxConfiguration>(device)) {
      hil::UbloxConfiguration as_in_paper = *ublox;
      as_in_paper.sensor.error_model = sim::ErrorModel::paper;
      add(as_in_paper);
    } else if (const auto* starfire = fields::as<hil::StarFireConfiguration>(device)) {
      add(*starfire);
    }
  }
  if (found.empty()) {
    throw std::invalid_argument("the rig has no satellite receiver");
  }
  return found;
}

LapEpoch to_epoch(const GnssSample& sample, double along_m, const sim::LocalFrame& frame,
                  const Vector3d& antenna_W) {
  LapEpoch epoch;
  epoch.along_m = along_m;
  epoch.satellites =
      static_cast<int>(std::ranges::count(sample.satellites, true, &SatelliteView::used));
  epoch.horizontal_dilution = sample.horizontal_dilution;
  epoch.vertical_dilution = sample.vertical_dilution;
  epoch.position_dilution = sample.position_dilution;
  epoch.horizontal_error_m = std::numeric_limits<double>::quiet_NaN();
  epoch.vertical_error_m = epoch.horizontal_error_m;
  if (sample.fix == GnssFix::two_d || sample.fix == GnssFix::three_d) {
    const Vector3d error_W =
        frame.to_world({sample.latitude_deg, sample.longitude_deg, sample.ellipsoid_height_m}) -
        antenna_W;
    epoch.horizontal_error_m = error_W.head<2>().norm();
    epoch.vertical_error_m = std::abs(error_W.z());
  }
  return epoch;
}

}  // namespace

std::vector<Lap> drive_lap(const hil::RigConfiguration& rig, double speed_mps, double spacing_m) {
  if (!(spacing_m > 0.0)) {
    throw std::invalid_argument(
        fmt::format("lap: found epochs every {} m, allowed > 0", spacing_m));
  }
  const sim::LocalFrame frame = hil::make_local_frame(rig.origin);
  std::vector<Receiver> all = receivers(rig, frame);
  CarriedMachine machine(rig, speed_mps);
  // Whole milliseconds: receivers measure on that grid.
  const Duration step = std::chrono::milliseconds{std::llround(1e3 * spacing_m / speed_mps)};
  SimTime time = kStart;
  for (double along_m = 0.0; along_m < machine.length_m(); along_m += spacing_m, time += step) {
    machine.place(time, along_m);
    for (Receiver& receiver : all) {
      const sim::LinkMotion antenna = machine.motion(receiver.mount);
      receiver.lap.epochs.push_back(to_epoch(receiver.sensor.sample(time, antenna, machine.scene()),
                                             along_m, frame, antenna.X_WL.translation()));
    }
  }
  std::vector<Lap> laps;
  for (Receiver& receiver : all) {
    laps.push_back(std::move(receiver.lap));
  }
  return laps;
}

LapRange lap_range(const Lap& lap) {
  const auto span = [&](const auto& value) {
    LapRange::Span found{std::numeric_limits<double>::infinity(),
                         -std::numeric_limits<double>::infinity()};
    for (const LapEpoch& epoch : lap.epochs) {
      if (const double x = value(epoch); std::isfinite(x)) {
        found.least = std::min(found.least, x);
        found.greatest = std::max(found.greatest, x);
      }
    }
    return found;
  };
  return {span([](const LapEpoch& e) { return static_cast<double>(e.satellites); }),
          span([](const LapEpoch& e) { return e.horizontal_dilution; }),
          span([](const LapEpoch& e) { return e.vertical_dilution; }),
          span([](const LapEpoch& e) { return e.position_dilution; })};
}

std::vector<PassedBuilding> passed_buildings(const hil::RigConfiguration& rig, double reach_m) {
  const sim::TrackLine line = sim::track_line(closed_track(rig));
  std::vector<PassedBuilding> passed;
  for (const sim::BoxObject& box : rig.scene.description.boxes) {
    PassedBuilding nearest{box.name, 0.0, reach_m, box.size_m.z()};
    constexpr int kPerEdge = 20;
    for (int i = 0; i < 4 * kPerEdge; ++i) {
      // Once round the outline of the box, edge by edge.
      const double along = 2.0 * (i % kPerEdge) / kPerEdge - 1.0;
      const int edge = i / kPerEdge;
      const Vector2d unit = edge == 0   ? Vector2d(along, 1.0)
                            : edge == 1 ? Vector2d(along, -1.0)
                            : edge == 2 ? Vector2d(1.0, along)
                                        : Vector2d(-1.0, along);
      const Vector2d corner =
          box.position_m.head<2>() +
          Eigen::Rotation2Dd(box.yaw_rad) * (0.5 * box.size_m.head<2>().cwiseProduct(unit));
      const auto way = line.nearest(corner);
      if (way.distance_m < nearest.distance_m) {
        nearest.distance_m = way.distance_m;
        nearest.along_m = way.along_m;
      }
    }
    if (nearest.distance_m < reach_m) {
      passed.push_back(nearest);
    }
  }
  std::ranges::sort(passed, {}, &PassedBuilding::along_m);
  return passed;
}

}  // namespace rigwire::bench
