// The payload of a multiple signal message after its number; message.h has the type and the
// sources. To read or write a message, use message.h.
#pragma once

#include <cstdint>
#include <optional>

#include "protocols/rtcm3/bits.h"
#include "protocols/rtcm3/message.h"

namespace rigwire::protocols::rtcm3 {

struct MultipleSignalsForm {
  MsmSystem system;
  MsmForm form;
};

[[nodiscard]] std::uint16_t number_of_multiple_signals(MsmSystem system, MsmForm form);
/// Nothing: another message.
[[nodiscard]] std::optional<MultipleSignalsForm> multiple_signals_of(std::uint16_t number);

/// False: satellites times signals are more than 64. System and form are given in `p`.
[[nodiscard]] bool read_multiple_signals(BitReader& bits, MultipleSignals& p);
/// Satellites that do not fit, the last by number, are left out.
void write_multiple_signals(BitWriter& bits, const MultipleSignals& p);

}  // namespace rigwire::protocols::rtcm3
