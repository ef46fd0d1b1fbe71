#include "drivers/socketcand_beacon.h"

#include <ifaddrs.h>
#include <netinet/in.h>
#include <unistd.h>

#include <array>
#include <boost/asio/buffer.hpp>

#include "drivers/endpoints.h"
#include "protocols/socketcand/socketcand.h"

namespace rigwire::drivers {

namespace asio = boost::asio;
using asio::ip::address_v4;

namespace {

std::string host_name() {
  std::array<char, 65> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

/// The address with all bits of the host set, by the mask of the interface that has it.
address_v4 broadcast_of(const address_v4& address) {
  if (address.is_loopback()) {
    return address_v4::broadcast(address, address_v4(0xFF00'0000U));
  }
  ifaddrs* interfaces = nullptr;
  address_v4 found = address_v4::broadcast();
  if (::getifaddrs(&interfaces) == 0) {
    const auto value = [](const sockaddr* in) {
      return address_v4(ntohl(reinterpret_cast<const sockaddr_in*>(in)->sin_addr.s_addr));
    };
    for (const ifaddrs* i = interfaces; i != nullptr; i = i->ifa_next) {
      if (i->ifa_addr != nullptr && i->ifa_addr->sa_family == AF_INET &&
          i->ifa_netmask != nullptr && value(i->ifa_addr) == address) {
        found = address_v4::broadcast(address, value(i->ifa_netmask));
      }
    }
    ::freeifaddrs(interfaces);
  }
  return found;
}

}  // namespace

SocketcandBeacon::SocketcandBeacon(asio::io_context& context, const std::string& address,
                                   std::uint16_t port, const std::vector<std::string>& buses)
    : socket_(context),
      timer_(context),
      text_(protocols::socketcand::beacon(host_name(), "rigwire", address, port, buses)) {
  boost::system::error_code error;
  const address_v4 own = asio::ip::make_address_v4(address, error);
  if (!error) {
    everybody_ = {broadcast_of(own), protocols::socketcand::kBeaconPort};
    socket_.open(asio::ip::udp::v4(), error);
  }
  if (!error) {
    socket_.set_option(asio::socket_base::broadcast(true), error);
  }
  if (!error) {
    socket_.bind({own, 0}, error);
  }
  if (error) {
    throw EndpointError("socketcand beacon of " + address + ": " + error.message() +
                        "; choose an address of this machine");
  }
  socket_.non_blocking(true, error);
  send();
}

void SocketcandBeacon::send() {
  boost::system::error_code ignored;
  socket_.send_to(asio::buffer(text_), everybody_, 0, ignored);
  timer_.expires_after(kPeriod);
  timer_.async_wait(
      [this, alive = std::weak_ptr<char>(alive_)](const boost::system::error_code& error) {
        if (!error && !alive.expired()) {
          send();
        }
      });
}

}  // namespace rigwire::drivers
