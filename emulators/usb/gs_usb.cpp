#include "emulators/usb/gs_usb.h"

#include <algorithm>
#include <stdexcept>

#include "protocols/can/bits.h"
#include "protocols/can/error_frame.h"

namespace rigwire::emulators {

namespace gs_usb = protocols::gs_usb;
namespace usb = protocols::usb;
using gs_usb::Feature;
using gs_usb::Request;
using protocols::can::BusError;
using protocols::can::ControllerReport;
using protocols::can::ErrorState;
using protocols::usb::Outcome;

namespace {

/// candleLight's, with one CAN channel and the entry to its firmware upgrade.
usb::DeviceDescription describe(const GsUsbSettings& settings) {
  usb::InterfaceDescription channel;
  channel.number = 0;
  channel.device_class = 0xFF;
  channel.subclass = 0xFF;
  channel.protocol = 0xFF;
  channel.endpoints = {
      {gs_usb::kEndpointToHost, usb::TransferType::bulk, gs_usb::kPacketBytes, 0},
      {gs_usb::kEndpointToDevice, usb::TransferType::bulk, gs_usb::kPacketBytes, 0}};

  usb::InterfaceDescription upgrade;
  upgrade.number = 1;
  upgrade.device_class = 0xFE;  // application specific
  upgrade.subclass = 0x01;      // device firmware upgrade
  upgrade.protocol = 0x01;      // run time
  upgrade.text = "candleLight firmware upgrade interface";
  // USB DFU 1.1, table 4.2: can download and upload, will detach; 255 ms; 2048 bytes; version 1.1a.
  upgrade.extra = {9, 0x21, 0x0B, 0xFF, 0x00, 0x00, 0x08, 0x1A, 0x01};

  usb::DeviceDescription device;
  device.vendor = 0x1D50;
  device.product = 0x606F;
  device.release = 0x0000;
  device.manufacturer = "bytewerk";
  device.product_name = "candleLight USB to CAN adapter";
  device.serial_number = settings.serial_number;
  device.maximum_power_2ma = 75;
  device.interfaces = {channel, upgrade};
  return device;
}

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

/// The adapter restarts its controller by itself.
constexpr OutsideController kClosed{.present = false, .restart_after = std::nullopt};

gs_usb::HostFrame error_frame(const ControllerReport& report) {
  const protocols::can::ErrorFrame error = protocols::can::to_error_frame(report);
  gs_usb::HostFrame frame;
  frame.identifier = error.id;
  frame.length_code = 8;
  frame.data = error.data;
  return frame;
}

}  // namespace

void validate(const GsUsbSettings& settings) {
  const auto is_digit = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'F') || (c >= 'a' && c <= 'f');
  };
  if (settings.serial_number.size() != 24 ||
      !std::ranges::all_of(settings.serial_number, is_digit)) {
    throw std::invalid_argument("gs_usb adapter: serial number '" + settings.serial_number +
                                "'; 24 hexadecimal digits are allowed");
  }
  if (settings.memory_frames < 16 || settings.memory_frames > GsUsbAdapter::kMemoryMax) {
    throw std::invalid_argument("gs_usb adapter: memory of " +
                                std::to_string(settings.memory_frames) +
                                " frames; 16 .. 1024 are allowed");
  }
}

GsUsbAdapter::GsUsbAdapter(const GsUsbSettings& settings, GsUsbWire& wire)
    : memory_frames_(settings.memory_frames), wire_(wire) {
  validate(settings);
  description_ = describe(settings);
  controller_.present = false;
}

void GsUsbAdapter::plugged(SimTime now, UsbHost& host) {
  unplugged(now);
  host_ = &host;
}

void GsUsbAdapter::unplugged(SimTime now) {
  host_ = nullptr;
  reads_.clear();
  writes_.clear();
  stop(now);
  bit_rate_bps_.reset();
  identifying_ = false;
}

bool GsUsbAdapter::cancel(SimTime /*now*/, UsbTransfer transfer) {
  const auto is_it = [transfer](const auto& open) { return open.transfer == transfer; };
  return reads_.remove_first(is_it) || writes_.remove_first(is_it);
}

SimTime GsUsbAdapter::next_event() const {
  return std::min(restart_at_, loop_end_);
}

void GsUsbAdapter::advance(SimTime now) {
  while (next_event() <= now) {
    if (loop_end_ <= restart_at_) {
      end_loop();
    } else {
      restart(restart_at_);
    }
  }
}

// The adapter's control endpoint.

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

// The adapter's bulk endpoints and its controller.

