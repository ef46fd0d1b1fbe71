#include "hil/devices/mounting.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <variant>

#include "fields/check.h"
#include "hil/world/gnss.h"
#include "hil/world/imu.h"
#include "hil/world/joint.h"
#include "hil/world/truth_faults.h"
#include "sim/encoder/joint_angle.h"

namespace rigwire::hil {
namespace {

constexpr std::array<fields::Choice<char>, 3> kAxes{
    {{'x', "x", "Forward."}, {'y', "y", "To the left."}, {'z', "z", "Up."}}};

sim::GnssSensor antenna(Site& site, const sim::GnssParameters& sensor,
                        const std::vector<sim::GnssFault>& faults) {
  sim::GnssParameters parameters = sensor;
  parameters.faults = faults;
  sim::GnssSensor antenna(parameters, site.satellites(), site.calendar(), site.frame(), site.seed(),
                          site.name());
  antenna.share(site.antennas());
  return antenna;
}

}  // namespace

void mount_antenna(Site& site, StationIndex station, const MountConfiguration& mount,
                   const sim::GnssParameters& sensor, const std::vector<sim::GnssFault>& faults) {
  site.world().add(make_world_gnss(station, site.name(), site.mount(mount), site.frame(),
                                   antenna(site, sensor, faults)));
}

void set_up_antenna(Site& site, StationIndex station, const Eigen::Vector3d& p_W,
                    const sim::GnssParameters& sensor, const std::vector<sim::GnssFault>& faults) {
  site.world().add(
      make_world_gnss(station, site.name(), p_W, site.frame(), antenna(site, sensor, faults)));
}

void check_corrections(sim::CorrectionKind kind, bool takes_them, std::string_view receiver) {
  if (kind == sim::CorrectionKind::rtk && !takes_them) {
    throw fields::Refused(
        "sensor.corrections.kind",
        "found rtk, which is made of what arrives at the device's ports, and a " +
            std::string(receiver) +
            " makes no solution of it, allowed: none, sbas, service, assumed_rtk");
  }
}

void check_band(const sim::JammingFault& jamming, std::size_t index, RadioBands bands,
                const std::string& at, RigCheck& check) {
  if (bands == RadioBands::one && jamming.band != sim::JammedBand::all) {
    check.report(fmt::format("{}.faults.{}.band", at, index), "this receiver has one band",
                 jamming.band == sim::JammedBand::l1 ? "l1" : "l2", "all");
  }
}

std::unique_ptr<FaultPort> antenna_faults(Executive& executive, Station& station, RadioBands bands,
                                          const std::vector<sim::GnssFault>& faults) {
  return truth_faults<sim::GnssFault>(
      executive, station, faults, [bands](const sim::GnssFault& fault) {
        if (bands == RadioBands::one && sim::tells_bands_apart(fault)) {
          throw std::invalid_argument("band: this receiver has one band, allowed all");
        }
      });
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

void visit(fields::Visitor& v, JointConfiguration& p) {
  v.text("base", p.base, "Link of the machine that carries the housing.");
  v.text("link", p.link, "Link of the machine that turns the shaft.");
  v.choice("axis", p.axis, kAxes, "Axis of the base link about which the shaft turns.");
}

void check_joint(const JointConfiguration& joint, const std::string& at, RigCheck& check) {
  check.link(at + ".base", joint.base);
  check.link(at + ".link", joint.link);
  if (joint.base == joint.link) {
    check.report(at + ".link", "turns against itself", "\"" + joint.link + "\"",
                 "another link than `base`");
  }
}

void mount_encoder(Site& site, StationIndex station, const JointConfiguration& joint) {
  site.world().add(make_world_joint(station, site.link(joint.base), site.link(joint.link),
                                    sim::JointAngle(joint.axis - 'x')));
}

}  // namespace rigwire::hil
