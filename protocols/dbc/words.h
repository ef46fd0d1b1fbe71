// What reader and writer of DBC files share.
#pragma once

#include <cstdint>
#include <string_view>

namespace rigwire::protocols::dbc {

/// Set in the identifier of a message of 29 bits.
inline constexpr std::uint32_t kExtendedFlag = 0x80000000U;
/// The node of a message that no node sends, or of a signal that none receives.
inline constexpr std::string_view kNobody = "Vector__XXX";

}  // namespace rigwire::protocols::dbc
