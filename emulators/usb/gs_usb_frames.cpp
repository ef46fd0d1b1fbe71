// The adapter's bulk endpoints and its controller.
#include <algorithm>

#include "emulators/usb/gs_usb.h"
#include "emulators/usb/gs_usb_error_frame.h"
#include "protocols/can/bits.h"

namespace rigwire::emulators {

namespace gs_usb = protocols::gs_usb;
using gs_usb::Feature;
using protocols::can::ErrorState;
using protocols::usb::Outcome;

void GsUsbAdapter::start(SimTime now) {
  started_ = true;
  latest_ = {};
  controller_ = {.open = !asked(Feature::kLoopBack),
                 .bit_rate_bps = *bit_rate_bps_,
                 .listen_only = asked(Feature::kListenOnly),
                 .one_shot = asked(Feature::kOneShot)};
  if (controller_.open) {
    wire_.set_controller(now, controller_);
  }
}

void GsUsbAdapter::stop(SimTime now) {
  started_ = false;
  flags_ = 0;
  latest_ = {};
  restart_at_ = kNever;
  from_host_.clear();
  in_controller_.clear();
  to_host_.clear();
  overflowed_ = false;
  looping_.reset();
  loop_end_ = kNever;
  if (controller_.open) {
    controller_ = {};
    wire_.set_controller(now, controller_);
  }
  controller_ = {};
}

/// The firmware switches its controller off and on, which empties the mailboxes.
void GsUsbAdapter::restart(SimTime now) {
  restart_at_ = kNever;
  while (!in_controller_.empty()) {
    ++counters_.abandoned;
    echo(now, in_controller_.pop());
  }
  latest_ = {};
  wire_.set_controller(now, {});
  wire_.set_controller(now, controller_);
  ++counters_.restarts;
  protocols::can::ControllerReport report;
  report.restarted = true;
  if (const auto frame = gs_usb_error_frame(report, false); frame && room() > 0) {
    ++counters_.error_frames;
    queue_to_host(now, *frame);
  }
  pump(now);
  settle(now);
}

std::size_t GsUsbAdapter::room() const {
  return kMemoryFrames - from_host_.size() - in_controller_.size() - to_host_.size() -
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
  if (!controller_.open) {
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
  if (in_controller_.empty()) {
    return;
  }
  counters_.abandoned += sent ? 0U : 1U;
  echo(now, in_controller_.pop());
  pump(now);
  settle(now);
}

bool GsUsbAdapter::reported(SimTime now, const protocols::can::ControllerReport& report) {
  if (!controller_.open) {
    return true;
  }
  const bool was_off = latest_.state == ErrorState::bus_off;
  latest_ = report;
  const bool is_off = report.state == ErrorState::bus_off;
  if (is_off && !was_off && !asked(Feature::kBusOffRecovery)) {
    restart_at_ = now + kBusOffPause;
  } else if (!is_off) {
    restart_at_ = kNever;
  }
  auto news = report;
  news.restarted = report.restarted && was_off;  // else it is the restart that the adapter made
  const auto frame = gs_usb_error_frame(news, asked(Feature::kBusErrors));
  bool told = true;
  if (frame) {
    told = room() > 0;
    if (told) {
      ++counters_.error_frames;
      queue_to_host(now, *frame);
    } else {
      ++counters_.lost;
      overflowed_ = true;
    }
  }
  if (was_off && !is_off) {
    pump(now);
  }
  settle(now);
  return told;
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
