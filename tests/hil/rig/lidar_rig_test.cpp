// Lidars of a running rig: what comes over UDP, and that the stream follows the web interface.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <boost/asio/ip/tcp.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "drivers/udp_socket.h"
#include "hil/rig/rig.h"
#include "private_wires.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using Packet = std::vector<std::uint8_t>;

// Fields of the packets, read without our tables.
unsigned little16(const Packet& packet, std::size_t at) {
  return packet[at] + 256U * packet[at + 1];
}
unsigned azimuth(const Packet& packet, std::size_t block) {
  return little16(packet, 100 * block + 2);
}
bool sees_something(const Packet& packet) {
  for (std::size_t block = 0; block < 12; ++block) {
    for (std::size_t channel = 0; channel < 32; ++channel) {
      if (little16(packet, 100 * block + 4 + 3 * channel) != 0) {
        return true;
      }
    }
  }
  return false;
}

/// Whether some shot has two echoes, 1 m apart at least: blocks of a pair, or of halves in turn.
bool tells_two_echoes(const Packet& packet, std::size_t apart) {
  for (std::size_t block = 0; block + apart < 12; ++block) {
    if (block / apart % 2 != 0 || azimuth(packet, block) != azimuth(packet, block + apart)) {
      continue;
    }
    for (std::size_t channel = 0; channel < 32; ++channel) {
      const int one = static_cast<int>(little16(packet, 100 * block + 4 + 3 * channel));
      const int other = static_cast<int>(little16(packet, 100 * (block + apart) + 4 + 3 * channel));
      if (one != 0 && other != 0 && std::abs(one - other) > 250) {
        return true;
      }
    }
  }
  return false;
}

/// Whether a program of ours may send from that port.
bool may_bind(std::uint16_t port) {
  boost::asio::io_context io;
  try {
    const drivers::UdpSocket trial(
        io, {.bind = drivers::UdpEndpoint{"0.0.0.0", port}, .shares_source = true});
    return true;
  } catch (const drivers::EndpointError&) {
    return false;
  }
}

/// Where a datagram came from, and with what time to live.
struct Origin {
  int port = 0;
  int time_to_live = 0;
};

/// A socket of the system, for what ours do not tell.
class HeaderListener {
 public:
  explicit HeaderListener(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    const int on = 1;
    ::setsockopt(socket_, IPPROTO_IP, IP_RECVTTL, &on, sizeof(on));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  }
  ~HeaderListener() { ::close(socket_); }
  HeaderListener(const HeaderListener&) = delete;
  HeaderListener& operator=(const HeaderListener&) = delete;

  /// Origin of a datagram that is there.
  [[nodiscard]] Origin next() const {
    std::array<char, 2048> bytes{};
    alignas(cmsghdr) std::array<char, 64> control{};
    sockaddr_in from{};
    iovec piece{bytes.data(), bytes.size()};
    msghdr message{};
    message.msg_name = &from;
    message.msg_namelen = sizeof(from);
    message.msg_iov = &piece;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    Origin origin;
    if (::recvmsg(socket_, &message, MSG_DONTWAIT) < 0) {
      return origin;
    }
    origin.port = ntohs(from.sin_port);
    for (cmsghdr* head = CMSG_FIRSTHDR(&message); head != nullptr;
         head = CMSG_NXTHDR(&message, head)) {
      if (head->cmsg_level == IPPROTO_IP && head->cmsg_type == IP_TTL) {
        std::memcpy(&origin.time_to_live, CMSG_DATA(head), sizeof(int));
      }
    }
    return origin;
  }

 private:
  int socket_;
};

struct Listener {
  Listener(boost::asio::io_context& io, const std::string& address, std::uint16_t port)
      : socket(io, {.bind = drivers::UdpEndpoint{address, port}}) {
    socket.start([this](std::span<const std::uint8_t> bytes) {
      packets.emplace_back(bytes.begin(), bytes.end());
    });
  }
  drivers::UdpSocket socket;
  std::vector<Packet> packets;
};

