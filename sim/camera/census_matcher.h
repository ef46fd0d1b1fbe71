// Semi-global matching of census pictures, the quick way of stereo_matcher.h.
//
//   cost   Pixels are compared by which of the 31 pairs of pixels opposite each other in a window
//          of 9 by 7 has its first one brighter (center-symmetric census: R. Spangenberg, T.
//          Langner, R. Rojas, "Weighted semi-global matching and center-symmetric census transform
//          for robust driver assistance", CAIP 2013, section 2): C, 0 .. 31, is the number of pairs
//          that differ. Gain, offset and vignetting of the heads do not show in it.
//   paths  L(p, d) = C(p, d) + min(L(q, d), L(q, d - 1) + P1, L(q, d + 1) + P1, min L(q) + P2)
//                    - min L(q),  q the pixel before p on the path
//          (H. Hirschmueller, IEEE PAMI 30(2), 2008, equation 13), from the left, the right and
//          above or also from above left and above right; S(p, d) is their sum.
//   best   The lowest S, refused where one of another surface is as good within `uniqueness`.
//          Between pixels: where two lines of opposite slope through three sums intersect, since
//          costs grow linearly with the distance.
//   back   The lowest S(x + d, d) for a pixel x of the right picture: the disparity leading back.
//   after  Median of 3 by 3, islands taken out.
//
// The picture is searched in four strips, whose paths from above begin 24 rows before their own:
// the same ones for any number of threads.
#pragma once

#include <memory>

#include "sim/camera/stereo_matcher.h"

namespace rigwire::sim {

/// `parameters` are valid.
[[nodiscard]] std::unique_ptr<StereoMatcher> make_census_matcher(
    const StereoMatchingParameters& parameters, int threads);

/// Pixel pairs that are compared; also the maximum cost.
inline constexpr int kCensusPairs = 31;

}  // namespace rigwire::sim
