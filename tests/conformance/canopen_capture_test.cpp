// tshark's CANopen dissector, which shares no table with us, reads an encoder's whole life:
// boot-up, SDO transfers with their aborts, network management, position PDOs and an emergency.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "emulators/canopen/rotary_encoder.h"
#include "j1939_capture.h"
#include "protocols/canopen/identifiers.h"

namespace rigwire::emulators {
namespace {

using testing::HasSubstr;
namespace canopen = protocols::canopen;

constexpr std::uint8_t kNode = 0x20;

/// One line per frame: the fields asked for, separated by commas.
std::string dissect(const std::filesystem::path& file, const std::string& fields) {
  const std::string command = "tshark -r '" + file.string() +
                              "' -d can.subdissector,canopen -T fields -E separator=, " + fields +
                              " 2>&1";
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> piece{};
  while (pipe != nullptr &&
         std::fgets(piece.data(), static_cast<int>(piece.size()), pipe) != nullptr) {
    text += piece.data();
  }
  EXPECT_EQ(pipe == nullptr ? -1 : pclose(pipe), 0) << text;
  return text;
}

/// Both directions in one capture, as a listener on the bus has them.
struct Client {
  Client(RotaryEncoder& of, CanCapture& into) : encoder(of), capture(into) {}
  void send(SimTime now, const protocols::can::Frame& frame) {
    capture.send(now, frame);
    encoder.receive(now, frame);
  }
  void request(SimTime now, const canopen::SdoPayload& payload) {
    send(now, canopen::make_frame(canopen::kSdoRequestBase + kNode, payload));
  }
  RotaryEncoder& encoder;
  CanCapture& capture;
};

TEST(CanopenConformance, DissectorReadsWhatTheEncoderSays) {
  const auto file = std::filesystem::temp_directory_path() /
                    ("rigwire_canopen_" + std::to_string(getpid()) + ".pcap");
  CanCapture capture(file);
  RotaryEncoderSettings settings;
  settings.node.node_id = kNode;
  settings.counter_clockwise = true;
  VolatileMemory memory;
  RotaryEncoder encoder(settings, memory, capture);
  Client client(encoder, capture);
  encoder.update({kStart, std::numbers::pi / 2.0, 0.0});  // 2048 of 8192 steps
  encoder.advance(kStart + 300ms);
  client.request(kStart + 310ms, canopen::make_upload({0x6501, 0}));
  client.request(kStart + 320ms, canopen::make_upload({0x6005, 0}));
  client.send(kStart + 330ms,
              canopen::make_network_request({canopen::NetworkCommand::start, kNode}));
  encoder.advance(kStart + 345ms);
  encoder.update({kStart + 346ms, std::numeric_limits<double>::quiet_NaN(), 0.0});
  capture.close();
  const std::string text =
      dissect(file,
              "-e canopen.cob_id -e canopen.function_code -e canopen.nmt_guard.state"
              " -e canopen.sdo.main_idx -e canopen.sdo.data.bytes -e canopen.sdo.abort_code"
              " -e canopen.nmt_ctrl.cd -e canopen.pdo.data.bytes -e canopen.em.err_code");
  std::filesystem::remove(file);
  EXPECT_THAT(text, HasSubstr("0x00000720,0x0000000e,0x00,,,,,,\n"));              // boot-up
  EXPECT_THAT(text, HasSubstr("0x000005a0,0x0000000b,,0x6501,00200000,,,,\n"));    // 8192
  EXPECT_THAT(text, HasSubstr("0x000005a0,0x0000000b,,0x6005,,0x06020000,,,\n"));  // no object
  EXPECT_THAT(text, HasSubstr("0x00000000,0x00000000,,,,,0x01,,\n"));              // start
  EXPECT_THAT(text, HasSubstr("0x000001a0,0x00000003,,,,,,00080000,\n"));          // 2048
  EXPECT_THAT(text, HasSubstr("0x000000a0,0x00000001,,,,,,,0x5000\n"));            // emergency
}

}  // namespace
}  // namespace rigwire::emulators