/// A lidar 2 m above level ground, free-running.
class LidarRig : public ::testing::Test {
 protected:
  void build(const std::string& type, const std::string& more = "",
             const std::string& devices = "") {
    data.reset();
    position.reset();
    const auto file = wires.folder / "rig.yaml";
    std::ofstream(file) << "machine: {include: " RIGWIRE_SOURCE_DIR
                           "/configs/machines/gator_855d.yaml}\n"
                           "scene: {terrain: {type: level, size: 60 m, cell: 1 m}}\n"
                           "step: 2 ms\nslice: 10 ms\nlead: 10 ms\ndevices:\n"
                        << devices << "  lidar:\n    type: " << type << "\n    port: " << port()
                        << "\n"
                        << (type.starts_with("velodyne-hdl-64e")
                                ? ""
                                : "    position_port: " + std::to_string(port() + 1) + "\n")
                        << "    mount: {link: body, position: [0 m, 0 m, 2 m]}\n"
                        << more;
    rig = std::make_unique<Rig>(load_rig(file.string(), {}).configuration, io, TruthFiles{});
    data = std::make_unique<Listener>(io, "127.0.0.1", port());
    position = std::make_unique<Listener>(io, "127.0.0.1", port() + 1);
  }
  void build_with_web(const std::string& type, const std::string& more = "") {
    web_port = test::free_port(SOCK_STREAM);
    build(type, "    web: {port: " + std::to_string(web_port) + "}\n" + more);
  }
  [[nodiscard]] std::uint16_t port() const { return wires.lidar_port; }

  /// The packets of so much more time.
  const std::vector<Packet>& run(Duration duration) {
    data->packets.clear();
    position->packets.clear();
    const RunOutcome outcome = rig->executive().run_free(rig->executive().now() + duration);
    EXPECT_FALSE(outcome.fault.has_value());
    poll();
    return data->packets;
  }
  void poll() {
    io.restart();
    io.run_for(20ms);
  }
  std::string request(const std::string& method, const std::string& target,
                      const std::string& body = "") {
    boost::asio::ip::tcp::socket client(io);
    client.connect({boost::asio::ip::address_v4::loopback(), web_port});
    const std::string text = method + " " + target + " HTTP/1.1\r\nHost: lidar\r\n" +
                             "Connection: close\r\nContent-Length: " + std::to_string(body.size()) +
                             "\r\n\r\n" + body;
    boost::system::error_code error;
    client.write_some(boost::asio::buffer(text), error);
    std::string answer;
    std::array<char, 4096> piece{};
    client.non_blocking(true);
    for (int turn = 0; turn < 200 && error != boost::asio::error::eof; ++turn) {
      io.restart();
      io.run_for(5ms);
      const std::size_t size = client.read_some(boost::asio::buffer(piece), error);
      answer.append(piece.data(), size);
    }
    return answer;
  }
  void post(const std::string& target, const std::string& body) {
    EXPECT_THAT(request("POST", target, body), StartsWith("HTTP/1.1 204 ")) << body;
  }

  rigwire::test::PrivateWires wires;
  boost::asio::io_context io;
  std::uint16_t web_port = 0;
  std::unique_ptr<Rig> rig;
  std::unique_ptr<Listener> data;
  std::unique_ptr<Listener> position;
};

TEST_F(LidarRig, EveryModelStreams) {
  const std::pair<const char*, int> models[] = {
      {"velodyne-hdl-32e", 0x21}, {"velodyne-vlp-16", 0x22}, {"velodyne-puck-hi-res", 0x24},
      {"velodyne-vlp-32c", 0x28}, {"velodyne-hdl-64e", -1},  {"velodyne-hdl-64e-s3", -1},
      {"velodyne-vls-128", 0xA1}};
  for (const auto& [type, product] : models) {
    build(type);
    const std::vector<Packet>& packets = run(50ms);
    ASSERT_GT(packets.size(), 30U) << type;
    bool something = false;
    for (const Packet& packet : packets) {
      ASSERT_EQ(packet.size(), 1206U) << type;
      something = something || sees_something(packet);
      if (product >= 0) {
        EXPECT_EQ(packet[1205], product) << type;
      }
    }
    EXPECT_TRUE(something) << type;
    if (product >= 0) {
      ASSERT_FALSE(position->packets.empty()) << type;
      EXPECT_EQ(position->packets.front().size(), 512U);
    }
    rig.reset();
  }
}

