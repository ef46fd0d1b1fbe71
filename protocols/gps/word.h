// Words of the legacy navigation message: 24 data bits and six parity bits.
//
// Source: IS-GPS-200 section 20.3.5 and table 20-XIV (the (32,26) Hamming code), figure 20-5 (the
// user's check). A word is in the low 30 bits of an integer, the bit sent first highest. Its data
// bits are sent complemented when the last bit of the word before, D30*, is 1; the parity bits
// cover the last two bits of the word before, D29* and D30*.
#pragma once

#include <cstdint>
#include <optional>

namespace rigwire::protocols::gps {

inline constexpr int kDataBits = 24;
inline constexpr int kParityBits = 6;
inline constexpr int kWordBits = kDataBits + kParityBits;
inline constexpr std::uint32_t kDataMask = (1U << kDataBits) - 1U;
inline constexpr std::uint32_t kWordMask = (1U << kWordBits) - 1U;

/// D25..D30 for data bits d1..d24 before they are complemented. `previous` is the word before, of
/// which only the last two bits count.
[[nodiscard]] std::uint32_t parity(std::uint32_t data, std::uint32_t previous);

/// The word as sent.
[[nodiscard]] std::uint32_t encode_word(std::uint32_t data, std::uint32_t previous);

/// The data bits of a word as sent; nothing when its parity is wrong.
[[nodiscard]] std::optional<std::uint32_t> decode_word(std::uint32_t word, std::uint32_t previous);

/// `data` with its last two bits chosen so that the word ends in D29 = D30 = 0, as words 2 and 10
/// of a subframe must: section 20.3.5.
[[nodiscard]] std::uint32_t with_zero_ending(std::uint32_t data, std::uint32_t previous);

/// The word as receivers hand it on once its data have their true polarity: all 30 bits and the two
/// bits before them, D29* and D30* in bits 31 and 30, complemented together when D30* is 1. So bit
/// 30 is always 0, and the parity holds within the 32 bits alone.
[[nodiscard]] std::uint32_t true_polarity(std::uint32_t word, std::uint32_t previous);

}  // namespace rigwire::protocols::gps
