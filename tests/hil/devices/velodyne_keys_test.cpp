// Keys of the Velodyne lidars: each type has those that its model can mean something by.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "device_keys.h"
#include "hil/devices/velodyne.h"
#include "hil/rig/rig_configuration.h"
#include "sim/lidar/velodyne_heads.h"

namespace rigwire::hil {
namespace {

using emulators::VelodyneTimeSource;
using ::testing::HasSubstr;

class LidarKeys : public DeviceKeys {
 protected:
  LidarKeys() : DeviceKeys("lidar") {}
  auto settings() { return settings_from<VelodyneConfiguration>(); }
};

TEST_F(LidarKeys, TypeChoosesTheModel) {
  const std::pair<const char*, const char*> types[] = {
      {"velodyne-hdl-32e", "HDL-32E"},         {"velodyne-vlp-16", "VLP-16"},
      {"velodyne-puck-hi-res", "Puck Hi-Res"}, {"velodyne-vlp-32c", "VLP-32C"},
      {"velodyne-hdl-64e", "HDL-64E S2"},      {"velodyne-hdl-64e-s3", "HDL-64E S3"},
      {"velodyne-vls-128", "VLS-128"}};
  for (const auto& [type, model] : types) {
    write(type, "");
    EXPECT_EQ(complaints(), "") << type;
    EXPECT_EQ(settings().model, model);
  }
}

TEST_F(LidarKeys, KeysThatMeanNothingToTheModelAreUnknown) {
  write("velodyne-hdl-64e", "    web: {port: 8080}\n");
  EXPECT_THAT(complaints(), HasSubstr("devices.lidar.web: unknown key"));
  write("velodyne-hdl-64e", "    position_port: 8308\n");
  EXPECT_THAT(complaints(), HasSubstr("devices.lidar.position_port: unknown key"));
  write("velodyne-vlp-16", "    calibration: unit.yaml\n");
  EXPECT_THAT(complaints(), HasSubstr("devices.lidar.calibration: unknown key"));
  write("velodyne-vlp-16", "    inertial: {}\n");
  EXPECT_THAT(complaints(), HasSubstr("devices.lidar.inertial: unknown key"));
}

TEST_F(LidarKeys, SecondEchoesOfBeamsWithoutWidthAreRefused) {
  for (const char* mode : {"last", "dual"}) {
    const std::string keys = std::string("    return_mode: ") + mode + "\n";
    write("velodyne-vlp-16", keys);
    EXPECT_EQ(complaints(), "") << mode;
    write("velodyne-vlp-16", keys + "    sensor: {sub_rays: 5}\n");
    EXPECT_EQ(complaints(), "") << mode;
    write("velodyne-vlp-16", keys + "    sensor: {sub_rays: 1}\n");
    EXPECT_THAT(complaints(), HasSubstr("allowed 0, 5, 19 or 1000")) << mode;
    write("velodyne-vlp-16", keys + "    sensor: {method: depth_image}\n");
    EXPECT_THAT(complaints(), HasSubstr("allowed rays")) << mode;
  }
  write("velodyne-hdl-64e-s3", "    return_mode: dual\n");
  EXPECT_EQ(complaints(), "");
  write("velodyne-hdl-64e", "    return_mode: dual\n");
  EXPECT_THAT(complaints(), HasSubstr("cannot; allowed: strongest, last"));
}

TEST_F(LidarKeys, FirmwareIsTheNewestUnlessItIsNamed) {
  write("velodyne-vls-128", "");
  EXPECT_EQ(emulators::model_of(settings()).firing_period_ns, 57'780);
  write("velodyne-vls-128", "    firmware: 5.1.7\n");
  EXPECT_EQ(complaints(), "");
  EXPECT_EQ(emulators::model_of(settings()).firing_period_ns, 53'300);
  write("velodyne-vlp-16", "    firmware: 5.1.7\n");
  EXPECT_THAT(complaints(), HasSubstr("devices.lidar.firmware: unknown key"));
}

TEST_F(LidarKeys, ErrorsOfReceiverAndRotorAreThoseOfTheModel) {
  write("velodyne-vlp-32c", "");
  const LoadedRig loaded = load_rig(file, {});
  const auto& sensor =
      fields::as<VelodyneConfiguration>(loaded.configuration.devices.at("lidar"))->sensor;
  const sim::SpinningHead head = sim::velodyne_head("VLP-32C");
  EXPECT_EQ(sensor.beam.range_sigma_m, head.receiver.range_sigma_m);
  EXPECT_EQ(sensor.beam.laser_bias_sigma_m, head.receiver.laser_bias_sigma_m);
  EXPECT_EQ(sensor.beam.range_noise, head.receiver.range_noise);
  EXPECT_EQ(sensor.beam.reflectivity_sigma, head.receiver.reflectivity_sigma);
  EXPECT_EQ(sensor.beam.air_focus_range_m, head.receiver.air_focus_range_m);
  EXPECT_EQ(sensor.beam.reference_range_m, head.receiver.reference_range_m);
  EXPECT_EQ(sensor.rotor.encoder_noise_rad, head.rotor.encoder_noise_rad);
  EXPECT_EQ(settings().reference_range_m, head.receiver.reference_range_m);
}

TEST_F(LidarKeys, SpeedOfNoMultipleOf60IsRefusedAsTheSensorWould) {
  write("velodyne-vlp-16", "    rate: 601 rpm\n");
  EXPECT_THAT(complaints(), HasSubstr("rotor_rpm is 601"));
}

TEST_F(LidarKeys, TimeSourceIsAWordOrAReceiver) {
  write("velodyne-vlp-16", "");
  EXPECT_EQ(settings().time_source, VelodyneTimeSource::ideal);
  write("velodyne-vlp-16", "    time_source: none\n");
  EXPECT_EQ(settings().time_source, VelodyneTimeSource::none);
  const std::string antenna = "  antenna: {type: ublox-neo-7p, mount: {link: body}}\n";
  write("velodyne-vlp-16", "    time_source: antenna\n", antenna);
  EXPECT_EQ(complaints(), "");
  EXPECT_EQ(settings().time_source, VelodyneTimeSource::receiver);
  write("velodyne-vlp-16", "    time_source: antena\n", antenna);
  EXPECT_THAT(complaints(), HasSubstr("devices.lidar.time_source: no such satellite receiver"));
  write("velodyne-vlp-16", "    time_source: lidar\n", antenna);
  EXPECT_THAT(complaints(), HasSubstr("no such satellite receiver"));
}

TEST_F(LidarKeys, FaultsReachTheEmulator) {
  write("velodyne-vlp-16",
        "    faults:\n"
        "      - {type: lost, at: 1 s, for: 2 s, share: 5 %}\n"
        "      - {type: dirt, at: 0 s, from: 350 deg, to: 10 deg, transmission: 20 %}\n");
  const auto faults = settings().faults;
  ASSERT_EQ(faults.size(), 2U);
  EXPECT_EQ(faults[0].when, (FaultPeriod{std::chrono::seconds(1), std::chrono::seconds(2)}));
  EXPECT_DOUBLE_EQ(std::get<emulators::LostPacketsFault>(faults[0].what).share, 0.05);
  const auto& dirt = std::get<emulators::DirtyWindowFault>(faults[1].what);
  EXPECT_DOUBLE_EQ(dirt.from_deg, 350.0);
  EXPECT_DOUBLE_EQ(dirt.transmission, 0.2);
  write("velodyne-vlp-16", "    faults: [{type: dead_laser, at: 0 s, first: 16, last: 16}]\n");
  EXPECT_THAT(complaints(), HasSubstr("dead_laser first is 16"));
}

TEST_F(LidarKeys, AddressesAndPortsAreChecked) {
  write("velodyne-vlp-16", "    address: 255.255.255.255\n");
  EXPECT_THAT(complaints(), HasSubstr("allow_remote: true"));
  write("velodyne-vlp-16", "    source_address: here\n");
  EXPECT_THAT(complaints(), HasSubstr("devices.lidar.source_address: not an IPv4 address"));
  write("velodyne-vlp-16", "    web: {address: 0.0.0.0, port: 8080}\n");
  EXPECT_THAT(complaints(), HasSubstr("devices.lidar.web.address: reaches beyond"));
  write("velodyne-vlp-16", "    web: {port: 8080}\n",
        "  other: {type: velodyne-vlp-16, mount: {link: body}, port: 2370, position_port: 8310, "
        "web: {port: 8080}}\n");
  EXPECT_THAT(complaints(), HasSubstr("web.port: already taken by"));
}

}  // namespace
}  // namespace rigwire::hil
