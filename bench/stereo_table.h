// The table of stereo matchers, which `rigwire bench camera` and the comparison with OpenCV print.
#pragma once

#include <nlohmann/json.hpp>
#include <ostream>

#include "bench/camera_kinds_bench.h"
#include "bench/table.h"

namespace rigwire::bench {

class StereoTable {
 public:
  /// Prints the head to `text`, which must outlive the table.
  explicit StereoTable(std::ostream& text);
  /// Prints the rows of `cost`, one for all depths and one for each band of them, and appends their
  /// figures to the array `rows`.
  void add(const StereoCost& cost, nlohmann::json& rows) const;
  /// Prints what the columns mean.
  void end() const;

 private:
  std::ostream& text_;
  Table table_;
};

}  // namespace rigwire::bench
