// Sobol's sequence in up to 21 dimensions.
//
// Direction numbers: S. Joe, F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional
// projections", SIAM J. Sci. Comput. 30 (2008), set new-joe-kuo-6.21201. Order of the points: the
// Gray code of I. A. Antonov and V. M. Saleev (1979), so that any of them is found by its index
// alone: more points continue a set, they change none.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rigwire::hil {

inline constexpr std::size_t kSobolDimensions = 21;

/// Coordinate of a point in units of 2^-32; 0 in every dimension of the first one. `dimension` is
/// below kSobolDimensions.
[[nodiscard]] std::uint32_t sobol_coordinate(std::size_t dimension, std::uint32_t index);

}  // namespace rigwire::hil
