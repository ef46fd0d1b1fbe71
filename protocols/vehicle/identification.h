// Identification of a node in ASCII texts: software (SOFT), component (CI), ECU (ECUID) and vehicle
// identification (VI), each field ended by "*". Usually longer than a frame, and so sent by
// transport.
//
// Sources: SAE J1939 digital annex (fields and their order); J1939-71, 5.2.5 (a field that is not
// known has no characters, but its "*"). Software identification has a byte with the number of its
// fields first.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string_view>

namespace rigwire::protocols::vehicle {

inline constexpr std::uint32_t kSoftwareIdentificationPgn = 65242;   ///< FEDA, SOFT.
inline constexpr std::uint32_t kComponentIdentificationPgn = 65259;  ///< FEEB, CI.
inline constexpr std::uint32_t kEcuIdentificationPgn = 64965;        ///< FDC5, ECUID.
inline constexpr std::uint32_t kVehicleIdentificationPgn = 65260;    ///< FEEC, VI.

/// The payload of one of them, at most kGreatest bytes.
struct Identification {
  static constexpr std::size_t kGreatest = 250;

  std::array<std::uint8_t, kGreatest> bytes{};
  std::size_t size = 0;

  [[nodiscard]] std::span<const std::uint8_t> payload() const {
    return std::span(bytes).first(size);
  }
};

/// Returns the fields in order. Characters that are not printable ASCII, and "*" itself, are sent
/// as "_"; what does not fit is left out.
[[nodiscard]] Identification make_identification(std::initializer_list<std::string_view> fields);
/// Returns the fields after a byte with their number.
[[nodiscard]] Identification make_software_identification(
    std::initializer_list<std::string_view> fields);

}  // namespace rigwire::protocols::vehicle
