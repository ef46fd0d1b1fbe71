#include "protocols/can/error_frame.h"

#include <algorithm>
#include <utility>

namespace rigwire::protocols::can {
namespace {

constexpr std::uint32_t kExtendedOrRemote = 0xC000'0000U;

// Classes.
constexpr std::uint32_t kArbitrationLost = 0x002;
constexpr std::uint32_t kController = 0x004;
constexpr std::uint32_t kProtocol = 0x008;
constexpr std::uint32_t kNoAcknowledgement = 0x020;
constexpr std::uint32_t kBusOff = 0x040;
constexpr std::uint32_t kBusError = 0x080;
constexpr std::uint32_t kRestarted = 0x100;
constexpr std::uint32_t kCounters = 0x200;

// Controller, d1.
constexpr std::uint32_t kReceiveOverflow = 0x01;
constexpr std::uint32_t kTransmitOverflow = 0x02;
constexpr std::uint32_t kReceiveWarning = 0x04;
constexpr std::uint32_t kTransmitWarning = 0x08;
constexpr std::uint32_t kReceivePassive = 0x10;
constexpr std::uint32_t kTransmitPassive = 0x20;
constexpr std::uint32_t kActive = 0x40;

// Protocol, d2.
constexpr std::uint32_t kSingleBit = 0x01;
constexpr std::uint32_t kForm = 0x02;
constexpr std::uint32_t kStuff = 0x04;
constexpr std::uint32_t kDominantNotSent = 0x08;
constexpr std::uint32_t kRecessiveNotSent = 0x10;
constexpr std::uint32_t kOwnFrame = 0x80;

constexpr std::uint8_t kCrcSequence = 0x08;

constexpr std::array<std::pair<FrameField, std::uint8_t>, 19> kLocations{
    {{FrameField::start_of_frame, 0x03},
     {FrameField::identifier_28_21, 0x02},
     {FrameField::identifier_20_18, 0x06},
     {FrameField::substitute_remote, 0x04},
     {FrameField::identifier_extension, 0x05},
     {FrameField::identifier_17_13, 0x07},
     {FrameField::identifier_12_5, 0x0F},
     {FrameField::identifier_4_0, 0x0E},
     {FrameField::remote_request, 0x0C},
     {FrameField::reserved_1, 0x0D},
     {FrameField::reserved_0, 0x09},
     {FrameField::length_code, 0x0B},
     {FrameField::data, 0x0A},
     {FrameField::crc_sequence, kCrcSequence},
     {FrameField::crc_delimiter, 0x18},
     {FrameField::acknowledge_slot, 0x19},
     {FrameField::acknowledge_delimiter, 0x1B},
     {FrameField::end_of_frame, 0x1A},
     {FrameField::intermission, 0x12}}};

std::uint8_t location_of(FrameField field) {
  for (const auto& [known, location] : kLocations) {
    if (known == field) {
      return location;
    }
  }
  return 0;
}

FrameField field_at(std::uint8_t location) {
  for (const auto& [field, known] : kLocations) {
    if (known == location) {
      return field;
    }
  }
  return FrameField::unspecified;
}

constexpr unsigned kWarningLevel = 96;
constexpr unsigned kPassiveLevel = 128;

void put_state(const ControllerReport& report, ErrorFrame& frame) {
  const auto name = [&](unsigned level, std::uint32_t transmit, std::uint32_t receive) {
    const bool by_receive = report.receive_errors >= level;
    const bool by_transmit = report.transmit_errors >= level || !by_receive;
    frame.id |= kController;
    frame.data[1] |=
        static_cast<std::uint8_t>((by_transmit ? transmit : 0U) | (by_receive ? receive : 0U));
  };
  switch (report.state) {
    case ErrorState::active:
      frame.id |= kController;
      frame.data[1] |= static_cast<std::uint8_t>(kActive);
      break;
    case ErrorState::warning:
      name(kWarningLevel, kTransmitWarning, kReceiveWarning);
      break;
    case ErrorState::passive:
      name(kPassiveLevel, kTransmitPassive, kReceivePassive);
      break;
    case ErrorState::bus_off:
      frame.id |= kBusOff;
      break;
  }
}

void put_error(const ControllerReport& report, ErrorFrame& frame) {
  frame.id |= kProtocol | kBusError;
  std::uint32_t type = report.transmitting ? kOwnFrame : 0U;
  frame.data[3] = location_of(report.field);
  switch (report.error) {
    case BusError::none:
      break;
    case BusError::bit:
      type |= report.dominant ? kDominantNotSent : kRecessiveNotSent;
      break;
    case BusError::stuff:
      type |= kStuff;
      break;
    case BusError::form:
      type |= kForm;
      break;
    case BusError::crc:
      frame.data[3] = kCrcSequence;
      break;
    case BusError::acknowledgement:
      frame.id |= kNoAcknowledgement;
      frame.data[3] = location_of(FrameField::acknowledge_slot);
      break;
  }
  frame.data[2] = static_cast<std::uint8_t>(type);
}

BusError error_in(const ErrorFrame& frame) {
  if ((frame.id & kProtocol) != 0) {
    const unsigned type = frame.data[2];
    if ((type & (kSingleBit | kDominantNotSent | kRecessiveNotSent)) != 0) {
      return BusError::bit;
    }
    if ((type & kStuff) != 0) {
      return BusError::stuff;
    }
    if ((type & kForm) != 0) {
      return BusError::form;
    }
    if (frame.data[3] == kCrcSequence) {
      return BusError::crc;
    }
  }
  return (frame.id & kNoAcknowledgement) != 0 ? BusError::acknowledgement : BusError::none;
}

/// The state that the frame names.
bool named_state(const ErrorFrame& frame, ErrorState& state) {
  if ((frame.id & kBusOff) != 0) {
    state = ErrorState::bus_off;
    return true;
  }
  const unsigned detail = (frame.id & kController) != 0 ? frame.data[1] : 0U;
  if ((detail & (kReceivePassive | kTransmitPassive)) != 0) {
    state = ErrorState::passive;
  } else if ((detail & (kReceiveWarning | kTransmitWarning)) != 0) {
    state = ErrorState::warning;
  } else if ((detail & kActive) != 0) {
    state = ErrorState::active;
  } else {
    return false;
  }
  return true;
}

}  // namespace

ErrorFrame to_error_frame(const ControllerReport& report) {
  ErrorFrame frame{kErrorFlag, {}};
  if (report.state_changed) {
    put_state(report, frame);
  }
  if (report.error != BusError::none) {
    put_error(report, frame);
  }
  if (report.arbitration_lost) {
    frame.id |= kArbitrationLost;
    frame.data[0] = report.bit;
  }
  if (report.receive_overflow || report.transmit_overflow) {
    frame.id |= kController;
    frame.data[1] |= static_cast<std::uint8_t>((report.receive_overflow ? kReceiveOverflow : 0U) |
                                               (report.transmit_overflow ? kTransmitOverflow : 0U));
  }
  frame.id |= report.restarted ? kRestarted : 0U;
  if ((frame.id & kBusOff) == 0) {
    frame.id |= kCounters;
    frame.data[6] = static_cast<std::uint8_t>(std::min<unsigned>(report.transmit_errors, 255U));
    frame.data[7] = static_cast<std::uint8_t>(std::min<unsigned>(report.receive_errors, 255U));
  }
  return frame;
}

// Reads the classes and details of the table in error_frame.h. The state follows from the counters
// unless the frame names it.
Decoded<ControllerReport> from_error_frame(const ErrorFrame& frame) {
  if ((frame.id & kErrorFlag) == 0) {
    return Malformed{"an error frame has flag 0x20000000"};
  }
  if ((frame.id & kExtendedOrRemote) != 0) {
    return Malformed{"an error frame is neither remote nor has it a 29-bit identifier"};
  }
  ControllerReport report;
  if ((frame.id & kCounters) != 0) {
    report.transmit_errors = frame.data[6];
    report.receive_errors = frame.data[7];
    const unsigned greater = std::max(report.transmit_errors, report.receive_errors);
    report.state = greater >= kPassiveLevel   ? ErrorState::passive
                   : greater >= kWarningLevel ? ErrorState::warning
                                              : ErrorState::active;
  }
  report.state_changed = named_state(frame, report.state);
  if (report.state == ErrorState::bus_off) {
    report.transmit_errors = 256;
    report.receive_errors = 0;
  }
  report.error = error_in(frame);
  if (report.error != BusError::none) {
    const unsigned type = (frame.id & kProtocol) != 0 ? frame.data[2] : 0U;
    const bool no_acknowledgement = report.error == BusError::acknowledgement;
    report.transmitting = no_acknowledgement || (type & kOwnFrame) != 0;
    report.dominant = report.error == BusError::bit && (type & kDominantNotSent) != 0;
    report.field = no_acknowledgement ? FrameField::acknowledge_slot : field_at(frame.data[3]);
  }
  if ((frame.id & kController) != 0) {
    report.receive_overflow = (frame.data[1] & kReceiveOverflow) != 0;
    report.transmit_overflow = (frame.data[1] & kTransmitOverflow) != 0;
  }
  if ((frame.id & kArbitrationLost) != 0) {
    report.arbitration_lost = true;
    report.bit = frame.data[0];
  }
  report.restarted = (frame.id & kRestarted) != 0;
  return {report, sizeof frame.id + frame.data.size()};
}

}  // namespace rigwire::protocols::can
