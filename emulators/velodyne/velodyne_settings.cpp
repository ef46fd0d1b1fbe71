#include "emulators/velodyne/velodyne_settings.h"

#include <cmath>
#include <stdexcept>

#include "protocols/velodyne/packet_layout.h"

namespace rigwire::emulators {
namespace {

namespace velodyne = protocols::velodyne;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// Step of the rotor's setting in the models that have a web interface.
constexpr int kRotorStep_rpm = 60;

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("velodyne lidar: " + what);
}

/// Limits given in integers print as integers.
template <class Number>
void check(const char* member, Number value, Number least, Number most) {
  if (!(value >= least && value <= most)) {
    refuse(std::string(member) + " is " + std::to_string(value) +
           ", allowed: " + std::to_string(least) + " to " + std::to_string(most));
  }
}

void check(const char* member, Duration value, Duration least, Duration most) {
  if (value < least || value > most) {
    refuse(std::string(member) + " is " + std::to_string(value.count()) + " ns, allowed: " +
           std::to_string(least.count()) + " ns to " + std::to_string(most.count()) + " ns");
  }
}

std::string model_names() {
  std::string names;
  for (const velodyne::Model& model : velodyne::models()) {
    names += (names.empty() ? "" : ", ") + std::string(model.name);
  }
  return names;
}

void check_rotor(double rpm, const velodyne::Model& model) {
  const int step = model.web_interface ? kRotorStep_rpm : 1;
  const bool within = rpm >= model.minimum_rotor_rpm && rpm <= model.maximum_rotor_rpm &&
                      std::fmod(rpm, step) == 0.0;
  if (!(rpm == 0.0 || within)) {
    refuse("rotor_rpm is " + std::to_string(rpm) + ", allowed: 0 or " +
           std::to_string(model.minimum_rotor_rpm) + " to " +
           std::to_string(model.maximum_rotor_rpm) + " in steps of " + std::to_string(step));
  }
}

void check_direction(const char* member, const Vector3& v) {
  const double squared = v.x * v.x + v.y * v.y + v.z * v.z;
  if (!(squared == 0.0 || std::abs(squared - 1.0) < 1e-6)) {
    refuse(std::string("inertial_axes ") + member + " has the length " +
           std::to_string(std::sqrt(squared)) + ", allowed: 1, or 0 for none");
  }
}

void check_laser_range(const VelodyneFault& fault, const velodyne::Model& model) {
  const int count = static_cast<int>(model.lasers.size());
  check("dead_laser first_laser", fault.first_laser, 0, count - 1);
  check("dead_laser last_laser", fault.last_laser, fault.first_laser, count - 1);
}

void check_sector(const VelodyneFault& fault) {
  check("dirty_window sector_start_deg", fault.sector_start_deg, 0.0, 360.0);
  check("dirty_window sector_end_deg", fault.sector_end_deg, 0.0, 360.0);
  if (fault.sector_start_deg == fault.sector_end_deg) {
    refuse(
        "dirty_window sector_end_deg is the sector's start, allowed: any other azimuth; 0 and "
        "360 are all round");
  }
  if (!(fault.transmission >= 0.0 && fault.transmission < 1.0)) {
    refuse("dirty_window transmission is " + std::to_string(fault.transmission) +
           ", allowed: 0 <= transmission < 1");
  }
}

void check_fault(const VelodyneFault& fault, const VelodyneSettings& settings,
                 const velodyne::Model& model) {
  const std::string kind(name(fault.kind));
  if (fault.begin < Duration::zero() || fault.end <= fault.begin) {
    refuse("fault " + kind + " lasts from " + std::to_string(fault.begin.count()) + " ns to " +
           std::to_string(fault.end.count()) + " ns, allowed: 0 <= begin < end");
  }
  switch (fault.kind) {
    case VelodyneFaultKind::lost_packets:
    case VelodyneFaultKind::swapped_packets:
    case VelodyneFaultKind::duplicated_packets:
      if (!(fault.probability > 0.0 && fault.probability <= 1.0)) {
        refuse("fault " + kind + " has the probability " + std::to_string(fault.probability) +
               ", allowed: 0 < probability <= 1");
      }
      break;
    case VelodyneFaultKind::dead_laser:
      check_laser_range(fault, model);
      break;
    case VelodyneFaultKind::dirty_window:
      check_sector(fault);
      break;
    case VelodyneFaultKind::motor_stall:
      break;
    case VelodyneFaultKind::pulse_loss:
    case VelodyneFaultKind::pulse_noise:
      if (settings.time_source == VelodyneTimeSource::none) {
        refuse("fault " + kind + " needs a pulse, but time_source is none");
      }
      break;
    case VelodyneFaultKind::sentence_loss:
      if (settings.time_source == VelodyneTimeSource::none ||
          settings.time_source == VelodyneTimeSource::pulse_only) {
        refuse("fault " + kind + " needs sentences, but time_source gives none");
      }
      break;
    case VelodyneFaultKind::clock_offset:
      check("clock_offset seconds", fault.seconds, -3600.0, 3600.0);
      if (fault.seconds == 0.0) {
        refuse("clock_offset seconds is 0, which is no offset");
      }
      break;
    case VelodyneFaultKind::hour_overrun:
      if (!(fault.seconds > 0.0 && fault.seconds <= 1.0)) {
        refuse("hour_overrun seconds is " + std::to_string(fault.seconds) +
               ", allowed: 0 < seconds <= 1");
      }
      break;
    case VelodyneFaultKind::factory_bytes:
      if (model.status_channel) {
        refuse("fault factory_bytes: the " + std::string(model.name) +
               " has a status channel in their place");
      }
      break;
  }
}

}  // namespace

