// The adapter's bulk endpoints and its controller.
#include <algorithm>

#include "emulators/usb/gs_usb.h"
#include "protocols/can/bits.h"
#include "protocols/can/error_frame.h"

namespace rigwire::emulators {

namespace gs_usb = protocols::gs_usb;
using gs_usb::Feature;
using protocols::can::BusError;
using protocols::can::ControllerReport;
using protocols::can::ErrorState;
using protocols::usb::Outcome;

namespace {

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
