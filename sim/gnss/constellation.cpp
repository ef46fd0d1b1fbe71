#include "sim/gnss/constellation.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "sim/gnss/ephemeris.h"
#include "sim/gnss/nominal_slots.h"

namespace rigwire::sim {
namespace {

/// The last few broadcasts, so that receivers at about the same time share one object.
template <typename Key>
class BroadcastCache {
 public:
  template <typename Make>
  std::shared_ptr<const GpsNavigation> get(const Key& key, Make make) {
    const std::scoped_lock lock(mutex_);
    for (const auto& entry : entries_) {
      if (entry.second && entry.first == key) {
        return entry.second;
      }
    }
    auto& entry = entries_[next_];
    next_ = (next_ + 1) % entries_.size();
    entry = {key, std::make_shared<const GpsNavigation>(make())};
    return entry.second;
  }

 private:
  std::mutex mutex_;
  std::array<std::pair<Key, std::shared_ptr<const GpsNavigation>>, 4> entries_;
  std::size_t next_ = 0;
};

class NominalConstellation final : public Constellation {
 public:
  explicit NominalConstellation(std::span<const GnssSystem> systems) {
    std::vector<GnssSystem> sorted(systems.begin(), systems.end());
    std::ranges::sort(sorted);
    sorted.erase(std::ranges::unique(sorted).begin(), sorted.end());
    for (const GnssSystem system : sorted) {
      if (system == GnssSystem::gps) {
        gps_ = kGpsSlots;  // the lowest of the systems: they come first
        for (std::uint8_t prn = 1; prn <= kGpsSlots; ++prn) {
          satellites_.push_back({system, prn});
        }
        continue;
      }
      const std::vector<NominalOrbit> orbits = nominal_orbits(system);
      if (orbits.empty()) {
        throw std::invalid_argument("constellation: system is " +
                                    std::to_string(static_cast<int>(system)) +
                                    ", nominal slots are known of 0 GPS, 1 SBAS, 2 Galileo, 3 "
                                    "BeiDou, 5 QZSS, 6 GLONASS");
      }
      for (const NominalOrbit& orbit : orbits) {
        satellites_.push_back(orbit.satellite);
        orbits_.push_back(orbit);
      }
    }
  }

  std::span<const Satellite> satellites() const override { return satellites_; }

  SatelliteState state(std::size_t index, const GpsTime& time, double offset_s) const override {
    if (index >= gps_) {
      return nominal_state(orbits_[index - gps_], time, offset_s);
    }
    return satellite_state(
        nominal_gps_set(satellites_[index].number, broadcast_interval(time, offset_s)), time,
        offset_s);
  }

  std::shared_ptr<const GpsNavigation> navigation(const GpsTime& time) const override {
    if (gps_ == 0) {
      return nullptr;
    }
    const std::int64_t interval = broadcast_interval(time);
    return broadcasts_.get(interval, [&] {
      GpsNavigation navigation;
      for (int prn = 1; prn <= static_cast<int>(kGpsSlots); ++prn) {
        navigation.ephemerides[static_cast<std::size_t>(prn - 1)] = nominal_gps_set(prn, interval);
      }
      navigation.ionosphere = nominal_ionosphere();
      navigation.utc = nominal_utc(interval);
      return navigation;
    });
  }

