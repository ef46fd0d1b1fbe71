// Rocks over pictures: the same rock keeps its number, and a rock that is seen only once is not
// reported.
//
// A rock of a new picture belongs to the nearest one that is known, within what its place may err
// by; each to one. The machine may be at rest or creep: where the camera turns or drives by more
// than that from picture to picture, rocks get new numbers.
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "find_rocks/rock_finder.h"

namespace rigwire::find_rocks {

struct TrackedRock {
  static constexpr std::size_t kMemory = 10;  ///< Pictures.

  std::uint64_t number = 0;  ///< From 1.
  double x_m = 0.0;          ///< Coordinates of SeenRock, averaged over the pictures.
  double y_m = 0.0;
  double z_m = 0.0;
  double width_m = 0.0;
  double height_m = 0.0;
  double contrast = 0.0;
  std::bitset<kMemory> seen;   ///< In the last pictures, the newest in bit 0.
  std::uint64_t pictures = 0;  ///< Number of pictures in which it was seen.

  /// Share of the last pictures in which it was seen, times its contrast: 0 .. 1.
  [[nodiscard]] double confidence() const {
    return contrast * static_cast<double>(seen.count()) / static_cast<double>(kMemory);
  }
};

class RockTracker {
 public:
  /// A rock is reported once it was seen in this many of the last kMemory pictures.
  static constexpr std::size_t kBelieved = 3;

  void update(const std::vector<SeenRock>& rocks);
  /// Returns the rocks that are reported, from near to far.
  [[nodiscard]] std::vector<TrackedRock> rocks() const;
  /// Number of rocks that were ever reported.
  [[nodiscard]] std::uint64_t numbers() const { return last_number_; }

 private:
  std::vector<TrackedRock> tracks_;
  std::uint64_t last_number_ = 0;
};

}  // namespace rigwire::find_rocks