TEST_F(LidarRig, StreamFollowsTheReturnMode) {
  build_with_web("velodyne-vlp-16");
  const std::size_t single = run(200ms).size();
  EXPECT_EQ(data->packets.back()[1204], 0x37);
  post("/cgi/setting", "returns=Dual");
  run(20ms);
  const std::vector<Packet>& packets = run(200ms);
  EXPECT_NEAR(static_cast<double>(packets.size()), 2.0 * static_cast<double>(single), 3.0);
  for (const Packet& packet : packets) {
    EXPECT_EQ(packet[1204], 0x39);
    for (std::size_t block = 0; block < 12; block += 2) {
      EXPECT_EQ(azimuth(packet, block), azimuth(packet, block + 1));
    }
  }
  EXPECT_THAT(request("GET", "/cgi/settings.json"), HasSubstr(R"("returns":"Dual")"));
}

TEST_F(LidarRig, StreamFollowsTheRotorSpeed) {
  build_with_web("velodyne-vlp-16");
  post("/cgi/setting", "rpm=1200");
  run(6s);
  const std::vector<Packet>& packets = run(300ms);
  double turned_deg = 0.0;
  for (std::size_t i = 1; i < packets.size(); ++i) {
    turned_deg += static_cast<double>(
                      (azimuth(packets[i], 0) + 36000U - azimuth(packets[i - 1], 0)) % 36000U) /
                  100.0;
  }
  const double seconds = static_cast<double>(packets.size() - 1) * 12 * 2 * 55.296e-6;
  EXPECT_NEAR(turned_deg / 360.0 / seconds * 60.0, 1200.0, 12.0);
  EXPECT_THAT(request("GET", "/cgi/status.json"), HasSubstr(R"("state":"On","rpm":)"));
}

TEST_F(LidarRig, StreamFollowsTheDestination) {
  build_with_web("velodyne-vlp-16");
  Listener other(io, "127.0.0.2", port());
  EXPECT_GT(run(50ms).size(), 30U);
  post("/cgi/setting/host", "addr=127.0.0.2");
  EXPECT_LT(run(50ms).size(), 3U);
  EXPECT_GT(other.packets.size(), 30U);
  const std::uint16_t moved = test::free_port(SOCK_DGRAM);
  Listener third(io, "127.0.0.2", moved);
  post("/cgi/setting/host", "dport=" + std::to_string(moved));
  run(50ms);
  EXPECT_GT(third.packets.size(), 30U);
}

TEST_F(LidarRig, DestinationOutsideThisMachineIsRefused) {
  build_with_web("velodyne-vlp-16");
  EXPECT_THAT(request("POST", "/cgi/setting/host", "addr=192.0.2.1"),
              AllOf(StartsWith("HTTP/1.1 403 "), HasSubstr("allow_remote")));
  EXPECT_GT(run(50ms).size(), 30U);
  EXPECT_THAT(request("GET", "/cgi/settings.json"), HasSubstr(R"("addr":"127.0.0.1")"));
}

TEST_F(LidarRig, StreamFollowsTheLaser) {
  build_with_web("velodyne-vlp-16");
  run(150ms);
  EXPECT_TRUE(std::ranges::any_of(data->packets, sees_something));
  post("/cgi/setting", "laser=off");
  run(50ms);
  run(150ms);
  EXPECT_FALSE(std::ranges::any_of(data->packets, sees_something));
  EXPECT_THAT(request("GET", "/cgi/status.json"), HasSubstr(R"("laser":{"state":"Off"})"));
}

TEST_F(LidarRig, StreamFollowsTheFieldOfView) {
  build_with_web("velodyne-vlp-16");
  post("/cgi/setting/fov", "start=350&end=29");
  run(100ms);
  const std::vector<Packet>& packets = run(500ms);
  EXPECT_GT(packets.size(), 20U);
  for (const Packet& packet : packets) {
    for (std::size_t block = 0; block < 12; ++block) {
      const unsigned at = (azimuth(packet, block) + 1000U) % 36000U;
      EXPECT_LT(at, 4000U + 20U);  // 40 degrees, and the second firing of a block
    }
  }
}

