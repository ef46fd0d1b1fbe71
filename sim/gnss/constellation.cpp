#include "sim/gnss/constellation.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "sim/gnss/broadcast_cache.h"
#include "sim/gnss/ephemeris.h"
#include "sim/gnss/nominal_slots.h"

namespace rigwire::sim {
namespace {

class NominalConstellation final : public Constellation {
 public:
  explicit NominalConstellation(std::span<const GnssSystem> systems) {
    std::vector<GnssSystem> sorted(systems.begin(), systems.end());
    std::ranges::sort(sorted);
    sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
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

}  // namespace

std::shared_ptr<const Constellation> make_nominal_constellation(
    std::span<const GnssSystem> systems) {
  return std::make_shared<NominalConstellation>(systems);
}

}  // namespace rigwire::sim
