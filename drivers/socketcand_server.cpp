#include "drivers/socketcand_server.h"

#include <ifaddrs.h>
#include <netinet/in.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/buffer.hpp>
#include <cstring>
#include <optional>
#include <stdexcept>

#include "drivers/endpoints.h"
#include "protocols/can/error_frame.h"
#include "protocols/socketcand/socketcand.h"

namespace rigwire::drivers {

namespace socketcand = protocols::socketcand;
using protocols::can::Frame;
using socketcand::Command;
using Clock = std::chrono::steady_clock;

namespace {

constexpr std::string_view kUnknown = "< error unknown command >";
constexpr std::string_view kOk = "< ok >";
constexpr StreamServer::ConnectionId kNobody = 0;

/// Identifiers of both lengths in one number.
std::uint64_t key_of(const Frame& frame) {
  constexpr std::uint64_t kExtended = 1ULL << 32U;
  constexpr std::uint64_t kRemote = 1ULL << 33U;
  return frame.id | (frame.extended ? kExtended : 0) | (frame.remote ? kRemote : 0);
}

std::uint64_t word_of(const socketcand::Mask& bytes) {
  std::uint64_t word = 0;
  std::memcpy(&word, bytes.data(), sizeof word);
  return word;
}

}  // namespace

/// A cyclic transmission.
struct SocketcandServer::Job {
  Job(boost::asio::io_context& context, const Frame& data) : frame(data), timer(context) {}
  Frame frame;
  std::chrono::microseconds interval{0};
  boost::asio::steady_timer timer;
};

/// A client's subscription to one identifier. Without masks it passes every frame; with one mask
/// those whose masked content has changed; with more, the first mask selects the bytes that
/// distinguish the contents, and each other one has such a value and the mask for it (the kernel's
/// bcm.c, bcm_rx_handler).
struct SocketcandServer::Subscription {
  Subscription(boost::asio::io_context& context, std::vector<socketcand::Mask> wanted)
      : masks(std::move(wanted)), last(masks.size()), throttle(context) {}

  /// Whether the frame is to be passed on.
  bool takes(const Frame& frame) {
    if (masks.empty()) {
      return true;
    }
    const std::uint64_t content = word_of(frame.data);
    std::size_t index = 0;
    if (masks.size() > 1) {
      const std::uint64_t which = word_of(masks[0]);
      for (index = 1; index < masks.size(); ++index) {
        if ((content & which) == (word_of(masks[index]) & which)) {
          break;
        }
      }
      if (index == masks.size()) {
        return false;
      }
    }
    const std::uint64_t mask = word_of(masks[index]);
    const bool news = !last[index] || ((*last[index] ^ content) & mask) != 0;
    if (news) {
      last[index] = content;
    }
    return news;
  }

  std::vector<socketcand::Mask> masks;
  std::vector<std::optional<std::uint64_t>> last;  ///< Contents, for each mask.
  std::chrono::microseconds interval{0};
  bool throttled = false;
  std::optional<std::pair<Frame, Stamp>> held;  ///< The newest one meanwhile.
  boost::asio::steady_timer throttle;
};

struct SocketcandServer::Client {
  enum class Mode : std::uint8_t { no_bus, bcm, raw, control };

  Client(boost::asio::io_context& context, ConnectionId number)
      : id(number), settling(context), statistics(context) {}

