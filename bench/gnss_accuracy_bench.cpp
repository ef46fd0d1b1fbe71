#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "bench/carried_machine.h"
#include "bench/gnss_bench.h"
#include "bench/gnss_surroundings.h"
#include "fields/constants.h"
#include "hil/devices/ublox.h"
#include "hil/rig/rig.h"
#include "hil/world/sky.h"

namespace rigwire::bench {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kCarried_mps = 2.0;
constexpr int kFilterSettles_s = 60;  ///< From a cold filter: not judged.

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += value;
  }
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

/// What the days of one receiver at one place add up to.
class AccuracyDays {
 public:
  void begin() { errors_m_.emplace_back(); }
  void add(const GnssSample& sample, const Vector3d& error_m, bool moves) {
    epochs_ += 1.0;
    const bool fixed = sample.fix == GnssFix::two_d || sample.fix == GnssFix::three_d;
    errors_m_.back().push_back(fixed ? std::optional<Vector2d>(error_m.head<2>()) : std::nullopt);
    moves_.resize(errors_m_.size());
    moves_.back().push_back(moves);
    satellites_ +=
        static_cast<double>(std::ranges::count(sample.satellites, true, &SatelliteView::used));
    rtk_fixed_ += sample.carrier == CarrierSolution::fixed ? 1.0 : 0.0;
    if (!fixed) {
      return;
    }
    const double level_m = error_m.head<2>().norm();
    level_m_.push_back(level_m);
    accuracy_m_.push_back(sample.horizontal_accuracy_m);
    inside_.push_back(level_m <= sample.horizontal_accuracy_m ? 1.0 : 0.0);
    if (sample.fix == GnssFix::three_d) {
      up_m_.push_back(error_m.z());
      ratio_.push_back(sample.vertical_accuracy_m / sample.horizontal_accuracy_m);
      inside_up_.push_back(std::abs(error_m.z()) <= sample.vertical_accuracy_m ? 1.0 : 0.0);
    }
  }
  void finish(ReceiverAccuracy& row) const {
    row.days = static_cast<int>(errors_m_.size());
    row.fixes = static_cast<double>(level_m_.size()) / epochs_;
    row.error_50_m = quantile_of(level_m_, 0.50);
    row.error_95_m = quantile_of(level_m_, 0.95);
    row.error_most_m = quantile_of(level_m_, 1.0);
    const double middle_m = mean_of(up_m_);
    double square_m2 = 0.0;
    for (const double up_m : up_m_) {
      square_m2 += (up_m - middle_m) * (up_m - middle_m) / static_cast<double>(up_m_.size());
    }
    row.up_deviation_m = std::sqrt(square_m2);
    row.horizontal_accuracy_m = quantile_of(accuracy_m_, 0.5);
    row.vertical_over_horizontal = quantile_of(ratio_, 0.5);
    row.inside_horizontal = mean_of(inside_);
    row.inside_vertical = mean_of(inside_up_);
    row.correlation_1s = correlation(1);
    row.correlation_5s = correlation(5);
    row.correlation_10s = correlation(10);
    row.satellites = satellites_ / epochs_;
    row.rtk_fixed = rtk_fixed_ / epochs_;
  }

 private:
  /// Returns the autocorrelation of both axes about each day's mean, over pairs of epochs in
  /// motion.
  [[nodiscard]] double correlation(std::size_t lag) const {
    double product = 0.0;
    double square = 0.0;
    for (std::size_t day = 0; day < errors_m_.size(); ++day) {
      const auto& errors = errors_m_[day];
      Vector2d middle = Vector2d::Zero();
      double count = 0.0;
      for (const auto& error : errors) {
        middle += error.value_or(Vector2d::Zero());
        count += error ? 1.0 : 0.0;
      }
      middle /= std::max(1.0, count);
      for (std::size_t i = 0; i + lag < errors.size(); ++i) {
        if (errors[i] && errors[i + lag] && moves_[day][i] && moves_[day][i + lag]) {
          const Vector2d a = *errors[i] - middle;
          const Vector2d b = *errors[i + lag] - middle;
          product += a.dot(b);
          square += 0.5 * (a.squaredNorm() + b.squaredNorm());
        }
      }
    }
    return square > 0.0 ? product / square : 0.0;
  }

