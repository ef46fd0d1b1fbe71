#include "field/gige_wire.h"

#include <boost/asio/ip/address_v4.hpp>
#include <utility>

#include "protocols/gige_vision/gvcp.h"

namespace rigwire::field {
namespace {

/// Size of one or two pictures, so that a program that is busy for a while loses none.
constexpr int kStreamBuffer_bytes = 8 << 20;

}  // namespace

GigeWire::GigeWire(boost::asio::io_context& context, const std::string& address,
                   GigeClientSettings settings, std::function<void(const GigeBlock&)> block)
    : control_(context,
               {.destination = drivers::UdpEndpoint{address, protocols::gige_vision::kGvcpPort}}),
      stream_(context, {.bind = drivers::UdpEndpoint{control_.local_address(), 0},
                        .receive_buffer_bytes = kStreamBuffer_bytes}),
      client_(std::move(settings),
              {boost::asio::ip::make_address_v4(control_.local_address()).to_uint(),
               stream_.local_port()},
              {.send =
                   [this](std::span<const std::uint8_t> datagram) {
                     // What the system does not take is lost as on the way, and asked again.
                     (void)control_.send(datagram);
                   },
               .block = std::move(block)}),
      timer_(context) {}

void GigeWire::start() {
  control_.start([this](std::span<const std::uint8_t> datagram) {
    client_.receive_control(now(), datagram);
    wait();
  });
  stream_.start([this](std::span<const std::uint8_t> datagram) {
    client_.receive_stream(now(), datagram);
    wait();
  });
  client_.start(now());
  wait();
}

void GigeWire::stop() {
  client_.stop();
  timer_.cancel();
}

void GigeWire::wait() {
  const GigeClient::Instant next = client_.next_event();
  if (next == GigeClient::Instant::max()) {
    return;
  }
  // Most packets change nothing: the timer is set anew only when the client wants it earlier.
  const Clock::time_point at = started_ + next;
  if (timer_.expiry() > Clock::now() && timer_.expiry() <= at) {
    return;
  }
  timer_.expires_at(at);
  timer_.async_wait([this](boost::system::error_code error) {
    if (!error) {
      client_.advance(now());
      wait();
    }
  });
}

}  // namespace rigwire::field
