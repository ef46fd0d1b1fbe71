#include "bench/modbus_bench.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sched.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <cerrno>
#include <chrono>
#include <span>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <vector>

#include "bench/cost.h"
#include "drivers/descriptor.h"
#include "drivers/tcp_server.h"
#include "emulators/modbus/modbus_server.h"
#include "emulators/valve_driver/valve_driver.h"
#include "protocols/modbus/mbap.h"
#include "protocols/modbus/pdu.h"

namespace rigwire::bench {
namespace {

namespace modbus = protocols::modbus;
using Clock = std::chrono::steady_clock;

constexpr std::uint16_t kRegisters = 10;
constexpr std::size_t kAnswerSize =
    modbus::kMbapHeaderSize + 1 /* function */ + 1 /* byte count */ + 2 * kRegisters;
static_assert(kAnswerSize == 29);

/// Keeps this thread, and those that it starts, on one processor while it lives.
class OnOneProcessor {
 public:
  OnOneProcessor() : known_(::sched_getaffinity(0, sizeof before_, &before_) == 0) {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<unsigned>(std::max(::sched_getcpu(), 0)), &one);
    static_cast<void>(::sched_setaffinity(0, sizeof one, &one));
  }
  ~OnOneProcessor() {
    if (known_) {
      static_cast<void>(::sched_setaffinity(0, sizeof before_, &before_));
    }
  }
  OnOneProcessor(const OnOneProcessor&) = delete;
  OnOneProcessor& operator=(const OnOneProcessor&) = delete;

 private:
  cpu_set_t before_{};
  bool known_;
};

[[noreturn]] void fail(const char* what) {
  throw std::runtime_error(std::string("modbus bench: ") + what + ": " +
                           std::generic_category().message(errno));
}

modbus::AduBytes request(std::uint16_t transaction) {
  const modbus::Pdu pdu =
      modbus::encode_request(modbus::ReadRegisters{modbus::RegisterTable::holding, 0, kRegisters});
  return modbus::encode_adu({transaction, modbus::kModbusProtocol, 1}, pdu.view());
}

sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

void no_delay(int socket) {
  const int on = 1;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

/// Blocks until all of `bytes` is there; false at the end of the stream.
bool read_all(int socket, std::span<std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t got = ::recv(socket, bytes.data(), bytes.size(), 0);
    if (got <= 0) {
      return false;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(got));
  }
  return true;
}

/// A client with one connection.
class Client {
 public:
  explicit Client(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const sockaddr_in address = loopback(port);
    if (!socket_.open() || ::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&address),
                                     sizeof address) != 0) {
      fail("cannot connect");
    }
    no_delay(socket_.get());
  }
  /// Writes `bytes` at once and waits for `answers` answers; false when one is not as expected.
  bool exchange(std::span<const std::uint8_t> bytes, std::size_t answers) {
    if (::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL) !=
        static_cast<ssize_t>(bytes.size())) {
      fail("cannot send");
    }
    bool right = true;
    for (std::size_t i = 0; i < answers; ++i) {
      std::array<std::uint8_t, kAnswerSize> answer{};
      if (!read_all(socket_.get(), answer)) {
        fail("the server has gone");
      }
      right = right && std::ranges::equal(std::span(answer).first(2),
                                          bytes.subspan(i * bytes.size() / answers, 2));
    }
    return right;
  }

 private:
  drivers::Descriptor socket_;
};

/// The valve driver behind a Modbus server on a free port, in its own thread. Answers leave at
/// once: what is measured is the machine, not the response delay.
class Server final : private emulators::StreamOutput {
 public:
  Server() : listener_(context_, {.port = 0}), modbus_(without_delay(), *this), driver_({}) {
    modbus_.add_unit(1, driver_.unit());
    listener_.start({[this](auto id) { modbus_.connected(kStart, id); },
                     [this](auto id, auto bytes) { modbus_.receive(kStart, id, bytes); },
                     [this](auto id) { modbus_.disconnected(kStart, id); }});
    thread_ = std::thread([this] {
      const auto keep_running = boost::asio::make_work_guard(context_);
      context_.run();
    });
  }
  ~Server() override {
    context_.stop();
    thread_.join();
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  [[nodiscard]] std::uint16_t port() const { return listener_.port(); }

  static emulators::ModbusServerSettings without_delay() {
    emulators::ModbusServerSettings settings;
    settings.response_delay.typical = Duration{0};
    return settings;
  }

 private:
  void send(emulators::ConnectionId connection, SimTime /*due*/,
            std::span<const std::uint8_t> bytes) override {
    (void)listener_.send(connection, bytes);
  }
  void close(emulators::ConnectionId connection, SimTime /*due*/) override {
    listener_.close(connection);
  }

  boost::asio::io_context context_{1};
  drivers::TcpServer listener_;
  emulators::ModbusServer modbus_;
  emulators::ValveDriver driver_;
  std::thread thread_;
};

/// Minimal server: one client, recv() and send().
class EchoServer {
 public:
  EchoServer() : listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address = loopback(0);
    socklen_t size = sizeof address;
    auto* const plain = reinterpret_cast<sockaddr*>(&address);
    if (!listener_.open() || ::bind(listener_.get(), plain, size) != 0 ||
        ::listen(listener_.get(), 1) != 0 || ::getsockname(listener_.get(), plain, &size) != 0) {
      fail("cannot listen");
    }
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { run(); });
  }
  ~EchoServer() {
    ::shutdown(listener_.get(), SHUT_RDWR);
    thread_.join();
  }
  EchoServer(const EchoServer&) = delete;
  EchoServer& operator=(const EchoServer&) = delete;
  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  void run() {
    const drivers::Descriptor client(::accept(listener_.get(), nullptr, nullptr));
    no_delay(client.get());
    std::array<std::uint8_t, modbus::kTcpAduMaximum> bytes{};
    while (::recv(client.get(), bytes.data(), bytes.size(), 0) > 0) {
      ::send(client.get(), bytes.data(), kAnswerSize, MSG_NOSIGNAL);
    }
  }

  drivers::Descriptor listener_;
  std::uint16_t port_ = 0;
  std::thread thread_;
};

