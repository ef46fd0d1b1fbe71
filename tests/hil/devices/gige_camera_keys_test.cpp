// Keys of the cameras: what is contradictory is refused in one message with its place.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "device_keys.h"
#include "hil/devices/device.h"
#include "hil/devices/gige_camera.h"
#include "hil/rig/rig.h"
#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class CameraKeys : public DeviceKeys {
 protected:
  CameraKeys() : DeviceKeys("eye") {}
  void write(const std::string& keys, const std::string& devices = "",
             const std::string& type = "gige-camera") {
    DeviceKeys::write(type, keys, devices);
  }
  auto settings() { return settings_from<GigeCameraConfiguration>(); }
};

TEST_F(CameraKeys, device_is_told_what_its_sensor_can_do) {
  write(
      "    address: 127.0.3.4\n    sensor: {image_sensor: {width: 320, height: 200, colour: true, "
      "row_time: 15 us}}\n");
  EXPECT_EQ(complaints(), "");
  const emulators::GigeCameraSettings told = settings();
  EXPECT_EQ(told.kind, emulators::GigeCameraKind::camera);
  EXPECT_EQ(told.width, 320);
  EXPECT_EQ(told.height, 200);
  EXPECT_EQ(told.formats.front(), PixelFormat::bayer_rg8);
  EXPECT_FALSE(told.binning);
  EXPECT_EQ(told.row_time, std::chrono::microseconds(15));
  EXPECT_EQ(told.address.address, 0x7F000304U);
  EXPECT_EQ(told.address.mask, 0xFF000000U);
  const protocols::gige_vision::MacAddress mac{0x02, 0x52, 127, 0, 3, 4};
  EXPECT_EQ(told.mac, mac);
}

TEST_F(CameraKeys, a_matching_method_that_is_gone_is_refused) {
  write("    address: 127.0.3.4\n    sensor: {matching: {method: semi_global}}\n", "",
        "gige-stereo");
  EXPECT_THAT(complaints(),
              AllOf(HasSubstr("devices.eye.sensor.matching.method"), HasSubstr("unknown value"),
                    HasSubstr("\"semi_global\""), HasSubstr("census, truth")));
}

TEST_F(CameraKeys, address_must_be_the_cameras_own_and_of_this_machine) {
  write("    address: 192.168.1.7\n");
  EXPECT_THAT(complaints(), AllOf(HasSubstr("devices.eye.address"), HasSubstr("allow_remote")));
  write("    address: camera\n");
  EXPECT_THAT(complaints(), AllOf(HasSubstr("devices.eye.address"), HasSubstr("\"camera\""),
                                  HasSubstr("127.0.0.")));
  write("    address: 127.255.255.255\n");
  EXPECT_THAT(complaints(), HasSubstr("devices.eye.address"));
  write("    netmask: 255.255.255.0\n");
  EXPECT_THAT(complaints(), HasSubstr("devices.eye.netmask"));
  write("    allow_remote: true\n    address: 192.168.1.7\n    netmask: 255.255.255.0\n");
  EXPECT_EQ(complaints(), "");
  EXPECT_EQ(settings().permitted.mask, 0xFFFFFF00U);
  write("    mac: 02-52-57\n");
  EXPECT_THAT(complaints(), HasSubstr("devices.eye.mac"));
  write("    mac: \"01:52:57:00:00:01\"\n");
  EXPECT_THAT(complaints(), HasSubstr("devices.eye.mac"));
}

TEST_F(CameraKeys, two_cameras_share_neither_address_nor_hardware_nor_name) {
  const std::string second = "  other:\n    type: gige-camera\n    mount: {link: body}\n";
  write("", second + "    serial: \"2\"\n");
  EXPECT_THAT(complaints(), AllOf(HasSubstr("devices.other.address"),
                                  HasSubstr("already taken by devices.eye.address")));
  write("", second + "    address: 127.0.0.3\n");
  EXPECT_THAT(complaints(), HasSubstr("devices.other.serial"));
  write("    mac: \"02:52:00:00:00:01\"\n",
        second + "    address: 127.0.0.3\n    serial: \"2\"\n    mac: \"02:52:00:00:00:01\"\n");
  EXPECT_THAT(complaints(), HasSubstr("devices.other.mac"));
  write("", second + "    address: 127.0.0.3\n    serial: \"2\"\n");
  EXPECT_EQ(complaints(), "");
}

TEST_F(CameraKeys, rate_exposure_and_size_must_go_together) {
  write("    rate: 50 Hz\n    exposure: 30 ms\n");
  EXPECT_THAT(complaints(), AllOf(HasSubstr("devices.eye.exposure"), HasSubstr("20 ms")));
  write("    rate: 50 Hz\n    exposure_auto: true\n");
  EXPECT_THAT(complaints(), HasSubstr("devices.eye.sensor.auto_exposure.longest"));
  // 480 rows of 10 us; 307 kB at 500 Mbit/s.
  write("    rate: 300 Hz\n    exposure: 1 ms\n");
  EXPECT_THAT(complaints(), AllOf(HasSubstr("devices.eye.rate"), HasSubstr("300 Hz")));
  write("    rate: 60 Hz\n    exposure: 1 ms\n    throughput: 100 Mbit/s\n");
  EXPECT_THAT(complaints(), HasSubstr("devices.eye.rate"));
  write("    sensor: {image_sensor: {width: 322}}\n");
  EXPECT_THAT(complaints(), AllOf(HasSubstr("devices.eye.sensor"), HasSubstr("322")));
  write("    line: {period: 1 ms, width: 2 ms}\n");
  EXPECT_THAT(complaints(), HasSubstr("devices.eye"));
}

TEST_F(CameraKeys, every_complaint_has_file_line_and_column) {
  write("    address: nowhere\n");
  EXPECT_THAT(complaints(), HasSubstr(file + ":6:"));
}

TEST_F(CameraKeys, port_that_another_program_has_is_an_error_of_the_environment) {
  write("    address: 127.0.5.9\n");
  boost::asio::io_context io;
  const LoadedRig loaded = load_rig(file, {});
  const Rig first(loaded.configuration, io, {});
  try {
    const Rig second(loaded.configuration, io, {});
    FAIL() << "both have it";
  } catch (const drivers::EndpointError& error) {
    EXPECT_THAT(error.what(), HasSubstr("127.0.5.9:3956"));
  }
}

}  // namespace
}  // namespace rigwire::hil
