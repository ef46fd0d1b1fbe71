#include "memory_datagram.h"

#include <boost/asio/post.hpp>
#include <deque>
#include <utility>
#include <vector>

namespace rigwire::drivers {

struct MemoryDatagramLink::State : std::enable_shared_from_this<MemoryDatagramLink::State> {
  State(boost::asio::io_context& the_context, std::string the_name)
      : context(the_context), name(std::move(the_name)) {}

  boost::asio::io_context& context;
  std::string name;
  bool listening = false;
  bool heard = false;  ///< The last datagram sent found a listener.
  DatagramSocket::Receiver receiver;
  std::deque<std::vector<std::uint8_t>> queue;
  std::size_t queued_bytes = 0;
  std::uint64_t lost = 0;
  bool delivery_posted = false;

  void accept(std::span<const std::uint8_t> datagram) {
    if (queued_bytes + datagram.size() > kCapacity) {
      ++lost;
      return;
    }
    queue.emplace_back(datagram.begin(), datagram.end());
    queued_bytes += datagram.size();
    post_delivery();
  }

  void post_delivery() {
    if (delivery_posted || queue.empty() || !receiver) {
      return;
    }
    delivery_posted = true;
    boost::asio::post(context, [self = shared_from_this()] { self->deliver(); });
  }

  void deliver() {
    delivery_posted = false;
    while (listening && receiver && !queue.empty()) {
      const auto datagram = std::move(queue.front());
      queue.pop_front();
      queued_bytes -= datagram.size();
      const auto to = receiver;  // survives the listener's end within the call
      to(datagram);
    }
  }

  void close() {
    listening = false;
    receiver = nullptr;
    queue.clear();
    queued_bytes = 0;
  }
};

namespace {

class SendingEnd final : public DatagramSocket {
 public:
  explicit SendingEnd(std::shared_ptr<MemoryDatagramLink::State> state)
      : state_(std::move(state)) {}

  void start(Receiver /*receiver*/) override {}  // nothing ever comes back
  bool send(std::span<const std::uint8_t> datagram) override {
    state_->heard = state_->listening;
    if (state_->listening) {
      state_->accept(datagram);
    }
    return true;
  }
  [[nodiscard]] EndpointStatus status() const override { return {state_->name, state_->heard}; }

 private:
  std::shared_ptr<MemoryDatagramLink::State> state_;
};

class ListeningEnd final : public DatagramSocket {
 public:
  explicit ListeningEnd(std::shared_ptr<MemoryDatagramLink::State> state)
      : state_(std::move(state)) {
    state_->listening = true;
  }
  ~ListeningEnd() override { state_->close(); }
  ListeningEnd(const ListeningEnd&) = delete;
  ListeningEnd& operator=(const ListeningEnd&) = delete;

  void start(Receiver receiver) override {
    state_->receiver = std::move(receiver);
    state_->post_delivery();
  }
  bool send(std::span<const std::uint8_t> /*datagram*/) override { return false; }
  [[nodiscard]] EndpointStatus status() const override { return {state_->name, state_->heard}; }

 private:
  std::shared_ptr<MemoryDatagramLink::State> state_;
};

}  // namespace

MemoryDatagramLink::MemoryDatagramLink(boost::asio::io_context& context, std::string name)
    : state_(std::make_shared<State>(context, std::move(name))),
      sender_(std::make_unique<SendingEnd>(state_)) {}

DatagramSocket& MemoryDatagramLink::sender() {
  return *sender_;
}

std::unique_ptr<DatagramSocket> MemoryDatagramLink::open_listener() {
  if (state_->listening) {
    throw EndpointError(state_->name + ": another listener has the port; close that one");
  }
  return std::make_unique<ListeningEnd>(state_);
}

std::uint64_t MemoryDatagramLink::lost() const {
  return state_->lost;
}

}  // namespace rigwire::drivers
