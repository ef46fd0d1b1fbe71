#include "emulators/usb/gs_usb_error_frame.h"

#include <algorithm>

namespace rigwire::emulators {

namespace {

using protocols::can::BusError;
using protocols::can::ControllerReport;
using protocols::can::ErrorState;
using protocols::gs_usb::HostFrame;

// Linux 6.1, include/uapi/linux/can/error.h.
constexpr std::uint32_t kController = 0x004;
constexpr std::uint32_t kProtocol = 0x008;
constexpr std::uint32_t kNoAcknowledgement = 0x020;
constexpr std::uint32_t kBusOff = 0x040;
constexpr std::uint32_t kBusError = 0x080;
constexpr std::uint32_t kRestarted = 0x100;
constexpr std::uint32_t kCounters = 0x200;

constexpr std::size_t kControllerByte = 1;
constexpr std::size_t kProtocolByte = 2;
constexpr std::size_t kLocationByte = 3;
constexpr std::size_t kTransmitCounterByte = 6;
constexpr std::size_t kReceiveCounterByte = 7;

constexpr std::uint8_t kFormError = 0x02;
constexpr std::uint8_t kStuffError = 0x04;
constexpr std::uint8_t kDominantNotSent = 0x08;
constexpr std::uint8_t kRecessiveNotSent = 0x10;
constexpr std::uint8_t kAtChecksum = 0x08;

constexpr std::uint8_t kActive = 0x40;

/// Level of one error counter, as the controller's registers give it.
ErrorState level(std::uint16_t errors) {
  return errors < 96    ? ErrorState::active
         : errors < 128 ? ErrorState::warning
         : errors < 256 ? ErrorState::passive
                        : ErrorState::bus_off;
}

std::uint8_t level_bits(ErrorState state, std::uint8_t warning, std::uint8_t passive) {
  switch (state) {
    case ErrorState::active:
      return kActive;
    case ErrorState::warning:
      return warning;
    case ErrorState::passive:
      return passive;
    case ErrorState::bus_off:
      break;
  }
  return 0;
}

std::uint8_t counter_byte(std::uint16_t errors) {
  return static_cast<std::uint8_t>(std::min<std::uint16_t>(errors, 0xFF));
}

void add_bus_error(HostFrame& frame, const ControllerReport& report) {
  if (report.transmit_errors == 0 && report.receive_errors == 0) {
    return;
  }
  frame.identifier |= kProtocol | kBusError | kCounters;
  frame.data[kTransmitCounterByte] = counter_byte(report.transmit_errors);
  frame.data[kReceiveCounterByte] = counter_byte(report.receive_errors);
  switch (report.error) {
    case BusError::none:
      break;
    case BusError::bit:
      frame.data[kProtocolByte] = report.dominant ? kDominantNotSent : kRecessiveNotSent;
      break;
    case BusError::stuff:
      frame.data[kProtocolByte] = kStuffError;
      break;
    case BusError::form:
      frame.data[kProtocolByte] = kFormError;
      break;
    case BusError::crc:
      frame.data[kLocationByte] = kAtChecksum;
      break;
    case BusError::acknowledgement:
      frame.identifier |= kNoAcknowledgement;
      break;
  }
}

}  // namespace

std::optional<HostFrame> gs_usb_error_frame(const ControllerReport& report, bool bus_errors) {
  HostFrame frame;
  frame.identifier = HostFrame::kError;
  frame.length_code = 8;
  if (report.restarted) {
    frame.identifier |= kRestarted;
    return frame;
  }
  if (report.state_changed && report.state == ErrorState::bus_off) {
    frame.identifier |= kBusOff;
    return frame;
  }
  if (report.state_changed) {
    constexpr std::uint8_t kReceiveWarning = 0x04;
    constexpr std::uint8_t kTransmitWarning = 0x08;
    constexpr std::uint8_t kReceivePassive = 0x10;
    constexpr std::uint8_t kTransmitPassive = 0x20;
    frame.identifier |= kController | kCounters;
    const ErrorState transmit = level(report.transmit_errors);
    const ErrorState receive = level(report.receive_errors);
    std::uint8_t bits = 0;
    if (transmit >= receive) {
      bits |= level_bits(transmit, kTransmitWarning, kTransmitPassive);
    }
    if (transmit <= receive) {
      bits |= level_bits(receive, kReceiveWarning, kReceivePassive);
    }
    frame.data[kControllerByte] = bits;
    add_bus_error(frame, report);
    return frame;
  }
  if (report.error != BusError::none && bus_errors &&
      (report.transmit_errors != 0 || report.receive_errors != 0)) {
    add_bus_error(frame, report);
    return frame;
  }
  return std::nullopt;
}

}  // namespace rigwire::emulators