TEST_F(LidarRig, NonsenseLeavesTheStreamAsItWas) {
  build_with_web("velodyne-vlp-16");
  const std::string before = request("GET", "/cgi/settings.json");
  for (const char* body : {"rpm=601", "returns=Some", "laser", "%%%", "a=b&c=d"}) {
    EXPECT_THAT(request("POST", "/cgi/setting", body), StartsWith("HTTP/1.1 400 ")) << body;
  }
  EXPECT_EQ(request("GET", "/cgi/settings.json"), before);
  EXPECT_GT(run(50ms).size(), 30U);
}

TEST_F(LidarRig, ResetBringsTheSavedSettingsBackAfterASilence) {
  build_with_web("velodyne-vlp-16", "    start_up: 300 ms\n");
  EXPECT_TRUE(run(250ms).empty());
  EXPECT_THAT(request("GET", "/cgi/info.json"), StartsWith("HTTP/1.1 503 "));
  run(200ms);
  post("/cgi/setting", "returns=Last");
  post("/cgi/save", "data=submit");
  post("/cgi/setting", "returns=Strongest");
  post("/cgi/reset", "data=reset_system");
  EXPECT_LT(run(250ms).size(), 3U);
  EXPECT_GT(run(250ms).size(), 30U);
  EXPECT_EQ(data->packets.back()[1204], 0x38);
}

TEST_F(LidarRig, HousingsMotionIsInThePositionPackets) {
  build("velodyne-hdl-32e");
  run(3s);  // the vehicle comes to rest on its springs
  ASSERT_FALSE(position->packets.empty());
  const Packet& packet = position->packets.back();
  // First group, second accelerometer: upward by default; 0.001221 g a count.
  EXPECT_NEAR(little16(packet, 14 + 6), 1.0 / 0.001221, 10.0);
  EXPECT_EQ(packet[202], 2) << "locked";
}

TEST_F(LidarRig, LidarWithoutTimeSourceHearsNoPulse) {
  build("velodyne-vlp-16", "    time_source: none\n");
  run(1500ms);
  ASSERT_FALSE(position->packets.empty());
  EXPECT_EQ(position->packets.back()[202], 0);
  EXPECT_EQ(position->packets.back()[206], 0) << "no sentence";
}

TEST_F(LidarRig, NamedReceiverLocksTheClockAfterItsFix) {
  const std::string receiver = "  antenna: {type: ublox-neo-7p, time_to_first_fix: 1 s, path: " +
                               (wires.folder / "gnss").string() +
                               ", mount: {link: body, position: [0.8 m, 0 m, 2.5 m]}}\n";
  build("velodyne-vlp-16", "    time_source: antenna\n    clock: {pulse_qualifier_delay: 1 s}\n",
        receiver);
  run(500ms);
  EXPECT_EQ(position->packets.back()[202], 0);
  run(6s);
  EXPECT_EQ(position->packets.back()[202], 2);
  const Packet& packet = position->packets.back();
  EXPECT_THAT(std::string(packet.begin() + 206, packet.begin() + 280), StartsWith("$GPRMC,08000"));
}

TEST_F(LidarRig, SourceAddressIsTheSensors) {
  build("velodyne-vlp-16", "    source_address: 127.0.0.201\n    source_ports: model\n");
  data.reset();  // makes room for a socket that only hears that address and port
  drivers::UdpSocket picky(io, {.destination = drivers::UdpEndpoint{"127.0.0.201", port()},
                                .bind = drivers::UdpEndpoint{"127.0.0.1", port()}});
  int heard = 0;
  picky.start([&](std::span<const std::uint8_t>) { ++heard; });
  rig->executive().run_free(kStart + 50ms);
  poll();
  EXPECT_GT(heard, 30);
}

TEST_F(LidarRig, HdlSendsFromItsOwnPortWhereItMayAndSaysSoWhereNot) {
  for (const char* type : {"velodyne-hdl-32e", "velodyne-hdl-64e-s3"}) {
    build(type);
    data.reset();
    const HeaderListener listener(port());
    rig->executive().run_free(kStart + 50ms);
    poll();
    const Origin origin = listener.next();
    if (may_bind(443)) {
      EXPECT_EQ(origin.port, 443) << type;
      EXPECT_THAT(rig->wires(), ::testing::IsEmpty()) << type;
    } else {
      EXPECT_GT(origin.port, 0) << type << ": the run goes on";
      EXPECT_THAT(rig->wires(), ::testing::ElementsAre(HasSubstr("not from 443"))) << type;
    }
    EXPECT_EQ(origin.time_to_live, 128) << type;
    rig.reset();
  }
}

