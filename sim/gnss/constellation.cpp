#include "sim/gnss/constellation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

#include "sim/gnss/broadcast_orbits.h"
#include "sim/gnss/ephemeris.h"
#include "sim/gnss/error_field.h"
#include "sim/gnss/nominal_slots.h"

namespace rigwire::sim {
namespace {

/// The last few broadcasts that were asked for, so that all receivers at about one time share one
/// object, which stays the same as long as nothing changes. `Key` says which sets are on the air.
/// Any thread may ask.
template <typename Key>
class BroadcastCache {
 public:
  /// Returns the broadcast of `key`; calls make() if it is not cached.
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
    sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
    for (const GnssSystem system : sorted) {
      if (system == GnssSystem::gps) {
        gps_ = true;
        for (std::uint8_t prn = 1; prn <= kGpsSlots; ++prn) {
          satellites_.push_back({system, prn});
          places_.push_back({system, prn});
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
        add(orbit);
      }
    }
  }

  std::span<const Satellite> satellites() const override { return satellites_; }

  SatelliteState state(std::size_t index, const GpsTime& time, double offset_s) const override {
    const Place& place = places_[index];
    switch (place.system) {
      case GnssSystem::gps:
        return satellite_state(
            nominal_gps_set(static_cast<int>(place.at), broadcast_interval(time, offset_s)), time,
            offset_s);
      case GnssSystem::galileo:
        return galileo_[place.at].state(time, offset_s);
      case GnssSystem::beidou:
        return beidou_[place.at].state(time, offset_s);
      case GnssSystem::glonass:
        return glonass_[place.at].state(time, offset_s);
      default:
        return nominal_state(standing_[place.at], time, offset_s);
    }
  }

  std::shared_ptr<const GpsNavigation> navigation(const GpsTime& time) const override {
    if (!gps_ && galileo_.empty() && beidou_.empty() && glonass_.empty()) {
      return nullptr;
    }
    // Numbers of the sets on the air, 0 of systems that are not there.
    const std::int64_t interval = broadcast_interval(time);
    const std::array<std::int64_t, 4> key{gps_ ? interval : 0,
                                          galileo_.empty() ? 0 : galileo_.front().interval(time),
                                          beidou_.empty() ? 0 : beidou_.front().interval(time),
                                          glonass_.empty() ? 0 : GlonassBroadcast::interval(time)};
    return broadcasts_.get(key, [&] {
      GpsNavigation navigation;
      for (int prn = 1; gps_ && prn <= static_cast<int>(kGpsSlots); ++prn) {
        navigation.ephemerides[static_cast<std::size_t>(prn - 1)] = nominal_gps_set(prn, interval);
      }
      for (const KeplerBroadcast& satellite : galileo_) {
        navigation.galileo.push_back(satellite.set(key[1]));
      }
      for (const KeplerBroadcast& satellite : beidou_) {
        navigation.beidou.push_back(satellite.set(key[2]));
      }
      for (const GlonassBroadcast& satellite : glonass_) {
        navigation.glonass.push_back(satellite.set(key[3]));
      }
      navigation.ionosphere = nominal_ionosphere();
      navigation.utc = nominal_utc(interval);
      return navigation;
    });
  }

 private:
  /// GPS: the number; the others: their place in the list of their kind.
  struct Place {
    GnssSystem system = GnssSystem::gps;
    std::size_t at = 0;
  };

  void add(const NominalOrbit& orbit) {
    const auto put = [&](auto& list) {
      places_.push_back({orbit.satellite.system, list.size()});
      list.emplace_back(orbit);
    };
    switch (orbit.satellite.system) {
      case GnssSystem::galileo:
        return put(galileo_);
      case GnssSystem::beidou:
        return put(beidou_);
      case GnssSystem::glonass:
        return put(glonass_);
      default:
        return put(standing_);
    }
  }

  std::vector<Satellite> satellites_;
  std::vector<Place> places_;  ///< In the order of satellites_.
  bool gps_ = false;
  std::vector<KeplerBroadcast> galileo_;
  std::vector<KeplerBroadcast> beidou_;
  std::vector<GlonassBroadcast> glonass_;
  std::vector<NominalOrbit> standing_;  ///< SBAS, QZSS.
  mutable BroadcastCache<std::array<std::int64_t, 4>> broadcasts_;
};

constexpr std::int64_t kPeriod_s = 7'200;

/// What a satellite has on the air.
struct Selection {
  std::size_t set = 0;
  std::int64_t periods = 0;  ///< How many periods later it is issued again.
  friend bool operator==(const Selection&, const Selection&) = default;
};

/// Broadcast sets from a file. A set is broadcast unchanged within two hours of its toe; where the
/// file has none so near, the nearest is issued again every two hours.
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
    std::array<Selection, 32> selections;
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
    // The set nearest by its time of ephemeris; of two equally near, the older.
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
      // Issued anew every two hours: the number of the nearest issue.
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
  /// Sets of each satellite, in the order of satellites_.
  std::vector<std::vector<GpsEphemeris>> sets_;
  KlobucharParameters ionosphere_;
  GpsUtcParameters utc_;
  mutable BroadcastCache<std::array<Selection, 32>> broadcasts_;
};

}  // namespace

void Constellation::states(std::span<const std::size_t> indices, const GpsTime& time,
                           std::span<SatelliteState> results) const {
  const std::scoped_lock lock(mutex_);
  kept_.resize(satellites().size());
  for (std::size_t i = 0; i < indices.size(); ++i) {
    Kept& kept = kept_[indices[i]];
    if (kept.time != time) {
      kept = {time, state(indices[i], time, 0.0)};
    }
    results[i] = kept.state;
  }
}

std::shared_ptr<const ErrorField> Constellation::errors(std::uint64_t seed) const {
  const std::scoped_lock lock(mutex_);
  std::weak_ptr<const ErrorField>& known = errors_[seed];
  std::shared_ptr<const ErrorField> field = known.lock();
  if (field == nullptr) {
    field = std::make_shared<const ErrorField>(satellites(), seed);
    known = field;
  }
  return field;
}

std::shared_ptr<const Constellation> make_nominal_constellation(
    std::span<const GnssSystem> systems) {
  return std::make_shared<NominalConstellation>(systems);
}

std::shared_ptr<const Constellation> make_gps_constellation(std::span<const GpsEphemeris> sets,
                                                            const KlobucharParameters& ionosphere,
                                                            const GpsUtcParameters& utc) {
  return std::make_shared<FileConstellation>(sets, ionosphere, utc);
}

}  // namespace rigwire::sim
