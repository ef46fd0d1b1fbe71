// Surroundings of satellite receivers that benches measure them in.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "sim/gnss/gnss_sensor.h"
#include "sim/random.h"
#include "sim/samples/gnss_carriers.h"
#include "sim/scene/scene.h"

namespace rigwire::bench {

/// A sky that is the same everywhere.
class SameSky final : public sim::Visibility {
 public:
  using Path = std::function<sim::SkyPath(const Eigen::Vector3d&)>;
  explicit SameSky(Path path) : path_(std::move(path)) {}
  bool blocked(const Eigen::Vector3d&, const Eigen::Vector3d& direction_W, double) const override {
    return path_(direction_W).blocked;
  }
  sim::SkyPath sky_path(const Eigen::Vector3d&, const Eigen::Vector3d& direction_W,
                        double) const override {
    return path_(direction_W);
  }

 private:
  Path path_;
};

/// How wide a street is and how high the walls along it.
struct Street {
  double width_m = 24.0;
  double lowest_m = 11.0;
  double highest_m = 33.0;
};

/// A street along the world's x between blocks of random lengths and heights, some with alleys.
class Canyon {
 public:
  static constexpr double kDriven_mps = 7.0;
  static constexpr int kStretch_s = 12;  ///< Driven, after as long at a light.

  explicit Canyon(int seconds, const Street& street = {}, std::uint64_t seed = 1) {
    constexpr double kDepth_m = 12.0;
    sim::RandomStream random(seed, "street");
    const double end_m = kDriven_mps * seconds + 60.0;
    for (const double side : {-1.0, 1.0}) {
      for (double along_m = -30.0; along_m < end_m;) {
        const double length_m = random.uniform(20.0, 60.0);
        const double height_m = random.uniform(street.lowest_m, street.highest_m);
        const double alley_m = random.uniform() < 0.5 ? random.uniform(3.0, 15.0) : 0.0;
        Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
        X_WB.translation() << along_m + 0.5 * length_m, side * 0.5 * (street.width_m + kDepth_m),
            0.5 * height_m;
        scene_.add_object(scene_.add_mesh(sim::make_box("block", {length_m, kDepth_m, height_m})),
                          X_WB, 1.0, {.reflectance = 0.5, .label = "building"});
        along_m += length_m + alley_m;
      }
    }
  }

  /// Moves the antenna on to second `i` of the drive.
  static void drive(int i, sim::LinkMotion& antenna) {
    const bool driven = i % (2 * kStretch_s) >= kStretch_s;
    antenna.v_WL_W.x() = driven ? kDriven_mps : 0.0;
    antenna.X_WL.translation() += antenna.v_WL_W;
  }
  /// Returns the scene prepared for the antenna's view at that time.
  const sim::Scene& at(SimTime time, const sim::LinkMotion& antenna) {
    scene_.begin_slice(time, time + std::chrono::milliseconds{1}, antenna.X_WL.translation(), {});
    return scene_;
  }

 private:
  sim::Scene scene_;
};

/// A receiver of all systems on both bands, as a ZED-F9P has them.
inline sim::GnssParameters two_band_receiver(sim::GnssParameters parameters) {
  parameters.systems = {.gps = true, .glonass = true, .galileo = true, .beidou = true};
  parameters.sky.maximum_channels = 60;
  parameters.second_signals = true;
  return parameters;
}

/// A reference station of the same sky and air as a rover's, whose corrections are a second old
/// when the rover has them.
class Base {
 public:
  Base(const sim::GnssParameters& rover, std::shared_ptr<const sim::Constellation> satellites,
       const Calendar& calendar, const sim::LocalFrame& frame, std::uint64_t seed)
      : sensor_(station(rover), std::move(satellites), calendar, frame, seed, "bench base") {
    constexpr double kBase_m = 500.0;  // east of the origin, under an open sky
    antenna_.X_WL.translation() << kBase_m, 0.0, 10.0;
    const Eigen::Vector3d place_E_m = frame.to_ecef(antenna_.X_WL.translation());
    place_E_m_ = {place_E_m.x(), place_E_m.y(), place_E_m.z()};
  }

  void share(std::shared_ptr<sim::AntennaBook> antennas) { sensor_.share(std::move(antennas)); }
  /// What arrives: measured at the `time` before.
  std::shared_ptr<const GnssCorrections> measure(SimTime time, bool floating_only) {
    auto arrived = std::move(next_);
    const GnssSample sample = sensor_.sample(time, antenna_, open_);
    GnssCorrections corrections;
    corrections.measured = time + sample.clock_label_offset;
    corrections.station_E_m = place_E_m_;
    corrections.floating_only = floating_only;
    for (const GnssMeasurement& m : sample.measurements) {
      const double wavelength_m = sim::kLightSpeed_mps / carrier_hz(m.system, m.second, m.channel);
      corrections.signals.push_back({m.system, m.number, m.second, m.pseudorange_m,
                                     m.carrier_phase_cycles * wavelength_m, wavelength_m});
    }
    next_ = std::make_shared<const GnssCorrections>(std::move(corrections));
    return arrived;
  }

 private:
  static sim::GnssParameters station(sim::GnssParameters parameters) {
    parameters.raw_measurements = true;
    parameters.corrections.kind = sim::CorrectionKind::none;
    return parameters;
  }

  sim::GnssSensor sensor_;
  sim::LinkMotion antenna_;
  Vector3 place_E_m_;
  SameSky open_{[](const Eigen::Vector3d&) { return sim::SkyPath{}; }};
  std::shared_ptr<const GnssCorrections> next_;
};

/// By order, without interpolation; NaN of nothing.
inline double quantile_of(std::vector<double> values, double share) {
  if (values.empty()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

}  // namespace rigwire::bench
