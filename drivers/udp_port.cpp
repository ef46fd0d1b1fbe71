#include "drivers/udp_port.h"

#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <boost/asio/ip/address_v4.hpp>
#include <boost/asio/socket_base.hpp>
#include <cerrno>
#include <cstring>
#include <utility>

namespace rigwire::drivers {
namespace {

using boost::asio::ip::udp;

/// The largest UDP payload over IPv4.
constexpr std::size_t kLargestDatagram = 65507;
constexpr int kDatagramsPerTurn = 64;
constexpr std::chrono::seconds kPresenceMemory{3};
constexpr std::uint32_t kEverybody = 0xFFFF'FFFF;

std::string text(std::uint32_t address, std::uint16_t port) {
  return boost::asio::ip::address_v4(address).to_string() + ":" + std::to_string(port);
}

/// An interface and its broadcast address.
struct Network {
  unsigned interface = 0;
  std::uint32_t broadcast = 0;
};

/// Returns the network of an address of this machine; every address of the loopback network is one.
std::optional<Network> network_of(std::uint32_t address) {
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) {
    return std::nullopt;
  }
  const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> owner(list, &::freeifaddrs);
  const auto number = [](const sockaddr* socket_address) {
    sockaddr_in in{};
    std::memcpy(&in, socket_address, sizeof in);
    return ntohl(in.sin_addr.s_addr);
  };
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET ||
        entry->ifa_netmask == nullptr) {
      continue;
    }
    const std::uint32_t own = number(entry->ifa_addr);
    const std::uint32_t mask = number(entry->ifa_netmask);
    const bool loopback = (entry->ifa_flags & IFF_LOOPBACK) != 0;
    if (own == address || (loopback && (own & mask) == (address & mask))) {
      return Network{::if_nametoindex(entry->ifa_name), own | ~mask};
    }
  }
  return std::nullopt;
}

}  // namespace

struct UdpPort::Ear {
  udp::socket socket;
  bool broadcasts = false;
};

UdpPort::UdpPort(boost::asio::io_context& context, const UdpPortSettings& settings)
    : settings_(settings), buffer_(kLargestDatagram) {
  const std::string name = "udp " + text(settings.address, settings.port);
  const auto open = [&](std::uint32_t address, bool broadcasts) {
    auto ear = std::make_unique<Ear>(Ear{udp::socket(context), broadcasts});
    udp::socket& socket = ear->socket;
    boost::system::error_code error;
    const auto require = [&](const std::string& what, const std::string& mend) {
      if (error) {
        throw EndpointError(name + ": " + what + ": " + error.message() + "; " + mend);
      }
    };
    socket.open(udp::v4(), error);
    require("cannot open a socket", "raise the limit of open files");
    socket.non_blocking(true, error);
    require("cannot make the socket non-blocking", "report this");
    boost::system::error_code ignored;
    socket.set_option(boost::asio::socket_base::send_buffer_size(settings.send_buffer_bytes),
                      ignored);
    socket.set_option(boost::asio::socket_base::broadcast(true), ignored);
    if (broadcasts) {
      socket.set_option(boost::asio::socket_base::reuse_address(true), error);
      require("cannot share broadcasts", "report this");
      const int on = 1;
      (void)::setsockopt(socket.native_handle(), IPPROTO_IP, IP_PKTINFO, &on, sizeof on);
    }
    socket.bind({boost::asio::ip::address_v4(address), settings.port}, error);
    require("cannot bind " + text(address, settings.port),
            "stop the program that has the port, or choose another address of this machine");
    ears_.push_back(std::move(ear));
  };
  open(settings.address, false);
  local_port_ = ears_.front()->socket.local_endpoint().port();
  if (settings.broadcasts) {
    const std::optional<Network> network = network_of(settings.address);
    if (!network) {
      throw EndpointError(name + ": no interface has this address; choose one of this machine");
    }
    interface_ = network->interface;
    open(kEverybody, true);
    open(network->broadcast, true);
  }
}

UdpPort::~UdpPort() = default;

void UdpPort::start(Receiver receiver) {
  receiver_ = std::move(receiver);
  for (const std::unique_ptr<Ear>& ear : ears_) {
    listen(*ear);
  }
}

void UdpPort::listen(Ear& ear) {
  ear.socket.async_wait(udp::socket::wait_read, [this, &ear, alive = std::weak_ptr<char>(alive_)](
                                                    boost::system::error_code error) {
    if (alive.expired() || error == boost::asio::error::operation_aborted) {
      return;
    }
    if (receive_all(ear)) {
      listen(ear);
    }
  });
}

bool UdpPort::receive_all(Ear& ear) {
  const std::weak_ptr<char> alive = alive_;
  for (int turn = 0; turn < kDatagramsPerTurn; ++turn) {
    sockaddr_in from{};
    iovec part{buffer_.data(), buffer_.size()};
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(in_pktinfo))> control{};
    msghdr message{};
    message.msg_name = &from;
    message.msg_namelen = sizeof from;
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t count = ::recvmsg(ear.socket.native_handle(), &message, 0);
    if (count < 0) {
      if (errno == EINTR || errno == ECONNREFUSED) {
        continue;  // a refusal is of something that was sent
      }
      break;
    }
    unsigned interface = 0;
    for (cmsghdr* header = CMSG_FIRSTHDR(&message); header != nullptr;
         header = CMSG_NXTHDR(&message, header)) {
      if (header->cmsg_level == IPPROTO_IP && header->cmsg_type == IP_PKTINFO) {
        in_pktinfo info{};
        std::memcpy(&info, CMSG_DATA(header), sizeof info);
        interface = static_cast<unsigned>(info.ipi_ifindex);
      }
    }
    if (ear.broadcasts && interface != interface_) {
      continue;
    }
    last_received_ = Clock::now();
    receiver_({ntohl(from.sin_addr.s_addr), ntohs(from.sin_port)},
              std::span(buffer_).first(static_cast<std::size_t>(count)));
    if (alive.expired()) {
      return false;
    }
  }
  return true;
}

bool UdpPort::send(const Peer& to, std::span<const std::uint8_t> datagram, bool do_not_fragment) {
  const int handle = ears_.front()->socket.native_handle();
  if (fragments_ == do_not_fragment) {
    const int discovery = do_not_fragment ? IP_PMTUDISC_DO : IP_PMTUDISC_WANT;
    (void)::setsockopt(handle, IPPROTO_IP, IP_MTU_DISCOVER, &discovery, sizeof discovery);
    fragments_ = !do_not_fragment;
  }
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(to.port);
  address.sin_addr.s_addr = htonl(to.address);
  // A pending refusal of an earlier datagram costs one attempt.
  for (int attempt = 0; attempt < 4; ++attempt) {
    if (::sendto(handle, datagram.data(), datagram.size(), MSG_NOSIGNAL,
                 reinterpret_cast<const sockaddr*>(&address), sizeof address) >= 0) {
      return true;
    }
    if (errno != ECONNREFUSED && errno != EINTR) {
      return false;
    }
  }
  return false;
}

EndpointStatus UdpPort::status() const {
  EndpointStatus status;
  status.address = "udp " + text(settings_.address, local_port_);
  status.client_present = last_received_ && Clock::now() - *last_received_ < kPresenceMemory;
  return status;
}

}  // namespace rigwire::drivers
