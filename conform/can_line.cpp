#include "conform/can_line.h"

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "conform/byte_line.h"
#include "conform/conformance_case.h"
#include "drivers/descriptor.h"
#include "protocols/pcapng/link_packet.h"
#include "protocols/slcan/bit_rate.h"
#include "protocols/slcan/slcan.h"

namespace rigwire::conform {

namespace slcan = protocols::slcan;
using protocols::can::Frame;
using std::chrono::milliseconds;

namespace {

// What may wait in the system's queue when a deadline passes.
constexpr std::size_t kWaitingFrames = 4096;
constexpr std::size_t kWaitingBytes = 64U << 10U;

class InterfaceLine final : public CanLine {
 public:
  explicit InterfaceLine(int descriptor) : descriptor_(descriptor) {}

  bool send(const Frame& frame) override {
    can_frame raw{};
    raw.can_id =
        frame.id | (frame.extended ? CAN_EFF_FLAG : 0U) | (frame.remote ? CAN_RTR_FLAG : 0U);
    raw.can_dlc = frame.length;
    std::ranges::copy(frame.data, raw.data);
    const auto deadline = Clock::now() + std::chrono::seconds(1);
    while (::write(descriptor_.get(), &raw, sizeof raw) != sizeof raw) {
      const bool full = errno == ENOBUFS || errno == EAGAIN || errno == EINTR;
      if (!full || Clock::now() >= deadline) {
        return false;
      }
      ::poll(nullptr, 0, 1);
    }
    return true;
  }

  std::optional<Frame> receive(Clock::time_point deadline) override {
    std::size_t errors_behind = 0;  // What waits is taken behind the deadline, too, and no more.
    while (true) {
      can_frame raw{};
      if (::read(descriptor_.get(), &raw, sizeof raw) == sizeof raw) {
        if ((raw.can_id & CAN_ERR_FLAG) != 0) {
          if (Clock::now() > deadline && ++errors_behind > kWaitingFrames) {
            return std::nullopt;
          }
          continue;
        }
        Frame frame;
        frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
        frame.remote = (raw.can_id & CAN_RTR_FLAG) != 0;
        frame.id = raw.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
        frame.length = std::min<std::uint8_t>(raw.can_dlc, CAN_MAX_DLEN);
        std::ranges::copy(raw.data, frame.data.begin());
        return frame;
      }
      const auto left = std::chrono::ceil<milliseconds>(deadline - Clock::now()).count();
      pollfd watched{descriptor_.get(), POLLIN, 0};
      if (left <= 0 ||
          ::poll(&watched, 1, static_cast<int>(std::min<std::int64_t>(left, 60'000))) <= 0) {
        return std::nullopt;
      }
      if ((watched.revents & POLLIN) == 0) {  // The interface went away.
        return std::nullopt;
      }
    }
  }

 private:
  drivers::Descriptor descriptor_;
};

std::unique_ptr<CanLine> open_interface(const Endpoint& endpoint) {
  const auto fail = [&]() -> Unreachable {
    return Unreachable(endpoint.text() + ": " + std::strerror(errno));
  };
  drivers::Descriptor socket(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW));
  if (!socket.open()) {
    throw fail();
  }
  const unsigned index = ::if_nametoindex(endpoint.address.c_str());
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(index);
  if (index == 0 ||
      ::bind(socket.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) < 0) {
    throw fail();
  }
  return std::make_unique<InterfaceLine>(socket.release());
}

class AdapterLine final : public CanLine {
 public:
  explicit AdapterLine(std::unique_ptr<ByteLine> line) : line_(std::move(line)) {}
  ~AdapterLine() override { static_cast<void>(write({slcan::Verb::close, 0, {}})); }

  bool write(const slcan::Command& command) {
    return line_->send(slcan::write_command(command).span());
  }
  bool send(const Frame& frame) override { return line_->send(slcan::write_frame(frame).span()); }

  std::optional<Frame> receive(Clock::time_point deadline) override {
    std::size_t behind = 0;  // Bytes that came behind the deadline and were no frame.
    while (true) {
      while (used_ < bytes_.size()) {
        const auto line = splitter_.push(bytes_[used_++]);
        if (!line) {
          continue;
        }
        const auto reply = slcan::parse_reply(line->text);
        if (!line->too_long && reply.ok() && reply->kind == slcan::ReplyKind::frame) {
          return reply->frame;
        }
      }
      bytes_.clear();
      used_ = 0;
      if (behind > kWaitingBytes || !line_->receive(bytes_, deadline)) {
        return std::nullopt;
      }
      behind += Clock::now() > deadline ? bytes_.size() : 0;
    }
  }

 private:
  std::unique_ptr<ByteLine> line_;
  slcan::LineSplitter splitter_;
  std::vector<std::uint8_t> bytes_;
  std::size_t used_ = 0;
};

std::unique_ptr<CanLine> open_adapter(const Endpoint& endpoint) {
  constexpr std::uint32_t kUsual_bps = 250'000;
  const std::uint32_t rate = endpoint.rate > 0 ? endpoint.rate : kUsual_bps;
  const auto code = slcan::rate_code(rate);
  if (!code) {
    throw Unreachable(endpoint.text() + ": slcan has no code for this bit rate");
  }
  // The speed of the line itself is the adapter's own matter, as of one on USB.
  constexpr std::uint32_t kLine_bps = 115'200;
  Endpoint line{Endpoint::Kind::serial, endpoint.address, 0, kLine_bps};
  auto adapter = std::make_unique<AdapterLine>(open_bytes(line));
  const bool opened = adapter->write({slcan::Verb::close, 0, {}}) &&
                      adapter->write({slcan::Verb::bit_rate, *code, {}}) &&
                      adapter->write({slcan::Verb::open, 0, {}});
  if (!opened) {
    throw Unreachable(endpoint.text() + ": the adapter takes nothing");
  }
  return adapter;
}

}  // namespace

std::unique_ptr<CanLine> open_can(const Endpoint& endpoint) {
  return endpoint.kind == Endpoint::Kind::can ? open_interface(endpoint) : open_adapter(endpoint);
}

std::vector<std::uint8_t> step_bytes(const Frame& frame) {
  const auto packet = protocols::pcapng::can_packet(frame);
  return {packet.begin(), packet.end()};
}

std::string frame_text(const Frame& frame) {
  std::array<char, 16> id{};
  std::snprintf(id.data(), id.size(), frame.extended ? "%08Xx" : "%03X", frame.id);
  if (frame.remote) {
    return std::string(id.data()) + " remote, length " + std::to_string(frame.length);
  }
  const auto payload = frame.payload();
  return std::string(id.data()) + " " + hex_text({payload.begin(), payload.end()});
}

}  // namespace rigwire::conform
