#include "emulators/velodyne/velodyne_settings.h"

#include <cmath>
#include <stdexcept>

#include "fields/check.h"
#include "fields/visitor.h"
#include "protocols/velodyne/packet_layout.h"

namespace rigwire::emulators {
namespace {

namespace velodyne = protocols::velodyne;
using fields::in;
using fields::IntegerRule;
using std::chrono::milliseconds;

constexpr std::array<fields::Choice<velodyne::ReturnMode>, 3> kReturnModes{
    {{velodyne::ReturnMode::strongest, "strongest", "The strongest echo of a shot."},
     {velodyne::ReturnMode::last, "last", "The last echo of a shot."},
     {velodyne::ReturnMode::dual, "dual", "Both, or the second strongest."}}};
constexpr std::array<fields::Choice<VelodyneReflectivity>, 4> kReflectivityScales{
    {{VelodyneReflectivity::model, "model", "The scale of the model."},
     {VelodyneReflectivity::to_100, "to_100", "Retro-reflectors from 101."},
     {VelodyneReflectivity::to_110, "to_110", "Retro-reflectors from 111."},
     {VelodyneReflectivity::full, "full", "0 .. 255, retro-reflectors at 255."}}};

constexpr std::string_view kUntil517 = "5.1.7";
constexpr std::array<fields::Choice<VelodyneFirmware>, 2> kFirmwares{
    {{VelodyneFirmware::newest, "newest", "5.2.3.0 and later: a firing lasts 57.8 us."},
     {VelodyneFirmware::until_5_1_7, kUntil517, "Up to 5.1.7.1: a firing lasts 53.3 us."}}};

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

/// Returns the maximum distance that the 16 bits of a return can hold.
double farthest_m(const velodyne::Model& model) {
  return 65535.0 * model.distance_unit_mm / 1000.0;
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
    refuse(std::string(member) + " has the length " + std::to_string(std::sqrt(squared)) +
           ", allowed: 1, or 0 for none");
  }
}

/// What a fault needs of the unit that it is to happen to; each alternative's own rules are kept.
struct FaultCheck {
  const VelodyneSettings& settings;
  const velodyne::Model& model;

  void operator()(const DeadLaserFault& fault) const {
    const int count = static_cast<int>(model.lasers.size());
    check("dead_laser first", fault.first, 0, count - 1);
    check("dead_laser last", fault.last, fault.first, count - 1);
  }
  void operator()(const DirtyWindowFault& fault) const {
    if (fault.from_deg == fault.to_deg) {
      refuse(
          "dirt to is where it begins, allowed: any other azimuth; 0 and 360 are all "
          "round");
    }
  }
  void operator()(const PulseLossFault& fault) const { needs_pulse(fault.kNamed.name); }
  void operator()(const PulseNoiseFault& fault) const { needs_pulse(fault.kNamed.name); }
  void operator()(const SentenceLossFault&) const {
    if (settings.time_source == VelodyneTimeSource::none ||
        settings.time_source == VelodyneTimeSource::pulse_only) {
      refuse("fault sentence_loss needs sentences, but time_source gives none");
    }
  }
  void operator()(const ClockOffsetFault& fault) const {
    if (fault.offset_s == 0.0) {
      refuse("wrong_time offset is 0, which is no offset");
    }
  }
  void operator()(const FactoryBytesFault&) const {
    if (model.status_channel) {
      refuse("fault factory_bytes: the " + std::string(model.name) +
             " has a status channel in their place");
    }
  }
  template <class Other>
  void operator()(const Other&) const {}

 private:
  void needs_pulse(std::string_view name) const {
    if (settings.time_source == VelodyneTimeSource::none) {
      refuse("fault " + std::string(name) + " needs a pulse, but time_source is none");
    }
  }
};

void visit_clock(fields::Visitor& v, VelodyneSettings& p) {
  v.number("drift", p.clock_drift_ppm, in("ppm").stored_as("ppm").between(-200, 200),
           "Error of the sensor's own crystal; positive = fast.");
  v.duration("pulse_length", p.pulse_length, {20'000'000, 200'000'000},
             "Length of the pulse per second.");
  v.duration("sentence_delay", p.sentence_delay, {50'000'000, 500'000'000},
             "From the pulse's end to the sentence.");
  v.boolean("sentence_tenths", p.sentence_tenths, "Sentences have tenths of seconds.");
  v.boolean("pulse_without_fix", p.pulse_without_fix, "There are pulses before a fix.");
  v.duration("pulse_qualifier_delay", p.pulse_qualifier_delay, {0, 65'535'000'000'000},
             "After good pulses for so long the sensor is locked.");
  v.boolean("pulse_needs_valid_receiver", p.pulse_needs_valid_receiver,
            "Locked only while sentences say 'A'.");
  v.boolean("sentence_needs_valid", p.sentence_needs_valid,
            "Only sentences that say 'A' set the time.");
}

template <auto kMember>
std::string_view told(VelodyneLiveSettings& live, SimTime /*now*/, const VelodyneSettings& wanted) {
  live.*kMember = wanted.saved.*kMember;
  return "";
}

}  // namespace

