// Where the antennas of a rig's receivers were at their latest epochs: the truth against which a
// receiver's engine holds what another one's messages say (reference_station.h). It never leaves
// the world.
//
// Of one thread. A receiver's entries are those of its own epochs, the last kRemembered of them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include "sim/samples/time.h"

namespace rigwire::sim {

class AntennaBook {
 public:
  static constexpr std::size_t kRemembered = 256;

  /// Notes an antenna's place at an epoch; times of one name must not decrease.
  void note(std::string_view name, SimTime time, const Eigen::Vector3d& p_W) {
    auto found = tracks_.find(name);
    if (found == tracks_.end()) {
      found = tracks_.emplace(std::string(name), Track{.id = tracks_.size()}).first;
    }
    Track& track = found->second;
    track.places[track.next % kRemembered] = {time, p_W};
    ++track.next;
  }

  /// Calls visit(id, p_W) for each antenna but `self` that had an epoch at that instant. Each
  /// antenna has an id of its own, which never changes.
  template <class Visit>
  void each(SimTime time, std::string_view self, Visit visit) const {
    for (const auto& [name, track] : tracks_) {
      if (name == self) {
        continue;
      }
      for (const Place& place : track.places) {
        if (place.time == time) {
          visit(track.id, place.p_W);
          break;
        }
      }
    }
  }

 private:
  struct Place {
    SimTime time = kNever;
    Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  };
  struct Track {
    std::size_t id = 0;
    std::array<Place, kRemembered> places{};
    std::size_t next = 0;
  };
  std::map<std::string, Track, std::less<>> tracks_;
};

}  // namespace rigwire::sim
