// RTKLIB's real-time program, unmodified, on a running rig: the rover's raw measurements come over
// its line, the base station's corrections from the caster by way of str2str (rtkrcv 2.4.3 b34 of
// Debian takes its own NTRIP client for FTP). What it solves is where the rover stands.
//
// It resolves weeks by the host's clock, so the rig begins at the host's time.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

#include "child_process.h"
#include "private_wires.h"
#include "sim/samples/calendar.h"

namespace rigwire {
namespace {

using namespace std::chrono_literals;
using boost::asio::ip::tcp;
using test::ChildProcess;
using test::eventually;

class RtkrcvLive : public testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const {
    return (wires_.folder / name).string();
  }
  /// The host's UTC, for the rig's file.
  [[nodiscard]] static std::string host_time() {
    const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
    const auto day = std::chrono::floor<std::chrono::days>(now);
    const std::chrono::year_month_day date{day};
    const std::chrono::hh_mm_ss time{now - day};
    return format_utc({static_cast<int>(date.year()),
                       static_cast<std::int32_t>(static_cast<unsigned>(date.month())),
                       static_cast<std::int32_t>(static_cast<unsigned>(date.day())),
                       static_cast<std::int32_t>(time.hours().count()),
                       static_cast<std::int32_t>(time.minutes().count()),
                       static_cast<std::int32_t>(time.seconds().count()), 0});
  }
  void write_rig(std::uint16_t caster) const {
    std::ofstream(file("rig.yaml"))
        << "machine: {include: " RIGWIRE_SOURCE_DIR
           "/configs/machines/gator_855d.yaml}\n"
           "scene: {terrain: {type: level, size: 60 m, cell: 1 m}}\n"
           "start: "
        << host_time()
        << "\ndevices:\n"
           "  base:\n"
           "    type: gnss-base\n"
           "    position: [300 m, 40 m, 5 m]\n"
           "    station: 9\n"
           "    messages: [RTCM-1005, RTCM-1077, RTCM-1087, RTCM-1097, RTCM-1127, RTCM-1230]\n"
           "  caster:\n"
           "    type: ntrip-caster\n"
           "    port: "
        << caster
        << "\n    user: rover\n    password: secret\n"
           "    mounts: [{name: BASE, from: base}]\n"
           "  gnss:\n"
           "    type: ublox-zed-f9p\n"
           "    path: "
        << file("gnss")
        << "\n    baud: 230400\n    nmea_sentences: []\n"
           "    ubx_messages: [RXM-RAWX, RXM-SFRBX]\n"
           "    mount: {link: body, position: [0.8 m, 0.5 m, 1.95 m]}\n";
  }
  void write_options(std::uint16_t corrections) const {
    std::ofstream(file("rtkrcv.conf"))
        // A path below /dev, with speed and framing.
        << "inpstr1-type=serial\ninpstr1-path=.." << file("gnss")
        << ":230400:8:n:1:off\ninpstr1-format=ubx\n"
           "inpstr2-type=tcpcli\ninpstr2-path=127.0.0.1:"
        << corrections
        << "\ninpstr2-format=rtcm3\ninpstr2-nmeareq=off\n"
           "outstr1-type=file\noutstr1-path="
        << file("fixes.pos")
        << "\noutstr1-format=enu\noutstr2-type=off\n"
           "pos1-posmode=kinematic\npos1-frequency=l1+2\npos1-navsys=61\npos1-elmask=10\n"
           "pos1-ionoopt=brdc\npos1-tropopt=saas\npos2-armode=continuous\npos2-gloarmode=off\n"
           "ant2-postype=rtcm\nout-outhead=off\nmisc-svrcycle=50\n";
  }
  struct Fix {
    Eigen::Vector3d baseline_m;
    int quality = 0;
  };
  [[nodiscard]] std::vector<Fix> fixes() const {
    std::vector<Fix> found;
    std::ifstream lines(file("fixes.pos"));
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string date;
      std::string time;
      Fix fix;
      words >> date >> time >> fix.baseline_m.x() >> fix.baseline_m.y() >> fix.baseline_m.z() >>
          fix.quality;
      if (words && line[0] != '%') {
        found.push_back(fix);
      }
    }
    return found;
  }

  test::PrivateWires wires_;
  boost::asio::io_context io_;
};

TEST_F(RtkrcvLive, FixesOnWhatTheBaseStationSendsThroughTheCaster) {
  const std::uint16_t caster = test::free_port(SOCK_STREAM);
  const std::uint16_t corrections = test::free_port(SOCK_STREAM);
  const std::uint16_t console = test::free_port(SOCK_STREAM);
  write_rig(caster);
  write_options(corrections);
  // Three times as fast: the program takes time from the measurements.
  ChildProcess rig({RIGWIRE_BINARY_DIR "/rigwire", "run", file("rig.yaml"), "--status", "none",
                    "--clock", "scaled:3"},
                   file("rig.log"));
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(file("gnss")); })) << rig.output();
  ChildProcess str2str(
      {"str2str", "-in", "ntrip://rover:secret@127.0.0.1:" + std::to_string(caster) + "/BASE",
       "-out", "tcpsvr://:" + std::to_string(corrections)},
      file("str2str.log"));
  // It leaves files where it is. With -s and no terminal it crashes, so it is told to start.
  ChildProcess rtkrcv({"sh", "-c",
                       "cd " + wires_.folder.string() + " && exec rtkrcv -p " +
                           std::to_string(console) + " -w '' -o rtkrcv.conf"},
                      file("rtkrcv.log"));
  tcp::socket terminal(io_);
  ASSERT_TRUE(eventually([&] {
    boost::system::error_code failed;
    terminal.close(failed);
    terminal.connect({boost::asio::ip::address_v4::loopback(), console}, failed);
    return !failed;
  })) << rtkrcv.output();
  boost::asio::write(terminal, boost::asio::buffer(std::string("start\r\n")));

  // Navigation messages come satellite by satellite. An epoch with few of them can be fixed on
  // wrong integers, as in the field: the first ones are not judged.
  constexpr std::size_t kFirst = 10;
  constexpr std::size_t kJudged = 15;
  std::vector<Fix> fixed;
  EXPECT_TRUE(eventually([&] {
    fixed = fixes();
    std::erase_if(fixed, [](const Fix& fix) { return fix.quality != 1; });
    return fixed.size() >= kFirst + kJudged;
  })) << "fixed "
      << fixed.size() << " of " << fixes().size() << " epochs; " << rtkrcv.output()
      << str2str.output() << rig.output();
  ASSERT_GE(fixed.size(), kFirst + kJudged);
  fixed.erase(fixed.begin(), fixed.end() - kJudged);
  // The machine stands level at the origin; its springs give by centimetres.
  const Eigen::Vector3d mean =
      std::accumulate(fixed.begin(), fixed.end(), Eigen::Vector3d(Eigen::Vector3d::Zero()),
                      [](const Eigen::Vector3d& sum, const Fix& fix) -> Eigen::Vector3d {
                        return sum + fix.baseline_m;
                      }) /
      static_cast<double>(fixed.size());
  EXPECT_NEAR(mean.x(), 0.8 - 300.0, 0.06);
  EXPECT_NEAR(mean.y(), 0.5 - 40.0, 0.06);
  EXPECT_NEAR(mean.z(), 1.95 - 5.0, 0.6) << "the body's origin is above the ground";
  for (const Fix& fix : fixed) {
    EXPECT_LT((fix.baseline_m - mean).norm(), 0.03);
  }
}

}  // namespace
}  // namespace rigwire
