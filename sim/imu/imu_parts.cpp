// Parameter sets of real inertial units, in the units of their data sheets.

#include "fields/constants.h"
#include "sim/imu/imu_sensor.h"

namespace rigwire::sim {
namespace {

constexpr double kDegreePerHour = kDegree / 3600.0;
constexpr double kMicroG = 1e-6 * kGravity_mps2;

struct Sheet {
  double rate_range_dps;
  double rate_noise_dps;  ///< deg/s/sqrt(Hz)
  double rate_bias_dph;   ///< In-run, deg/h.
  double g_sensitivity_dps_per_g;
  double force_range_g;
  double force_noise_ug;  ///< ug/sqrt(Hz)
  double force_bias_ug;   ///< In-run.
  double scale;           ///< 1
  double misalignment_deg;
  double turn_on_rate_dps;
  double turn_on_force_mg;
  double self_heating_k;
};

ImuParameters from(ImuPart part, const Sheet& sheet) {
  ImuParameters imu;
  imu.part = part;
  imu.gyroscope.range = sheet.rate_range_dps * kDegree;
  imu.gyroscope.random.noise_density = sheet.rate_noise_dps * kDegree;
  imu.gyroscope.random.bias_instability = sheet.rate_bias_dph * kDegreePerHour;
  imu.gyroscope.turn_on_bias = sheet.turn_on_rate_dps * kDegree;
  imu.gyroscope.scale_error = sheet.scale;
  imu.gyroscope.misalignment_rad = sheet.misalignment_deg * kDegree;
  imu.g_sensitivity_radps_per_mps2 = sheet.g_sensitivity_dps_per_g * kDegree / kGravity_mps2;
  imu.accelerometer.range = sheet.force_range_g * kGravity_mps2;
  imu.accelerometer.random.noise_density = sheet.force_noise_ug * kMicroG;
  imu.accelerometer.random.bias_instability = sheet.force_bias_ug * kMicroG;
  imu.accelerometer.turn_on_bias = 1e3 * sheet.turn_on_force_mg * kMicroG;
  imu.accelerometer.scale_error = sheet.scale;
  imu.accelerometer.misalignment_rad = sheet.misalignment_deg * kDegree;
  imu.self_heating_k = sheet.self_heating_k;
  return imu;
}

}  // namespace

ImuParameters perfect_imu() {
  return {};
}

// Turn-on biases and self-heating are judgement throughout.

ImuParameters openimu300_class() {
  return from(ImuPart::openimu300,
              {400.0, 0.005, 6.0, 0.01, 8.0, 70.0, 10.0, 1e-3, 0.05, 0.05, 2.0, 10.0});
}

ImuParameters adis16470() {
  return from(ImuPart::adis16470,
              {2000.0, 0.008, 8.0, 0.009, 40.0, 100.0, 13.0, 3e-3, 0.05, 0.2, 2.0, 5.0});
}

ImuParameters mti300() {
  return from(ImuPart::mti300,
              {450.0, 0.01, 10.0, 0.003, 20.0, 60.0, 15.0, 5e-4, 0.05, 0.2, 2.0, 8.0});
}

ImuParameters mti30() {
  return from(ImuPart::mti30,
              {450.0, 0.03, 18.0, 0.006, 20.0, 80.0, 40.0, 5e-4, 0.05, 0.2, 3.0, 8.0});
}

ImuParameters parameters_of(ImuPart part) {
  switch (part) {
    case ImuPart::perfect:
      break;
    case ImuPart::openimu300:
      return openimu300_class();
    case ImuPart::adis16470:
      return adis16470();
    case ImuPart::mti300:
      return mti300();
    case ImuPart::mti30:
      return mti30();
  }
  return perfect_imu();
}

}  // namespace rigwire::sim
