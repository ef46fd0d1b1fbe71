// What is there, what may be read and written, and what survives the supply.
#include "emulators/gige_camera/register_bank.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "gige_camera_fixture.h"

namespace rigwire::emulators {
namespace {

using gev::Status;
using std::chrono::milliseconds;
using std::chrono::seconds;

class RegisterBankTest : public GigeCameraFixture {
 protected:
  RegisterBankTest() { make(); }
};

TEST_F(RegisterBankTest, TheDescriptionIsWhereItsUrlSays) {
  const std::string url = read_text(boot::kFirstUrl, 512);
  unsigned address = 0;
  unsigned size = 0;
  ASSERT_EQ(std::sscanf(url.c_str(), "Local:rigwire_camera.xml;%x;%x", &address, &size), 2) << url;
  std::string text;
  for (unsigned at = 0; at < size; at += 512) {
    const auto count = static_cast<std::uint16_t>(std::min(512U, size - at));
    const auto bytes = read_bytes(address + at, count);
    text.append(bytes.begin(), bytes.end());
  }
  EXPECT_EQ(text, camera->description());
  EXPECT_THAT(text, testing::StartsWith("<?xml"));
  EXPECT_EQ(ask(gev::encode_read_memory(1, address + size - 4, 8)).status, Status::invalid_address);
  EXPECT_EQ(ask(gev::encode_read_memory(2, 0xFFFF'FFF8, 16)).status, Status::invalid_address);
}

TEST_F(RegisterBankTest, TheDescriptionIsNotWritten) {
  take_control();
  EXPECT_EQ(write(kDescriptionAddress, 0), Status::write_protect);
}

TEST_F(RegisterBankTest, AddressesThatAreNotThere) {
  take_control();
  for (const std::uint32_t address : {0x0100U, 0x0940U + 0x10U, 0x0B00U, 0xAF00U, 0xFFFF'FFFCU}) {
    EXPECT_EQ(status_of_reading(address), Status::invalid_address) << address;
    EXPECT_EQ(write(address, 1), Status::invalid_address) << address;
  }
  EXPECT_EQ(ask(gev::encode_read_memory(1, 0xF4, 8)).status, Status::invalid_address);
}

TEST_F(RegisterBankTest, OfTheDiscoveryBlockWhatIsNoRegisterIsZero) {
  EXPECT_EQ(read(0x0018), 0U);
  const auto block = read_bytes(0, 0xF8);
  EXPECT_EQ(block.size(), 0xF8U);
}

TEST_F(RegisterBankTest, WhatCanOnlyBeWrittenIsNotRead) {
  EXPECT_EQ(status_of_reading(boot::kTimestampControl), Status::access_denied);
}

TEST_F(RegisterBankTest, WhatCanOnlyBeReadIsNotWritten) {
  take_control();
  EXPECT_EQ(write(boot::kVersion, 1), Status::write_protect);
  EXPECT_EQ(write(reg::kPayloadSize, 1), Status::write_protect);
}

TEST_F(RegisterBankTest, HalfAnEightByteNumberIsNotWritten) {
  take_control();
  EXPECT_EQ(write(reg::kExposureTime, 0x4080'0000), Status::bad_alignment);
  EXPECT_EQ(write(reg::kExposureTime + 4, 0), Status::bad_alignment);
  EXPECT_EQ(read_real(reg::kExposureTime), 5000.0);
}

TEST_F(RegisterBankTest, NumbersStayInTheirRange) {
  take_control();
  for (const double value : {9.0, 1.1e6, -1.0, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(write_real(reg::kExposureTime, value), Status::invalid_parameter) << value;
  }
  EXPECT_EQ(write_real(reg::kExposureTime, 10.0), Status::success);
  EXPECT_EQ(write(reg::kWidth, 62), Status::invalid_parameter);  // steps of four
  EXPECT_EQ(write(reg::kWidth, 68), Status::invalid_parameter);
  EXPECT_EQ(write(reg::kWidth, 12), Status::invalid_parameter);
  EXPECT_EQ(write(reg::kPixelFormat, 0x0218'0014), Status::invalid_parameter);
  EXPECT_EQ(write(reg::kTriggerMode, 2), Status::invalid_parameter);
  EXPECT_EQ(write(reg::kFrameRateEnable, 2), Status::invalid_parameter);
  EXPECT_EQ(write(reg::kAcquisitionStart, 2), Status::invalid_parameter);
  EXPECT_EQ(read(reg::kWidth), 64U);
}

TEST_F(RegisterBankTest, TheNameIsKept) {
  take_control();
  std::array<std::uint8_t, 16> name{'l', 'e', 'f', 't'};
  EXPECT_EQ(write_bytes(boot::kUserDefinedName, name), Status::success);
  make();
  EXPECT_EQ(read_text(boot::kUserDefinedName, 16), "left");
  take_control();
  name.fill('x');
  EXPECT_EQ(write_bytes(boot::kUserDefinedName, name), Status::success);
  EXPECT_EQ(read_text(boot::kUserDefinedName, 16), std::string(15, 'x'));
}

TEST_F(RegisterBankTest, TheNameCanBeWrittenInPieces) {
  take_control();
  ASSERT_EQ(write(boot::kUserDefinedName, 0x6C65'6674), Status::success);
  EXPECT_EQ(write(boot::kUserDefinedName + 4, 0x3200'0000), Status::success);
  EXPECT_EQ(read_text(boot::kUserDefinedName, 16), "left2");
}

TEST_F(RegisterBankTest, ThePersistentAddressIsTakenFromTheNextStartOn) {
  take_control();
  EXPECT_EQ(write(boot::kPersistentAddress, 0x7F00'0042), Status::success);
  EXPECT_EQ(camera->address().address, 0x7F00'0002U);
  make();
  EXPECT_EQ(camera->address().address, 0x7F00'0042U);
  take_control();
  // Without the persistent one the camera has the address of its settings.
  EXPECT_EQ(write(boot::kIpConfiguration, 0), Status::success);
  EXPECT_EQ(read(boot::kIpConfiguration), gev::IpConfiguration::kLinkLocal);
  make();
  EXPECT_EQ(camera->address().address, 0x7F00'0002U);
  take_control();
  EXPECT_EQ(write(boot::kIpConfiguration, gev::IpConfiguration::kDhcp), Status::invalid_parameter);
}

TEST_F(RegisterBankTest, AMemoryThatCannotBeWrittenIsSaid) {
  class FullMemory final : public NonvolatileMemory {
   public:
    [[nodiscard]] std::span<const std::uint8_t> content() const override { return {}; }
    [[nodiscard]] bool store(std::span<const std::uint8_t> /*block*/) override { return false; }
  } full;
  camera = std::make_unique<GigeCamera>(small(), full, control, stream);
  take_control();
  EXPECT_EQ(write(boot::kUserDefinedName, 0x6C65'6674), Status::error);
  EXPECT_EQ(read_text(boot::kUserDefinedName, 16), "");
}

TEST_F(RegisterBankTest, TimeIsLatchedAndReset) {
  take_control();
  EXPECT_EQ(write(boot::kTimestampControl, gev::TimestampControl::kLatch), Status::success);
  pass(milliseconds{10});
  EXPECT_EQ(read(boot::kTimestampHigh), 0U);
  EXPECT_EQ(read(boot::kTimestampLow), 1'000'000'000U);
  EXPECT_EQ(write(boot::kTimestampControl, gev::TimestampControl::kReset), Status::success);
  pass(milliseconds{7});
  EXPECT_EQ(write(boot::kTimestampControl, gev::TimestampControl::kLatch), Status::success);
  EXPECT_EQ(read(boot::kTimestampLow), 7'000'000U);
  EXPECT_EQ(write(boot::kTimestampControl, 4), Status::invalid_parameter);
}

TEST_F(RegisterBankTest, TheRegionFitsTheSensor) {
  take_control();
  EXPECT_EQ(write(reg::kOffsetX, 4), Status::invalid_parameter);
  EXPECT_EQ(write(reg::kWidth, 32), Status::success);
  EXPECT_EQ(write(reg::kOffsetX, 32), Status::success);
  EXPECT_EQ(write(reg::kWidth, 36), Status::invalid_parameter);
  EXPECT_EQ(write(reg::kHeight, 16), Status::success);
  EXPECT_EQ(write(reg::kOffsetY, 32), Status::success);
  EXPECT_EQ(camera->command().region, (PictureRegion{32, 32, 32, 16}));
  EXPECT_EQ(read(reg::kPayloadSize), 32U * 16);
  EXPECT_EQ(write(reg::kPixelFormat, 0x0110'0005), Status::success);
  EXPECT_EQ(camera->command().format, PixelFormat::mono12);
  EXPECT_EQ(read(reg::kPayloadSize), 32U * 16 * 2);
}

TEST_F(RegisterBankTest, BinningBeginsWithTheWholeSensor) {
  take_control();
  ASSERT_EQ(write(reg::kWidth, 32), Status::success);
  EXPECT_EQ(write(reg::kBinningHorizontal, 2), Status::success);
  EXPECT_EQ(read(reg::kWidthMax), 32U);
  EXPECT_EQ(camera->command().region, (PictureRegion{0, 0, 32, 48}));
  EXPECT_EQ(camera->command().binning_horizontal, 2);
  EXPECT_EQ(write(reg::kBinningHorizontal, 3), Status::invalid_parameter);
}

TEST_F(RegisterBankTest, ASensorThatCannotBinRefusesIt) {
  GigeCameraSettings settings = small();
  settings.binning = false;
  make(settings);
  take_control();
  EXPECT_EQ(write(reg::kBinningVertical, 2), Status::invalid_parameter);
}

TEST_F(RegisterBankTest, AResetDeviceIsAsItWasAtPowerOn) {
  take_control();
  ASSERT_EQ(write(reg::kWidth, 32), Status::success);
  ASSERT_EQ(write(boot::kHeartbeatTimeout, 9000), Status::success);
  EXPECT_EQ(write(reg::kDeviceReset, 1), Status::success);
  EXPECT_FALSE(camera->controlled());
  EXPECT_EQ(read(reg::kWidth), 64U);
  EXPECT_EQ(read(boot::kHeartbeatTimeout), 3000U);
}

TEST_F(RegisterBankTest, AStereoCameraTellsItsGeometry) {
  GigeCameraSettings settings = small();
  settings.kind = GigeCameraKind::stereo;
  settings.geometry = {320.0, 0.25, 32.0, 24.0, {1.0 / 16, 2.0, 0}};
  make(settings);
  EXPECT_EQ(read_real(reg::kScan3dFocalLength), 320.0);
  EXPECT_EQ(read_real(reg::kScan3dBaseline), 0.25);
  EXPECT_EQ(read_real(reg::kScan3dScale), 1.0 / 16);
  EXPECT_EQ(read_real(reg::kScan3dOffset), 2.0);
  settings.kind = GigeCameraKind::depth;
  settings.geometry.coding = {0.001, 0.0, 0};
  make(settings);
  EXPECT_EQ(read_real(reg::kScan3dScale), 1.0);  // millimetres
  EXPECT_EQ(status_of_reading(reg::kScan3dBaseline), Status::invalid_address);
  make();
  EXPECT_EQ(status_of_reading(reg::kScan3dScale), Status::invalid_address);
}

TEST_F(RegisterBankTest, TheLineIsReadAsItStands) {
  GigeCameraSettings settings = small();
  settings.line = {milliseconds{1500}, milliseconds{100}, milliseconds{10}};
  make(settings);
  EXPECT_EQ(read(reg::kLineStatus), 0U);
  pass(milliseconds{505});
  EXPECT_EQ(read(reg::kLineStatus), 1U);
  pass(milliseconds{5});
  EXPECT_EQ(read(reg::kLineStatus), 0U);
}

}  // namespace
}  // namespace rigwire::emulators
