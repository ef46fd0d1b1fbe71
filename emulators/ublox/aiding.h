// AID-EPH, AID-ALM and AID-HUI from what a receiver collected of the navigation message.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "emulators/ublox/subframe_reception.h"
#include "protocols/ubx/frame.h"

namespace rigwire::emulators {

/// Each writes a whole frame under the class and id `id` and returns its size; `out` has room for
/// it (precondition, 112 bytes are enough). prn is 1..32. Without data the short form.
[[nodiscard]] std::size_t encode_aiding_ephemeris(const SubframeReception& reception,
                                                  std::size_t prn, protocols::ubx::MessageId id,
                                                  std::span<std::uint8_t> out);
[[nodiscard]] std::size_t encode_aiding_almanac(const SubframeReception& reception, std::size_t prn,
                                                protocols::ubx::MessageId id,
                                                std::span<std::uint8_t> out);
[[nodiscard]] std::size_t encode_aiding_health(const SubframeReception& reception,
                                               std::span<std::uint8_t> out);

}  // namespace rigwire::emulators
