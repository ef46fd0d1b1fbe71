// The units in which a register map names the valve driver's signals.
#pragma once

namespace rigwire::emulators {

inline constexpr double kPercent = 100.0;  ///< Of full command or travel.
/// A position after loss of the master beyond this one means: hold.
inline constexpr double kHold_percent = 100.0;

}  // namespace rigwire::emulators
