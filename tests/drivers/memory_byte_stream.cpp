#include "memory_byte_stream.h"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <utility>
#include <vector>

namespace rigwire::drivers {

/// What both ends and the posted deliveries share.
struct MemorySerialLine::State : std::enable_shared_from_this<MemorySerialLine::State> {
  State(boost::asio::io_context& the_context, std::string the_name, std::uint32_t the_baud)
      : context(the_context), name(std::move(the_name)), baud(the_baud) {}

  struct Client {
    ByteStream::Receiver receiver;
  };

  boost::asio::io_context& context;
  std::string name;
  std::uint32_t baud;
  bool alive = true;  ///< The line still exists.
  ByteStream::Receiver device_receiver;
  ByteStream::ClientWatcher watcher;
  LineClient told;
  std::vector<std::shared_ptr<Client>> clients;  ///< In order of opening.
  std::vector<std::uint8_t> to_device;
  std::vector<std::uint8_t> to_client;
  bool delivery_posted = false;

  static std::size_t append(std::vector<std::uint8_t>& queue, std::span<const std::uint8_t> bytes) {
    const std::size_t count = std::min(bytes.size(), kCapacity - queue.size());
    queue.insert(queue.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
  }

  [[nodiscard]] LineClient client() const {
    return clients.empty() ? LineClient{} : LineClient{true, baud};
  }
  [[nodiscard]] bool has_news() const {
    return alive && watcher && device_receiver && client() != told;
  }

  void tell(const LineClient& now) {
    told = now;
    const auto listener = watcher;
    listener(now);
  }

  void post_delivery() {
    if (delivery_posted || (to_device.empty() && to_client.empty() && !has_news())) {
      return;
    }
    delivery_posted = true;
    boost::asio::post(context, [self = shared_from_this()] { self->deliver(); });
  }

  void deliver() {
    delivery_posted = false;
    const bool client_left_with_bytes_behind = clients.empty() && !to_device.empty();
    if (has_news() && !client_left_with_bytes_behind) {
      tell(client());
    } else if (alive && watcher && device_receiver && client_left_with_bytes_behind &&
               told != LineClient{true, baud}) {
      tell({true, baud});
    }
    if (alive && device_receiver && !to_device.empty()) {
      const auto bytes = std::exchange(to_device, {});
      const auto receiver = device_receiver;
      receiver(bytes);
    }
    if (!clients.empty() && clients.front()->receiver && !to_client.empty()) {
      const auto bytes = std::exchange(to_client, {});
      const auto receiver = clients.front()->receiver;
      receiver(bytes);
    }
    // What nobody has asked for yet waits for start(); what the receivers wrote goes on its way.
    const bool device_waits = !to_device.empty() && device_receiver;
    const bool client_waits = !to_client.empty() && !clients.empty() && clients.front()->receiver;
    if (device_waits || client_waits || has_news()) {
      post_delivery();
    }
  }
};

namespace {

class DeviceEnd final : public ByteStream {
 public:
  explicit DeviceEnd(std::shared_ptr<MemorySerialLine::State> state) : state_(std::move(state)) {}

  void start(Receiver receiver) override {
    state_->device_receiver = std::move(receiver);
    state_->post_delivery();
  }
  void on_client(ClientWatcher watcher) override { state_->watcher = std::move(watcher); }
  std::size_t write(std::span<const std::uint8_t> bytes) override {
    if (state_->clients.empty()) {
      return bytes.size();
    }
    const std::size_t taken = MemorySerialLine::State::append(state_->to_client, bytes);
    state_->post_delivery();
    return taken;
  }
  [[nodiscard]] EndpointStatus status() const override {
    return {state_->name, !state_->clients.empty()};
  }

 private:
  std::shared_ptr<MemorySerialLine::State> state_;
};

class ClientEnd final : public ByteStream {
 public:
  explicit ClientEnd(std::shared_ptr<MemorySerialLine::State> state)
      : state_(std::move(state)), self_(std::make_shared<MemorySerialLine::State::Client>()) {
    state_->clients.push_back(self_);
    state_->post_delivery();
  }
  ~ClientEnd() override {
    std::erase(state_->clients, self_);
    if (state_->clients.empty()) {
      state_->to_client.clear();
    }
    state_->post_delivery();
  }
  ClientEnd(const ClientEnd&) = delete;
  ClientEnd& operator=(const ClientEnd&) = delete;

  void start(Receiver receiver) override {
    self_->receiver = std::move(receiver);
    state_->post_delivery();
  }
  std::size_t write(std::span<const std::uint8_t> bytes) override {
    if (!state_->alive) {
      return bytes.size();
    }
    const std::size_t taken = MemorySerialLine::State::append(state_->to_device, bytes);
    state_->post_delivery();
    return taken;
  }
  [[nodiscard]] EndpointStatus status() const override { return {state_->name, state_->alive}; }

 private:
  std::shared_ptr<MemorySerialLine::State> state_;
  std::shared_ptr<MemorySerialLine::State::Client> self_;
};

}  // namespace

MemorySerialLine::MemorySerialLine(boost::asio::io_context& context, std::string name,
                                   std::uint32_t baud)
    : state_(std::make_shared<State>(context, std::move(name), baud)),
      device_(std::make_unique<DeviceEnd>(state_)) {}

MemorySerialLine::~MemorySerialLine() {
  state_->alive = false;
  state_->device_receiver = nullptr;
  state_->watcher = nullptr;
}

ByteStream& MemorySerialLine::device() {
  return *device_;
}

std::unique_ptr<ByteStream> MemorySerialLine::open_client() {
  return std::make_unique<ClientEnd>(state_);
}

void MemorySerialLine::set_client_baud(std::uint32_t baud) {
  state_->baud = baud;
  state_->post_delivery();
}

}  // namespace rigwire::drivers
