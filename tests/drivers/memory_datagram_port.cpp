#include "memory_datagram_port.h"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <utility>
#include <vector>

namespace rigwire::drivers {
namespace {

constexpr std::uint32_t kEverybody = 0xFFFF'FFFF;
constexpr std::uint32_t kEverybodyHere = 0x7FFF'FFFF;

class MemoryPort;

}  // namespace

struct MemoryDatagramNetwork::State {
  explicit State(boost::asio::io_context& io) : context(io) {}
  boost::asio::io_context& context;
  std::vector<MemoryPort*> ports;
  std::uint16_t next_port = 40000;
};

namespace {

class MemoryPort final : public DatagramPort {
 public:
  MemoryPort(std::shared_ptr<MemoryDatagramNetwork::State> state, const Peer& end, bool broadcasts)
      : state_(std::move(state)), end_(end), broadcasts_(broadcasts) {
    state_->ports.push_back(this);
  }
  ~MemoryPort() override { std::erase(state_->ports, this); }
  MemoryPort(const MemoryPort&) = delete;
  MemoryPort& operator=(const MemoryPort&) = delete;

  void start(Receiver receiver) override { receiver_ = std::move(receiver); }
  bool send(const Peer& to, std::span<const std::uint8_t> datagram,
            bool /*do_not_fragment*/) override {
    const bool everybody = to.address == kEverybody || to.address == kEverybodyHere;
    for (MemoryPort* port : state_->ports) {
      if (port->end_ == to || (everybody && port->broadcasts_ && port->end_.port == to.port)) {
        boost::asio::post(
            state_->context, [state = state_, port, from = end_,
                              bytes = std::vector<std::uint8_t>(datagram.begin(), datagram.end())] {
              if (std::ranges::find(state->ports, port) != state->ports.end() && port->receiver_) {
                port->heard_ = true;
                port->receiver_(from, bytes);
              }
            });
      }
    }
    return true;
  }
  [[nodiscard]] EndpointStatus status() const override {
    return {.address = "memory port " + std::to_string(end_.port), .client_present = heard_};
  }
  [[nodiscard]] const Peer& peer() const { return end_; }

 private:
  std::shared_ptr<MemoryDatagramNetwork::State> state_;
  Peer end_;
  bool broadcasts_;
  bool heard_ = false;
  Receiver receiver_;
};

}  // namespace

MemoryDatagramNetwork::MemoryDatagramNetwork(boost::asio::io_context& context)
    : state_(std::make_shared<State>(context)) {}

std::unique_ptr<DatagramPort> MemoryDatagramNetwork::open(std::uint32_t address, std::uint16_t port,
                                                          bool broadcasts) {
  const DatagramPort::Peer end{address, port != 0 ? port : state_->next_port++};
  for (const MemoryPort* other : state_->ports) {
    if (other->peer() == end) {
      throw EndpointError("memory port " + std::to_string(port) + " is taken");
    }
  }
  return std::make_unique<MemoryPort>(state_, end, broadcasts);
}

DatagramPort::Peer MemoryDatagramNetwork::end_of(const DatagramPort& port) {
  return dynamic_cast<const MemoryPort&>(port).peer();
}

}  // namespace rigwire::drivers
