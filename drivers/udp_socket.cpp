#include "drivers/udp_socket.h"

#include <netinet/in.h>
#include <sys/socket.h>

#include <boost/asio/ip/address_v4.hpp>
#include <boost/asio/ip/unicast.hpp>
#include <boost/asio/socket_base.hpp>
#include <cerrno>
#include <string_view>
#include <utility>

namespace rigwire::drivers {
namespace {

using boost::asio::ip::udp;

/// The largest UDP payload over IPv4.
constexpr std::size_t kLargestUdpDatagram = 65507;
constexpr int kUdpDatagramsPerTurn = 64;
constexpr std::chrono::seconds kPeerMemory{1};

std::string text(const UdpEndpoint& endpoint) {
  return endpoint.address + ":" + std::to_string(endpoint.port);
}

udp::endpoint resolve(const UdpEndpoint& endpoint, std::string_view role) {
  boost::system::error_code error;
  const auto address = boost::asio::ip::make_address_v4(endpoint.address, error);
  if (error) {
    throw EndpointError("udp " + text(endpoint) + ": the " + std::string(role) +
                        " is not an IPv4 address; write it as 127.0.0.1");
  }
  return {address, endpoint.port};
}

UdpEndpoint source_of(const UdpSettings& settings) {
  UdpEndpoint source = *settings.bind;
  if (settings.source_port_follows && settings.destination) {
    source.port = settings.destination->port;
  }
  return source;
}

}  // namespace

UdpSocket::UdpSocket(boost::asio::io_context& context, UdpSettings settings)
    : settings_(std::move(settings)),
      socket_(open(context.get_executor(), settings_)),
      ends_(find_ends()),
      buffer_(kLargestUdpDatagram) {}

udp::socket UdpSocket::open(const boost::asio::any_io_executor& executor,
                            const UdpSettings& settings) {
  if (!settings.destination && !settings.bind) {
    throw EndpointError("udp: neither a destination nor an address to bind is given; give one");
  }
  const std::string name = text(settings.destination ? *settings.destination : *settings.bind);
  udp::socket socket(executor);
  boost::system::error_code error;
  const auto require = [&](const std::string& what, const std::string& mend) {
    if (error) {
      throw EndpointError("udp " + name + ": " + what + ": " + error.message() + "; " + mend);
    }
  };
  socket.open(udp::v4(), error);
  require("cannot open a socket", "raise the limit of open files");
  socket.non_blocking(true, error);
  require("cannot make the socket non-blocking", "report this");
  boost::system::error_code ignored;
  socket.set_option(boost::asio::socket_base::receive_buffer_size(settings.receive_buffer_bytes),
                    ignored);
  if (settings.broadcast) {
    socket.set_option(boost::asio::socket_base::broadcast(true), error);
    require("cannot allow broadcast", "use a unicast destination");
  }
  if (settings.time_to_live != 0) {
    socket.set_option(boost::asio::ip::unicast::hops(settings.time_to_live), error);
    require("cannot set the time to live", "report this");
  }
  if (settings.dont_fragment) {
    const int always = IP_PMTUDISC_DO;
    (void)::setsockopt(socket.native_handle(), IPPROTO_IP, IP_MTU_DISCOVER, &always,
                       sizeof(always));
  }
  if (settings.shares_source) {
    socket.set_option(boost::asio::socket_base::reuse_address(true), error);
    require("cannot share the address to bind", "report this");
  }
  if (settings.bind) {
    const UdpEndpoint source = source_of(settings);
    socket.bind(resolve(source, "address to bind"), error);
    require("cannot bind " + text(source),
            "stop the program that has the port, or choose another port or an address of this "
            "machine");
  }
  if (settings.destination) {
    const udp::endpoint destination = resolve(*settings.destination, "destination");
    if (destination.port() == 0) {
      throw EndpointError("udp " + name + ": the destination's port is 0; allowed 1..65535");
    }
    socket.connect(destination, error);
    require("cannot use the destination",
            settings.broadcast ? "check the route to it"
                               : "check the route to it; a broadcast address must be asked for");
  }
  return socket;
}

std::optional<std::string> UdpSocket::retarget(const UdpEndpoint& destination) {
  UdpSettings wanted = settings_;
  wanted.destination = destination;
  // A second socket beside the old one could not have the same source port.
  const bool keeps_port =
      settings_.bind && source_of(settings_).port == source_of(wanted).port && local_port() != 0;
  UdpSettings trial = wanted;
  if (keeps_port) {
    trial.bind->port = 0;
    trial.source_port_follows = false;
  }
  try {
    udp::socket fresh = open(socket_.get_executor(), trial);
    if (keeps_port) {
      if (resolve(*settings_.bind, "address to bind").address().is_unspecified()) {
        // Dissolved first: the system has bound the socket to the address of the old route.
        sockaddr nobody{};
        nobody.sa_family = AF_UNSPEC;
        (void)::connect(socket_.native_handle(), &nobody, sizeof(nobody));
      }
      socket_.connect(resolve(destination, "destination"));
    } else {
      socket_ = std::move(fresh);
      if (receiver_) {
        wait_readable();
      }
    }
  } catch (const std::exception& refusal) {
    return refusal.what();
  }
  settings_ = std::move(wanted);
  ends_ = find_ends();
  last_sent_.reset();
  last_refused_.reset();
  return std::nullopt;
}

void UdpSocket::start(Receiver receiver) {
  receiver_ = std::move(receiver);
  wait_readable();
}

void UdpSocket::wait_readable() {
  socket_.async_wait(udp::socket::wait_read,
                     [this, alive = std::weak_ptr<char>(alive_)](boost::system::error_code error) {
                       if (alive.expired() || error == boost::asio::error::operation_aborted) {
                         return;
                       }
                       receive_all();
                     });
}

void UdpSocket::receive_all() {
  const std::weak_ptr<char> alive = alive_;
  for (int turn = 0; turn < kUdpDatagramsPerTurn; ++turn) {
    const ssize_t count = ::recv(socket_.native_handle(), buffer_.data(), buffer_.size(), 0);
    if (count >= 0) {
      last_received_ = Clock::now();
      receiver_(std::span(buffer_).first(static_cast<std::size_t>(count)));
      if (alive.expired()) {
        return;  // the receiver has destroyed this object
      }
      continue;
    }
    if (errno == ECONNREFUSED) {
      note_refusal();
    } else if (errno != EINTR) {
      break;
    }
  }
  wait_readable();
}

void UdpSocket::note_refusal() const {
  last_refused_ = Clock::now();
}

bool UdpSocket::send(std::span<const std::uint8_t> datagram) {
  if (!settings_.destination) {
    return false;
  }
  // Each pending refusal costs one attempt; there is at most one per earlier datagram.
  for (int attempt = 0; attempt < 4; ++attempt) {
    if (::send(socket_.native_handle(), datagram.data(), datagram.size(), MSG_NOSIGNAL) >= 0) {
      last_sent_ = Clock::now();
      return true;
    }
    if (errno == ECONNREFUSED) {
      note_refusal();
    } else if (errno != EINTR) {
      return false;
    }
  }
  return false;
}

DatagramSocket::Ends UdpSocket::find_ends() const {
  Ends ends;
  boost::system::error_code none;
  const udp::endpoint own = socket_.local_endpoint(none);
  if (!none) {
    ends.own.address = own.address().to_v4().to_uint();
  }
  if (settings_.bind) {
    ends.own.port = source_of(settings_).port;
  }
  if (settings_.destination) {
    const udp::endpoint to = socket_.remote_endpoint(none);
    if (!none) {
      ends.destination = {to.address().to_v4().to_uint(), to.port()};
    }
  }
  return ends;
}

EndpointStatus UdpSocket::status() const {
  EndpointStatus status;
  const auto now = Clock::now();
  if (!settings_.destination) {
    status.address = "udp " + settings_.bind->address + ":" + std::to_string(local_port());
    status.client_present = last_received_ && now - *last_received_ < kPeerMemory;
    return status;
  }
  int pending = 0;
  socklen_t size = sizeof(pending);
  if (::getsockopt(socket_.native_handle(), SOL_SOCKET, SO_ERROR, &pending, &size) == 0 &&
      pending == ECONNREFUSED) {
    note_refusal();
  }
  status.address = "udp " + text(*settings_.destination);
  status.client_present =
      last_sent_ &&
      (!last_refused_ || (*last_sent_ > *last_refused_ && now - *last_refused_ > kPeerMemory));
  return status;
}

std::uint16_t UdpSocket::local_port() const {
  boost::system::error_code error;
  const udp::endpoint local = socket_.local_endpoint(error);
  return error ? std::uint16_t{0} : local.port();
}

std::string UdpSocket::local_address() const {
  boost::system::error_code error;
  const udp::endpoint local = socket_.local_endpoint(error);
  return error ? std::string("0.0.0.0") : local.address().to_string();
}

}  // namespace rigwire::drivers
