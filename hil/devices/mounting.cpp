#include "hil/devices/mounting.h"

#include <optional>

#include "hil/world/gnss.h"
#include "hil/world/imu.h"

namespace rigwire::hil {

void mount_antenna(Site& site, StationIndex station, const MountConfiguration& mount,
                   const sim::GnssParameters& sensor, const std::vector<sim::GnssFault>& faults) {
  sim::GnssParameters parameters = sensor;
  parameters.faults = faults;
  site.world().add(make_world_gnss(station, site.name(), site.mount(mount), site.frame(),
                                   sim::GnssSensor(parameters, site.satellites(), site.calendar(),
                                                   site.frame(), site.seed(), site.name())));
}

void mount_inertial_unit(Site& site, StationIndex station, const MountConfiguration& mount,
                         const sim::ImuParameters& sensor,
                         const sim::MagnetometerConfiguration& magnetometer) {
  std::optional<sim::Magnetometer> field;
  if (magnetometer.present) {
    field.emplace(parameters_of(magnetometer), site.seed(), site.name());
  }
  site.world().add(make_world_imu(station, site.mount(mount),
                                  sim::ImuSensor(sensor, site.seed(), site.name()),
                                  std::move(field)));
}

}  // namespace rigwire::hil
