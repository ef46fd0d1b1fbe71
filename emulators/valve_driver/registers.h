// The register map of the valve driver: addresses for the code, one table for everybody else.
//
// Rigwire's own map (docs/devices/valve-driver.md), after what electro-hydraulic drivers commonly
// expose. Addresses count from 0. Tables are sized for kValveSections rows whatever is fitted.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emulators/valve_amplifier/settings.h"
#include "emulators/valve_driver/valve_map.h"
#include "sim/samples/valve_sample.h"

namespace rigwire::emulators::valve_registers {

// Holding registers.
inline constexpr std::uint16_t kControl = 0;
inline constexpr std::uint16_t kSpoolCommand = 1;
inline constexpr std::uint16_t kHeartbeat = kSpoolCommand + kValveSections;
inline constexpr std::uint16_t kWatchdog = 16;
inline constexpr std::uint16_t kReaction = 17;
inline constexpr std::uint16_t kWatchdogSource = 18;
inline constexpr std::uint16_t kSectionParameters = 20;  ///< First section, first parameter.
static_assert(kHeartbeat == 9);
inline constexpr std::uint16_t kDitherAmplitude = 10;
inline constexpr std::uint16_t kDitherFrequency = 11;
inline constexpr std::uint16_t kCurrentStart = 12;
inline constexpr std::uint16_t kCurrentFull = 13;

/// Parameters of one section, at kSectionParameters + kParameterStride * section + parameter.
enum Parameter : std::uint16_t {
  dead_band_positive,
  dead_band_negative,
  ramp_up,
  ramp_down,
  gain,
  polarity,
};
inline constexpr std::uint16_t kParameterStride = Parameter::polarity + 1;
inline constexpr std::uint16_t kHoldingEnd =
    kSectionParameters + kParameterStride * static_cast<std::uint16_t>(kValveSections);
static_assert(kHoldingEnd == 68);

// Input registers; readable as holding registers at kInputMirror + address too.
inline constexpr std::uint16_t kStatus = 0;
inline constexpr std::uint16_t kFaultCode = 1;
inline constexpr std::uint16_t kSpoolPosition = 2;
inline constexpr std::uint16_t kCoilCurrent = kSpoolPosition + kValveSections;
inline constexpr std::uint16_t kSupplyVoltage = kCoilCurrent + kValveSections;
inline constexpr std::uint16_t kDriverTemperature = kSupplyVoltage + 1;
inline constexpr std::uint16_t kHeartbeatEcho = kDriverTemperature + 1;
inline constexpr std::uint16_t kMissedCycles = kHeartbeatEcho + 1;
inline constexpr std::uint16_t kFaultSection = 22;
static_assert(kCoilCurrent == 10 && kSupplyVoltage == 18 && kMissedCycles == 21);
inline constexpr std::uint16_t kSwingAngle = 30;  ///< Two registers, high word first.
inline constexpr std::uint16_t kSwingRate = 32;
inline constexpr std::uint16_t kMeasurementCount = 33;
inline constexpr std::uint16_t kPortAPressure = 40;
inline constexpr std::uint16_t kPortBPressure = 50;
inline constexpr std::uint16_t kSupplyPressure = 60;
inline constexpr std::uint16_t kOilTemperature = 61;
inline constexpr std::uint16_t kInputEnd = kOilTemperature + 1;
inline constexpr std::uint16_t kInputMirror = 1000;

// Control word bits.
inline constexpr std::uint16_t kControlEnable = 1U << 0U;
inline constexpr std::uint16_t kControlFaultReset = 1U << 1U;  ///< Acts on the edge 0 to 1.
inline constexpr std::uint16_t kControlFloat = 1U << 2U;
inline constexpr std::uint16_t kControlQuickStop = 1U << 3U;
inline constexpr std::uint16_t kControlMaximum =
    kControlEnable | kControlFaultReset | kControlFloat | kControlQuickStop;

// Status bits.
inline constexpr std::uint16_t kStatusReady = 1U << 0U;
inline constexpr std::uint16_t kStatusEnabled = 1U << 1U;
inline constexpr std::uint16_t kStatusFault = 1U << 2U;
inline constexpr std::uint16_t kStatusWatchdogTripped = 1U << 3U;
inline constexpr std::uint16_t kStatusAtLimit = 1U << 4U;

using FaultCode = ValveFault;    ///< Input register 1. The first fault stays until it is reset.
using Reaction = ValveReaction;  ///< Holding register 17; 0 .. 2.

/// The whole map of a driver with so many sections, 1 .. 8. Initial values are the parameters'.
[[nodiscard]] ValveMap map(std::size_t sections = kValveSections,
                           const ValveAmplifierParameters& parameters = {});

}  // namespace rigwire::emulators::valve_registers
