// Base stations of a running rig: lines to rovers, a caster, and what a wrong name of them gets.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>

#include "drivers/serial_port.h"
#include "hil/rig/rig.h"
#include "private_wires.h"
#include "protocols/rtcm3/message.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using boost::asio::ip::tcp;
using ::testing::HasSubstr;

class BaseStationRig : public ::testing::Test {
 protected:
  void build(const std::string& devices) {
    const auto file = wires.folder / "rig.yaml";
    std::ofstream(file) << "machine: {include: " RIGWIRE_SOURCE_DIR
                           "/configs/machines/gator_855d.yaml}\n"
                           "scene: {terrain: {type: level, size: 60 m, cell: 1 m}}\n"
                           "step: 10 ms\nslice: 100 ms\nlead: 100 ms\n"
                           "start: 2026-06-01T08:00:00Z\ndevices:\n"
                        << devices;
    rig = std::make_unique<Rig>(load_rig(file.string(), {}).configuration, io, TruthFiles{});
  }
  [[nodiscard]] std::string rover(const std::string& name, const std::string& from) const {
    return "  " + name + ":\n    type: ublox-zed-f9p\n    path: " + (wires.folder / name).string() +
           "\n    baud: 115200\n    nmea_sentences: [GGA]\n    mount: {link: body, position: [0.8 "
           "m, 0.5 m, 1.95 m]}\n" +
           (from.empty() ? "" : "    corrections_from: " + from + "\n    uart2_baud: 115200\n");
  }
  void run(SimTime until) {
    io.restart();
    io.run_for(20ms);
    EXPECT_FALSE(rig->executive().run_free(until).fault.has_value());
    io.restart();
    io.run_for(20ms);
  }

  rigwire::test::PrivateWires wires;
  boost::asio::io_context io;
  std::unique_ptr<Rig> rig;
};

const std::string kBase = "  base: {type: gnss-base, position: [300 m, 0 m, 5 m], station: 9}\n";

TEST_F(BaseStationRig, RoverOnItsLineFloatsAndTheOtherDoesNot) {
  build(kBase + rover("wired", "base") + rover("alone", ""));
  std::string wired;
  std::string alone;
  const auto listen = [&](const std::string& name, std::string& heard) {
    auto port = std::make_unique<drivers::SerialPort>(
        io, drivers::SerialPortSettings{.path = (wires.folder / name).string(), .baud = 115'200});
    port->start([&heard](std::span<const std::uint8_t> bytes) {
      heard.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    });
    return port;
  };
  const auto first = listen("wired", wired);
  const auto second = listen("alone", alone);
  run(kStart + 10s);
  EXPECT_THAT(wired, ::testing::ContainsRegex(R"(,[EW],5,[0-9]*,[0-9.]*,[^*]*,0009\*)"));
  EXPECT_THAT(alone, ::testing::ContainsRegex(R"(,[EW],1,)"));
  EXPECT_THAT(alone, ::testing::Not(::testing::ContainsRegex(R"(,[EW],[245],)")));
}

TEST_F(BaseStationRig, CasterHandsItsFramesToAClient) {
  const std::uint16_t port =
      tcp::acceptor(io, {boost::asio::ip::address_v4::loopback(), 0}).local_endpoint().port();
  build(kBase + "  caster:\n    type: ntrip-caster\n    port: " + std::to_string(port) +
        "\n    mounts: [{name: BASE, from: base}]\n");
  tcp::socket client(io);
  client.connect({boost::asio::ip::address_v4::loopback(), port});
  boost::asio::write(client, boost::asio::buffer(std::string("GET /BASE HTTP/1.0\r\n\r\n")));
  run(kStart + 5s);
  std::string heard(65'536, '\0');
  client.non_blocking(true);
  heard.resize(client.read_some(boost::asio::buffer(heard)));
  ASSERT_TRUE(heard.starts_with("ICY 200 OK\r\n"));
  int places = 0;
  int observations = 0;
  for (std::size_t at = 12; at < heard.size();) {
    const auto rest =
        std::span(reinterpret_cast<const std::uint8_t*>(heard.data()), heard.size()).subspan(at);
    const auto frame = protocols::rtcm3::decode_frame(rest);
    ASSERT_TRUE(frame.ok()) << "every byte belongs to a frame";
    places += frame->message() == 1005 ? 1 : 0;
    observations += frame->message() == 1077 ? 1 : 0;
    at += frame.consumed();
  }
  EXPECT_GE(places, 4);
  EXPECT_EQ(places, observations);
}

TEST_F(BaseStationRig, NamesThatAreNoBaseStationAreRefused) {
  const auto refused = [this](const std::string& devices) {
    try {
      build(devices);
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refused(rover("a", "nobody")), HasSubstr("devices.a.corrections_from"));
  EXPECT_THAT(refused(rover("a", "a")), HasSubstr("no such base station"));
  EXPECT_THAT(refused("  c: {type: ntrip-caster, mounts: [{from: x}]}\n"),
              HasSubstr("devices.c.mounts.0.from"));
  EXPECT_THAT(refused("  c: {type: ntrip-caster, mounts: [{name: a b, from: x}]}\n"),
              HasSubstr("without space"));
  EXPECT_THAT(refused("  g: {type: ublox-neo-m8t, sensor: {corrections: {kind: rtk}}}\n"),
              HasSubstr("assumed_rtk"));
}

}  // namespace
}  // namespace rigwire::hil