TEST_F(LidarRig, VlpLeavesItsPortToAClientOnThisMachineAndSaysSo) {
  build("velodyne-vlp-16");
  data.reset();
  const HeaderListener listener(port());
  rig->executive().run_free(kStart + 50ms);
  poll();
  const Origin origin = listener.next();
  EXPECT_NE(origin.port, port());
  EXPECT_EQ(origin.time_to_live, 255);
  EXPECT_THAT(rig->wires(),
              ::testing::ElementsAre(AllOf(StartsWith("lidar: "), HasSubstr("listens there"))));
}

TEST_F(LidarRig, DualReturnOfBeamsWithoutWidthIsRefusedWhileItRuns) {
  build_with_web("velodyne-vlp-16", "    sensor: {sub_rays: 1}\n");
  EXPECT_THAT(request("POST", "/cgi/setting", "returns=Dual"),
              AllOf(StartsWith("HTTP/1.1 403 "), HasSubstr("sub_rays")));
  EXPECT_THAT(request("GET", "/cgi/settings.json"), HasSubstr(R"("returns":"Strongest")"));
}

TEST_F(LidarRig, WebInterfaceDoesNotNameAServerThatTheSensorIsNot) {
  build_with_web("velodyne-vlp-16");
  EXPECT_THAT(request("GET", "/cgi/info.json"), ::testing::Not(HasSubstr("Server:")));
}

TEST(LidarPark, AllModelsStreamAtOnce) {
  const std::vector<std::string> lidars{"hdl_32e", "hdl_64e", "puck_hi_res",
                                        "vlp_16",  "vlp_32c", "vls_128"};
  const rigwire::test::PrivateWires wires;
  boost::asio::io_context io;
  std::vector<std::string> sets{"devices.gnss.path=" + wires.gnss()};
  std::vector<std::unique_ptr<Listener>> listeners;
  const auto set_port = [&](const std::string& lidar, const std::string& key, int type) {
    const std::uint16_t port = test::free_port(type);
    sets.push_back("devices." + lidar + "." + key + "=" + std::to_string(port));
    return port;
  };
  for (const std::string& lidar : lidars) {
    const std::uint16_t port = set_port(lidar, "port", SOCK_DGRAM);
    listeners.push_back(std::make_unique<Listener>(io, "127.0.0.1", port));
    if (lidar != "hdl_64e") {
      set_port(lidar, "position_port", SOCK_DGRAM);
      if (lidar != "hdl_32e") {
        set_port(lidar, "web.port", SOCK_STREAM);
      }
    }
  }
  Rig rig(load_rig(RIGWIRE_SOURCE_DIR "/configs/rigs/lidar_park.yaml", sets).configuration, io, {});
  EXPECT_FALSE(rig.executive().run_free(kStart + 100ms).fault.has_value());
  io.restart();
  io.run_for(20ms);
  for (std::size_t i = 0; i < lidars.size(); ++i) {
    const auto& packets = listeners[i]->packets;
    EXPECT_GT(packets.size(), 60U) << lidars[i];
    EXPECT_TRUE(std::ranges::any_of(packets, sees_something)) << lidars[i];
    if (lidars[i] == "puck_hi_res" || lidars[i] == "vlp_32c" || lidars[i] == "hdl_64e") {
      const std::size_t apart = lidars[i] == "hdl_64e" ? 2 : 1;
      EXPECT_TRUE(std::ranges::any_of(
          packets, [&](const Packet& packet) { return tells_two_echoes(packet, apart); }))
          << lidars[i] << " shows both echoes";
    }
  }
  const RigStatus status = rig.status();
  for (const DeviceStatus& device : status.devices) {
    EXPECT_EQ(device.dropped, 0U) << device.name;
  }
}

}  // namespace
}  // namespace rigwire::hil
