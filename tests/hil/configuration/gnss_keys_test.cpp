// Keys of satellite receivers, their faults, their satellites and the geoid.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "hil/configuration/fault_window.h"
#include "hil/devices/ublox.h"
#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// The campus rig with lines appended to it.
class GnssKeys : public ::testing::Test {
 protected:
  void TearDown() override { fs::remove(file); }

  void write(const std::string& text) { std::ofstream(file) << text; }
  /// A rig of its own, whose only device is a receiver with these keys beside its type.
  void write_receiver(const std::string& keys, const std::string& type = "ublox-neo-7p") {
    write("machine: {type: wheeled}\ndevices:\n  gnss:\n    type: " + type +
          "\n    mount: {link: body}\n" + keys);
  }
  std::string complaints(const std::vector<std::string>& sets = {}) {
    try {
      (void)load_rig(file.string(), sets);
      return "";
    } catch (const ConfigurationError& error) {
      return error.what();
    }
  }
  RigConfiguration rig() { return load_rig(file.string(), {}).configuration; }
  const UbloxConfiguration& receiver() {
    loaded = rig();
    return *fields::as<UbloxConfiguration>(loaded.devices.at("gnss"));
  }

  fs::path file = fs::temp_directory_path() / ("rigwire_gnss_" + std::to_string(::getpid()));
  RigConfiguration loaded;
};

TEST_F(GnssKeys, AReceiverChecksItsClientsSpeedUnlessToldNotTo) {
  write_receiver("");
  EXPECT_EQ(receiver().check_baud, BaudCheck::lenient);
  write_receiver("    check_baud: strict\n");
  EXPECT_EQ(receiver().check_baud, BaudCheck::strict);
  write_receiver("    check_baud: none\n");
  EXPECT_EQ(receiver().check_baud, BaudCheck::none);
}

TEST_F(GnssKeys, EachTypeBringsItsProfile) {
  write_receiver("");
  EXPECT_EQ(receiver().receiver.profile, &emulators::ublox_neo_7p());
  write_receiver("", "ublox-neo-m8");
  EXPECT_EQ(receiver().receiver.profile, &emulators::ublox_neo_m8());
  write_receiver("", "ublox-zed-f9p");
  EXPECT_EQ(receiver().receiver.profile, &emulators::ublox_zed_f9p());
  EXPECT_EQ(receiver().receiver.baud, emulators::ublox_zed_f9p().baud);
}

TEST_F(GnssKeys, GreatestRateIsTheTypes) {
  write_receiver("    rate: 25 Hz\n    baud: 115200\n    nmea_sentences: [RMC]\n");
  EXPECT_THAT(complaints(), HasSubstr("devices.gnss.rate: out of range"));
}

