// Rights of the clients, how long they hold them, and the answers to requests that are refused.
#include "emulators/gige_camera/control_channel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gige_camera_fixture.h"

namespace rigwire::emulators {
namespace {

using gev::Status;
using std::chrono::milliseconds;
using std::chrono::seconds;

class ControlChannelTest : public GigeCameraFixture {
 protected:
  ControlChannelTest() { make(); }
};

TEST_F(ControlChannelTest, DiscoveryTellsTheFirstRegisters) {
  const auto acknowledge = ask(gev::encode_discovery(0xFFFF));
  EXPECT_EQ(acknowledge.acknowledge, 0x0003);
  EXPECT_EQ(acknowledge.request, 0xFFFF);
  ASSERT_EQ(acknowledge.payload.size(), 248U);
  const auto word = [&](std::size_t at) {
    return protocols::load_big<std::uint32_t>(acknowledge.payload, at);
  };
  EXPECT_EQ(word(0x00), 0x0002'0000U);
  EXPECT_EQ(word(0x04), 0x8000'0001U);
  EXPECT_EQ(word(0x08), 0x0000'0252U);
  EXPECT_EQ(word(0x0C), 0x5700'0001U);
  EXPECT_EQ(word(0x24), 0x7F00'0002U);
  EXPECT_EQ(word(0x34), 0xFF00'0000U);
  const auto text = [&](std::size_t at) {
    return std::string(reinterpret_cast<const char*>(acknowledge.payload.data() + at));
  };
  EXPECT_EQ(text(0x48), "Rigwire");
  EXPECT_EQ(text(0x68), "AreaCamera");
  EXPECT_EQ(text(0xD8), "1");
}

TEST_F(ControlChannelTest, DiscoveryIsAnsweredToEverybodyAtEveryTime) {
  ASSERT_EQ(write(boot::kControlPrivilege, gev::Privilege::kExclusive), Status::success);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(ask(gev::encode_discovery(0xFFFF), kOther).payload.size(), 248U);
  }
}

TEST_F(ControlChannelTest, DiscoveryWithoutAcknowledgeIsSilent) {
  const std::array<std::uint8_t, 8> silent{0x42, 0, 0, 2, 0, 0, 0, 1};
  camera->receive(now, kClient, silent);
  EXPECT_TRUE(control.sent.empty());
}

TEST_F(ControlChannelTest, AClientInAnotherNetworkIsAnsweredByBroadcastWhereItAllowsThat) {
  GigeCameraSettings settings = small();
  settings.address = {0x0A00'0005, 0xFF00'0000, 0};  // 10.0.0.5
  settings.permitted = {0, 0, 0};                    // everybody
  make(settings);
  const UdpEnd far{0xC0A8'0001, 40000};  // 192.168.0.1
  camera->receive(now, far, gev::encode_discovery(1, true).view());
  ASSERT_EQ(control.sent.size(), 1U);
  EXPECT_EQ(control.sent[0].to, (UdpEnd{0xFFFF'FFFF, 40000}));
  camera->receive(now, far, gev::encode_discovery(1, false).view());
  ASSERT_EQ(control.sent.size(), 2U);
  EXPECT_EQ(control.sent[1].to, far);
}

TEST_F(ControlChannelTest, WhoIsNotPermittedIsNotAnswered) {
  camera->receive(now, {0xC0A8'0001, 40000}, gev::encode_discovery(1).view());
  EXPECT_TRUE(control.sent.empty());
  EXPECT_EQ(camera->received().ignored, 1U);
}

TEST_F(ControlChannelTest, WithoutControlNothingButTheControlIsWritten) {
  EXPECT_EQ(write(boot::kHeartbeatTimeout, 1000), Status::access_denied);
  EXPECT_EQ(read(boot::kHeartbeatTimeout), 3000U);
  EXPECT_EQ(write(boot::kControlPrivilege, 2), Status::success);
  EXPECT_EQ(write(boot::kHeartbeatTimeout, 1000), Status::success);
  EXPECT_EQ(read(boot::kHeartbeatTimeout), 1000U);
}

TEST_F(ControlChannelTest, WithControlOthersReadOnly) {
  take_control();
  EXPECT_EQ(read(boot::kControlPrivilege, kOther), 2U);
  EXPECT_EQ(read(boot::kPrimaryAddress, kOther), kClient.address);
  EXPECT_EQ(read(boot::kPrimaryPort, kOther), kClient.port);
  EXPECT_EQ(write(boot::kHeartbeatTimeout, 1000, kOther), Status::access_denied);
  EXPECT_EQ(write(boot::kControlPrivilege, 2, kOther), Status::access_denied);
  EXPECT_EQ(write(boot::kControlPrivilege, 0, kOther), Status::access_denied);
  EXPECT_EQ(read(boot::kControlPrivilege), 2U);
}

TEST_F(ControlChannelTest, WithExclusiveControlOthersReadTheControlOnly) {
  ASSERT_EQ(write(boot::kControlPrivilege, gev::Privilege::kExclusive), Status::success);
  EXPECT_EQ(read(boot::kControlPrivilege, kOther), 1U);
  EXPECT_EQ(status_of_reading(boot::kVersion, kOther), Status::access_denied);
  EXPECT_EQ(ask(gev::encode_read_memory(9, 0x200, 512), kOther).status, Status::access_denied);
  EXPECT_EQ(ask(gev::encode_read_memory(9, boot::kControlPrivilege, 8), kOther).status,
            Status::access_denied);
  EXPECT_EQ(read(boot::kVersion), 0x0002'0000U);
}

TEST_F(ControlChannelTest, ControlThatIsGivenBackCanBeTaken) {
  take_control();
  EXPECT_EQ(write(boot::kControlPrivilege, 0), Status::success);
  EXPECT_EQ(read(boot::kPrimaryPort), 0U);
  EXPECT_EQ(write(boot::kControlPrivilege, 2, kOther), Status::success);
  EXPECT_EQ(write(boot::kHeartbeatTimeout, 1000), Status::access_denied);
}

TEST_F(ControlChannelTest, UnknownPrivilegesAreRefused) {
  EXPECT_EQ(write(boot::kControlPrivilege, 4), Status::invalid_parameter);  // switch-over
  EXPECT_EQ(read(boot::kControlPrivilege), 0U);
}

TEST_F(ControlChannelTest, SilenceEndsControl) {
  start_streaming();
  EXPECT_TRUE(camera->acquiring());
  EXPECT_EQ(camera->next_event(), now + seconds{3});
  pass(milliseconds{2999});
  EXPECT_TRUE(camera->controlled());
  pass(milliseconds{1});
  EXPECT_FALSE(camera->controlled());
  EXPECT_FALSE(camera->acquiring());
  EXPECT_EQ(read(boot::kControlPrivilege, kOther), 0U);
  EXPECT_EQ(read(boot::kStreamPort, kOther), 0U);
}

TEST_F(ControlChannelTest, EveryCommandIsAHeartbeatOfItsSenderAlone) {
  take_control();
  for (int i = 0; i < 5; ++i) {
    pass(seconds{2});
    EXPECT_EQ(read(boot::kControlPrivilege), 2U);
  }
  pass(seconds{2});
  EXPECT_EQ(read(boot::kControlPrivilege, kOther), 2U);
  pass(seconds{1});
  EXPECT_FALSE(camera->controlled());
}

TEST_F(ControlChannelTest, AHeartbeatThatIsSwitchedOffNeverEnds) {
  take_control();
  ASSERT_EQ(write(boot::kConfiguration, gev::Configuration::kHeartbeatDisable), Status::success);
  EXPECT_EQ(camera->next_event(), kNever);
  pass(seconds{3600});
  EXPECT_TRUE(camera->controlled());
}

TEST_F(ControlChannelTest, TheTimeoutHasAFloor) {
  take_control();
  EXPECT_EQ(write(boot::kHeartbeatTimeout, 0), Status::success);
  EXPECT_EQ(read(boot::kHeartbeatTimeout), 500U);
}

TEST_F(ControlChannelTest, ACommandThatComesAgainIsAnsweredAgainAndNotActedOn) {
  start_streaming();
  ASSERT_EQ(write(reg::kAcquisitionStop, 1), Status::success);
  ASSERT_EQ(write(reg::kTriggerMode, 1), Status::success);
  ASSERT_EQ(write(reg::kAcquisitionStart, 1), Status::success);
  const gev::RegisterValue trigger{reg::kTriggerSoftware, 1};
  const auto once = gev::encode_write_registers(next_request(), std::span(&trigger, 1));
  const auto first = ask(once);
  pass(milliseconds{500});
  const auto again = ask(once);
  EXPECT_EQ(first.status, Status::success);
  EXPECT_EQ(again.status, Status::success);
  EXPECT_EQ(again.request, first.request);
  EXPECT_EQ(camera->command().software_triggers, 1U);
  EXPECT_EQ(write(reg::kTriggerSoftware, 1), Status::success);
  EXPECT_EQ(camera->command().software_triggers, 2U);
}

TEST_F(ControlChannelTest, ANewClientWithTheSamePortAndNumberIsActedOn) {
  const gev::RegisterValue control_register{boot::kControlPrivilege, 2};
  const auto first = gev::encode_write_registers(65300, std::span(&control_register, 1));
  EXPECT_EQ(ask(first).status, Status::success);
  pass(seconds{10});
  EXPECT_FALSE(camera->controlled());
  EXPECT_EQ(ask(first).status, Status::success);
  EXPECT_TRUE(camera->controlled());
}

TEST_F(ControlChannelTest, SeveralRegistersEndAtTheFirstThatIsRefused) {
  take_control();
  const std::vector<gev::RegisterValue> pairs{
      {boot::kHeartbeatTimeout, 1000}, {boot::kVersion, 1}, {boot::kStreamPacketDelay, 5}};
  const auto acknowledge = ask(gev::encode_write_registers(next_request(), pairs));
  EXPECT_EQ(acknowledge.status, Status::write_protect);
  EXPECT_EQ(*gev::decode_count(acknowledge), 1);
  EXPECT_EQ(read(boot::kHeartbeatTimeout), 1000U);
  EXPECT_EQ(read(boot::kStreamPacketDelay), 0U);
}

TEST_F(ControlChannelTest, WhatIsNoCommandIsNotAnswered) {
  const std::vector<std::uint8_t> wrong_key{0x41, 1, 0, 2, 0, 0, 0, 1};
  camera->receive(now, kClient, wrong_key);
  camera->receive(now, kClient, std::span(wrong_key).first(3));
  camera->receive(now, kClient, {});
  EXPECT_TRUE(control.sent.empty());
  EXPECT_EQ(camera->received().malformed, 3U);
}

TEST_F(ControlChannelTest, TruncatedAndOversizedCommandsAreInvalidHeaders) {
  const std::vector<std::uint8_t> truncated{0x42, 1, 0, 0x84, 0, 8, 0, 5, 0, 0};
  std::vector<std::uint8_t> oversized{0x42, 1, 0, 0x84, 0, 0, 0, 6};
  oversized.resize(1400);
  camera->receive(now, kClient, truncated);
  camera->receive(now, kClient, oversized);
  ASSERT_EQ(control.sent.size(), 2U);
  for (const auto& sent : control.sent) {
    const auto acknowledge = gev::decode_acknowledge(sent.bytes);
    EXPECT_EQ(acknowledge->status, Status::invalid_header);
    EXPECT_EQ(acknowledge->acknowledge, 0x85);
  }
}

TEST_F(ControlChannelTest, CommandsThatAreNotThereAreNotImplemented) {
  const std::vector<std::uint8_t> action{0x42, 1, 1, 0, 0, 0, 0, 1};
  camera->receive(now, kClient, action);
  ASSERT_EQ(control.sent.size(), 1U);
  EXPECT_EQ(gev::decode_acknowledge(control.sent[0].bytes)->status, Status::not_implemented);
  EXPECT_EQ(gev::decode_acknowledge(control.sent[0].bytes)->acknowledge, 0x101);
  EXPECT_EQ(camera->received().ignored, 1U);
}

TEST_F(ControlChannelTest, ForceIpMovesTheDeviceThatIsMeant) {
  gev::ForceIp command;
  command.mac = {0x02, 0x52, 0x57, 0, 0, 1};
  command.address = 0x7F00'0009;
  command.mask = 0xFF00'0000;
  EXPECT_EQ(ask(gev::encode_force_ip(1, command)).status, Status::success);
  EXPECT_EQ(camera->address(), (CameraAddress{0x7F00'0009, 0xFF00'0000, 0}));
  EXPECT_EQ(camera->address_changes(), 1U);
  // Where nobody may be.
  command.address = 0x0A00'0001;
  EXPECT_EQ(ask(gev::encode_force_ip(2, command)).status, Status::invalid_parameter);
  // Back to what it is configured to be.
  command.address = 0;
  EXPECT_EQ(ask(gev::encode_force_ip(3, command)).status, Status::success);
  EXPECT_EQ(camera->address().address, 0x7F00'0002U);
  // Another device.
  command.mac[5] = 2;
  camera->receive(now, kClient, gev::encode_force_ip(4, command).view());
  EXPECT_EQ(control.sent.size(), 3U);
  EXPECT_EQ(camera->address_changes(), 2U);
}

TEST_F(ControlChannelTest, ForceIpIsRefusedUnderControl) {
  take_control();
  gev::ForceIp command;
  command.mac = {0x02, 0x52, 0x57, 0, 0, 1};
  command.address = 0x7F00'0009;
  EXPECT_EQ(ask(gev::encode_force_ip(1, command), kOther).status, Status::access_denied);
  EXPECT_EQ(camera->address_changes(), 0U);
}

}  // namespace
}  // namespace rigwire::emulators
