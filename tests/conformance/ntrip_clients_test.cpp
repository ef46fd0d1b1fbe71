// Unmodified clients on the caster: str2str of RTKLIB, which knows version 1 alone, and gpsd, which
// asks in version 2. What reaches them is what the base station sent.
#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "child_process.h"
#include "drivers/tcp_server.h"
#include "emulators/ntrip/caster.h"
#include "private_wires.h"
#include "protocols/rtcm3/message.h"

namespace rigwire {
namespace {

namespace fs = std::filesystem;
namespace rtcm3 = protocols::rtcm3;
using namespace std::chrono_literals;

/// Answers leave at once.
struct Output final : emulators::StreamOutput {
  explicit Output(drivers::TcpServer& to) : server(to) {}
  void send(emulators::ConnectionId connection, SimTime /*due*/,
            std::span<const std::uint8_t> bytes) override {
    server.send(connection, bytes);
  }
  void close(emulators::ConnectionId connection, SimTime /*due*/) override {
    server.close(connection);
  }
  drivers::TcpServer& server;
};

class NtripClients : public ::testing::Test {
 protected:
  NtripClients() {
    std::string pattern = (fs::temp_directory_path() / "ntrip.XXXXXX").string();
    directory_ = ::mkdtemp(pattern.data());
    protocols::ntrip::Stream stream;
    stream.details = "1005(1)";
    mount_ = caster_.add(stream);
    server_.start({.connected = [this](auto c) { caster_.connected(now(), c); },
                   .received = [this](auto c, auto bytes) { caster_.receive(now(), c, bytes); },
                   .disconnected = [this](auto c) { caster_.disconnected(now(), c); }});
  }
  ~NtripClients() override { fs::remove_all(directory_); }