TEST_F(GnssKeys, FaultsOfTheSurroundingsGoToTheSignals) {
  write_receiver(R"(    faults:
      - {type: outage, at: 10 s, for: 5 s}
      - {type: jamming, at: 20 s, for: 1 s, loss: 15 dB}
      - {type: spoofing, at: 30 s, velocity: [0 m/s, 2 m/s, 0 m/s], clock_rate: 3 m/s}
      - {type: jump, at: 40 s, offset: [1 m, 2 m, 3 m]}
      - {type: short, at: 50 s}
      - {type: open, at: 60 s}
      - {type: correction_outage, at: 70 s}
)");
  ASSERT_EQ(complaints(), "");
  const auto& configured = receiver().faults;
  const auto faults = those_of<sim::GnssFault>(configured);
  ASSERT_EQ(faults.size(), 7U);
  EXPECT_EQ(faults[0].when, (FaultPeriod{seconds(10), seconds(5)}));
  EXPECT_TRUE(std::holds_alternative<sim::OutageFault>(faults[0].what));
  EXPECT_EQ(std::get<sim::JammingFault>(faults[1].what).loss_db, 15.0);
  const auto& spoof = std::get<sim::SpoofDriftFault>(faults[2].what);
  EXPECT_EQ(spoof.velocity_mps, Eigen::Vector3d(0.0, 2.0, 0.0));
  EXPECT_EQ(spoof.clock_rate_mps, 3.0);
  EXPECT_EQ(faults[2].when.length, std::nullopt);
  EXPECT_EQ(std::get<sim::JumpFault>(faults[3].what).offset_m, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_TRUE(std::holds_alternative<sim::AntennaShortFault>(faults[4].what));
  EXPECT_TRUE(std::holds_alternative<sim::AntennaOpenFault>(faults[5].what));
  EXPECT_TRUE(std::holds_alternative<sim::CorrectionOutageFault>(faults[6].what));
  EXPECT_TRUE(those_of<emulators::UbloxFault>(configured).empty());
}

TEST_F(GnssKeys, FaultsOfTheDeviceGoToTheEmulator) {
  write_receiver(R"(    faults:
      - {type: frozen, at: 1 s, for: 2 s}
      - {type: wrong_leap_second, at: 3 s, for: 4 s, seconds: -2}
      - {type: noise, at: 5 s, for: 6 s, bit_error_rate: 0.01}
)");
  ASSERT_EQ(complaints(), "");
  const auto& configured = receiver().faults;
  const auto faults = those_of<emulators::UbloxFault>(configured);
  ASSERT_EQ(faults.size(), 3U);
  EXPECT_EQ(faults[0].when, (FaultPeriod{seconds(1), seconds(2)}));
  EXPECT_TRUE(std::holds_alternative<emulators::FrozenFixFault>(faults[0].what));
  EXPECT_EQ(std::get<emulators::WrongLeapSecondFault>(faults[1].what).seconds, -2);
  EXPECT_EQ(std::get<emulators::UartNoiseFault>(faults[2].what).bit_error_rate, 0.01);
  EXPECT_EQ(faults[2].when.end(), kStart + seconds(11));
  EXPECT_TRUE(those_of<sim::GnssFault>(configured).empty());
}

TEST_F(GnssKeys, UnknownFaultsAndKeysAreRefusedWithWhatIsAllowed) {
  write_receiver("    faults:\n      - {type: jaming, at: 1 s}\n");
  EXPECT_THAT(complaints(), AllOf(HasSubstr("devices.gnss.faults.0.type"), HasSubstr("spoofing"),
                                  HasSubstr("did you mean jamming?")));
  write_receiver("    faults:\n      - {type: jamming, at: 1 s, los: 3 dB}\n");
  EXPECT_THAT(complaints(), HasSubstr("faults.0.los: unknown key, did you mean loss?"));
  write_receiver("    faults:\n      - {type: outage, at: 1 s, loss: 3 dB}\n");
  EXPECT_THAT(complaints(), HasSubstr("faults.0.loss: unknown key"));
  write_receiver("    faults:\n      - {type: outage}\n");
  EXPECT_EQ(complaints(), "") << "from the start of the run to its end";
  write_receiver("    faults:\n      - {at: 1 s}\n");
  EXPECT_THAT(complaints(), HasSubstr("faults.0.type: missing key"));
  write_receiver("    faults:\n      - {type: jamming, at: 1 s, loss: 3 m}\n");
  EXPECT_THAT(complaints(), HasSubstr("wrong unit"));
  write_receiver("    faults:\n      - {type: wrong_leap_second, at: 1 s, seconds: 0}\n");
  EXPECT_THAT(complaints(), HasSubstr("0 is the right number of leap seconds"));
  write_receiver("    faults:\n      - {type: outage, at: 1 s, for: -1 s}\n");
  EXPECT_THAT(complaints(), HasSubstr("faults.0.for: out of range"));
}

TEST_F(GnssKeys, AJammerOfOneBandNeedsAReceiverOfTwo) {
  const std::string l2 = "    faults: [{type: jamming, at: 1 s, band: l2}]\n";
  write_receiver(l2, "ublox-zed-f9p");
  EXPECT_EQ(complaints(), "");
  for (const char* type : {"ublox-neo-7p", "ublox-neo-m8t", "starfire-3000"}) {
    write_receiver(l2, type);
    EXPECT_THAT(complaints(),
                AllOf(HasSubstr("devices.gnss.faults.0.band: this receiver has one band"),
                      HasSubstr("all")))
        << type;
  }
  write_receiver("    faults: [{type: jamming, at: 1 s, band: all}]\n");
  EXPECT_EQ(complaints(), "");
}

TEST_F(GnssKeys, FaultsThatADeviceDoesNotImplementAreRefused) {
  write_receiver("    faults: [{type: outage, at: 1 s}]\n", "starfire-3000");
  EXPECT_EQ(complaints(), "");
  write_receiver("    faults: [{type: outage, at: 1 s}, {type: frozen, at: 1 s}]\n",
                 "starfire-3000");
  EXPECT_THAT(complaints(), AllOf(HasSubstr("devices.gnss.faults.1.type: unknown type"),
                                  HasSubstr("\"frozen\""), HasSubstr("jamming")));
}

TEST_F(GnssKeys, AStarFireNeedsAWire) {
  write_receiver("    path: \"\"\n", "starfire-3000");
  EXPECT_THAT(complaints(), HasSubstr("neither `path` nor `bus` is given"));
  write_receiver("    bus: cam\n", "starfire-3000");
  EXPECT_THAT(complaints(), HasSubstr("devices.gnss.bus: no such bus"));
}

TEST_F(GnssKeys, OnlyAReceiverOnUsbHasAPlugToPull) {
  write_receiver("    path: /tmp/rigwire_gnss_plug\n    faults: [{type: unplugged, at: 5 s}]\n");
  EXPECT_THAT(complaints(), AllOf(HasSubstr("devices.gnss.faults.0.type: there is no plug"),
                                  HasSubstr("wire: usb")));
}

TEST_F(GnssKeys, AFileThatIsPlayedHasNoFaults) {
  write(
      "machine: {type: wheeled}\ndevices:\n  tape:\n    type: replay\n"
      "    file: tape.nmea\n    faults: []\n");
  EXPECT_THAT(complaints(), HasSubstr("devices.tape.faults: unknown key"));
}

TEST_F(GnssKeys, GeoidIsAConstantOrAGridAndNeverBoth) {
  const std::string machine = "machine: {type: wheeled}\n";
  write(machine + "origin: {geoid_separation: 40 m}\n");
  EXPECT_EQ(rig().origin.geoid, GeoidSource::constant);
  write(machine + "origin: {geoid: egm96}\n");
  EXPECT_EQ(rig().origin.geoid, GeoidSource::egm96);
  write(machine + "origin: {geoid: egm96, geoid_separation: 40 m}\n");
  EXPECT_THAT(complaints(), HasSubstr("origin.geoid_separation: has no effect with geoid: egm96"));
  write(machine + "origin: {geoid_interpolation: bicubic}\n");
  EXPECT_THAT(complaints(),
              HasSubstr("origin.geoid_interpolation: has no effect; it needs geoid: egm96"));
  write(machine + "origin: {geoid: egm96, geoid_file: nowhere.gtx}\n");
  EXPECT_THAT(complaints(), HasSubstr("origin.geoid_file: no such file"));
}

TEST_F(GnssKeys, PrintedRigLoadsToTheSameHashWhateverTheGeoid) {
  for (const char* geoid : {"constant", "egm96"}) {
    write("machine: {type: wheeled}\norigin: {geoid: " + std::string(geoid) + "}\n");
    const LoadedRig first = load_rig(file.string(), {});
    write(print_rig(first));
    EXPECT_EQ(config_hash(rig()), config_hash(first.configuration)) << geoid;
  }
}

TEST_F(GnssKeys, SatellitesStandInTheirSlotsOrComeFromAFile) {
  const std::string machine = "machine: {type: wheeled}\n";
  write(machine + "satellites: {systems: [gps, galileo]}\n");
  EXPECT_EQ(systems_of(rig().satellites), (std::vector{GnssSystem::gps, GnssSystem::galileo}));
  write(machine + "satellites: {systems: [gps, glonas]}\n");
  EXPECT_THAT(complaints(), AllOf(HasSubstr("\"glonas\""), HasSubstr("beidou, qzss, glonass")));
  write(machine + "satellites: {systems: [gps, gps]}\n");
  EXPECT_THAT(complaints(), HasSubstr("\"gps\" twice"));
  write(machine + "satellites: {systems: []}\n");
  EXPECT_THAT(complaints(), HasSubstr("systems is empty"));
  write(machine + "satellites: {file: " + file.string() + ", systems: [gps]}\n");
  EXPECT_THAT(complaints(), HasSubstr("satellites.systems: has no effect with file: "));
  write(machine + "satellites: {file: nowhere.rnx}\n");
  EXPECT_THAT(complaints(), HasSubstr("satellites.file: no such file"));
}

TEST_F(GnssKeys, StartsFrom1999To2035AreTaken) {
  for (const char* start :
       {"1999-08-21T23:59:40Z", "2016-12-31T23:59:60Z", "2035-12-31T23:59:59Z"}) {
    write("machine: {type: wheeled}\nstart: " + std::string(start) + "\n");
    EXPECT_EQ(complaints(), "") << start;
  }
}

}  // namespace
}  // namespace rigwire::hil
