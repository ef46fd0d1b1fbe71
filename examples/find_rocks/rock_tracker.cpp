#include "find_rocks/rock_tracker.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace rigwire::find_rocks {
namespace {

/// A picture's share in the averages, once there are enough pictures.
constexpr double kNewShare = 0.2;
/// How far a place may be off: along the line of sight it grows with distance.
constexpr double kAcross_m = 0.25;
constexpr double kAlong_m = 0.3;
constexpr double kAlongShare = 0.04;

/// Below 1: may be the same rock.
double apart(const TrackedRock& track, const SeenRock& rock) {
  const double along = (track.x_m - rock.x_m) / (kAlong_m + kAlongShare * rock.x_m);
  const double across = (track.y_m - rock.y_m) / (kAcross_m + 0.5 * rock.width_m);
  return std::hypot(along, across);
}

}  // namespace

/// Assigns rocks to tracks greedily, the nearest pair first, updates the tracks by exponential
/// averages, drops those unseen in the last kMemory pictures and starts new ones.
void RockTracker::update(const std::vector<SeenRock>& rocks) {
  for (TrackedRock& track : tracks_) {
    track.seen <<= 1U;
  }
  struct Pair {
    double apart;
    std::size_t track;
    std::size_t rock;
  };
  std::vector<Pair> pairs;
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    for (std::size_t r = 0; r < rocks.size(); ++r) {
      if (const double distance = apart(tracks_[t], rocks[r]); distance < 1.0) {
        pairs.push_back({distance, t, r});
      }
    }
  }
  std::ranges::sort(pairs, {}, &Pair::apart);
  std::vector<bool> taken(rocks.size(), false);
  for (const Pair& pair : pairs) {
    TrackedRock& track = tracks_[pair.track];
    if (track.seen.test(0) || taken[pair.rock]) {
      continue;
    }
    taken[pair.rock] = true;
    track.seen.set(0);
    ++track.pictures;
    const SeenRock& rock = rocks[pair.rock];
    const double share = std::max(kNewShare, 1.0 / static_cast<double>(track.pictures));
    const auto blend = [share](double& mean, double value) { mean += share * (value - mean); };
    blend(track.x_m, rock.x_m);
    blend(track.y_m, rock.y_m);
    blend(track.z_m, rock.z_m);
    blend(track.width_m, rock.width_m);
    blend(track.height_m, rock.height_m);
    blend(track.contrast, rock.contrast);
  }
  std::erase_if(tracks_, [](const TrackedRock& track) { return track.seen.none(); });
  for (std::size_t r = 0; r < rocks.size(); ++r) {
    if (!taken[r]) {
      const SeenRock& rock = rocks[r];
      tracks_.push_back(
          {0, rock.x_m, rock.y_m, rock.z_m, rock.width_m, rock.height_m, rock.contrast, {1U}, 1});
    }
  }
  for (TrackedRock& track : tracks_) {
    if (track.number == 0 && track.seen.count() >= kBelieved) {
      track.number = ++last_number_;
    }
  }
}

std::vector<TrackedRock> RockTracker::rocks() const {
  std::vector<TrackedRock> believed;
  std::ranges::copy_if(tracks_, std::back_inserter(believed), [](const TrackedRock& track) {
    return track.number > 0 && track.seen.count() >= kBelieved;
  });
  std::ranges::sort(believed, {}, &TrackedRock::x_m);
  return believed;
}

}  // namespace rigwire::find_rocks