void GsUsbAdapter::start(SimTime now) {
  started_ = true;
  latest_ = {};
  controller_ = {.present = !asked(Feature::kLoopBack),
                 .bit_rate_bps = *bit_rate_bps_,
                 .listen_only = asked(Feature::kListenOnly),
                 .one_shot = asked(Feature::kOneShot),
                 .restart_after = std::nullopt};
  if (controller_.present) {
    wire_.set_controller(now, controller_);
  }
}

void GsUsbAdapter::stop(SimTime now) {
  started_ = false;
  flags_ = 0;
  latest_ = {};
  restart_at_ = kNever;
  from_host_.clear();
  drop_mailboxes();
  to_host_.clear();
  overflowed_ = false;
  looping_.reset();
  loop_end_ = kNever;
  const bool was_present = controller_.present;
  controller_ = kClosed;
  if (was_present) {
    wire_.set_controller(now, kClosed);
  }
}

void GsUsbAdapter::drop_mailboxes() {
  dropped_ += in_controller_.size();
  in_controller_.clear();
}

/// The firmware switches its controller off and on, which empties the mailboxes.
void GsUsbAdapter::restart(SimTime now) {
  restart_at_ = kNever;
  for (std::size_t i = 0; i < in_controller_.size(); ++i) {
    ++counters_.abandoned;
    echo(now, in_controller_[i]);
  }
  drop_mailboxes();
  latest_ = {};
  wire_.set_controller(now, kClosed);
  wire_.set_controller(now, controller_);
  ++counters_.restarts;
  ControllerReport report;
  report.restarted = true;
  static_cast<void>(tell(now, report));
  pump(now);
  settle(now);
}

std::size_t GsUsbAdapter::room() const {
  return memory_frames_ - from_host_.size() - in_controller_.size() - to_host_.size() -
         (looping_ ? 1U : 0U);
}

void GsUsbAdapter::write(SimTime now, UsbTransfer transfer, std::uint8_t endpoint,
                         std::span<const std::uint8_t> data) {
  if (endpoint != gs_usb::kEndpointToDevice) {
    host_->complete(now, transfer, Outcome::stalled, {}, 0);
    return;
  }
  const std::size_t packets = (data.size() + gs_usb::kPacketBytes - 1) / gs_usb::kPacketBytes;
  if (writes_.empty() && packets <= room()) {
    for (std::size_t i = 0; i < packets; ++i) {
      const auto rest = data.subspan(i * gs_usb::kPacketBytes);
      accept(rest.first(std::min(rest.size(), gs_usb::kPacketBytes)));
    }
    host_->complete(now, transfer, Outcome::done, {}, data.size());
    pump(now);
    return;
  }
  Write waiting{transfer, {}, data.size()};
  if (packets > 1 || writes_.full()) {
    host_->complete(now, transfer, Outcome::stalled, {}, 0);
    return;
  }
  std::ranges::copy(data, waiting.bytes.begin());
  static_cast<void>(writes_.push(waiting));
}

void GsUsbAdapter::accept(std::span<const std::uint8_t> packet) {
  const auto frame = gs_usb::decode_frame(packet, false);
  if (!frame.ok() || frame->channel != 0 || !gs_usb::to_can(*frame)) {
    ++counters_.malformed_frames;
  } else if (!started_ || !from_host_.push(*frame)) {
    ++counters_.unsent;
  }
}

void GsUsbAdapter::pump(SimTime now) {
  if (started_ && asked(Feature::kLoopBack)) {
    begin_loop(now);
    return;
  }
  if (!started_ || asked(Feature::kListenOnly) || latest_.state == ErrorState::bus_off) {
    return;
  }
  while (!from_host_.empty() && !in_controller_.full()) {
    const HostFrame frame = from_host_.pop();
    static_cast<void>(in_controller_.push(frame));
    ++counters_.from_host;
    wire_.send(now, *gs_usb::to_can(frame));
  }
}

