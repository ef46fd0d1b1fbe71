// A rig with one camera, and a client of the test's own in the same thread: what it has sent before
// the run begins is heard after the first slice, so that free runs can be compared.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "drivers/udp_port.h"
#include "emulators/gige_camera/camera_features.h"
#include "hil/rig/rig.h"
#include "private_wires.h"
#include "protocols/gige_vision/bootstrap.h"
#include "protocols/gige_vision/gvcp.h"

namespace rigwire::hil {

namespace gev = protocols::gige_vision;
namespace boot = protocols::gige_vision::bootstrap;
namespace reg = emulators::camera_register;

inline constexpr std::uint32_t kHere = 0x7F00'0001;

/// An address of 127.9.0.0/16 that another test beside this one does not have.
inline std::uint32_t number(unsigned last) {
  return 0x7F09'0000 + (static_cast<std::uint32_t>(::getpid()) % 250U << 8U) + last;
}
inline std::string address_of(unsigned last) {
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
  void open(const std::vector<std::string>& sets = {}, const TruthFiles& truth = {}) {
    rig.reset();
    next_ = 1;
    rig = std::make_unique<Rig>(load_rig(file, sets).configuration, io, truth);
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

  rigwire::test::PrivateWires wires;
  std::string file = (wires.folder / "rig.yaml").string();
  boost::asio::io_context io;
  std::unique_ptr<Rig> rig;
  drivers::UdpPort client{io, {.address = kHere}};
  drivers::UdpPort sink{io, {.address = kHere}};
  std::uint16_t next_ = 1;
};

}  // namespace rigwire::hil
