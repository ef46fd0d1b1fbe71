#include "hil/campaign/sobol.h"

#include <array>
#include <span>

namespace rigwire::hil {

namespace {

constexpr std::size_t kBits = 32;

/// A primitive polynomial over GF(2) and the first direction integers of its recurrence.
struct Dimension {
  std::size_t degree;
  std::uint32_t inner;  ///< Coefficients between the first and the last, which are 1.
  std::array<std::uint32_t, 7> first;
};

/// Rows of all dimensions but the first, which is van der Corput's sequence.
constexpr std::array<Dimension, kSobolDimensions - 1> kDimensions{{
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
    {5, 4, {1, 1, 5, 5, 5}},
    {5, 7, {1, 1, 7, 11, 19}},
    {5, 11, {1, 1, 5, 1, 1}},
    {5, 13, {1, 1, 1, 3, 11}},
    {5, 14, {1, 3, 5, 5, 31}},
    {6, 1, {1, 3, 3, 9, 7, 49}},
    {6, 13, {1, 1, 1, 15, 21, 21}},
    {6, 16, {1, 3, 1, 13, 27, 49}},
    {6, 19, {1, 1, 1, 15, 7, 5}},
    {6, 22, {1, 3, 1, 15, 13, 25}},
    {6, 25, {1, 1, 5, 5, 19, 61}},
    {7, 1, {1, 3, 7, 11, 23, 15, 103}},
    {7, 4, {1, 3, 7, 13, 13, 15, 69}},
}};

using Directions = std::array<std::uint32_t, kBits>;

/// v_k = a_1 v_{k-1} + ... + v_{k-s} + v_{k-s} / 2^s over GF(2) (Joe and Kuo, eq. 2).
constexpr Directions directions_of(std::size_t dimension) {
  Directions v{};
  if (dimension == 0) {
    for (std::size_t k = 0; k < kBits; ++k) {
      v[k] = std::uint32_t{1} << (kBits - 1 - k);
    }
    return v;
  }
  const Dimension& d = kDimensions[dimension - 1];
  for (std::size_t k = 0; k < kBits; ++k) {
    if (k < d.degree) {
      v[k] = d.first[k] << (kBits - 1 - k);
      continue;
    }
    v[k] = v[k - d.degree] ^ (v[k - d.degree] >> d.degree);
    for (std::size_t term = 1; term < d.degree; ++term) {
      const bool in = ((d.inner >> (d.degree - 1 - term)) & 1u) != 0;
      v[k] ^= in ? v[k - term] : 0u;
    }
  }
  return v;
}

constexpr std::array<Directions, kSobolDimensions> kDirections = [] {
  std::array<Directions, kSobolDimensions> all{};
  for (std::size_t dimension = 0; dimension < kSobolDimensions; ++dimension) {
    all[dimension] = directions_of(dimension);
  }
  return all;
}();

}  // namespace

std::uint32_t sobol_coordinate(std::size_t dimension, std::uint32_t index) {
  std::uint32_t coordinate = 0;
  const std::uint32_t gray = index ^ (index >> 1);
  for (std::size_t bit = 0; bit < kBits; ++bit) {
    coordinate ^= ((gray >> bit) & 1u) != 0 ? kDirections[dimension][bit] : 0u;
  }
  return coordinate;
}

}  // namespace rigwire::hil
