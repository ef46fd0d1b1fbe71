// Cameras of a running rig, with a client of our own in the same thread: what it has sent before
// the run begins is heard after the first slice, so that free runs can be compared.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "drivers/udp_port.h"
#include "emulators/gige_camera/camera_features.h"
#include "hil/rig/rig.h"
#include "private_wires.h"
#include "protocols/bytes.h"
#include "protocols/gige_vision/bootstrap.h"
#include "protocols/gige_vision/gvcp.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
namespace gev = protocols::gige_vision;
namespace boot = protocols::gige_vision::bootstrap;
namespace reg = emulators::camera_register;

constexpr std::uint32_t kHere = 0x7F00'0001;

/// An address of 127.9.0.0/16 that another test beside this one does not have.
std::uint32_t number(unsigned last) {
  return 0x7F09'0000 + (static_cast<std::uint32_t>(::getpid()) % 250U << 8U) + last;
}
std::string address_of(unsigned last) {
  return emulators::address_text(number(last));
}

class CameraRig : public ::testing::Test {
 protected:
  void write(const std::string& keys) {
    std::ofstream(file) << "seed: 5\nmachine: {include: " RIGWIRE_SOURCE_DIR
                           "/configs/machines/gator_855d.yaml}\n"
                           "scene:\n  terrain: {type: level, size: 60 m, cell: 1 m}\n"
                           "  boxes: [{position: [8 m, 1 m, 0 m], size: [2 m, 3 m, 2 m]}]\n"
                           "devices:\n  eye:\n    type: gige-camera\n    address: "
                        << address_of(2)
                        << "\n"
                           "    exposure_auto: true\n"
                           "    mount: {link: body, position: [1.5 m, 0 m, 1.9 m]}\n"
                        << keys;
  }
  void open(const std::vector<std::string>& sets = {}) {
    rig.reset();
    next_ = 1;
    rig = std::make_unique<Rig>(load_rig(file, sets).configuration, io, TruthFiles{});
  }
  void ask(unsigned camera, const gev::GvcpPacket& packet) {
    ASSERT_TRUE(client.send({number(camera), gev::kGvcpPort}, packet.view(), false));
  }
  void set(unsigned camera, std::uint32_t address, std::uint32_t value) {
    const gev::RegisterValue one{address, value};
    ask(camera, gev::encode_write_registers(next_++, {&one, 1}));
  }
  void start_streaming() {
    set(2, boot::kControlPrivilege, 2);
    set(2, boot::kHeartbeatTimeout, 3'600'000);
    set(2, boot::kStreamDestination, kHere);
    set(2, boot::kStreamPort, sink.local_port());
    set(2, reg::kAcquisitionStart, 1);
  }
  [[nodiscard]] std::map<std::string, std::uint64_t> counts() const {
    std::map<std::string, std::uint64_t> all;
    const std::vector<DeviceReport> reports = rig->device_reports();
    for (const NamedCount& counted : reports.at(0).counts) {
      all.emplace(counted.name, counted.count);
    }
    return all;
  }

  test::PrivateWires wires;
  std::string file = (wires.folder / "rig.yaml").string();
  boost::asio::io_context io;
  std::unique_ptr<Rig> rig;
  drivers::UdpPort client{io, {.address = kHere}};
  drivers::UdpPort sink{io, {.address = kHere}};
  std::uint16_t next_ = 1;
};

