// Cameras of a running rig (camera_rig.h).
#include "camera_rig.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "drivers/udp_port.h"
#include "fields/check.h"
#include "hil/configuration/problems.h"
#include "protocols/bytes.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

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

TEST_F(CameraRig, looks_of_a_label_that_nothing_has_are_refused_with_their_place) {
  const auto refusal = [this](const std::string& looks) {
    write("    sensor:\n      image_sensor: {width: 160, height: 120}\n      looks:\n" + looks);
    const LoadedRig loaded = load_rig(file, {});
    try {
      check_start(loaded);
    } catch (const ConfigurationError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusal("        - {label: building, kind: concrete}\n"), "");
  const std::string unknown = refusal(
      "        - {label: building, kind: concrete}\n"
      "        - {label: bilding, kind: rock}\n");
  EXPECT_THAT(unknown, HasSubstr(file + ":"));
  EXPECT_THAT(unknown, HasSubstr(": devices.eye.sensor.looks.1.label: nothing in the scene has it, "
                                 "found \"bilding\", allowed "));
  EXPECT_THAT(unknown, HasSubstr("building"));
  EXPECT_THAT(unknown, HasSubstr("ground"));
  EXPECT_THAT(unknown, HasSubstr("did you mean building?"));
  EXPECT_THAT(refusal("        - {label: building, kind: concrete}\n"
                      "        - {label: building, kind: rock}\n"),
              HasSubstr("looks.1.label: it has its looks already"));
  // A run says so as a check does, without a wire being opened.
  EXPECT_THROW(open(), fields::Refused);
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
