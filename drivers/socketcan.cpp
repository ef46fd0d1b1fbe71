#include "drivers/socketcan.h"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <stdexcept>

#include "drivers/can_interface.h"
#include "drivers/descriptor.h"
#include "protocols/can/controller_report.h"
#include "protocols/can/error_frame.h"
#include "protocols/can/frame.h"

namespace rigwire::drivers {

using protocols::can::ControllerReport;
using protocols::can::ErrorFrame;
using protocols::can::Frame;

namespace {

// Frames and reports as the kernel's struct can_frame, and back (include/uapi/linux/can.h).

can_frame to_kernel(const Frame& frame) {
  can_frame out{};
  out.can_id = frame.extended ? (frame.id & CAN_EFF_MASK) | CAN_EFF_FLAG : frame.id & CAN_SFF_MASK;
  out.can_id |= frame.remote ? CAN_RTR_FLAG : 0U;
  out.len = std::min<std::uint8_t>(frame.length, CAN_MAX_DLEN);
  std::copy(frame.data.begin(), frame.data.end(), out.data);
  return out;
}

can_frame to_kernel(const ControllerReport& report) {
  const ErrorFrame frame = protocols::can::to_error_frame(report);
  can_frame out{};
  out.can_id = frame.id;
  out.len = CAN_MAX_DLEN;
  std::copy(frame.data.begin(), frame.data.end(), out.data);
  return out;
}

/// Precondition: not an error frame.
Frame from_kernel(const can_frame& in) {
  Frame frame;
  frame.extended = (in.can_id & CAN_EFF_FLAG) != 0;
  frame.remote = (in.can_id & CAN_RTR_FLAG) != 0;
  frame.id = in.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.length = std::min<std::uint8_t>(in.len, CAN_MAX_DLEN);
  if (!frame.remote) {
    std::copy_n(in.data, frame.length, frame.data.begin());
  }
  return frame;
}

/// Nothing when it is no error frame.
std::optional<ControllerReport> report_from_kernel(const can_frame& in) {
  ErrorFrame frame{in.can_id, {}};
  std::copy_n(in.data, frame.data.size(), frame.data.begin());
  const auto report = protocols::can::from_error_frame(frame);
  return report.ok() ? std::optional(*report) : std::nullopt;
}

int open_can_socket() {
  return ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
}

std::string mend(const std::string& interface) {
  return "make one with: ip link add dev " + interface + " type vcan && ip link set " + interface +
         " up";
}

[[noreturn]] void fail(const std::string& interface, const std::string& what, int error) {
  throw EndpointError("CAN interface " + interface + ": " + what +
                      (error != 0 ? std::string(": ") + std::strerror(error) : std::string()) +
                      "; " + mend(interface));
}

int open_interface(const std::string& interface) {
  if (interface.empty() || interface.size() >= IFNAMSIZ) {
    throw EndpointError("CAN interface \"" + interface + "\": a name has 1 .. " +
                        std::to_string(IFNAMSIZ - 1) + " characters");
  }
  Descriptor socket(open_can_socket());
  if (!socket.open()) {
    fail(interface, "the kernel has no CAN sockets (modprobe can_raw vcan)", errno);
  }
  ifreq request{};
  std::copy(interface.begin(), interface.end(), request.ifr_name);
  if (::ioctl(socket.get(), SIOCGIFINDEX, &request) != 0) {
    fail(interface, "no such interface", errno);
  }
  const int index = request.ifr_ifindex;
  if (::ioctl(socket.get(), SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) == 0) {
    fail(interface, "the interface is down", 0);
  }
  const int on = 1;
  // The kernel reports lost frames with the next ones; a kernel that cannot is no error.
  (void)::setsockopt(socket.get(), SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
  // FD frames are asked for in order to be counted.
  (void)::setsockopt(socket.get(), SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on);
  const can_err_mask_t errors = CAN_ERR_MASK;
  (void)::setsockopt(socket.get(), SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = index;
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    fail(interface, "cannot bind (is it a CAN interface?)", errno);
  }
  return socket.release();
}

int write_frame(int socket, const can_frame& frame) {
  if (::write(socket, &frame, sizeof frame) == static_cast<ssize_t>(sizeof frame)) {
    return 0;
  }
  return errno;
}

/// What the interface is now, whatever was seen of it before.
CanLink look_at(const std::string& interface) {
  const auto found = find_can_interface(interface);
  if (!found) {
    return CanLink::gone;
  }
  return found->up ? CanLink::up : CanLink::down;
}

}  // namespace

bool socketcan_available() {
  const Descriptor socket(open_can_socket());
  return socket.open();
}

bool socketcan_available(const std::string& interface) {
  return socketcan_available() && ::if_nametoindex(interface.c_str()) != 0;
}

SocketCanBus::SocketCanBus(boost::asio::io_context& context, std::string interface,
                           std::uint32_t bit_rate_bps)
    : interface_(std::move(interface)),
      socket_(context, open_interface(interface_)),
      retry_timer_(context),
      search_timer_(context),
      queue_(kWaiting, [this](const can_frame& frame) {
        return write_frame(socket_.native_handle(), frame);
      }) {
  const auto found = find_can_interface(interface_);
  virtual_ = found && found->is_virtual();
  if (found && bit_rate_bps != 0 && found->bit_rate_bps != 0 &&
      found->bit_rate_bps != bit_rate_bps) {
    throw std::invalid_argument("CAN interface " + interface_ + ": its bit rate is " +
                                std::to_string(found->bit_rate_bps) + " bit/s, the bus's is " +
                                std::to_string(bit_rate_bps) +
                                " bit/s; on one bus both must be the same");
  }
}

SocketCanBus::~SocketCanBus() = default;

void SocketCanBus::start(Receiver receiver) {
  receiver_ = std::move(receiver);
  started_ = true;
  wait_readable();
}

void SocketCanBus::wait_readable() {
  socket_.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                     [this, alive = std::weak_ptr<char>(alive_)](boost::system::error_code error) {
                       if (error || alive.expired()) {
                         return;
                       }
                       read_all();
                       if (!alive.expired() && link() != CanLink::gone) {
                         wait_readable();
                       }
                     });
}

void SocketCanBus::read_all() {
  const std::weak_ptr<char> alive = alive_;
  // Not for ever: a flood must not starve the other endpoints.
  for (int i = 0; i < 256 && !alive.expired(); ++i) {
    canfd_frame in{};
    iovec part{&in, sizeof in};
    alignas(cmsghdr) char control[CMSG_SPACE(sizeof(std::uint32_t))];
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof control;
    const ssize_t size = ::recvmsg(socket_.native_handle(), &message, 0);
    if (size < 0) {
      if (errno == ENETDOWN) {
        queue_.set_link(CanLink::down);
      } else if (errno == ENODEV || errno == ENXIO) {
        queue_.set_link(CanLink::gone);
      }
      follow_link();
      return;
    }
    for (cmsghdr* head = CMSG_FIRSTHDR(&message); head != nullptr;
         head = CMSG_NXTHDR(&message, head)) {
      if (head->cmsg_level == SOL_SOCKET && head->cmsg_type == SO_RXQ_OVFL) {
        std::uint32_t total = 0;
        std::memcpy(&total, CMSG_DATA(head), sizeof total);
        counters_.dropped += total - dropped_by_socket_;  // modulo 2^32, as the kernel counts
        dropped_by_socket_ = total;
      }
    }
    if (size == static_cast<ssize_t>(sizeof(can_frame))) {
      can_frame frame;
      std::memcpy(&frame, &in, sizeof frame);
      take(frame);
    } else {
      ++counters_.fd_frames;
    }
  }
}

void SocketCanBus::take(const can_frame& frame) {
  queue_.set_link(CanLink::up);
  follow_link();
  if ((frame.can_id & CAN_ERR_FLAG) != 0) {
    ++counters_.error_frames;
    const auto report = report_from_kernel(frame);
    if (report && watcher_) {
      watcher_(*report);
    }
    return;
  }
  heard_ = true;
  if (receiver_) {
    receiver_(from_kernel(frame));
  }
}

bool SocketCanBus::send(const Frame& frame) {
  return offer(to_kernel(frame));
}

bool SocketCanBus::report(const protocols::can::ControllerReport& report, Stamp /*stamp*/) {
  return !virtual_ || offer(to_kernel(report));
}

bool SocketCanBus::offer(const can_frame& frame) {
  const bool taken = queue_.offer(frame);
  follow_link();
  if (queue_.waiting()) {
    wait_to_retry();
  }
  return taken;
}

void SocketCanBus::wait_to_retry() {
  if (retrying_) {
    return;
  }
  retrying_ = true;
  retry_timer_.expires_after(kRetryPeriod);
  retry_timer_.async_wait(
      [this, alive = std::weak_ptr<char>(alive_)](boost::system::error_code error) {
        if (error || alive.expired()) {
          return;
        }
        retrying_ = false;
        queue_.retry();
        follow_link();
        if (queue_.waiting()) {
          wait_to_retry();
        }
      });
}

void SocketCanBus::follow_link() {
  if (link() == known_link_) {
    return;
  }
  known_link_ = link();
  counters_.interruptions += known_link_ == CanLink::up ? 0 : 1;
  if (known_link_ == CanLink::gone) {
    wait_to_search();
  }
}

void SocketCanBus::wait_to_search() {
  if (searching_) {
    return;
  }
  searching_ = true;
  search_timer_.expires_after(kSearchPeriod);
  search_timer_.async_wait(
      [this, alive = std::weak_ptr<char>(alive_)](boost::system::error_code error) {
        if (error || alive.expired()) {
          return;
        }
        searching_ = false;
        if (look_at(interface_) != CanLink::up) {
          wait_to_search();
          return;
        }
        try {
          const int fresh = open_interface(interface_);
          socket_.close();
          socket_.assign(fresh);
        } catch (const EndpointError&) {  // removed again between two looks
          wait_to_search();
          return;
        }
        dropped_by_socket_ = 0;
        queue_.set_link(CanLink::up);
        follow_link();
        if (started_) {
          wait_readable();
        }
      });
}

EndpointStatus SocketCanBus::status() const {
  switch (link()) {
    case CanLink::up:
      return {interface_, heard_};
    case CanLink::down:
      return {interface_ + (look_at(interface_) == CanLink::up ? "" : " (down)"), false};
    case CanLink::gone:
      break;
  }
  return {interface_ + " (removed)", false};
}

}  // namespace rigwire::drivers