  std::vector<std::vector<std::optional<Vector2d>>> errors_m_;  ///< By day; none: no fix.
  std::vector<std::vector<bool>> moves_;
  std::vector<double> level_m_;
  std::vector<double> up_m_;
  std::vector<double> accuracy_m_;
  std::vector<double> ratio_;
  std::vector<double> inside_;
  std::vector<double> inside_up_;
  double epochs_ = 0.0;
  double satellites_ = 0.0;
  double rtk_fixed_ = 0.0;
};

struct ReceiverType {
  const char* name;
  const emulators::UbloxProfile* profile;
  bool corrected;  ///< By a base station.
};

/// Receiver, sky and base of one day.
class ReceiverDay {
 public:
  ReceiverDay(const ReceiverType& type, const hil::RigConfiguration& rig, std::uint64_t seed)
      : calendar_(UtcTime{2026, 6, static_cast<int>(1 + seed % 28), static_cast<int>(5 * seed % 24),
                          0, 0, 0}),
        satellites_(hil::make_satellites(rig.satellites, calendar_)),
        frame_(hil::make_local_frame(rig.origin)),
        parameters_(hil::UbloxConfiguration(*type.profile).sensor),
        sensor_(parameters_, satellites_, calendar_, frame_, seed, "bench") {
    if (type.profile->generation > 8) {
      command_.minimum_elevation_rad = 10.0 * kDegree;  // as it is delivered
    }
    if (type.corrected) {
      base_.emplace(parameters_, satellites_, calendar_, frame_, seed);
      const auto antennas = std::make_shared<sim::AntennaBook>();
      base_->share(antennas);
      sensor_.share(antennas);
    }
  }
  GnssSample sample(SimTime time, const sim::LinkMotion& antenna, const sim::Visibility& sky) {
    if (base_) {
      command_.corrections = base_->measure(time, false);
    }
    sensor_.command(command_);
    return sensor_.sample(time, antenna, sky);
  }
  [[nodiscard]] Vector3d error_m(const GnssSample& sample, const Vector3d& truth_W) const {
    return frame_.to_world({sample.latitude_deg, sample.longitude_deg, sample.ellipsoid_height_m}) -
           truth_W;
  }

 private:
  Calendar calendar_;
  std::shared_ptr<const sim::Constellation> satellites_;
  sim::LocalFrame frame_;
  sim::GnssParameters parameters_;
  sim::GnssSensor sensor_;
  std::optional<Base> base_;
  GnssCommand command_;
};

const hil::UbloxConfiguration& first_ublox(const hil::RigConfiguration& rig) {
  for (const auto& [name, device] : rig.devices) {
    if (const auto* ublox = fields::as<hil::UbloxConfiguration>(device)) {
      return *ublox;
    }
  }
  throw std::invalid_argument("the rig has no u-blox receiver to measure");
}

}  // namespace

