// The lines by which an adapter in the Linux kernel's dialect tells of its controller: s with state
// and counters, e with errors.
//
// Source: Linux 6.1, drivers/net/can/slcan/slcan-core.c, slc_bump_state and slc_bump_err.
//
//   sw000097   warning, receive counter 0, transmit counter 97; a w p b = active .. bus-off
//   e2as       two errors: no acknowledge, stuff error
//   letters    a acknowledge, b dominant bit, B recessive bit, c CRC, f form, s stuff error;
//              o receive overflow, O transmit overflow
//
// What has no letter (where in the frame, a lost arbitration) is not carried.
#pragma once

#include <optional>

#include "protocols/can/controller_report.h"
#include "protocols/slcan/slcan.h"

namespace rigwire::protocols::slcan {

/// The state line of a report that is about the state.
[[nodiscard]] std::optional<Reply> state_line(const can::ControllerReport& report);
/// The error line of a report that is about errors or overflows.
[[nodiscard]] std::optional<Reply> error_line(const can::ControllerReport& report);

/// What a state line (state, counters) or an error line (one error, overflows) says; of several
/// errors in one line the last letter's. Precondition: reply is of one of the two kinds.
[[nodiscard]] can::ControllerReport report_of(const Reply& reply);

}  // namespace rigwire::protocols::slcan