  ConnectionId id;
  Mode mode = Mode::no_bus;
  bool ending = false;
  socketcand::ElementSplitter splitter;
  std::map<std::uint64_t, Job> jobs;
  std::map<std::uint64_t, Subscription> subscriptions;
  bool is_settling = false;
  std::string held_back;  ///< While it settles.
  boost::asio::steady_timer settling;
  std::chrono::microseconds statistics_interval{0};
  boost::asio::steady_timer statistics;
};

SocketcandServer::SocketcandServer(boost::asio::io_context& context, StreamServer& server,
                                   SocketcandSettings settings)
    : context_(context), server_(server), settings_(std::move(settings)) {
  if (settings_.buses.empty() || settings_.transmit_queue_frames == 0) {
    throw std::invalid_argument("socketcand: buses and transmit_queue_frames must not be empty");
  }
}

SocketcandServer::~SocketcandServer() = default;

template <class Then>
void SocketcandServer::wait(boost::asio::steady_timer& timer, Then then) {
  timer.async_wait([alive = std::weak_ptr<char>(alive_),
                    then = std::move(then)](const boost::system::error_code& error) {
    if (!error && !alive.expired()) {
      then();
    }
  });
}

void SocketcandServer::start(Receiver receiver) {
  receiver_ = std::move(receiver);
  server_.start({[this](ConnectionId id) {
                   clients_.emplace(id, std::make_unique<Client>(context_, id));
                   (void)say(id, "< hi >");
                 },
                 [this](ConnectionId id, std::span<const std::uint8_t> bytes) {
                   if (Client* client = find(id)) {
                     received(*client, bytes);
                   }
                 },
                 [this](ConnectionId id) {
                   clients_.erase(id);
                   tell_client();
                 }});
}

SocketcandServer::Client* SocketcandServer::find(ConnectionId client) {
  const auto found = clients_.find(client);
  return found == clients_.end() ? nullptr : found->second.get();
}

bool SocketcandServer::say(ConnectionId client, std::string_view text) {
  return server_.send(client, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

socketcand::Stamp SocketcandServer::calendar(Stamp stamp) const {
  return settings_.epoch + std::chrono::duration_cast<socketcand::Stamp>(stamp);
}

void SocketcandServer::tell_client() {
  const bool open = !in_flight_.empty() || !waiting_.empty() ||
                    std::ranges::any_of(clients_, [](const auto& entry) {
                      return entry.second->mode != Client::Mode::no_bus;
                    });
  if (open != told_open_ && watcher_) {
    told_open_ = open;
    watcher_({.open = open});
  }
}

// ---- From clients.

void SocketcandServer::received(Client& client, std::span<const std::uint8_t> bytes) {
  settle(client);
  for (const std::uint8_t byte : bytes) {
    const auto element = client.splitter.push(static_cast<char>(byte));
    if (element) {
      execute(client, socketcand::parse_command(*element));
    }
    if (client.ending || client.splitter.overflowed()) {
      server_.close(client.id);
      return;
    }
  }
}

void SocketcandServer::execute(Client& client, const Command& command) {
  switch (client.mode) {
    case Client::Mode::no_bus:
      execute_without_bus(client, command);
      break;
    case Client::Mode::bcm:
      execute_bcm(client, command);
      break;
    case Client::Mode::raw:
      execute_raw(client, command);
      break;
    case Client::Mode::control:
      execute_control(client, command);
      break;
  }
}

void SocketcandServer::execute_without_bus(Client& client, const Command& command) {
  if (command.verb != socketcand::Verb::open ||
      std::ranges::find(settings_.buses, command.bus) == settings_.buses.end()) {
    (void)say(client.id, "< error could not open bus >");
    client.ending = true;
    return;
  }
  client.mode = Client::Mode::bcm;
  (void)say(client.id, kOk);
  tell_client();
}

/// The commands that all modes have; a mode's own name is unknown in it.
void SocketcandServer::enter(Client& client, socketcand::Verb mode) {
  if (mode == socketcand::Verb::echo) {
    (void)say(client.id, "< echo >");
    return;
  }
  const auto next = mode == socketcand::Verb::raw_mode       ? Client::Mode::raw
                    : mode == socketcand::Verb::bcm_mode     ? Client::Mode::bcm
                    : mode == socketcand::Verb::control_mode ? Client::Mode::control
                                                             : client.mode;
  if (next == client.mode) {
    (void)say(client.id, kUnknown);
    return;
  }
  client.mode = next;
  client.jobs.clear();
  client.subscriptions.clear();
  client.statistics.cancel();
  (void)say(client.id, kOk);
  if (next == Client::Mode::raw) {
    client.is_settling = true;
    client.settling.expires_after(kSettling);
    wait(client.settling, [this, id = client.id] {
      if (Client* known = find(id)) {
        settle(*known);
      }
    });
  } else if (next == Client::Mode::control) {
    report_statistics(client.id);
  }
}

void SocketcandServer::settle(Client& client) {
  if (client.is_settling) {
    client.is_settling = false;
    client.settling.cancel();
    if (!client.held_back.empty()) {
      (void)say(client.id, std::exchange(client.held_back, {}));
    }
  }
}

void SocketcandServer::execute_bcm(Client& client, const Command& command) {
  const std::uint64_t key = key_of(command.frame);
  switch (command.verb) {
    case socketcand::Verb::malformed:
      break;
    case socketcand::Verb::send:
      (void)submit(client.id, command.frame);
      break;
    case socketcand::Verb::add: {
      Job& job = client.jobs.try_emplace(key, context_, command.frame).first->second;
      job.frame = command.frame;
      job.interval = command.interval;
      job.timer.expires_at(Clock::now());
      repeat(client.id, key);
      break;
    }
    case socketcand::Verb::update:
      if (const auto job = client.jobs.find(key); job != client.jobs.end()) {
        job->second.frame = command.frame;
      }
      break;
    case socketcand::Verb::remove:
      client.jobs.erase(key);
      break;
    case socketcand::Verb::subscribe:
    case socketcand::Verb::filter:
    case socketcand::Verb::mux_filter: {
      client.subscriptions.erase(key);
      Subscription& fresh =
          client.subscriptions.try_emplace(key, context_, command.masks).first->second;
      // The daemon leaves the interval of a < muxfilter > out.
      fresh.interval = command.verb == socketcand::Verb::mux_filter ? std::chrono::microseconds{0}
                                                                    : command.interval;
      break;
    }
    case socketcand::Verb::unsubscribe:
      client.subscriptions.erase(key);
      break;
    default:
      enter(client, command.verb);
      break;
  }
}

void SocketcandServer::execute_raw(Client& client, const Command& command) {
  if (command.verb == socketcand::Verb::send) {
    client.ending = !submit(client.id, command.frame);
  } else if (command.verb != socketcand::Verb::malformed) {
    enter(client, command.verb);
  }
}

void SocketcandServer::execute_control(Client& client, const Command& command) {
  if (command.verb == socketcand::Verb::statistics) {
    client.statistics_interval = command.interval;
    client.statistics.expires_at(Clock::now());
    report_statistics(client.id);
  } else if (command.verb != socketcand::Verb::malformed) {
    enter(client, command.verb);
  }
}

void SocketcandServer::report_statistics(ConnectionId id) {
  Client* client = find(id);
  if (client == nullptr || client->statistics_interval.count() == 0) {
    return;
  }
  client->statistics.expires_after(client->statistics_interval);
  wait(client->statistics, [this, id] {
    (void)say(id, socketcand::statistics_element(statistics_));
    report_statistics(id);
  });
}

/// Sends the job's frame and waits for its next turn. Turns that were missed are left out.
void SocketcandServer::repeat(ConnectionId id, std::uint64_t key) {
  Client* client = find(id);
  if (client == nullptr || !client->jobs.contains(key)) {
    return;
  }
  Job& job = client->jobs.at(key);
  (void)submit(id, job.frame);
  if (job.interval.count() > 0) {
    const auto next = job.timer.expiry() + std::max(job.interval, kShortestInterval);
    job.timer.expires_at(std::max(next, Clock::now()));
    wait(job.timer, [this, id, key] { repeat(id, key); });
  }
}

// ---- To the bus and back.

bool SocketcandServer::submit(ConnectionId client, const Frame& frame) {
  if (waiting_.size() >= settings_.waiting_frames) {
    return false;
  }
  waiting_.push_back({client, frame});
  hand_over();
  return true;
}

void SocketcandServer::hand_over() {
  while (!waiting_.empty() && in_flight_.size() < settings_.transmit_queue_frames) {
    in_flight_.push_back(waiting_.front());
    waiting_.pop_front();
    if (receiver_) {
      receiver_(in_flight_.back().frame);
    }
  }
}

void SocketcandServer::confirm(bool sent, Stamp stamp) {
  newest_stamp_ = stamp;
  if (in_flight_.empty()) {
    return;
  }
  const Sent settled = in_flight_.front();
  in_flight_.pop_front();
  if (sent) {
    ++statistics_.sent_frames;
    statistics_.sent_bytes += settled.frame.length;
    (void)pass_on(settled.frame, stamp, settled.client);
  }
  hand_over();
  tell_client();
}

bool SocketcandServer::deliver(const Frame& frame, Stamp stamp) {
  newest_stamp_ = stamp;
  ++statistics_.received_frames;
  statistics_.received_bytes += frame.length;
  return pass_on(frame, stamp, kNobody);
}

bool SocketcandServer::pass_on(const Frame& frame, Stamp stamp, ConnectionId sender) {
  if (frame.remote) {
    return true;
  }
  bool taken = true;
  const std::string element =
      socketcand::frame_element(frame, calendar(stamp), socketcand::DataStyle::together);
  for (const auto& [id, client] : clients_) {
    if (client->mode == Client::Mode::raw && id != sender) {
      if (client->is_settling) {
        client->held_back += element;
        if (client->held_back.size() >= kHeldBackBytes) {
          settle(*client);
        }
      } else {
        taken = say(id, element) && taken;
      }
    } else if (client->mode == Client::Mode::bcm) {
      const auto wanted = client->subscriptions.find(key_of(frame));
      if (wanted != client->subscriptions.end()) {
        consider(*client, wanted->second, frame, stamp);
      }
    }
  }
  return taken;
}

void SocketcandServer::consider(Client& client, Subscription& subscription, const Frame& frame,
                                Stamp stamp) {
  if (!subscription.takes(frame)) {
    return;
  }
  if (subscription.throttled) {
    subscription.held = {frame, stamp};
    return;
  }
  (void)say(client.id,
            socketcand::frame_element(frame, calendar(stamp), socketcand::DataStyle::apart));
  if (subscription.interval.count() > 0) {
    subscription.throttled = true;
    subscription.throttle.expires_after(subscription.interval);
    wait(subscription.throttle,
         [this, id = client.id, key = key_of(frame)] { end_throttling(id, key); });
  }
}

void SocketcandServer::end_throttling(ConnectionId id, std::uint64_t key) {
  Client* client = find(id);
  if (client == nullptr || !client->subscriptions.contains(key)) {
    return;
  }
  Subscription& subscription = client->subscriptions.at(key);
  subscription.throttled = false;
  if (subscription.held) {
    const auto [frame, stamp] = *std::exchange(subscription.held, std::nullopt);
    (void)say(id, socketcand::frame_element(frame, calendar(stamp), socketcand::DataStyle::apart));
    subscription.throttled = true;
    subscription.throttle.expires_after(subscription.interval);
    wait(subscription.throttle, [this, id, key] { end_throttling(id, key); });
  }
}

bool SocketcandServer::report(const protocols::can::ControllerReport& report, Stamp stamp) {
  newest_stamp_ = stamp;
  const std::uint32_t classes =
      protocols::can::to_error_frame(report).id & ~protocols::can::kErrorFlag;
  if ((classes & settings_.error_mask) == 0) {
    return true;
  }
  bool taken = true;
  for (const auto& [id, client] : clients_) {
    if (client->mode == Client::Mode::raw && !client->is_settling) {
      taken = say(id, socketcand::error_element(classes, calendar(stamp))) && taken;
    }
  }
  return taken;
}

EndpointStatus SocketcandServer::status() const {
  EndpointStatus status = server_.status();
  status.address = "socketcand " + status.address;
  status.client_present = std::ranges::any_of(
      clients_, [](const auto& entry) { return entry.second->mode != Client::Mode::no_bus; });
  return status;
}

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
