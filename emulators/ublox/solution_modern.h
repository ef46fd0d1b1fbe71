// The navigation messages that u-blox 8 and 9 have beyond those of u-blox 7, or in another form:
// NAV-PVT of 92 bytes, SAT, SIG, ORB, TIMELS, TIMEGLO, TIMEBDS, TIMEGAL, ODO, EOE, COV, HPPOSECEF,
// HPPOSLLH, SVIN and RELPOSNED of a rover without base, and the carrier solution in PVT and STATUS.
//
// Sources: u-blox M8 receiver description, UBX-13003221 R28, section 32.17; u-blox F9 HPG 1.50
// interface description, UBXDOC-963802114-12815, section 3.15; SVIN and RELPOSNED besides from
// u-center's log of a ZED-F9P (HPG 1.32) without base and survey. What is constant is listed
// in docs/devices/ublox-neo-m8.md and ublox-zed-f9p.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "emulators/ublox/profile.h"
#include "emulators/ublox/solution.h"

namespace rigwire::emulators {

/// Writes the frame and returns its size; 0 when it is none of these messages. The carrier solution
/// is told where the profile has one. Precondition: out.size() >= kLongestSolutionFrame.
[[nodiscard]] std::size_t encode_modern_solution(const UbloxSolution& solution,
                                                 const UbloxProfile& profile,
                                                 protocols::ubx::MessageId id,
                                                 std::span<std::uint8_t> out);

}  // namespace rigwire::emulators