const velodyne::Model& model_of(const VelodyneSettings& settings) {
  const velodyne::Model* model = settings.firmware == VelodyneFirmware::until_5_1_7
                                     ? velodyne::find_model(settings.model, kUntil517)
                                     : velodyne::find_model(std::string_view(settings.model));
  if (model != nullptr) {
    return *model;
  }
  if (velodyne::find_model(std::string_view(settings.model)) != nullptr) {
    refuse("firmware " + std::string(kUntil517) + " of the " + settings.model +
           " is not known; allowed: newest");
  }
  std::string names;
  for (const velodyne::Model& known : velodyne::models()) {
    if (velodyne::find_model(known.name) == &known) {
      names += (names.empty() ? "" : ", ") + std::string(known.name);
    }
  }
  refuse("model '" + settings.model + "' is not known; allowed: " + names);
}

VelodyneRangeWindow range_window(const VelodyneSettings& settings, const velodyne::Model& model) {
  const auto or_default = [](double value, double fallback) {
    return value > 0.0 ? value : fallback;
  };
  return {or_default(settings.minimum_range_m, model.minimum_range_m),
          or_default(settings.maximum_range_m, model.maximum_range_m)};
}

Duration position_period(const VelodyneSettings& settings, const velodyne::Model& model) {
  constexpr std::int64_t kDataPacketsPerPositionPacket = 14;
  return settings.position_period > Duration::zero()
             ? settings.position_period
             : kDataPacketsPerPositionPacket *
                   Duration{packet_period_ns(model, velodyne::ReturnMode::strongest)};
}

void visit(fields::Visitor& v, VelodyneInertialAxes& p) {
  const fields::NumberRule component = fields::plain().between(-1, 1);
  v.vector3("gyro", p.gyro, component,
            "Unit vector about which the gyroscope measures, or 0 0 0 for none.");
  v.vector3("acceleration_x", p.acceleration_x, component,
            "Unit vector along which the first accelerometer measures, or 0 0 0 for none.");
  v.vector3("acceleration_y", p.acceleration_y, component,
            "Unit vector along which the second accelerometer measures, or 0 0 0 for none.");
}

void validate(const VelodyneInertialAxes& axes) {
  fields::check(axes);
  check_direction("gyro", axes.gyro);
  check_direction("acceleration_x", axes.acceleration_x);
  check_direction("acceleration_y", axes.acceleration_y);
}