void GsUsbAdapter::begin_loop(SimTime now) {
  if (looping_ || from_host_.empty()) {
    return;
  }
  looping_ = from_host_.pop();
  ++counters_.from_host;
  const auto bits = [this](unsigned count) {
    return Duration{static_cast<std::int64_t>(count) * 1'000'000'000 / controller_.bit_rate_bps};
  };
  const unsigned length = protocols::can::exact_bits(*gs_usb::to_can(*looping_));
  const SimTime begin = std::max(now, loop_free_);
  loop_end_ = begin + bits(length - protocols::can::kInterframeBits);
  loop_free_ = begin + bits(length);
}

void GsUsbAdapter::end_loop() {
  const SimTime now = loop_end_;
  const HostFrame frame = *looping_;
  looping_.reset();
  loop_end_ = kNever;
  echo(now, frame);
  HostFrame copy = frame;
  copy.echo = gs_usb::kReceived;
  copy.flags = 0;
  if (room() > 0) {
    queue_to_host(now, copy);
  } else {
    ++counters_.lost;
    overflowed_ = true;
  }
  pump(now);
  settle(now);
}

bool GsUsbAdapter::received(SimTime now, const protocols::can::Frame& frame) {
  if (!controller_.present) {
    return true;
  }
  if (room() == 0) {
    ++counters_.lost;
    overflowed_ = true;
    return false;
  }
  HostFrame to_host = gs_usb::from_can(frame);
  to_host.flags = overflowed_ ? HostFrame::kOverflow : std::uint8_t{0};
  overflowed_ = false;
  queue_to_host(now, to_host);
  settle(now);
  return true;
}

void GsUsbAdapter::confirmed(SimTime now, bool sent) {
  if (dropped_ > 0) {
    --dropped_;
    return;
  }
  if (in_controller_.empty()) {
    return;
  }
  counters_.abandoned += sent ? 0U : 1U;
  echo(now, in_controller_.pop());
  if (sent || controller_.one_shot) {
    pump(now);  // else the controller goes off the bus
  }
  settle(now);
}

bool GsUsbAdapter::reported(SimTime now, const ControllerReport& report) {
  if (!controller_.present) {
    return true;
  }
  const bool was_off = latest_.state == ErrorState::bus_off;
  const bool is_off = report.state == ErrorState::bus_off;
  latest_ = report;
  if (is_off && !was_off && !asked(Feature::kBusOffRecovery)) {
    restart_at_ = now + kBusOffPause;
  } else if (!is_off) {
    restart_at_ = kNever;
  }
  ControllerReport news = report;
  news.restarted = report.restarted && was_off;  // else it is the restart that the adapter made
  bool told = true;
  if (news.restarted || news.state_changed ||
      (news.error != BusError::none && asked(Feature::kBusErrors))) {
    told = tell(now, news);
  }
  if (was_off && !is_off) {
    pump(now);
  }
  settle(now);
  return told;
}

bool GsUsbAdapter::tell(SimTime now, const ControllerReport& report) {
  if (room() == 0) {
    ++counters_.lost;
    overflowed_ = true;
    return false;
  }
  ++counters_.error_frames;
  queue_to_host(now, error_frame(report));
  return true;
}

/// Precondition: there is room.
void GsUsbAdapter::queue_to_host(SimTime now, HostFrame frame) {
  if (asked(Feature::kTimeStamp)) {
    const auto microseconds = now.time_since_epoch() / std::chrono::microseconds{1};
    frame.time_stamp_us = static_cast<std::uint32_t>(microseconds);
  }
  static_cast<void>(to_host_.push(frame));
}

void GsUsbAdapter::echo(SimTime now, HostFrame frame) {
  ++counters_.echoed;
  frame.flags = 0;
  queue_to_host(now, frame);  // it stays where it was in the adapter's memory
}

void GsUsbAdapter::settle(SimTime now) {
  while (host_ != nullptr) {
    if (!reads_.empty() && !to_host_.empty()) {
      const Read read = reads_.pop();
      const HostFrame frame = to_host_.pop();
      const gs_usb::HostFrameBytes bytes = gs_usb::encode_frame(frame, asked(Feature::kPadded));
      if (bytes.size > read.length) {
        ++counters_.lost;
        host_->complete(now, read.transfer, Outcome::overflow, bytes.span().first(read.length), 0);
      } else {
        counters_.to_host +=
            frame.echo == gs_usb::kReceived && (frame.identifier & HostFrame::kError) == 0 ? 1U
                                                                                           : 0U;
        host_->complete(now, read.transfer, Outcome::done, bytes.span(), 0);
      }
    } else if (!writes_.empty() && room() > 0) {
      const Write write = writes_.pop();
      accept(std::span(write.bytes).first(write.size));
      host_->complete(now, write.transfer, Outcome::done, {}, write.size);
      pump(now);
    } else {
      break;
    }
  }
}

void GsUsbAdapter::read(SimTime now, UsbTransfer transfer, std::uint8_t endpoint,
                        std::size_t length) {
  if (endpoint != gs_usb::kEndpointToHost || !reads_.push({transfer, length})) {
    host_->complete(now, transfer, Outcome::stalled, {}, 0);
    return;
  }
  settle(now);
}

}  // namespace rigwire::emulators
