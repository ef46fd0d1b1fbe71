// Sensors that several types of devices carry, put on the machine for the station of a device.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "fields/visitor.h"
#include "hil/devices/rig_check.h"
#include "hil/devices/site.h"
#include "hil/executive/station.h"
#include "sim/gnss/gnss_sensor.h"
#include "sim/imu/imu_sensor.h"
#include "sim/imu/magnetometer.h"

namespace rigwire::hil {

/// Mounts a satellite antenna with its faults.
void mount_antenna(Site& site, StationIndex station, const MountConfiguration& mount,
                   const sim::GnssParameters& sensor, const std::vector<sim::GnssFault>& faults);
/// Bands of a receiver's radio part.
enum class RadioBands : unsigned char { one, two };
[[nodiscard]] inline RadioBands bands_of(const sim::GnssParameters& sensor) {
  return sensor.second_signals ? RadioBands::two : RadioBands::one;
}

/// Returns the port for further faults of an antenna, as truth_faults() makes it. A fault of a
/// single band is refused for a receiver with one band.
[[nodiscard]] std::unique_ptr<FaultPort> antenna_faults(Executive& executive, Station& station,
                                                        RadioBands bands,
                                                        const std::vector<sim::GnssFault>& faults);
/// Refuses fault `index` of a rig's file if it jams a single band of a receiver with one band;
/// `at`: key path of the device.
void check_band(const sim::JammingFault& jamming, std::size_t index, RadioBands bands,
                const std::string& at, RigCheck& check);
template <class Faults>
void check_bands(const Faults& faults, RadioBands bands, const std::string& at, RigCheck& check) {
  for (std::size_t i = 0; i < faults.size(); ++i) {
    if (const auto* const jamming = std::get_if<sim::JammingFault>(&faults[i].what)) {
      check_band(*jamming, i, bands, at, check);
    }
  }
}

/// Sets up an antenna with its faults on the ground, at the point `p_W` of the world.
void set_up_antenna(Site& site, StationIndex station, const Eigen::Vector3d& p_W,
                    const sim::GnssParameters& sensor, const std::vector<sim::GnssFault>& faults);

/// Throws std::invalid_argument for RTK of a receiver that takes no corrections at its ports.
void check_corrections(sim::CorrectionKind kind, bool takes_them, std::string_view receiver);

/// An inertial unit, and its magnetometer if it has one.
void mount_inertial_unit(Site& site, StationIndex station, const MountConfiguration& mount,
                         const sim::ImuParameters& sensor,
                         const sim::MagnetometerConfiguration& magnetometer);

/// A joint of the machine whose angle is read.
struct JointConfiguration {
  std::string base = "undercarriage";  ///< Link that carries the housing.
  std::string link = "upper";          ///< Link that turns the shaft.
  char axis = 'z';  ///< Axis of the base link about which the shaft turns: x, y or z.
};
/// Visits its keys, which are beside those of the device.
void visit(fields::Visitor& v, JointConfiguration& p);
/// `at`: key path of the joint's keys.
void check_joint(const JointConfiguration& joint, const std::string& at, RigCheck& check);
void mount_encoder(Site& site, StationIndex station, const JointConfiguration& joint);

}  // namespace rigwire::hil