 private:
  std::vector<Satellite> satellites_;
  std::vector<NominalOrbit> orbits_;  ///< Of the satellites after the GPS ones.
  std::size_t gps_ = 0;
  mutable BroadcastCache<std::int64_t> broadcasts_;
};

/// Sets out of a file. A set is broadcast as it stands within two hours of its toe; where the file
/// has none so near, the nearest is issued anew every two hours.
class FileConstellation final : public Constellation {
 public:
  FileConstellation(std::span<const GpsEphemeris> sets, const KlobucharParameters& ionosphere,
                    const GpsUtcParameters& utc)
      : ionosphere_(ionosphere), utc_(utc) {
    std::array<std::vector<GpsEphemeris>, 32> by_prn;
    for (const GpsEphemeris& set : sets) {
      if (set.prn < 1 || set.prn > by_prn.size()) {
        throw std::invalid_argument("constellation: PRN is " + std::to_string(set.prn) +
                                    ", allowed are 1 .. 32");
      }
      by_prn[set.prn - 1U].push_back(quantised(set));
    }
    for (auto& of_one : by_prn) {
      if (of_one.empty()) {
        continue;
      }
      tidy(of_one);
      satellites_.push_back({GnssSystem::gps, of_one.front().prn});
      sets_.push_back(std::move(of_one));
    }
    if (sets_.empty()) {
      throw std::invalid_argument("constellation: no broadcast set is given, one is needed");
    }
  }

  std::span<const Satellite> satellites() const override { return satellites_; }

  SatelliteState state(std::size_t index, const GpsTime& time, double offset_s) const override {
    return satellite_state(issue(index, select(index, time, offset_s)), time, offset_s);
  }

  std::shared_ptr<const GpsNavigation> navigation(const GpsTime& time) const override {
    std::vector<Selection> selections(sets_.size());
    for (std::size_t i = 0; i < sets_.size(); ++i) {
      selections[i] = select(i, time, 0.0);
    }
    return broadcasts_.get(selections, [&] {
      GpsNavigation navigation;
      for (std::size_t i = 0; i < sets_.size(); ++i) {
        navigation.ephemerides[satellites_[i].number - 1U] = issue(i, selections[i]);
      }
      navigation.ionosphere = ionosphere_;
      navigation.utc = utc_;
      return navigation;
    });
  }

 private:
  static constexpr std::int64_t kPeriod_s = 7'200;

  struct Selection {
    std::size_t set = 0;
    std::int64_t periods = 0;  ///< How many periods later it is issued again.
    friend bool operator==(const Selection&, const Selection&) = default;
  };

  /// By time, one set of each toe (the last given), and no two neighbours of the same issue.
  static void tidy(std::vector<GpsEphemeris>& sets) {
    const auto toe = [](const GpsEphemeris& set) {
      return std::pair(set.week, set.ephemeris_time_s);
    };
    std::ranges::stable_sort(sets, {}, toe);
    std::vector<GpsEphemeris> kept;
    for (const GpsEphemeris& set : sets) {
      if (!kept.empty() && toe(kept.back()) == toe(set)) {
        kept.pop_back();
      }
      kept.push_back(set);
    }
    for (std::size_t i = 0; i < kept.size(); ++i) {
      GpsEphemeris& set = kept[i];
      if (i > 0 && set.issue_of_ephemeris == kept[i - 1].issue_of_ephemeris) {
        set.issue_of_ephemeris = static_cast<std::uint8_t>(set.issue_of_ephemeris % 255 + 1);
      }
      set.issue_of_clock =
          static_cast<std::uint16_t>((set.issue_of_clock & 0x300) | set.issue_of_ephemeris);
    }
    sets = std::move(kept);
  }

  Selection select(std::size_t index, const GpsTime& time, double offset_s) const {
    const auto& sets = sets_[index];
    const auto age_s = [&](const GpsEphemeris& set) {
      return seconds_between(set.week, set.ephemeris_time_s, time, offset_s);
    };
    const auto after = std::ranges::partition_point(
        sets, [&](const GpsEphemeris& set) { return age_s(set) >= 0.0; });
    auto nearest = after;
    if (after == sets.end() ||
        (after != sets.begin() && age_s(*std::prev(after)) <= -age_s(*after))) {
      --nearest;
    }
    const double age = age_s(*nearest);
    Selection selection;
    selection.set = static_cast<std::size_t>(nearest - sets.begin());
    if (std::abs(age) > double{kPeriod_s}) {
      selection.periods = std::llround(age / double{kPeriod_s});
    }
    return selection;
  }