  static emulators::NtripCasterSettings settings() {
    emulators::NtripCasterSettings settings;
    settings.user = "u";
    settings.password = "p";
    return settings;
  }
  [[nodiscard]] SimTime now() const { return now_; }
  /// Serves and sends a frame every 50 ms of the caster's time until `condition` holds. A turn of 2
  /// ms takes `turn_` of that time: as much, or more when no client has anything to say in time.
  bool serve_until(const std::function<bool()>& condition) {
    const auto end = std::chrono::steady_clock::now() + test::kPatience;
    while (std::chrono::steady_clock::now() < end) {
      io_.run_for(2ms);
      io_.restart();
      now_ += turn_;
      caster_.advance(now_);
      for (; next_frame_ <= now_; next_frame_ += 50ms) {
        caster_.hear(now_, mount_, frame_);
      }
      if (condition()) {
        return true;
      }
    }
    return false;
  }
  /// Whether its clients have read all that was sent: no socket of the caster's port holds a byte.
  [[nodiscard]] bool all_is_read() const {
    std::ifstream lines("/proc/net/tcp");
    for (std::string line; std::getline(lines, line);) {
      unsigned local = 0;
      unsigned remote = 0;
      unsigned state = 0;
      unsigned to_send = 0;
      unsigned to_read = 0;
      const int found = std::sscanf(line.c_str(), " %*d: %*8x:%4x %*8x:%4x %2x %8x:%8x", &local,
                                    &remote, &state, &to_send, &to_read);
      constexpr unsigned kEstablished = 1;
      if (found == 5 && (local == server_.port() || remote == server_.port()) &&
          state == kEstablished && (to_send > 0 || to_read > 0)) {
        return false;
      }
    }
    return true;
  }
  [[nodiscard]] std::string url() const {
    return "ntrip://u:p@127.0.0.1:" + std::to_string(server_.port()) + "/BASE";
  }
  static std::vector<std::uint8_t> frame_of_base() {
    rtcm3::AntennaPosition p;
    p.station = 42;
    p.position_m = {4'139'423.1234, 550'210.9876, 4'804'002.0005};
    std::vector<std::uint8_t> frame(rtcm3::kGreatestFrame);
    frame.resize(rtcm3::encode(p, frame));
    return frame;
  }

  Duration turn_ = 2ms;
  SimTime now_ = kStart;
  SimTime next_frame_ = kStart;
  Calendar calendar_{parse_utc("2026-06-01T08:00:00Z")};
  boost::asio::io_context io_;
  drivers::TcpServer server_{io_, {.port = 0}};
  Output output_{server_};
  emulators::NtripCaster caster_{settings(), calendar_, output_};
  std::size_t mount_ = 0;
  std::vector<std::uint8_t> frame_ = frame_of_base();
  fs::path directory_;
};

TEST_F(NtripClients, Str2strTakesEveryByteAndNoOther) {
  const fs::path out = directory_ / "base.rtcm3";
  test::ChildProcess str2str({"str2str", "-in", url() + "#rtcm3", "-out", "file://" + out.string()},
                             directory_ / "str2str.log");
  const std::size_t wanted = 20 * frame_.size();
  ASSERT_TRUE(serve_until([&] { return caster_.streaming() == 1; })) << str2str.output();
  turn_ = 20ms;
  ASSERT_TRUE(serve_until([&] { return caster_.frames_sent() >= 40; })) << str2str.output();
  ASSERT_TRUE(test::eventually([&] { return all_is_read(); }));
  // str2str writes its file when it ends.
  str2str.signal(SIGINT);
  serve_until([&] { return str2str.wait(0s).has_value(); });
  std::ifstream file(out, std::ios::binary);
  const std::vector<std::uint8_t> all{std::istreambuf_iterator<char>(file), {}};
  ASSERT_GE(all.size(), wanted);
  for (std::size_t i = 0; i < all.size() / frame_.size(); ++i) {
    const auto part = std::span(all).subspan(i * frame_.size(), frame_.size());
    ASSERT_TRUE(std::ranges::equal(part, frame_)) << "frame " << i;
  }
}

TEST_F(NtripClients, WrongPasswordGetsNothing) {
  const std::string wrong = "ntrip://u:x@127.0.0.1:" + std::to_string(server_.port()) + "/BASE";
  test::ChildProcess str2str(
      {"str2str", "-in", wrong, "-out", "file://" + (directory_ / "nothing").string()},
      directory_ / "str2str.log");
  ASSERT_TRUE(serve_until([&] { return caster_.counters().refused > 0; }));
  EXPECT_EQ(caster_.streaming(), 0U);
}

TEST_F(NtripClients, GpsdFindsTheMountInTheTableAndReadsChunks) {
  const std::string port = std::to_string(test::free_port(SOCK_STREAM));
  test::ChildProcess gpsd({"gpsd", "-N", "-n", "-b", "-D", "2", "-S", port, url()},
                          directory_ / "gpsd.log");
  ASSERT_TRUE(serve_until([&] { return caster_.streaming() > 0; })) << gpsd.output();
  ASSERT_TRUE(serve_until([&] { return caster_.frames_sent() >= 10; }));
  test::ChildProcess client({"gpspipe", "-w", "-n", "40", "-x", "15", "127.0.0.1:" + port},
                            directory_ / "client.json");
  serve_until([&] { return client.output().find("\"RTCM3\"") != std::string::npos; });
  EXPECT_NE(client.output().find(R"("type":1005,"length":19,"station_id":42)"), std::string::npos)
      << client.output() << gpsd.output();
}

// A client that trickles its request is closed after ten seconds, and others are served meanwhile.
TEST_F(NtripClients, SlowRequestEndsAndHoldsNobodyUp) {
  using boost::asio::ip::tcp;
  boost::asio::io_context io;
  tcp::socket slow(io);
  slow.connect({boost::asio::ip::address_v4::loopback(), server_.port()});
  boost::asio::write(slow, boost::asio::buffer(std::string("GET /BASE HTT")));
  test::ChildProcess str2str(
      {"str2str", "-in", url(), "-out", "file://" + (directory_ / "x").string()},
      directory_ / "str2str.log");
  ASSERT_TRUE(serve_until([&] { return caster_.streaming() == 1; }));
  turn_ = 20ms;
  ASSERT_TRUE(serve_until([&] { return caster_.counters().timed_out == 1; }));
  EXPECT_EQ(caster_.streaming(), 1U);
  EXPECT_TRUE(serve_until([&] { return server_.clients() == 1; }));
}

// Clients that trickle their requests and clients that send garbage take every place but one: the
// one that is served gets each frame, whole and once, from the first of them to the last.
TEST_F(NtripClients, ADozenSlowAndADozenSenselessClientsTakeNothingFromOne) {
  using boost::asio::ip::tcp;
  constexpr std::size_t kOfEach = 12;
  const fs::path out = directory_ / "base.rtcm3";
  test::ChildProcess str2str({"str2str", "-in", url() + "#rtcm3", "-out", "file://" + out.string()},
                             directory_ / "str2str.log");
  ASSERT_TRUE(serve_until([&] { return caster_.streaming() == 1; })) << str2str.output();
  turn_ = 20ms;
  const std::uint64_t sent_before = caster_.frames_sent();
  boost::asio::io_context io;
  std::vector<tcp::socket> slow;
  std::vector<tcp::socket> senseless;
  std::mt19937 random(11);
  for (std::size_t i = 0; i < kOfEach; ++i) {
    for (auto* kind : {&slow, &senseless}) {
      kind->emplace_back(io);
      kind->back().connect({boost::asio::ip::address_v4::loopback(), server_.port()});
    }
    // More than a head may have, half of it without a line's end.
    std::string garbage(8'192, '\0');
    for (char& byte : garbage) {
      byte = static_cast<char>(random());
    }
    boost::asio::write(senseless.back(), boost::asio::buffer(garbage));
  }
  const std::string request =
      "GET /BASE HTTP/1.0\r\nUser-Agent: NTRIP slow\r\nX: " + std::string(200, 'y') + "\r\n\r\n";
  std::size_t said = 0;
  const auto trickle = [&] {
    // A byte of each in every tenth of a second: the head would take 25 s.
    const auto wanted = static_cast<std::size_t>(to_seconds(now() - kStart) * 10.0);
    for (; said < std::min(wanted, request.size()); ++said) {
      for (tcp::socket& socket : slow) {
        boost::system::error_code closed;
        boost::asio::write(socket, boost::asio::buffer(&request[said], 1), closed);
      }
    }
    return caster_.counters().timed_out == kOfEach;
  };
  ASSERT_TRUE(serve_until(trickle)) << caster_.counters().timed_out;
  EXPECT_GE(caster_.counters().refused, kOfEach);
  EXPECT_EQ(caster_.streaming(), 1U);
  ASSERT_TRUE(serve_until([&] { return server_.clients() == 1; }));
  EXPECT_GE(caster_.frames_sent() - sent_before, 100U);
  ASSERT_TRUE(test::eventually([&] { return all_is_read(); }));
  str2str.signal(SIGINT);
  serve_until([&] { return str2str.wait(0s).has_value(); });
  std::ifstream file(out, std::ios::binary);
  const std::vector<std::uint8_t> all{std::istreambuf_iterator<char>(file), {}};
  ASSERT_GE(all.size() / frame_.size(), 100U);
  EXPECT_EQ(all.size() % frame_.size(), 0U);
  for (std::size_t i = 0; i < all.size() / frame_.size(); ++i) {
    ASSERT_TRUE(
        std::ranges::equal(std::span(all).subspan(i * frame_.size(), frame_.size()), frame_))
        << "frame " << i;
  }
}

}  // namespace
}  // namespace rigwire
