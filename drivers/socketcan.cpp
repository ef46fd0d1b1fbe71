#include "drivers/socketcan.h"

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "drivers/descriptor.h"

namespace rigwire::drivers {

using protocols::can::Frame;

namespace {

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
  // Lost frames are announced with the frames; a kernel that cannot tell is no error.
  (void)::setsockopt(socket.get(), SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = index;
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    fail(interface, "cannot bind (is it a CAN interface?)", errno);
  }
  return socket.release();
}

can_frame to_kernel(const Frame& frame) {
  can_frame out{};
  out.can_id = frame.extended ? (frame.id & CAN_EFF_MASK) | CAN_EFF_FLAG : frame.id & CAN_SFF_MASK;
  out.can_id |= frame.remote ? CAN_RTR_FLAG : 0U;
  out.len = std::min<std::uint8_t>(frame.length, 8);
  std::copy(frame.data.begin(), frame.data.end(), out.data);
  return out;
}

Frame from_kernel(const can_frame& in) {
  Frame frame;
  frame.extended = (in.can_id & CAN_EFF_FLAG) != 0;
  frame.remote = (in.can_id & CAN_RTR_FLAG) != 0;
  frame.id = in.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.length = std::min<std::uint8_t>(in.len, 8);
  if (!frame.remote) {
    std::copy_n(in.data, frame.length, frame.data.begin());
  }
  return frame;
}

}  // namespace

bool socketcan_available() {
  const Descriptor socket(open_can_socket());
  return socket.open();
}

bool socketcan_available(const std::string& interface) {
  return socketcan_available() && ::if_nametoindex(interface.c_str()) != 0;
}

SocketCanBus::SocketCanBus(boost::asio::io_context& context, std::string interface)
    : interface_(std::move(interface)), socket_(context, open_interface(interface_)) {}

SocketCanBus::~SocketCanBus() = default;

void SocketCanBus::start(Receiver receiver) {
  receiver_ = std::move(receiver);
  wait_readable();
}

void SocketCanBus::wait_readable() {
  socket_.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                     [this, alive = std::weak_ptr<char>(alive_)](boost::system::error_code error) {
                       if (!error && !alive.expired() && read_all()) {
                         wait_readable();
                       }
                     });
}

bool SocketCanBus::read_all() {
  // Not for ever: a flood must not starve the other endpoints.
  for (int i = 0; i < 256; ++i) {
    can_frame in{};
    iovec part{&in, sizeof in};
    alignas(cmsghdr) char control[CMSG_SPACE(sizeof(std::uint32_t))];
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof control;
    const ssize_t size = ::recvmsg(socket_.native_handle(), &message, 0);
    if (size < 0) {
      return errno == EAGAIN || errno == EINTR || errno == ENETDOWN || errno == ENOBUFS;
    }
    for (cmsghdr* head = CMSG_FIRSTHDR(&message); head != nullptr;
         head = CMSG_NXTHDR(&message, head)) {
      if (head->cmsg_level == SOL_SOCKET && head->cmsg_type == SO_RXQ_OVFL) {
        std::memcpy(&dropped_, CMSG_DATA(head), sizeof dropped_);
      }
    }
    if (size != static_cast<ssize_t>(sizeof in) || (in.can_id & CAN_ERR_FLAG) != 0) {
      continue;
    }
    heard_ = true;
    if (receiver_) {
      receiver_(from_kernel(in));
    }
  }
  return true;
}

bool SocketCanBus::send(const Frame& frame) {
  const can_frame out = to_kernel(frame);
  return ::write(socket_.native_handle(), &out, sizeof out) == static_cast<ssize_t>(sizeof out);
}

EndpointStatus SocketCanBus::status() const {
  return {interface_, heard_};
}

}  // namespace rigwire::drivers