std::vector<ReceiverAccuracy> measure_accuracies(const hil::RigConfiguration& campus,
                                                 const hil::RigConfiguration& forest, int days,
                                                 const ModelRow& wanted) {
  const std::array<ReceiverType, 5> types{{{"NEO-7P", &emulators::ublox_neo_7p(), false},
                                           {"NEO-M8N", &emulators::ublox_neo_m8(), false},
                                           {"NEO-M8T", &emulators::ublox_neo_m8t(), false},
                                           {"ZED-F9P", &emulators::ublox_zed_f9p(), false},
                                           {"ZED-F9P, RTK", &emulators::ublox_zed_f9p(), true}}};
  std::vector<ReceiverAccuracy> rows;
  const auto measure = [&](const char* place, const hil::RigConfiguration& rig, auto&& drive) {
    for (const ReceiverType& type : types) {
      if (!wanted(place, type.name)) {
        continue;
      }
      AccuracyDays sum;
      for (int i = 1; i <= days; ++i) {
        const auto seed = static_cast<std::uint64_t>(i);
        ReceiverDay day(type, rig, seed);
        sum.begin();
        drive(seed, [&](int second, const sim::LinkMotion& antenna, const sim::Visibility& sky) {
          const SimTime time = kStart + std::chrono::seconds{second};
          const GnssSample sample = day.sample(time, antenna, sky);
          if (second >= kFilterSettles_s) {
            sum.add(sample, day.error_m(sample, antenna.X_WL.translation()),
                    antenna.v_WL_W.norm() > 0.5);
          }
        });
      }
      sum.finish(rows.emplace_back(ReceiverAccuracy{.place = place, .receiver = type.name}));
    }
  };
  constexpr int kFiveMinutes_s = 300;
  const SameSky open([](const Vector3d&) { return sim::SkyPath{}; });
  measure("open", campus, [&](std::uint64_t, const auto& epoch) {
    for (int i = 0; i < kFiveMinutes_s; ++i) {
      epoch(i, sim::LinkMotion{}, open);
    }
  });
  const SameSky wood(
      [](const Vector3d& d) { return sim::SkyPath{.blocked = d.z() < 0.26, .foliage_m = 6.0}; });
  measure("wood", campus, [&](std::uint64_t, const auto& epoch) {
    for (int i = 0; i < kFiveMinutes_s; ++i) {
      epoch(i, sim::LinkMotion{}, wood);
    }
  });
  measure("deep canyon", campus, [&](std::uint64_t seed, const auto& epoch) {
    constexpr int kTenMinutes_s = 600;
    Canyon canyon(kTenMinutes_s, {.width_m = 21.0, .lowest_m = 35.0, .highest_m = 55.0}, seed);
    sim::LinkMotion antenna;
    antenna.X_WL.translation() << 0.0, -2.0, 2.0;
    for (int i = 0; i < kTenMinutes_s; ++i) {
      Canyon::drive(i, antenna);
      epoch(i, antenna, canyon.at(kStart + std::chrono::seconds{i}, antenna));
    }
  });
  const auto lap = [&](const hil::RigConfiguration& rig) {
    const hil::SensorMount mount = hil::sensor_mount(rig.machine, first_ublox(rig).mount);
    return [&rig, mount](std::uint64_t, const auto& epoch) {
      CarriedMachine machine(rig, kCarried_mps);
      // The lap begins once the receiver has settled.
      const int end_s = kFilterSettles_s + static_cast<int>(machine.length_m() / kCarried_mps);
      for (int i = 0; i < end_s; ++i) {
        const SimTime time = kStart + std::chrono::seconds{i + 1};
        const double along_m = kCarried_mps * std::max(0, i - kFilterSettles_s);
        // The antenna's velocity is that of its way: it turns and climbs with the machine.
        constexpr double kBeside_m = 0.1;
        std::array<Vector3d, 2> beside_W;
        for (const int k : {0, 1}) {
          machine.place(time - std::chrono::milliseconds{2 - k},
                        std::max(0.0, along_m + (2 * k - 1) * kBeside_m));
          beside_W[static_cast<std::size_t>(k)] = machine.motion(mount).X_WL.translation();
        }
        machine.place(time, along_m);
        sim::LinkMotion antenna = machine.motion(mount);
        antenna.v_WL_W = (i <= kFilterSettles_s ? 0.0 : kCarried_mps / (2.0 * kBeside_m)) *
                         (beside_W[1] - beside_W[0]);
        epoch(i, antenna, machine.scene());
      }
    };
  };
  measure("campus", campus, lap(campus));
  measure("forest", forest, lap(forest));
  return rows;
}

}  // namespace rigwire::bench
