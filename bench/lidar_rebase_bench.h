// What the scene's local origin is for: range errors with it and without, over the distance from
// the map origin.
#pragma once

#include <cstddef>
#include <vector>

namespace rigwire::bench {

/// Errors against a closed form in double, of rays that should hit.
struct RangeErrorSummary {
  std::size_t rays = 0;
  std::size_t leaks = 0;  ///< Rays that hit nothing, or something 1 m off.
  double rms_m = 0.0;     ///< RMS error of the others.
  double p99_m = 0.0;
  double worst_m = 0.0;
};

struct RebaseError {
  double map_offset_m = 0.0;
  RangeErrorSummary rebased;  ///< Vertices about a centre of their own, local origin near the rays.
  RangeErrorSummary raw;      ///< Vertices and rays in world coordinates, as floats.
};

/// A plane of 1 m triangles, seen with ranges of 1 to 100 m, at each distance. It slants, because
/// on a level one horizontal errors would not show.
[[nodiscard]] std::vector<RebaseError> measure_rebasing(const std::vector<double>& map_offsets_m);

}  // namespace rigwire::bench
