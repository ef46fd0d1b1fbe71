// The YUMA almanac: coarse GPS orbits as text, one block of thirteen lines per satellite.
//
// Source: U.S. Coast Guard Navigation Center, "Definition of a Yuma Almanac". Units are SI and
// radians; the inclination is whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "protocols/gps/almanac.h"

namespace rigwire::protocols::rinex {

struct YumaAlmanac {
  std::vector<gps::Almanac> almanacs;  ///< In the file's order.
  std::size_t skipped_lines = 0;       ///< With unknown names.
};

/// Weeks below 1024 in the file are taken as the week nearest to `week_hint` with these low bits.
/// Throws std::invalid_argument "name:line: ..." for a block with a line missing or twice, for a
/// value that is not a number or out of its range, and for a file without any block.
[[nodiscard]] YumaAlmanac read_yuma(std::string_view text, std::string_view name,
                                    std::int32_t week_hint);

}  // namespace rigwire::protocols::rinex
