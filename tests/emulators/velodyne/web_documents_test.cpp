#include "emulators/velodyne/web_documents.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "web_control_stub.h"

namespace rigwire::emulators {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

// Conversions of the manual, from counts to what a monitor shows.
constexpr double kVoltsPerCount = 5.0 / 4096.0;
double temperature_c(int counts) {
  return -1481.96 + std::sqrt(2.1962e6 + (1.8639 - counts * kVoltsPerCount) / 3.88e-6);
}
double input_voltage_v(int counts) {
  return 11.0 * counts * kVoltsPerCount;
}
double input_current_a(int counts) {
  return 10.0 * (counts * kVoltsPerCount - 2.5);
}

TEST(VelodyneWebDocuments, SettingsHaveTheTypesOfARealSensor) {
  VelodyneLiveSettings live;
  live.phase_lock = true;
  live.phase_lock_offset_centideg = 9000;
  EXPECT_EQ(settings_document(live),
            R"({"laser":"On","returns":"Strongest","rpm":600,"fov":{"start":0,"end":359},)"
            R"("phaselock":{"enabled":"On","offset":"9000"},)"
            R"("host":{"addr":"255.255.255.255","dport":"2368","tport":"8308"},)"
            R"("net":{"addr":"192.168.1.201","mask":"255.255.255.0","gateway":"192.168.1.1",)"
            R"("dhcp":"Off"}})");
}

TEST(VelodyneWebDocuments, StatusTellsPulseMotorAndLaser) {
  VelodyneReadings readings;
  readings.pulse_state = protocols::velodyne::PulseState::locked;
  readings.gps_position = "49 26.00N 007 45.00E";
  readings.motor_rpm = 599.6;
  readings.motor_locked = true;
  readings.motor_phase_centideg = 35999;
  EXPECT_EQ(status_document({}, readings),
            R"({"gps":{"pps_state":"Locked","position":"49 26.00N 007 45.00E"},)"
            R"("motor":{"state":"On","rpm":600,"lock":"On","phase":35999},)"
            R"("laser":{"state":"On"}})");
}

TEST(VelodyneWebDocuments, LaserThatWaitsForTheRotorIsDisabledNotOff) {
  VelodyneReadings readings;
  readings.laser_on = false;
  VelodyneLiveSettings live;
  EXPECT_THAT(status_document(live, readings), HasSubstr(R"("laser":{"state":"Disabled"})"));
  live.laser_on = false;
  EXPECT_THAT(status_document(live, readings), HasSubstr(R"("laser":{"state":"Off"})"));
}

TEST(VelodyneWebDocuments, TextCannotLeaveItsQuotes) {
  VelodyneReadings readings;
  readings.gps_position = "a\"b\\c\nd";
  EXPECT_THAT(status_document({}, readings), HasSubstr(R"("position":"a\"b\\cd")"));
}

TEST(VelodyneWebDocuments, CountsGoBackToTheReadings) {
  for (double wanted_c = -40.0; wanted_c <= 90.0; wanted_c += 0.5) {
    EXPECT_NEAR(temperature_c(temperature_counts(wanted_c)), wanted_c, 0.06);
  }
  for (double wanted_v = 8.0; wanted_v <= 19.0; wanted_v += 0.1) {
    EXPECT_NEAR(input_voltage_v(input_voltage_counts(wanted_v)), wanted_v, 0.0068);
  }
  for (double wanted_a = 0.3; wanted_a <= 1.0; wanted_a += 0.01) {
    EXPECT_NEAR(input_current_a(input_current_counts(wanted_a)), wanted_a, 0.0062);
  }
}

TEST(VelodyneWebDocuments, CountsEndWhereTheConverterEnds) {
  EXPECT_EQ(input_voltage_counts(1000.0), 4095);
  EXPECT_EQ(input_voltage_counts(-1.0), 0);
}

TEST(VelodyneWebDocuments, DiagnosticsDifferByFamily) {
  const std::string puck = diagnostics_document({}, false);
  EXPECT_THAT(puck, StartsWith(R"({"volt_temp":{"top":{"hv":)"));
  EXPECT_THAT(puck, HasSubstr(R"("pwr_5v_raw":2191)"));
  EXPECT_THAT(puck, HasSubstr(R"("vhv":412,"adc_nf":14,"ixe":1})"));
  const std::string ultra_puck = diagnostics_document({}, true);
  EXPECT_THAT(ultra_puck, Not(HasSubstr("pwr_5v_raw")));
  EXPECT_THAT(ultra_puck, HasSubstr(R"("pwr_raw":)"));
  EXPECT_THAT(ultra_puck, HasSubstr(R"("adc_stats":[{"mean":)"));
  EXPECT_THAT(ultra_puck, HasSubstr(R"("adctp_stat":[)"));
}

TEST(VelodyneWebDocuments, FamilyFollowsTheModel) {
  WebControlStub control;
  EXPECT_FALSE(has_diagnostic_arrays(control));
  for (const char* model : {"VLP-32C", "VLS-128"}) {
    control.model = model;
    EXPECT_TRUE(has_diagnostic_arrays(control)) << model;
  }
}

TEST(VelodyneWebDocuments, SnapshotHoldsTheOtherFour) {
  WebControlStub control;
  const std::string snapshot = snapshot_document(SimTime{}, control);
  EXPECT_EQ(snapshot, "{\"info\":" + info_document(control) +
                          ",\"config\":" + settings_document(control.live) +
                          ",\"status\":" + status_document(control.live, control.measured) +
                          ",\"diag\":" + diagnostics_document(control.measured, false) + "}");
  EXPECT_THAT(snapshot, HasSubstr(R"("model":"VLP-16","serial":"11001191157192")"));
}

TEST(VelodyneWebDocuments, HardwareAddressBelongsToTheSerialNumber) {
  WebControlStub one;
  WebControlStub other;
  EXPECT_EQ(info_document(one), info_document(other));
  other.serial = "11001191157193";
  EXPECT_NE(info_document(one).substr(info_document(one).find("mac_addr")),
            info_document(other).substr(info_document(other).find("mac_addr")));
}

}  // namespace
}  // namespace rigwire::emulators