void visit(fields::Visitor& v, VelodyneSettings& p) {
  using velodyne::PositionLayout;
  if (velodyne::find_model(p.model, kUntil517) != nullptr) {
    v.choice("firmware", p.firmware, kFirmwares, "Firmware, by its timing.");
  }
  const velodyne::Model& model = model_of(p);
  v.text("address", p.saved.host_address, "Where the packets go, an IPv4 address.");
  v.integer("port", p.saved.data_port, IntegerRule{1, 65535}, "UDP port of the data packets.");
  if (model.position_layout != PositionLayout::none) {
    v.integer("position_port", p.saved.telemetry_port, IntegerRule{1, 65535},
              "UDP port of the position packets.");
  }
  v.number("rate", p.saved.rotor_rpm,
           in("rpm").stored_as("rpm").between(0, model.maximum_rotor_rpm),
           "Speed of the rotor; 10 Hz is 600 rpm; 0 = it does not turn.");
  v.choice("return_mode", p.saved.return_mode, kReturnModes, "Echoes that are sent.");
  v.boolean("laser", p.saved.laser_on, "Whether the lasers fire.");
  v.group(
      "fov",
      [&p](fields::Visitor& w) {
        const IntegerRule azimuth{0, 359, fields::unit("deg")};
        w.integer("start", p.saved.view_start_deg, azimuth,
                  "First azimuth at which it fires, clockwise.");
        w.integer("end", p.saved.view_end_deg, azimuth,
                  "Last azimuth at which it fires, included; may lie beyond 0.");
      },
      "Where it fires; whole degrees.");
  v.group(
      "phase_lock",
      [&p](fields::Visitor& w) {
        w.boolean("enabled", p.saved.phase_lock,
                  "The rotor passes the offset at each full second.");
        w.integer("offset", p.saved.phase_lock_offset_centideg, IntegerRule{0, 35999},
                  "Azimuth at the full second, in hundredths of a degree.");
      },
      "Locks the rotor to the pulse per second.");
  v.text("serial", p.serial_number, "Serial number, as the web interface shows it.");
  if (!model.status_channel) {
    v.boolean("legacy_factory_bytes", p.legacy_factory_bytes,
              "Factory bytes are zero, as in firmware before 2.2.20.");
  }
  v.choice("reflectivity", p.reflectivity, kReflectivityScales, "Scale of the reflectivity byte.");
  v.boolean("vertical_offsets", p.vertical_offsets, "Each beam leaves from its own height.");
  v.number("minimum_range", p.minimum_range_m, in("m").between(0, farthest_m(model)),
           "Returns nearer than this are reported as none; 0 = the model's limit.");
  v.number("maximum_range", p.maximum_range_m, in("m").between(0, farthest_m(model)),
           "Returns beyond this are reported as none; 0 = the model's limit.");
  v.duration("send_delay", p.send_delay,
             {0, packet_period_ns(model, velodyne::ReturnMode::strongest)},
             "From the last shot of a packet to its start on the wire.");
  if (model.position_layout != PositionLayout::none) {
    v.duration("position_period", p.position_period, {0, 10'000'000'000},
               "Time between position packets; 0 = as long as 14 data packets.");
    v.check(p.position_period == Duration::zero() || p.position_period >= milliseconds{1},
            "position_period", "too short", fields::print_duration(p.position_period.count()),
            "0 or at least 1 ms");
    v.duration("position_wait", p.position_wait, {0, position_period(p, model).count()},
               "Position packets wait up to so long for a place between data packets.");
  }
  v.duration("start_up", p.start_up, {0, 600'000'000'000},
             "From power-on to the first packet; 0 = it runs already.");
  v.group(
      "clock", [&p](fields::Visitor& w) { visit_clock(w, p); },
      "Its clock, and where it gets the time from.");
  if (model.position_layout == PositionLayout::inertial) {
    v.group(
        "inertial",
        [&p](fields::Visitor& w) {
          w.section("first", p.inertial_axes[0],
                    "Directions of the first group, in the sensor's frame.");
          w.section("second", p.inertial_axes[1],
                    "Directions of the second group, in the sensor's frame.");
          w.section("third", p.inertial_axes[2],
                    "Directions of the third group, in the sensor's frame.");
        },
        "Directions of its gyroscopes and accelerometers.");
  }
}

std::span<const VelodyneLiveRow> velodyne_live_settings(const velodyne::Model& model) {
  static constexpr std::array<VelodyneLiveRow, 10> kRows{
      {{"rate", "rpm of /cgi/setting", told<&VelodyneLiveSettings::rotor_rpm>},
       {"return_mode", "returns of /cgi/setting", told<&VelodyneLiveSettings::return_mode>},
       {"laser", "laser of /cgi/setting", told<&VelodyneLiveSettings::laser_on>},
       {"fov.start", "start of /cgi/setting/fov", told<&VelodyneLiveSettings::view_start_deg>},
       {"fov.end", "end of /cgi/setting/fov", told<&VelodyneLiveSettings::view_end_deg>},
       {"phase_lock.enabled", "enabled of /cgi/setting/phaselock",
        told<&VelodyneLiveSettings::phase_lock>},
       {"phase_lock.offset", "offset of /cgi/setting/phaselock",
        told<&VelodyneLiveSettings::phase_lock_offset_centideg>},
       {"address", "addr of /cgi/setting/host", told<&VelodyneLiveSettings::host_address>},
       {"port", "dport of /cgi/setting/host", told<&VelodyneLiveSettings::data_port>},
       {"position_port", "tport of /cgi/setting/host",
        told<&VelodyneLiveSettings::telemetry_port>}}};
  const bool positions = model.position_layout != velodyne::PositionLayout::none;
  return std::span(kRows).first(kRows.size() - (positions ? 0 : 1));
}

void validate(const VelodyneSettings& settings) {
  fields::check(settings);
  const velodyne::Model& model = model_of(settings);
  check_rotor(settings.saved.rotor_rpm, model);
  if (settings.saved.return_mode == velodyne::ReturnMode::dual && !model.dual_return) {
    refuse("return_mode is dual, which the " + std::string(model.name) +
           " cannot; allowed: strongest, last");
  }
  if (settings.legacy_factory_bytes && model.status_channel) {
    refuse("legacy_factory_bytes: the " + std::string(model.name) +
           " has a status channel in their place");
  }
  if (settings.calibration) {
    if (!model.status_channel) {
      refuse("calibration: the " + std::string(model.name) + " measures true ranges, it has none");
    }
    validate(*settings.calibration);
  }
  const auto [minimum, maximum] = range_window(settings, model);
  if (!(minimum < maximum)) {
    refuse("range limits are " + std::to_string(minimum) + " m and " + std::to_string(maximum) +
           " m, allowed: minimum < maximum");
  }
  for (const SupplyFault& fault : settings.supply_faults) {
    fields::check(fault);
  }
  for (const VelodyneFault& fault : settings.faults) {
    check_fault(fault, settings);
  }
}

void check_fault(const VelodyneFault& fault, const VelodyneSettings& settings) {
  fields::check(fault);
  std::visit(FaultCheck{settings, model_of(settings)}, fault.what);
}

}  // namespace rigwire::emulators
