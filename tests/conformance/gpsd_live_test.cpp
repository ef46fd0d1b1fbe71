// The daemon itself: Debian's gpsd, unmodified, opens a pseudo-terminal on which the emulated
// receiver lives in real time; it must find out what it is, configure it, and report the truth.
//
// The programs are required dependencies: without them the test fails. Every wait is bounded.
#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <deque>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "child_process.h"
#include "drivers/descriptor.h"
#include "emulators/ublox/receiver.h"
#include "private_wires.h"

namespace rigwire {
namespace {

using namespace std::chrono_literals;
using drivers::Descriptor;
using Json = nlohmann::json;
using WallClock = std::chrono::steady_clock;

constexpr double kLatitude_deg = 49.4240123;
constexpr double kLongitude_deg = 7.7510456;
constexpr double kHeight_m = 328.25;

/// gpsd in the foreground on one device and one port; ended with the object.
class Daemon {
 public:
  Daemon(const std::string& device, std::uint16_t port) : process_(::fork()) {
    if (process_ == 0) {
      const std::string number = std::to_string(port);
      ::execlp("gpsd", "gpsd", "-N", "-n", "-S", number.c_str(), device.c_str(), nullptr);
      ::_exit(127);
    }
  }
  ~Daemon() {
    if (process_ > 0) {
      ::kill(process_, SIGKILL);
      ::waitpid(process_, nullptr, 0);
    }
  }
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;
  [[nodiscard]] bool running() const { return ::waitpid(process_, nullptr, WNOHANG) == 0; }

 private:
  pid_t process_;
};

/// The receiver on the master side of a pseudo-terminal: bytes wait until they are due.
class Line final : public emulators::ByteOutput {
 public:
  Line() : master_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    ::grantpt(master_.get());
    ::unlockpt(master_.get());
    name_ = ::ptsname(master_.get());
    const Descriptor slave(::open(name_.c_str(), O_RDWR | O_NOCTTY));
    termios raw{};
    ::tcgetattr(slave.get(), &raw);
    ::cfmakeraw(&raw);
    ::tcsetattr(slave.get(), TCSANOW, &raw);
    keep_open_ = ::open(name_.c_str(), O_RDWR | O_NOCTTY);
  }
  ~Line() override { ::close(keep_open_); }
  void send(SimTime due, std::span<const std::uint8_t> bytes) override {
    waiting_.push_back({due, {bytes.begin(), bytes.end()}});
  }
  void write_due(SimTime now) {
    while (!waiting_.empty() && waiting_.front().due <= now) {
      const auto& bytes = waiting_.front().bytes;
      if (::write(master_.get(), bytes.data(), bytes.size()) != std::ssize(bytes)) {
        ADD_FAILURE() << "the pseudo-terminal took no more";
      }
      waiting_.pop_front();
    }
  }
  [[nodiscard]] std::vector<std::uint8_t> read() const {
    std::vector<std::uint8_t> bytes(4096);
    const ssize_t n = ::read(master_.get(), bytes.data(), bytes.size());
    bytes.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
    return bytes;
  }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  struct Chunk {
    SimTime due;
    std::vector<std::uint8_t> bytes;
  };
  Descriptor master_;
  std::string name_;
  int keep_open_ = -1;
  std::deque<Chunk> waiting_;
};

GnssSample truth_at(SimTime time) {
  GnssSample sample;
  sample.time = time;
  sample.fix = GnssFix::three_d;
  sample.latitude_deg = kLatitude_deg;
  sample.longitude_deg = kLongitude_deg;
  sample.ellipsoid_height_m = kHeight_m;
  sample.geoid_separation_m = 48.0;
  sample.horizontal_accuracy_m = 2.5;
  sample.vertical_accuracy_m = 4.0;
  sample.speed_accuracy_mps = 0.1;
  sample.horizontal_dilution = 1.16;
  sample.vertical_dilution = 2.24;
  sample.position_dilution = 1.9;
  sample.time_dilution = 0.9;
  for (std::uint8_t prn = 1; prn <= 10; ++prn) {
    sample.satellites.push_back({prn, 0.5 * prn, 0.1 * prn, 35.0 + prn, true, true});
  }
  return sample;
}

/// Reports of the daemon, line by line, from a connection made as soon as it listens.
class Watcher {
 public:
  explicit Watcher(std::uint16_t port) : port_(port) {}
  ~Watcher() {
    if (socket_ >= 0) {
      ::close(socket_);
    }
  }
  Watcher(const Watcher&) = delete;
  Watcher& operator=(const Watcher&) = delete;