  GpsEphemeris issue(std::size_t index, const Selection& selection) const {
    const GpsEphemeris& set = sets_[index][selection.set];
    return selection.periods == 0 ? set
                                  : reissued(set, selection.periods * kPeriod_s, selection.periods);
  }

  std::vector<Satellite> satellites_;
  std::vector<std::vector<GpsEphemeris>> sets_;  ///< As satellites_.
  KlobucharParameters ionosphere_;
  GpsUtcParameters utc_;
  mutable BroadcastCache<std::vector<Selection>> broadcasts_;
};

}  // namespace

std::shared_ptr<const Constellation> make_nominal_constellation(
    std::span<const GnssSystem> systems) {
  return std::make_shared<NominalConstellation>(systems);
}

std::shared_ptr<const Constellation> make_gps_constellation(std::span<const GpsEphemeris> sets,
                                                            const KlobucharParameters& ionosphere,
                                                            const GpsUtcParameters& utc) {
  return std::make_shared<FileConstellation>(sets, ionosphere, utc);
}

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kSemiMajorAxis_m = 26'559.7e3;
constexpr double kInclination = 55.0 * kDegree;
constexpr double kGravity_m3ps2 = 3.986005e14;
// 18 h 36 m 14.4 s of right ascension.
constexpr double kGreenwichAtEpoch = (18.0 + 36.0 / 60.0 + 14.4 / 3600.0) * 15.0 * kDegree;
// 1993-07-01 00:00:00 UTC in GPS time: week 703, Thursday, GPS 9 s ahead of UTC.
constexpr std::int64_t kEpochWeek = 703;
constexpr std::int64_t kEpochOfWeek_ns = (4LL * 86'400 + 9) * 1'000'000'000;
constexpr std::int64_t kSlotWeek_ns = 604'800LL * 1'000'000'000;

constexpr std::array kNode_deg{272.847, 332.847, 32.847, 92.847, 152.847, 212.847};
constexpr std::array<double, kGpsSlots> kArgumentOfLatitude_deg{
    268.126, 161.786, 11.676,  41.806,   // A
    80.956,  173.336, 309.976, 204.376,  // B
    111.876, 11.796,  339.666, 241.556,  // C
    135.226, 265.446, 35.156,  167.356,  // D
    197.046, 302.596, 66.066,  333.686,  // E
    238.886, 345.226, 105.206, 135.346,  // F
};

double seconds_since_epoch(const GpsTime& time) {
  return static_cast<double>((time.week - kEpochWeek) * kSlotWeek_ns + time.time_of_week_ns -
                             kEpochOfWeek_ns) *
         1e-9;
}

}  // namespace

Eigen::Vector3d gps_satellite_ecef(std::size_t slot, const GpsTime& time) {
  static const double kMeanMotion =
      std::sqrt(kGravity_m3ps2 / (kSemiMajorAxis_m * kSemiMajorAxis_m * kSemiMajorAxis_m));
  const double t = seconds_since_epoch(time);
  const double argument =
      kArgumentOfLatitude_deg[slot] * kDegree + std::fmod(kMeanMotion * t, 2.0 * std::numbers::pi);
  const double node = kNode_deg[slot / 4] * kDegree - kGreenwichAtEpoch -
                      std::fmod(kEarthRate_radps * t, 2.0 * std::numbers::pi);
  const double x = kSemiMajorAxis_m * std::cos(argument);
  const double y = kSemiMajorAxis_m * std::sin(argument);
  const double y_equator = y * std::cos(kInclination);
  return {x * std::cos(node) - y_equator * std::sin(node),
          x * std::sin(node) + y_equator * std::cos(node), y * std::sin(kInclination)};
}

std::array<Eigen::Vector3d, kGpsSlots> gps_constellation_ecef(const GpsTime& time) {
  std::array<Eigen::Vector3d, kGpsSlots> positions;
  for (std::size_t slot = 0; slot < kGpsSlots; ++slot) {
    positions[slot] = gps_satellite_ecef(slot, time);
  }
  return positions;
}

}  // namespace rigwire::sim
