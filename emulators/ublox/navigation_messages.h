// The solution in UBX messages of class NAV, in the form of u-blox 7 or in that of u-blox 8 and 9.
//
// Sources: u-blox M8 receiver description, UBX-13003221 R28, section 32.17; u-blox F9 HPG 1.50
// interface description, UBXDOC-963802114-12815, section 3.15; SVIN and RELPOSNED besides from
// u-center's log of a ZED-F9P (HPG 1.32) without base and survey: RELPOSNED is that of a rover
// without base. What is constant is listed in docs/devices/ublox-neo-7p.md, ublox-neo-m8.md and
// ublox-zed-f9p.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "emulators/ublox/profile.h"
#include "emulators/ublox/solution.h"
#include "protocols/ubx/navigation.h"

namespace rigwire::emulators {

/// Room for the longest frame of this file and of monitor.h.
inline constexpr std::size_t kLongestNavigationFrame = 2048;

/// Writes the UBX frame of a message of class NAV and returns its size; 0 when there is no such
/// message here. The carrier solution is reported where the profile has one. Values beyond a
/// field's range are clamped to it. Precondition: out.size() >= kLongestNavigationFrame.
[[nodiscard]] std::size_t encode_navigation(const UbloxSolution& solution,
                                            const UbloxProfile& profile,
                                            protocols::ubx::MessageId id,
                                            std::span<std::uint8_t> out);

}  // namespace rigwire::emulators