TEST_F(CameraRig, free_runs_send_the_same_bytes_whatever_the_threads) {
  write("    sensor: {image_sensor: {width: 160, height: 120}, samples: 2}\n");
  std::vector<std::uint64_t> hashes;
  for (const char* threads : {"1", "1", "3"}) {
    open({std::string("devices.eye.sensor.threads=") + threads});
    start_streaming();
    rig->executive().run_free(kStart + 1s);
    EXPECT_GE(counts().at("pictures"), 17U);
    EXPECT_EQ(counts().at("skipped_pictures"), 0U);
    hashes.push_back(rig->device_reports().at(0).statistics.hash.value());
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
  // Another seed, other noise.
  open({"seed=6"});
  start_streaming();
  rig->executive().run_free(kStart + 1s);
  EXPECT_NE(rig->device_reports().at(0).statistics.hash.value(), hashes[0]);
}

TEST_F(CameraRig, paced_run_skips_and_counts_what_it_cannot_render) {
  // Some seconds of work for each.
  write("    processing: 10 ms\n    sensor: {samples: 20}\n");
  open();
  start_streaming();
  const RunOutcome outcome = rig->executive().run_paced({}, kStart + 1500ms);
  EXPECT_FALSE(outcome.fault);
  EXPECT_EQ(counts().at("pictures"), 0U);
  EXPECT_GE(counts().at("skipped_pictures"), 10U);
  EXPECT_GE(rig->status().devices.at(0).dropped, 10U);
}

TEST_F(CameraRig, told_another_address_it_moves_there_and_tells_what_was_asked_last) {
  write("");
  open();
  std::vector<drivers::DatagramPort::Peer> heard;
  client.start([&](const drivers::DatagramPort::Peer& from, std::span<const std::uint8_t>) {
    heard.push_back(from);
  });
  // The camera's own, which has the bytes of its address.
  const gev::MacAddress mac{0x02, 0x52, 127, 9, static_cast<std::uint8_t>(number(2) >> 8U), 2};
  ask(2, gev::encode_force_ip(next_++, {.mac = mac, .address = number(7), .mask = 0xFF000000}));
  rig->executive().run_free(kStart + 50ms);
  const std::array<std::uint32_t, 1> address{boot::kCurrentAddress};
  ask(7, gev::encode_read_registers(next_++, address));
  rig->executive().run_free(kStart + 100ms);
  ASSERT_EQ(heard.size(), 2U);
  EXPECT_EQ(heard[1], (drivers::DatagramPort::Peer{number(7), gev::kGvcpPort}));
  EXPECT_EQ(rig->status().devices.at(0).wire, "udp " + address_of(7) + ":3956");
  ASSERT_TRUE(rig->status().devices.at(0).last_request);
  EXPECT_EQ(rig->status().devices.at(0).last_request->text, "ReadReg 0x0024");
  // Where somebody else is it cannot go.
  const drivers::UdpPort other(io, {.address = number(8), .port = gev::kGvcpPort});
  ask(7, gev::encode_force_ip(next_++, {.mac = mac, .address = number(8), .mask = 0xFF000000}));
  rig->executive().run_free(kStart + 150ms);
  EXPECT_EQ(rig->status().devices.at(0).wire, "udp " + address_of(7) + ":3956");
  ask(7, gev::encode_read_registers(next_++, address));
  heard.clear();
  rig->executive().run_free(kStart + 200ms);
  EXPECT_EQ(heard.size(), 1U);
}

TEST_F(CameraRig, settings_file_keeps_the_name_that_a_client_gave) {
  write("    user_name: old\n    settings_file: " + (wires.folder / "eye.bin").string() + "\n");
  std::string name;
  client.start([&](const drivers::DatagramPort::Peer&, std::span<const std::uint8_t> datagram) {
    const auto acknowledge = gev::decode_acknowledge(datagram);
    ASSERT_TRUE(acknowledge.ok());
    if (const auto content = gev::decode_memory(*acknowledge);
        content.ok() && !content->bytes.empty()) {
      name.assign(content->bytes.begin(), std::ranges::find(content->bytes, std::uint8_t{0}));
    }
  });
  open();
  ask(2, gev::encode_read_memory(next_++, boot::kUserDefinedName, 16));
  rig->executive().run_free(kStart + 20ms);
  EXPECT_EQ(name, "old");
  std::array<std::uint8_t, 16> fresh{'n', 'e', 'w'};
  set(2, boot::kControlPrivilege, 2);
  ask(2, gev::encode_write_memory(next_++, boot::kUserDefinedName, fresh));
  rig->executive().run_free(kStart + 40ms);
  open();
  ask(2, gev::encode_read_memory(next_++, boot::kUserDefinedName, 16));
  rig->executive().run_free(kStart + 20ms);
  EXPECT_EQ(name, "new");
}

}  // namespace
}  // namespace rigwire::hil
