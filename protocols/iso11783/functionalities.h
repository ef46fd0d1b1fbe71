// What a node can do on an ISO 11783 bus, as it answers when it is asked: "control function
// functionalities".
//
// Source: ISO 11783-12:2019, 6 and annex B (functionalities, generations, options) as AgIsoStack++
// (isobus_functionalities) and isobus.net have them. Payload: FF, number of functionalities, then
// for each its number, its generation, the number of its option bytes and these; filled with ones
// to eight bytes. Every node has the first one.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "protocols/vehicle/message.h"

namespace rigwire::protocols::iso11783 {

inline constexpr std::uint32_t kFunctionalitiesPgn = 64654;  ///< FC8E, on request.
inline constexpr std::uint8_t kFunctionalitiesPriority = 6;

enum class Functionality : std::uint8_t {
  minimum_control_function = 0,
  basic_tractor_ecu_server = 13,
  tractor_implement_management_server = 15,
};

/// Options of the basic tractor server; none: less than class 1.
inline constexpr std::uint8_t kTractorClass1 = 0x01;
inline constexpr std::uint8_t kTractorNavigation = 0x08;
inline constexpr std::uint8_t kTractorFrontHitch = 0x10;
inline constexpr std::uint8_t kTractorGuidance = 0x20;

struct SupportedFunctionality {
  Functionality functionality = Functionality::minimum_control_function;
  std::uint8_t generation = 1;
  std::vector<std::uint8_t> options{0};  ///< Bit by bit what of it is there.
};

[[nodiscard]] inline std::vector<std::uint8_t> make_functionalities(
    std::span<const SupportedFunctionality> supported) {
  std::vector<std::uint8_t> payload{0xFF, static_cast<std::uint8_t>(supported.size())};
  for (const SupportedFunctionality& one : supported) {
    payload.push_back(static_cast<std::uint8_t>(one.functionality));
    payload.push_back(one.generation);
    payload.push_back(static_cast<std::uint8_t>(one.options.size()));
    payload.insert(payload.end(), one.options.begin(), one.options.end());
  }
  while (payload.size() < vehicle::kMessageBytes) {
    payload.push_back(0xFF);
  }
  return payload;
}

}  // namespace rigwire::protocols::iso11783
