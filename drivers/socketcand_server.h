// The daemon socketcand with one CAN interface: any number of clients on TCP share one controller
// on the bus, as programs on the daemon's machine would (protocols/socketcand/socketcand.h).
//
// - The controller is open while a client has opened the bus, and until what such clients sent has
//   left; on_client() reports it. It has the bus's rate.
// - A client begins without a bus. Everything but "open" with one of the bus's names is answered by
//   an error and the end of the connection. Then it is in BCM mode; rawmode, bcmmode and
//   controlmode change that, each ends what the mode before had set up.
// - Raw mode: every data frame of others, never the client's own. Frames of other clients of the
//   daemon are passed on once they were on the bus, remote requests are not, errors by `error_mask`
//   only.
// - BCM mode: "add" sends at once and then every interval (at least kShortestInterval), "update"
//   changes the data, "delete" ends it. "subscribe" passes an identifier on, "filter" and
//   "muxfilter" only when the masked content differs from the one before; an interval is the
//   minimum time between two, the newest content is passed on at its end. Own frames are passed on,
//   too.
// - Control mode: "statistics" reports bytes and frames of the interface every interval.
// - What cannot be understood of a known command is not answered, an unknown one by an error.
// - A client that sends faster than the bus takes has `waiting_frames` of queue. Like the daemon,
//   the server ends the connection of a client in raw mode whose frame the interface refuses.
// - Clients take one "< ok >" for one read (python-can), so that frames are held back after the one
//   for rawmode: for kSettling, or until the client sends something, or until there are as many as
//   a client reads at once.
//
// Timers are the wall clock's, as the kernel's broadcast manager has them.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/endpoints.h"
#include "protocols/socketcand/socketcand.h"

namespace rigwire::drivers {

struct SocketcandSettings {
  std::vector<std::string> buses = {"can0"};  ///< Names of the one bus.
  std::chrono::microseconds epoch{0};         ///< Time since 1970 at the start of the run.
  std::uint32_t error_mask = 0;               ///< Classes of error frames that are passed on.
  std::size_t transmit_queue_frames = 64;     ///< Given to the bus and not settled, at least 1.
  std::size_t waiting_frames = 1000;          ///< Behind those.
};

class SocketcandServer final : public CanBus {
 public:
  static constexpr std::chrono::microseconds kShortestInterval{50};
  static constexpr std::chrono::milliseconds kSettling{20};
  static constexpr std::size_t kHeldBackBytes = 960;

  /// `server` must outlive it and have no other user. Throws std::invalid_argument.
  SocketcandServer(boost::asio::io_context& context, StreamServer& server,
                   SocketcandSettings settings);
  ~SocketcandServer() override;

  void start(Receiver receiver) override;
  void on_client(ClientWatcher watcher) override { watcher_ = std::move(watcher); }
  bool send(const protocols::can::Frame& frame) override { return deliver(frame, newest_stamp_); }
  bool deliver(const protocols::can::Frame& frame, Stamp stamp) override;
  void confirm(bool sent, Stamp stamp) override;
  bool report(const protocols::can::ControllerReport& report, Stamp stamp) override;
  /// client_present: a client has the bus open.
  [[nodiscard]] EndpointStatus status() const override;

 private:
  using ConnectionId = StreamServer::ConnectionId;
  struct Client;
  struct Job;
  struct Subscription;
  struct Sent {
    ConnectionId client;
    protocols::can::Frame frame;
  };

  void received(Client& client, std::span<const std::uint8_t> bytes);
  void execute(Client& client, const protocols::socketcand::Command& command);
  void execute_without_bus(Client& client, const protocols::socketcand::Command& command);
  void execute_bcm(Client& client, const protocols::socketcand::Command& command);
  void execute_raw(Client& client, const protocols::socketcand::Command& command);
  void execute_control(Client& client, const protocols::socketcand::Command& command);
  void enter(Client& client, protocols::socketcand::Verb mode);

  bool submit(ConnectionId client, const protocols::can::Frame& frame);
  void hand_over();
  /// To every client but `sender` in raw mode.
  bool pass_on(const protocols::can::Frame& frame, Stamp stamp, ConnectionId sender);
  void consider(Client& client, Subscription& subscription, const protocols::can::Frame& frame,
                Stamp stamp);
  void end_throttling(ConnectionId client, std::uint64_t key);
  void repeat(ConnectionId client, std::uint64_t key);
  void report_statistics(ConnectionId client);
  void settle(Client& client);
  bool say(ConnectionId client, std::string_view text);
  void tell_client();
  [[nodiscard]] Client* find(ConnectionId client);
  [[nodiscard]] protocols::socketcand::Stamp calendar(Stamp stamp) const;
  /// `then`, when the timer has run down and everything is still there.
  template <class Then>
  void wait(boost::asio::steady_timer& timer, Then then);

  boost::asio::io_context& context_;
  StreamServer& server_;
  SocketcandSettings settings_;
  Receiver receiver_;
  ClientWatcher watcher_;
  bool told_open_ = false;
  std::map<ConnectionId, std::unique_ptr<Client>> clients_;
  std::deque<Sent> in_flight_;  ///< Given to the bus, oldest first.
  std::deque<Sent> waiting_;
  protocols::socketcand::Statistics statistics_;
  Stamp newest_stamp_{0};
  std::shared_ptr<char> alive_ = std::make_shared<char>();
};

/// The datagram by which a socketcand makes itself known: every three seconds to UDP port 42000 of
/// its network's broadcast address.
class SocketcandBeacon {
 public:
  static constexpr std::chrono::seconds kPeriod{3};

  /// Announces a server at `address`, a numeric IPv4 address of this machine, and `port`. Throws
  /// EndpointError. Errors while sending are ignored.
  SocketcandBeacon(boost::asio::io_context& context, const std::string& address, std::uint16_t port,
                   const std::vector<std::string>& buses);

 private:
  void send();

  boost::asio::ip::udp::socket socket_;
  boost::asio::ip::udp::endpoint everybody_;
  boost::asio::steady_timer timer_;
  std::string text_;
  std::shared_ptr<char> alive_ = std::make_shared<char>();
};

}  // namespace rigwire::drivers
