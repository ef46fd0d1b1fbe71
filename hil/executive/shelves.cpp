#include "hil/executive/shelves.h"

#include <cassert>

namespace rigwire::hil {

void Shelves::clear() {
  for (const auto& shelves : by_station_) {
    for (const auto& shelf : shelves) {
      shelf->clear();
    }
  }
}

std::size_t Shelves::size() const {
  std::size_t sum = 0;
  for (const auto& shelves : by_station_) {
    for (const auto& shelf : shelves) {
      sum += shelf->size();
    }
  }
  return sum;
}

void Shelves::move_to(Shelves& other) {
  assert(this != &other);
  for (StationIndex station = 0; station < by_station_.size(); ++station) {
    for (const auto& shelf : by_station_[station]) {
      shelf->move_to(station, other);
    }
  }
}

}  // namespace rigwire::hil
