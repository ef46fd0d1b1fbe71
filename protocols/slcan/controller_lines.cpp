#include "protocols/slcan/controller_lines.h"

#include <cassert>

namespace rigwire::protocols::slcan {

using can::BusError;
using can::ControllerReport;

namespace {

unsigned letter_of(const ControllerReport& report) {
  switch (report.error) {
    case BusError::acknowledgement:
      return kNoAcknowledge;
    case BusError::bit:
      return report.dominant ? kDominantBit : kRecessiveBit;
    case BusError::crc:
      return kCrcError;
    case BusError::form:
      return kFormError;
    case BusError::stuff:
      return kStuffError;
    case BusError::none:
      break;
  }
  return 0;
}

}  // namespace

std::optional<Reply> state_line(const ControllerReport& report) {
  if (!report.state_changed && !report.restarted) {
    return std::nullopt;
  }
  Reply reply;
  reply.kind = ReplyKind::bus_state;
  reply.state = report.state;
  reply.receive_errors = report.receive_errors;
  reply.transmit_errors = report.transmit_errors;
  return reply;
}

std::optional<Reply> error_line(const ControllerReport& report) {
  const unsigned letters = letter_of(report) |
                           (report.receive_overflow ? unsigned{kReceiveOverflow} : 0U) |
                           (report.transmit_overflow ? unsigned{kTransmitOverflow} : 0U);
  if (letters == 0) {
    return std::nullopt;
  }
  Reply reply;
  reply.kind = ReplyKind::bus_errors;
  reply.number = static_cast<std::uint16_t>(letters);
  return reply;
}

ControllerReport report_of(const Reply& reply) {
  assert(reply.kind == ReplyKind::bus_state || reply.kind == ReplyKind::bus_errors);
  ControllerReport report;
  if (reply.kind == ReplyKind::bus_state) {
    report.state = reply.state;
    report.state_changed = true;
    report.receive_errors = reply.receive_errors;
    report.transmit_errors = reply.transmit_errors;
    return report;
  }
  const unsigned letters = reply.number;
  const auto take = [&](unsigned letter, BusError error) {
    if ((letters & letter) != 0) {
      report.error = error;
    }
  };
  take(kNoAcknowledge, BusError::acknowledgement);
  take(kDominantBit | kRecessiveBit, BusError::bit);
  take(kCrcError, BusError::crc);
  take(kFormError, BusError::form);
  take(kStuffError, BusError::stuff);
  // The driver's own order: these concern a frame that was being sent.
  report.transmitting = (letters & (kNoAcknowledge | kDominantBit | kRecessiveBit)) != 0;
  report.dominant = (letters & kDominantBit) != 0;
  report.receive_overflow = (letters & kReceiveOverflow) != 0;
  report.transmit_overflow = (letters & kTransmitOverflow) != 0;
  return report;
}

}  // namespace rigwire::protocols::slcan