LatencyFigures figures(std::vector<double>& latencies_us) {
  const auto percentile = [&](double share) {
    const auto at =
        static_cast<std::ptrdiff_t>(share * static_cast<double>(latencies_us.size() - 1));
    std::nth_element(latencies_us.begin(), latencies_us.begin() + at, latencies_us.end());
    return latencies_us[static_cast<std::size_t>(at)];
  };
  return {percentile(0.5), percentile(0.99)};
}

double since_s(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

double measure_alone_ns() {
  struct Nowhere final : emulators::StreamOutput {
    void send(emulators::ConnectionId, SimTime, std::span<const std::uint8_t> bytes) override {
      sum += bytes.back();
    }
    void close(emulators::ConnectionId, SimTime) override {}
    std::uint64_t sum = 0;
  };
  Nowhere output;
  emulators::ModbusServer server(Server::without_delay(), output);
  emulators::ValveDriver driver({});
  server.add_unit(1, driver.unit());
  server.connected(kStart, 1);
  const modbus::AduBytes bytes = request(1);
  return nanoseconds_of([&](int) {
    server.receive(kStart, 1, bytes.view());
    keep(&output.sum);
  });
}

}  // namespace

/// Measures round trips of the Modbus server and of the echo server in turns on one processor, then
/// requests in batches, and the server's own CPU time.
ModbusBench measure_modbus(const ModbusBenchSettings& settings) {
  const OnOneProcessor here;
  ModbusBench result;
  Server server;
  EchoServer echo;
  Client modbus_client(server.port());
  Client echo_client(echo.port());
  std::vector<double> modbus_us;
  std::vector<double> echo_us;
  std::uint16_t transaction = 0;
  double modbus_s = 0.0;
  const auto round = [&](Client& client, std::vector<double>& latencies_us) {
    const auto begin = Clock::now();
    for (std::size_t i = 0; i < settings.transactions; ++i) {
      const modbus::AduBytes bytes = request(++transaction);
      const auto sent = Clock::now();
      const bool right = client.exchange(bytes.view(), 1);
      latencies_us.push_back(since_s(sent) * 1e6);
      result.wrong_answers += right ? 0 : 1;
    }
    return since_s(begin);
  };
  for (std::size_t i = 0; i < settings.rounds; ++i) {
    (void)round(echo_client, echo_us);
    modbus_s += round(modbus_client, modbus_us);
  }
  result.per_second = static_cast<double>(modbus_us.size()) / modbus_s;
  result.modbus = figures(modbus_us);
  result.echo = figures(echo_us);
  result.ratio_p50 = result.modbus.p50_us / result.echo.p50_us;
  result.ratio_p99 = result.modbus.p99_us / result.echo.p99_us;

  std::vector<std::uint8_t> burst;
  for (std::size_t i = 0; i < settings.pipelined; ++i) {
    const modbus::AduBytes bytes = request(static_cast<std::uint16_t>(i));
    burst.insert(burst.end(), bytes.view().begin(), bytes.view().end());
  }
  const std::size_t bursts = std::max<std::size_t>(1, settings.transactions / settings.pipelined);
  const auto begin = Clock::now();
  for (std::size_t i = 0; i < bursts; ++i) {
    result.wrong_answers += modbus_client.exchange(burst, settings.pipelined) ? 0 : 1;
  }
  result.pipelined_per_second = static_cast<double>(bursts * settings.pipelined) / since_s(begin);
  result.nanoseconds_alone = measure_alone_ns();
  return result;
}

}  // namespace rigwire::bench
