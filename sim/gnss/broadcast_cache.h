// The last few broadcasts that were asked for, so that all receivers at about one time share one
// object, which stays the same as long as nothing changes.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>

#include "sim/samples/gps_navigation.h"

namespace rigwire::sim {

/// `Key` says which sets are on the air. Any thread may ask.
template <typename Key>
class BroadcastCache {
 public:
  /// The broadcast of `key`, made by make() when it is not at hand.
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

}  // namespace rigwire::sim
