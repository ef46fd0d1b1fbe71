#include "hil/devices/velodyne.h"

#include <cassert>

#include "hil/files/lidar_calibration_file.h"

namespace rigwire::hil {
namespace {

using emulators::VelodyneTimeSource;

VelodyneTimeSource time_source_of(const VelodyneConfiguration& p) {
  if (p.time_source == VelodyneConfiguration::kAutomaticTimeSource ||
      p.time_source == VelodyneConfiguration::kIdealTimeSource) {
    return VelodyneTimeSource::ideal;
  }
  if (p.time_source == VelodyneConfiguration::kPulseTimeSource) {
    return VelodyneTimeSource::pulse_only;
  }
  if (p.time_source == VelodyneConfiguration::kNoTimeSource) {
    return VelodyneTimeSource::none;
  }
  return VelodyneTimeSource::receiver;
}

/// Without what needs a file.
emulators::VelodyneSettings settings_but_calibration(const VelodyneConfiguration& p) {
  emulators::VelodyneSettings settings = p.lidar;
  settings.time_source = time_source_of(p);
  settings.faults = velodyne_faults(p.faults);
  return settings;
}

}  // namespace

emulators::VelodyneSettings settings_of(const VelodyneConfiguration& p) {
  emulators::VelodyneSettings settings = settings_but_calibration(p);
  if (!p.calibration_file.empty()) {
    settings.calibration = load_lidar_calibration(p.calibration_file);
  }
  return settings;
}

const protocols::velodyne::Model& model_of(const VelodyneConfiguration& p) {
  const auto* model = protocols::velodyne::find_model(std::string_view(p.lidar.model));
  assert(model != nullptr);
  return *model;
}

bool permits(const VelodyneConfiguration& p, std::string_view address) {
  return p.allow_remote || address.starts_with("127.");
}

void validate(const VelodyneConfiguration& p) {
  validate(settings_but_calibration(p));
  validate(p.sensor.beam);
  validate(p.sensor.images);
  validate(p.sensor.rotor);
}

}  // namespace rigwire::hil