VelodyneRangeWindow range_window(const VelodyneSettings& settings, const velodyne::Model& model) {
  const auto or_default = [](double value, double fallback) {
    return value > 0.0 ? value : fallback;
  };
  return {or_default(settings.minimum_range_m, model.minimum_range_m),
          or_default(settings.maximum_range_m, model.maximum_range_m)};
}

void validate(const VelodyneSettings& settings) {
  const velodyne::Model* model = velodyne::find_model(std::string_view(settings.model));
  if (model == nullptr) {
    refuse("model '" + settings.model + "' is not known; allowed: " + model_names());
  }
  check_rotor(settings.rotor_rpm, *model);
  if (settings.return_mode == velodyne::ReturnMode::dual && !model->dual_return) {
    refuse("return_mode is dual, which the " + std::string(model->name) +
           " cannot; allowed: strongest, last");
  }
  check("view_start_deg", settings.view_start_deg, 0, 359);
  check("view_end_deg", settings.view_end_deg, 0, 359);
  check("phase_lock_offset_centideg", settings.phase_lock_offset_centideg, 0, 35999);
  if (settings.legacy_factory_bytes && model->status_channel) {
    refuse("legacy_factory_bytes: the " + std::string(model->name) +
           " has a status channel in their place");
  }
  if (settings.calibration) {
    if (!model->status_channel) {
      refuse("calibration: the " + std::string(model->name) + " measures true ranges, it has none");
    }
    validate(*settings.calibration);
  }
  const double largest = 65535.0 * model->distance_unit_mm * 1e-3;
  const auto [minimum, maximum] = range_window(settings, *model);
  if (!(settings.minimum_range_m >= 0.0 && settings.maximum_range_m >= 0.0 && minimum < maximum &&
        maximum <= largest)) {
    refuse("range limits are " + std::to_string(minimum) + " m and " + std::to_string(maximum) +
           " m, allowed: 0 < minimum < maximum <= " + std::to_string(largest) + " m");
  }
  const std::int64_t packet_ns = packet_period_ns(*model, velodyne::ReturnMode::strongest);
  check("send_delay", settings.send_delay, Duration::zero(), Duration{packet_ns});
  if (settings.position_period != Duration::zero() && settings.position_period < milliseconds{1}) {
    refuse("position_period is " + std::to_string(settings.position_period.count()) +
           " ns, allowed: 0 (the model's own) or at least 1 ms");
  }
  check("start_up", settings.start_up, Duration::zero(), seconds{600});
  check("clock_drift_ppm", settings.clock_drift_ppm, -200.0, 200.0);
  check("pulse_length", settings.pulse_length, milliseconds{20}, milliseconds{200});
  check("sentence_delay", settings.sentence_delay, milliseconds{50}, milliseconds{500});
  check("pulse_qualifier_delay", settings.pulse_qualifier_delay, Duration::zero(), seconds{65535});
  for (const VelodyneInertialAxes& axes : settings.inertial_axes) {
    check_direction("gyro", axes.gyro);
    check_direction("acceleration_x", axes.acceleration_x);
    check_direction("acceleration_y", axes.acceleration_y);
  }
  for (const VelodyneFault& fault : settings.faults) {
    check_fault(fault, settings, *model);
  }
}

VelodyneLiveSettings saved_settings(const VelodyneSettings& settings) {
  return {.rotor_rpm = static_cast<int>(std::lround(settings.rotor_rpm)),
          .return_mode = settings.return_mode,
          .laser_on = settings.laser_on,
          .view_start_deg = settings.view_start_deg,
          .view_end_deg = settings.view_end_deg,
          .phase_lock = settings.phase_lock,
          .phase_lock_offset_centideg = settings.phase_lock_offset_centideg,
          .host_address = settings.host_address,
          .data_port = settings.data_port,
          .telemetry_port = settings.telemetry_port,
          .net_address = settings.net_address,
          .net_mask = settings.net_mask,
          .net_gateway = settings.net_gateway,
          .net_dhcp = settings.net_dhcp};
}

}  // namespace rigwire::emulators
