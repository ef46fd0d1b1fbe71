// The adapter's control endpoint.
#include <algorithm>

#include "emulators/usb/gs_usb.h"

namespace rigwire::emulators {

namespace gs_usb = protocols::gs_usb;
using gs_usb::Feature;
using gs_usb::Request;
using protocols::usb::Outcome;

namespace {

constexpr std::uint8_t kKindMask = 0x60;
constexpr std::uint8_t kClassRequest = 0x20;
constexpr std::uint8_t kVendorRequest = 0x40;
constexpr std::uint8_t kRecipientMask = 0x1F;
constexpr std::uint8_t kToInterface = 0x01;
constexpr std::uint16_t kUpgradeInterface = 1;

/// bxCAN of the STM32F042 behind a clock of 48 MHz.
constexpr gs_usb::BitTimingLimits kLimits{
    .features = Feature::kListenOnly | Feature::kLoopBack | Feature::kOneShot |
                Feature::kTimeStamp | Feature::kIdentify | Feature::kPadded | Feature::kBusErrors |
                Feature::kControllerState | Feature::kBusOffRecovery,
    .clock_hz = 48'000'000,
    .segment_1_min = 1,
    .segment_1_max = 16,
    .segment_2_min = 1,
    .segment_2_max = 8,
    .jump_width_max = 4,
    .prescaler_min = 1,
    .prescaler_max = 1024,
    .prescaler_step = 1};

/// One channel.
constexpr gs_usb::DeviceConfiguration kConfiguration{
    .last_channel = 0, .software_version = 2, .hardware_version = 1};

/// The firmware reads its counter at every start of frame, which a full-speed host sends each
/// millisecond.
gs_usb::TimeStamp at_start_of_frame(SimTime now) {
  const auto milliseconds = now.time_since_epoch() / std::chrono::milliseconds{1};
  return {static_cast<std::uint32_t>(milliseconds * 1000)};
}

bool is_for_the_device(Request request) {
  return request == Request::host_format || request == Request::device_configuration;
}

}  // namespace

void GsUsbAdapter::control(SimTime now, UsbTransfer transfer, const Setup& setup,
                           std::span<const std::uint8_t> data) {
  const bool by_class = (setup.request_type & kKindMask) == kClassRequest;
  if (by_class && (setup.request_type & kRecipientMask) == kToInterface &&
      setup.index == kUpgradeInterface) {
    firmware_upgrade(now, transfer, setup);
  } else if ((setup.request_type & kKindMask) != kVendorRequest ||
             (!is_for_the_device(Request{setup.request}) && setup.value != 0)) {
    stall(now, transfer);
  } else if (setup.to_host()) {
    vendor_to_host(now, transfer, setup);
  } else {
    vendor_from_host(now, transfer, setup, data);
  }
}

void GsUsbAdapter::stall(SimTime now, UsbTransfer transfer) {
  ++counters_.refused_requests;
  host_->complete(now, transfer, Outcome::stalled, {}, 0);
}

/// The firmware refuses to cut an answer short.
void GsUsbAdapter::answer(SimTime now, UsbTransfer transfer, const Setup& setup,
                          std::span<const std::uint8_t> bytes) {
  if (setup.length < bytes.size()) {
    stall(now, transfer);
  } else {
    host_->complete(now, transfer, Outcome::done, bytes, 0);
  }
}

void GsUsbAdapter::vendor_to_host(SimTime now, UsbTransfer transfer, const Setup& setup) {
  switch (Request{setup.request}) {
    case Request::bit_timing_limits:
      answer(now, transfer, setup, gs_usb::encode(kLimits));
      break;
    case Request::device_configuration:
      answer(now, transfer, setup, gs_usb::encode(kConfiguration));
      break;
    case Request::time_stamp:
      answer(now, transfer, setup, gs_usb::encode(at_start_of_frame(now)));
      break;
    case Request::controller_state:
      answer(now, transfer, setup, gs_usb::encode(state()));
      break;
    default:
      stall(now, transfer);
      break;
  }
}

void GsUsbAdapter::vendor_from_host(SimTime now, UsbTransfer transfer, const Setup& setup,
                                    std::span<const std::uint8_t> data) {
  bool effective = true;
  bool whole = true;
  switch (Request{setup.request}) {
    case Request::host_format:
      whole = gs_usb::decode<gs_usb::HostFormat>(data).ok();  // little endian, whatever is asked
      break;
    case Request::bit_timing: {
      const auto timing = gs_usb::decode<gs_usb::BitTiming>(data);
      whole = timing.ok();
      effective = whole && set_bit_timing(*timing);
      break;
    }
    case Request::mode: {
      const auto mode = gs_usb::decode<gs_usb::Mode>(data);
      whole = mode.ok();
      effective = whole && set_mode(now, *mode);
      break;
    }
    case Request::identify: {
      const auto identify = gs_usb::decode<gs_usb::Identify>(data);
      whole = identify.ok();
      identifying_ = whole ? identify->on != 0 : identifying_;
      break;
    }
    case Request::bus_off_recovery:
      effective = started_ && asked(Feature::kBusOffRecovery) &&
                  latest_.state == protocols::can::ErrorState::bus_off;
      if (effective) {
        restart_at_ = now;
      }
      break;
    default:
      whole = false;
      break;
  }
  if (!whole) {
    stall(now, transfer);
    return;
  }
  counters_.refused_requests += effective ? 0U : 1U;
  host_->complete(now, transfer, Outcome::done, {}, data.size());
}

/// Requests of the upgrade interface at run time: USB DFU 1.1, 5 and 6.1.2.
void GsUsbAdapter::firmware_upgrade(SimTime now, UsbTransfer transfer, const Setup& setup) {
  constexpr std::uint8_t kDetach = 0;
  constexpr std::uint8_t kGetStatus = 3;
  // Status OK; no pause until the next poll (3 bytes); state appIDLE; no text.
  constexpr std::array<std::uint8_t, 6> kStatus{0, 0, 0, 0, 0, 0xFF};
  if (setup.request == kDetach && !setup.to_host()) {
    host_->complete(now, transfer, Outcome::done, {}, 0);
  } else if (setup.request == kGetStatus && setup.to_host()) {
    const std::span<const std::uint8_t> status(kStatus);
    host_->complete(now, transfer, Outcome::done,
                    status.first(std::min<std::size_t>(status.size(), setup.length)), 0);
  } else {
    stall(now, transfer);
  }
}

bool GsUsbAdapter::set_bit_timing(const gs_usb::BitTiming& timing) {
  if (!gs_usb::permitted(timing, kLimits)) {
    return false;
  }
  bit_rate_bps_ = gs_usb::bit_rate_bps(timing, kLimits.clock_hz);
  return bit_rate_bps_.has_value();
}

bool GsUsbAdapter::set_mode(SimTime now, const gs_usb::Mode& mode) {
  if (mode.mode == gs_usb::Mode::kReset) {
    stop(now);
    settle(now);
    return true;
  }
  constexpr std::uint32_t kCannot = Feature::kFlexibleDataRate;
  if (mode.mode != gs_usb::Mode::kStart || !bit_rate_bps_ || (mode.flags & kCannot) != 0) {
    return false;
  }
  if (started_) {
    stop(now);
  }
  flags_ = mode.flags;
  start(now);
  return true;
}

gs_usb::ControllerState GsUsbAdapter::state() const {
  using State = gs_usb::ControllerState;
  // States of ISO 11898-1 and of gs_usb have the same order, and `stopped` comes after them.
  const auto number = static_cast<std::uint32_t>(latest_.state);
  return {started_ ? number : State::kStopped, latest_.receive_errors, latest_.transmit_errors};
}

}  // namespace rigwire::emulators