  std::vector<Json> reports() {
    if (socket_ < 0 && !connect()) {
      return {};
    }
    std::array<char, 8192> buffer{};
    for (ssize_t n = 0; (n = ::recv(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT)) > 0;) {
      text_.append(buffer.data(), static_cast<std::size_t>(n));
    }
    std::vector<Json> found;
    for (std::size_t end = 0; (end = text_.find('\n')) != std::string::npos;) {
      if (Json report = Json::parse(text_.substr(0, end), nullptr, false); report.is_object()) {
        found.push_back(std::move(report));
      }
      text_.erase(0, end + 1);
    }
    return found;
  }

 private:
  bool connect() {
    const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port_);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
      ::close(socket);
      return false;
    }
    socket_ = socket;
    const std::string watch = "?WATCH={\"enable\":true,\"json\":true};\n";
    return ::send(socket_, watch.data(), watch.size(), 0) == std::ssize(watch);
  }

  std::uint16_t port_;
  int socket_ = -1;
  std::string text_;
};

TEST(GpsdLive, FindsTheReceiverConfiguresItAndReportsTheTruth) {
  Line line;
  const Calendar calendar(UtcTime{2026, 6, 1, 8, 0, 0, 0});
  emulators::UbloxSettings settings;
  settings.baud = 38400;
  emulators::UbloxReceiver receiver(settings, calendar, line);
  const std::uint16_t port = test::free_port(SOCK_STREAM);
  const Daemon daemon(line.name(), port);
  Watcher watcher(port);

  bool fix_from_nmea = false;
  bool fix_from_ubx = false;
  bool leap_seconds = false;
  bool sky = false;
  std::string driver;
  std::string version;
  SimTime last_sample = kStart;
  const auto start = WallClock::now();
  const auto complete = [&] {
    return fix_from_nmea && fix_from_ubx && leap_seconds && sky &&
           version.find("PROTVER 14.00") != std::string::npos;
  };
  while (!complete() && WallClock::now() - start < test::kPatience) {
    ASSERT_TRUE(daemon.running()) << "gpsd is missing or has ended";
    const SimTime now = kStart + std::chrono::duration_cast<Duration>(WallClock::now() - start);
    for (SimTime due = receiver.sample_plan().next_after(last_sample); due <= now;
         due = receiver.sample_plan().next_after(last_sample)) {
      last_sample = due;
      receiver.update(truth_at(due));
    }
    receiver.receive(now, line.read());
    receiver.advance(now);
    line.write_due(now);
    for (const Json& report : watcher.reports()) {
      const std::string kind = report.value("class", "");
      if (kind == "DEVICE") {
        driver = report.value("driver", driver);
        version = report.value("subtype", version) + report.value("subtype1", std::string());
      } else if (kind == "DEVICES" && !report.at("devices").empty()) {
        driver = report.at("devices")[0].value("driver", driver);
      } else if (kind == "TPV" && report.value("mode", 0) == 3 && report.contains("lat")) {
        EXPECT_NEAR(report.at("lat").get<double>(), kLatitude_deg, 3e-7);
        EXPECT_NEAR(report.at("lon").get<double>(), kLongitude_deg, 3e-7);
        (driver == "u-blox" ? fix_from_ubx : fix_from_nmea) = true;
        leap_seconds |= report.value("leapseconds", 0) == 18;
        if (driver == "u-blox" && report.contains("altHAE")) {
          EXPECT_NEAR(report.at("altHAE").get<double>(), kHeight_m, 0.1);
        }
      } else if (kind == "SKY" && report.contains("satellites")) {
        sky |= report.at("satellites").size() == 10U;
      }
    }
    pollfd idle{-1, 0, 0};
    ::poll(&idle, 0, 2);
  }
  EXPECT_TRUE(fix_from_nmea);
  EXPECT_TRUE(fix_from_ubx);
  EXPECT_TRUE(leap_seconds);
  EXPECT_TRUE(sky);
  EXPECT_EQ(driver, "u-blox");
  EXPECT_NE(version.find("PROTVER 14.00"), std::string::npos) << version;
  EXPECT_EQ(receiver.counters().messages_lost, 0U);
}

}  // namespace
}  // namespace rigwire
