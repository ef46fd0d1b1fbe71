// How slcan names bit rates: one digit, or the two bus timing registers of an SJA1000.
//
// Sources: LAWICEL AB, "CANUSB manual" 1.0D, commands S and s; NXP SJA1000 data sheet, rev. 04,
// 6.5.1 and 6.5.2 (BTR0, BTR1), with the 16 MHz clock that LAWICEL's adapters have.
//
// Programs disagree about two digits. S7 is 800 kbit/s at LAWICEL and in the Linux kernel, 750
// kbit/s in python-can; S9 is no code at LAWICEL and 83.3 kbit/s in python-can.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace rigwire::protocols::slcan {

/// Bit rates of S0..S8, bit/s.
inline constexpr std::array<std::uint32_t, 9> kBitRates_bps{
    10'000, 20'000, 50'000, 100'000, 125'000, 250'000, 500'000, 800'000, 1'000'000};
inline constexpr unsigned kPythonCanCode = 9;
inline constexpr std::uint32_t kPythonCanRate_bps = 83'300;
inline constexpr unsigned kDisputedCode = 7;
inline constexpr std::uint32_t kPythonCanDisputedRate_bps = 750'000;

/// The digit for a bit rate; nothing when the protocol has none.
[[nodiscard]] std::optional<unsigned> rate_code(std::uint32_t bit_rate_bps);

/// Returns what a client means by Sn on a bus of `bus_bit_rate_bps`: the table's rate, but 750
/// kbit/s for S7 on a bus of that rate, which no other code names. Precondition: code 0..9.
[[nodiscard]] std::uint32_t rate_of_code(unsigned code, std::uint32_t bus_bit_rate_bps);

/// The bit rate of s BTR0 BTR1 (BTR0 in the upper byte), rounded to bit/s: 5000 and more. Nothing
/// when it is beyond 1 Mbit/s.
[[nodiscard]] std::optional<std::uint32_t> rate_of_registers(std::uint16_t registers);

/// Whether two nodes whose rates differ by so little understand each other: within 0.5 %, which
/// the resynchronisation of ISO 11898-1 tolerates at every usual sample point.
[[nodiscard]] bool rates_agree(std::uint32_t first_bps, std::uint32_t second_bps);

}  // namespace rigwire::protocols::slcan
