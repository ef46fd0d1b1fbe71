// Every key of every device, machine, scene, bus, line and rig, at both ends of its range and just
// outside: what `describe` says, what a reader does and what a structure's check does are one.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "fields/check.h"
#include "hil/configuration/document.h"
#include "hil/configuration/reader.h"
#include "hil/rig/rig_configuration.h"
#include "ranged_keys.h"

namespace rigwire::hil {
namespace {

/// A structure that is made anew for each document.
struct Subject {
  std::function<void(const std::function<void(const fields::Part&)>&)> with_fresh;
  std::vector<std::string_view> skipped;  ///< Keys of the top that are subjects of their own.
};

template <class Struct>
Subject subject(std::vector<std::string_view> skipped = {}) {
  return {[](const std::function<void(const fields::Part&)>& use) {
            Struct fresh;
            use(fields::Part::of(fresh));
          },
          std::move(skipped)};
}

/// What a form needs beside it to be sound.
struct Companion {
  std::string_view label;  ///< Label of a key that the form has; `*` stands for anything.
  std::string_view path;   ///< What is then written.
  std::string_view value;
};

/// An end of a range that other members of the structure do not allow.
struct JointRefusal {
  std::string_view label;  ///< `*` stands for anything.
  End end;
  std::string_view why;
};

/// A form that no other members make sound.
struct Meaningless {
  std::string_view label;  ///< Label of its keys; `*` stands for anything.
  std::string_view why;
};

bool matches(std::string_view pattern, std::string_view text) {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) {
    return pattern == text;
  }
  if (!text.starts_with(pattern.substr(0, star))) {
    return false;
  }
  for (std::size_t at = star; at <= text.size(); ++at) {
    if (matches(pattern.substr(star + 1), text.substr(at))) {
      return true;
    }
  }
  return false;
}

struct Finding {
  std::vector<Problem> problems;  ///< Problems of reading.
  std::string refusal;            ///< Refusal by the check of what was read.
};

class EveryKey {
 public:
  EveryKey(Subject subject, std::span<const Companion> companions,
           std::span<const JointRefusal> joint, std::span<const Meaningless> meaningless = {})
      : subject_(std::move(subject)),
        companions_(companions),
        joint_(joint),
        meaningless_(meaningless) {}

  /// Takes every form and tries every key once. Returns how many keys there were.
  std::size_t run() {
    forms_.push_back({});
    for (; !forms_.empty(); forms_.pop_front()) {
      take(forms_.front());
    }
    for (const auto& [identity, problems] : unsound_) {
      const auto known = std::ranges::find_if(
          meaningless_, [&](const Meaningless& form) { return matches(form.label, identity); });
      EXPECT_TRUE(known != meaningless_.end()) << identity << ": no sound document has it:\n"
                                               << problems;
    }
    for (const JointRefusal& entry : joint_) {
      EXPECT_TRUE(refused_.contains(&entry)) << entry.label << ": no joint refusal any more";
    }
    for (const Meaningless& form : meaningless_) {
      EXPECT_TRUE(std::ranges::any_of(
          unsound_, [&](const auto& entry) { return matches(form.label, entry.first); }))
          << form.label << ": sound by now";
    }
    return tried_.size();
  }

 private:
  void take(const Forms& forms) {
    OutlineNode shaped;
    std::vector<RangedKey> keys;
    subject_.with_fresh([&](const fields::Part& part) {
      RangedKeys walk(subject_.skipped, &forms);
      part.show(walk);
      for (const Fork& fork : walk.forks()) {
        taken_.insert({fork.label, fork.chosen});
        for (std::size_t form = 0; form < fork.count; ++form) {
          if (taken_.insert({fork.label, form}).second) {
            forms_.push_back(forms);
            forms_.back()[fork.label] = form;
          }
        }
      }
      keys = walk.keys();
      shaped = outline_part(part);
    });
    const auto is_new = [this](const RangedKey& key) { return !tried_.contains(key.identity()); };
    if (std::ranges::none_of(keys, is_new)) {
      return;
    }

    Problems problems;
    Value document = parse_document(print_yaml(least(shaped), Origins{}), "least.yaml",
                                    RIGWIRE_SOURCE_DIR, problems);
    for (const Companion& companion : companions_) {
      const bool is_meant = std::ranges::any_of(
          keys, [&](const RangedKey& key) { return matches(companion.label, key.label); });
      if (is_meant) {
        apply_set(document, std::string(companion.path) + "=" + std::string(companion.value),
                  problems);
      }
    }
    const Finding sound = read_into(document, problems, [&](const fields::Part& part) {
      RangedKeys walk(subject_.skipped, nullptr);
      part.show(walk);
      keys = walk.keys();
      shaped = outline_part(part);
    });
    for (const RangedKey& key : keys) {
      if (!is_new(key)) {
        continue;
      }
      if (!sound.problems.empty() || !sound.refusal.empty()) {
        unsound_[key.identity()] = text_of(sound);
        continue;
      }
      tried_.insert(key.identity());
      unsound_.erase(key.identity());
      const OutlineNode* described = find_node(shaped, key.path);
      ASSERT_NE(described, nullptr) << key.label;
      EXPECT_EQ(described->allowed, key.range) << key.label;
      EXPECT_EQ(described->unit, key.unit) << key.label;
      try_ends(document, key);
    }
  }

  void try_ends(const Value& document, const RangedKey& key) {
    for (const Attempt& attempt : key.attempts) {
      if (key.components.empty()) {
        try_value(document, key, key.path, attempt.written, attempt);
      }
      for (std::size_t i = 0; i < key.components.size(); ++i) {
        std::string list;
        for (std::size_t j = 0; j < key.components.size(); ++j) {
          list += (j == 0 ? "" : ", ") + (i == j ? attempt.written : key.components[j]);
        }
        try_value(document, key, key.path + "." + std::to_string(i), "[" + list + "]", attempt);
      }
    }
  }

  void try_value(const Value& base, const RangedKey& key, const std::string& path,
                 const std::string& value, const Attempt& attempt) {
    Value document = base;
    Problems problems;
    apply_set(document, key.path + "=" + value, problems);
    const Finding found = read_into(document, problems, [](const fields::Part&) {});
    const std::string what = key.label + "=" + value;
    if (!attempt.is_allowed) {
      ASSERT_EQ(found.problems.size(), 1u) << what << "\n" << text_of(found);
      EXPECT_EQ(found.problems[0].path, path) << what;
      EXPECT_EQ(found.problems[0].what, "out of range") << what;
      EXPECT_EQ(found.problems[0].allowed, key.range) << what;
      check_refuses(base, path, attempt.written, what);
      return;
    }
    for (const Problem& problem : found.problems) {
      EXPECT_NE(problem.what, "out of range") << what << "\n" << problem.line();
    }
    if (found.problems.empty() && found.refusal.empty()) {
      return;
    }
    const auto known = std::ranges::find_if(joint_, [&](const JointRefusal& entry) {
      return entry.end == attempt.end && matches(entry.label, key.label);
    });
    if (known == joint_.end()) {
      ADD_FAILURE() << what << ", allowed " << key.range << ", is refused:\n" << text_of(found);
      return;
    }
    refused_.insert(&*known);
  }

  /// What a program puts in place of a file is refused as well.
  void check_refuses(const Value& document, const std::string& path, const std::string& written,
                     const std::string& what) {
    Problems problems;
    read_into(document, problems, [&](const fields::Part& part) {
      RangedKeys walk(subject_.skipped, nullptr);
      walk.plant(path, written);
      part.show(walk);
      if (!walk.has_planted()) {
        return;
      }
      try {
        fields::check_part(part);
        ADD_FAILURE() << what << " passes the check";
      } catch (const fields::Refused& refused) {
        EXPECT_EQ(refused.path(), path) << what << "\n" << refused.what();
      } catch (const std::invalid_argument& error) {
        ADD_FAILURE() << what << " is refused otherwise: " << error.what();
      }
    });
  }

  /// Reads, and checks what was read when there was nothing to find.
  Finding read_into(const Value& document, Problems& problems,
                    const std::function<void(const fields::Part&)>& look) {
    Finding found;
    subject_.with_fresh([&](const fields::Part& part) {
      Origins origins;
      Reader(document, problems, origins).read(part);
      found.problems = problems.sorted();
      if (found.problems.empty()) {
        try {
          fields::check_part(part);
        } catch (const std::invalid_argument& error) {
          found.refusal = error.what();
        }
      }
      look(part);
    });
    return found;
  }

  static std::string text_of(const Finding& found) {
    std::string text;
    for (const Problem& problem : found.problems) {
      text += "  " + problem.line() + "\n";
    }
    return text + (found.refusal.empty() ? "" : "  check: " + found.refusal + "\n");
  }

  Subject subject_;
  std::span<const Companion> companions_;
  std::span<const JointRefusal> joint_;
  std::span<const Meaningless> meaningless_;
  std::deque<Forms> forms_;
  std::set<std::pair<std::string, std::size_t>> taken_;
  std::set<std::string> tried_;
  std::map<std::string, std::string> unsound_;  ///< Problems by the key's identity.
  std::set<const JointRefusal*> refused_;
};

constexpr std::string_view kStroke = "the link's cylinder has a stroke";
constexpr std::string_view kNoRtk = "it solves no carriers by what arrives at its ports";
constexpr std::string_view kPins = "cylinders must reach between their pins";
constexpr std::string_view kAboveLargest = "above the largest";
constexpr std::string_view kBelowSmallest = "below the smallest";
constexpr std::string_view kAreaCount = "density times area, at most 50000 plants";
constexpr std::string_view kGrid = "size over cell, 10 to 8192 cells along a side";
constexpr std::string_view kCarries = "the tyre must carry the wheel off the rim";
constexpr std::string_view kUnitVector = "not of length 1 with the other components";
constexpr std::string_view kLensFolds = "the lens folds over, sees too much, or must be a pinhole";
constexpr std::string_view kCameraBusy = "reading out and sending a picture takes longer";
constexpr std::string_view kTooStiff = "lighter, or slower, than a contact's stiffness allows";
constexpr std::string_view kDriveTooStiff = "stiffer than the step allows";
constexpr std::string_view kOnce = "nothing is repeated";
constexpr std::string_view kOfTheLine = "of faults of the Modbus line alone";
constexpr std::string_view kAlways = "the repetitions have no length of their own";
constexpr std::string_view kInertia = "no body has a moment above the sum of the other two";

template <class Interface>
void expect_sound_defaults(std::span<const fields::TypeRow<Interface>> rows) {
  for (const fields::TypeRow<Interface>& row : rows) {
    EXPECT_NO_THROW(fields::check_part(fields::Part::of(*row.fresh()))) << row.named.name;
  }
}

TEST(EveryKeyEnds, defaults_lie_between_them) {
  expect_sound_defaults(device_types());
  expect_sound_defaults(machine_types());
  RigConfiguration rig;
  EXPECT_NO_THROW(fields::check_part(fields::Part::of(rig)));
  BusConfiguration bus;
  EXPECT_NO_THROW(fields::check_part(fields::Part::of(bus)));
  ModbusLineConfiguration line;
  EXPECT_NO_THROW(fields::check_part(fields::Part::of(line)));
  line.wire = emulators::ModbusWire::rtu;
  EXPECT_NO_THROW(fields::check_part(fields::Part::of(line)));
}

TEST(EveryKeyEnds, of_devices_are_where_describe_says) {
  static constexpr std::array kJoint{
      JointRefusal{"starfire-3000.rate", End::upper, "the line is too slow for the sentences"},
      JointRefusal{"ublox-*.rate", End::upper, "the line is too slow for the messages"},
      JointRefusal{"ublox-*.baud", End::lower, "the line is too slow for the messages"},
      JointRefusal{"*.sensor.corrections.refix_shortest", End::upper, "above refix_longest"},
      JointRefusal{"*.sensor.corrections.refix_longest", End::lower, "below refix_shortest"},
      JointRefusal{"*.faults.0.duty", End::upper, kOnce},
      JointRefusal{"*.faults.0.every", End::upper, kAlways},
      JointRefusal{"velodyne-*.minimum_range", End::upper, "above maximum_range"},
      JointRefusal{"velodyne-*.faults.0.dead_laser.*", End::upper, "the model has fewer lasers"},
      JointRefusal{"velodyne-*.faults.0.dirt.to", End::lower, "where the dirt begins"},
      JointRefusal{"velodyne-hdl-32e.inertial.*", End::lower, kUnitVector},
      JointRefusal{"velodyne-hdl-32e.inertial.*", End::upper, kUnitVector},
      JointRefusal{
          "valve-driver.watchdog", End::upper,
          "the built-in map's register holds up to 5 s; a map of one's own decides itself"},
      JointRefusal{"valve-driver.faults.0.unit", End::upper, kOfTheLine},
      JointRefusal{"valve-driver.faults.0.first", End::upper, kOfTheLine},
      JointRefusal{"valve-driver.faults.0.last", End::lower, kOfTheLine},
      JointRefusal{"valve-driver.faults.0.share", End::lower, kOfTheLine},
      JointRefusal{"*.coil_current_start", End::upper, "above coil_current_full"},
      JointRefusal{"*.coil_current_full", End::lower, "below coil_current_start"},
      JointRefusal{"*.electronics.supply_voltage", End::lower, "below under_voltage"},
      JointRefusal{"*.electronics.under_voltage", End::upper, "above supply_voltage"},
      JointRefusal{"*.faults.0.*.section", End::upper, "the block has fewer sections"},
      JointRefusal{"vehicle-gateway.minimum_tyre_pressure", End::upper,
                   "above maximum_tyre_pressure"},
      JointRefusal{"vehicle-gateway.maximum_tyre_pressure", End::lower,
                   "below minimum_tyre_pressure"},
      JointRefusal{"vehicle-gateway.odometry.*_distance", End::lower, "no wheelbase is left"},
      JointRefusal{"dbc-node.attached.vehicle.odometry.*_distance", End::lower,
                   "no wheelbase is left"},
      JointRefusal{"iso-valves.first_valve", End::upper, "all sections need a valve number"},
      JointRefusal{"iso-valves.general_purpose_section", End::upper,
                   "the block has fewer sections"},
      JointRefusal{"gige-*.rate", End::upper, kCameraBusy},
      JointRefusal{"gige-*.throughput", End::lower, kCameraBusy},
      JointRefusal{"gige-*.sensor.*row_time", End::upper, kCameraBusy},
      JointRefusal{"gige-*.sensor*.width", End::lower, "no multiple of the wire's step"},
      JointRefusal{"gige-*.sensor*.width", End::upper, kCameraBusy},
      JointRefusal{"gige-*.sensor*.height", End::lower, "no multiple of the wire's step"},
      JointRefusal{"gige-*.sensor*.height", End::upper, kCameraBusy},
      JointRefusal{"gige-*.exposure", End::lower, "below what the camera exposes at least"},
      JointRefusal{"gige-*.exposure", End::upper, "above what the camera exposes at most"},
      JointRefusal{"gige-*.gain", End::upper, "above the camera's greatest gain"},
      JointRefusal{"gige-*.saturation_capacity", End::upper, "above full_well"},
      JointRefusal{"gige-*.full_well", End::lower, "below saturation_capacity"},
      JointRefusal{"gige-*.dead_columns", End::upper, "more than there are"},
      JointRefusal{"gige-*.auto_exposure.shortest", End::upper, "above longest"},
      JointRefusal{"gige-*.auto_exposure.longest", End::lower, "below shortest"},
      JointRefusal{"gige-*.sensor.lens.focal_length", End::lower, kLensFolds},
      JointRefusal{"gige-*.sensor.lens.k*", End::lower, kLensFolds},
      JointRefusal{"gige-*.sensor.lens.k*", End::upper, kLensFolds},
      JointRefusal{"gige-*.sensor.lens.p*", End::lower, kLensFolds},
      JointRefusal{"gige-*.sensor.lens.p*", End::upper, kLensFolds},
      JointRefusal{"gige-*.image_sensor.pixel_pitch", End::upper, kLensFolds},
      JointRefusal{"gige-stereo.sensor.matching.*disparit*", End::upper, "as wide as the picture"},
      JointRefusal{"gige-stereo.sensor.matching.small_step_bits", End::upper, "above the large"},
      JointRefusal{"gige-stereo.sensor.matching.large_step_bits", End::lower, "below the small"},
      JointRefusal{"gige-depth.sensor.nearest", End::upper, "beyond farthest"},
      JointRefusal{"gige-depth.sensor.farthest", End::lower, "before nearest"},
      JointRefusal{"gige-depth.sensor.farthest", End::upper, "beyond unambiguous"},
      JointRefusal{"gige-depth.sensor.unambiguous", End::lower, "before farthest"},
      JointRefusal{"gige-depth.sensor.step", End::lower, "16 bits do not reach to farthest"},
      JointRefusal{"gige-depth.sensor.noise_floor", End::upper, "above greatest_noise"},
      JointRefusal{"gige-depth.sensor.greatest_noise", End::lower, "below noise_floor"},
      JointRefusal{"gige-360.sensor.elevation_upper", End::lower, "no row is above -90 degrees"},
      JointRefusal{"gige-360.sensor.lens.vignetting", End::upper, "rays have no fall-off"},
  };
  static constexpr std::array kMeaningless{
      Meaningless{"velodyne-hdl-64e*.faults.0.factory_bytes.*",
                  "the model has a status channel in their place"},
      Meaningless{"gnss-base.sensor.corrections.convergence*", kNoRtk},
      Meaningless{"gnss-base.sensor.corrections.fixed_age*", kNoRtk},
      Meaningless{"starfire-3000.sensor.corrections.convergence*", kNoRtk},
      Meaningless{"starfire-3000.sensor.corrections.fixed_age*", kNoRtk},
      Meaningless{"ublox-neo-*.sensor.corrections.convergence*", kNoRtk},
      Meaningless{"ublox-neo-*.sensor.corrections.fixed_age*", kNoRtk},
      Meaningless{"gige-stereo.sensor.lens.k4*", "of another lens model"},
      Meaningless{"gige-depth.sensor.lens.k4*", "of another lens model"},
      Meaningless{"valve-driver.faults.0.noise.*", "its own line is of wire tcp"},
  };
  static constexpr std::array kCompanions{
      Companion{"gige-*", "sensor.looks.0.label", "ground"},
      Companion{"*.faults.0.noisier.*", "faults.0.deviation", "1"},
      Companion{"*.faults.0.dead_zone.*", "faults.0.width", "1"},
      Companion{"valve-driver.faults.0.frozen.*", "faults.0.table", "holding"},
      Companion{"valve-driver.faults.0.frozen.*", "faults.0.last", "9"},
  };
  EveryKey keys(subject<ConfiguredDevice>(), kCompanions, kJoint, kMeaningless);
  EXPECT_GT(keys.run(), 900u);
}

TEST(EveryKeyEnds, of_machines_are_where_describe_says) {
  static constexpr std::array kJoint{
      JointRefusal{"*.principal_inertia", End::lower, kInertia},
      JointRefusal{"*.principal_inertia", End::upper, kInertia},
      JointRefusal{"excavator.excavator.drives.*_stiffness", End::upper, kDriveTooStiff},
      JointRefusal{"excavator.excavator.supply.load_sensing_margin", End::upper,
                   "above relief_pressure"},
      JointRefusal{"excavator.excavator.supply.tank_pressure", End::upper, "above relief_pressure"},
      JointRefusal{"*.engine.full_load.0.speed", End::upper, "above the next point"},
      JointRefusal{"*.engine.idle", End::upper, "above maximum"},
      JointRefusal{"*.engine.maximum", End::upper, "above cut_off"},
      JointRefusal{"excavator.*.set_speed", End::upper, "above engine.maximum"},
      JointRefusal{"wheeled.wheeled.body.mass", End::upper, kCarries},
      JointRefusal{"wheeled.wheeled.*.beam.mass", End::upper, kCarries},
      JointRefusal{"wheeled.wheeled.*.independent.corner_mass", End::upper, kCarries},
      JointRefusal{"wheeled.wheeled.gravity", End::upper, kCarries},
      JointRefusal{"wheeled.wheeled.*.beam.pitch_inertia", End::upper, "above twice roll_inertia"},
      JointRefusal{"wheeled.wheeled.*.initial_pressure", End::upper,
                   "above tyre_pressure.pressure_max"},
      JointRefusal{"wheeled.wheeled.tyre_pressure.pressure_min", End::upper, "above pressure_max"},
      JointRefusal{"wheeled.driveline.*.clutch.open", End::upper, "above full"},
      JointRefusal{"wheeled.driveline.cvt.variator.top_ratio", End::upper, "above launch_ratio"},
      JointRefusal{"wheeled.driveline.cvt.variator.shift_from", End::upper, "above shift_to"},
      JointRefusal{"tandem_roller.roller.roll_inertia", End::lower, kInertia},
      JointRefusal{"tandem_roller.roller.roll_inertia", End::upper, kInertia},
      JointRefusal{"tandem_roller.roller.pitch_inertia", End::lower, kInertia},
      JointRefusal{"tandem_roller.roller.pitch_inertia", End::upper, kInertia},
      JointRefusal{"tandem_roller.roller.yaw_inertia", End::lower, kInertia},
      JointRefusal{"tandem_roller.roller.yaw_inertia", End::upper, kInertia},
      JointRefusal{"tandem_roller.roller.drive.engine_idle", End::upper, "above engine_rated"},
      JointRefusal{"tandem_roller.roller.sp*.initial", End::upper, "above capacity"},
      JointRefusal{"excavator.excavator.boom.mass", End::lower, kTooStiff},
      JointRefusal{"excavator.excavator.stick.mass", End::lower, kTooStiff},
      JointRefusal{"excavator.excavator.bucket.mass", End::lower, kTooStiff},
      JointRefusal{"excavator.excavator.*_length", End::lower, kPins},
      JointRefusal{"excavator.excavator.boom_length", End::upper, kPins},
      JointRefusal{"excavator.excavator.stick_length", End::upper, kPins},
      JointRefusal{"excavator.excavator.*_linkage.*_pin", End::lower, kPins},
      JointRefusal{"excavator.excavator.*_linkage.*_pin", End::upper, kPins},
      JointRefusal{"excavator.excavator.bucket_linkage.idler_*", End::lower, kPins},
      JointRefusal{"excavator.excavator.bucket_linkage.idler_*", End::upper, kPins},
      JointRefusal{"excavator.excavator.bucket_linkage.link_length", End::upper, kPins},
      JointRefusal{"excavator.excavator.bucket_linkage.lug_radius", End::upper, kPins},
      JointRefusal{"excavator.excavator.*_cylinder.rod", End::upper, "above bore"},
      JointRefusal{"excavator.excavator.*_cylinder.length_min", End::upper, "above length_max"},
      JointRefusal{"excavator.excavator.*_cylinder.length_max", End::upper, kPins},
      JointRefusal{"excavator.excavator.*_cylinder.length_min", End::lower, kPins},
      JointRefusal{"excavator.excavator.*_cylinder.length_max", End::lower, "below length_min"},
      JointRefusal{"excavator.excavator.*_cylinder.bore", End::lower, "below rod"},
      JointRefusal{"excavator.excavator.supports.*.rod", End::upper, "above bore"},
      JointRefusal{"excavator.excavator.supports.*.bore", End::lower, "below rod"},
      JointRefusal{"excavator.excavator.tracks.gauge", End::lower, "below shoe_width"},
      JointRefusal{"excavator.excavator.tracks.shoe_width", End::upper, "above gauge"},
      JointRefusal{"excavator.excavator.bucket_linkage.lug_radius", End::lower, kPins},
      JointRefusal{"excavator.excavator.bucket_linkage.branch", End::lower, kPins},
      JointRefusal{"excavator.excavator.bucket_linkage.lug_angle", End::lower, kStroke},
      JointRefusal{"excavator.excavator.bucket_linkage.lug_angle", End::upper, kStroke},
      JointRefusal{"excavator.excavator.initial.*", End::lower, kStroke},
      JointRefusal{"excavator.excavator.initial.*", End::upper, kStroke},
      JointRefusal{"excavator.excavator.supply.*relief_pressure", End::lower,
                   "below tank_pressure and load_sensing_margin together"},
      JointRefusal{"*.tyre.unloaded_radius", End::lower, "below rim_radius"},
      JointRefusal{"*.tyre.rim_radius", End::upper, "above unloaded_radius"},
      JointRefusal{"wheeled.wheeled.body.center_of_mass", End::lower, "not between the axles"},
      JointRefusal{"wheeled.wheeled.body.center_of_mass", End::upper, "not between the axles"},
      JointRefusal{"wheeled.wheeled.front.position", End::lower, "behind the rear axle"},
      JointRefusal{"wheeled.wheeled.rear.position", End::upper, "before the front axle"},
      JointRefusal{"wheeled.wheeled.*.beam.spring_base", End::upper, "above twice the track"},
      JointRefusal{"tandem_roller.roller.center_of_mass_x", End::lower, "not between the drums"},
      JointRefusal{"tandem_roller.roller.center_of_mass_x", End::upper, "not between the drums"},
      JointRefusal{"wheeled.wheeled.*.tyre.stiffness_per_pressure", End::lower, kCarries},
      JointRefusal{"wheeled.wheeled.*.tyre.reference_pressure", End::lower, kCarries},
      JointRefusal{"wheeled.wheeled.*.track", End::lower, "below half of beam.spring_base"},
      JointRefusal{"wheeled.wheeled.*.beam.roll_inertia", End::lower,
                   "below half of beam.pitch_inertia"},
      JointRefusal{"wheeled.wheeled.*.initial_pressure", End::lower,
                   "below tyre_pressure.pressure_min"},
      JointRefusal{"wheeled.wheeled.tyre_pressure.pressure_max", End::lower, "below pressure_min"},
      JointRefusal{"*.engine.maximum", End::lower, "below idle"},
      JointRefusal{"*.engine.cut_off", End::lower, "below maximum"},
      JointRefusal{"excavator.*.set_speed", End::lower, "below engine.idle"},
      JointRefusal{"*.thermostat_opens", End::upper, "above thermostat_open"},
      JointRefusal{"*.thermostat_open", End::lower, "below thermostat_opens"},
      JointRefusal{"wheeled.driveline.*.clutch.open", End::lower, "below half of engine.idle"},
      JointRefusal{"wheeled.driveline.*.clutch.full", End::lower, "below open"},
      JointRefusal{"wheeled.driveline.cvt.variator.launch_ratio", End::lower, "below top_ratio"},
      JointRefusal{"wheeled.driveline.cvt.variator.shift_to", End::lower, "below shift_from"},
      JointRefusal{"tandem_roller.roller.drive.engine_rated", End::lower, "below engine_idle"},
      JointRefusal{"tandem_roller.roller.*.capacity", End::lower, "below initial"},
  };
  EveryKey keys(subject<MachineConfiguration>(), {}, kJoint);
  EXPECT_GT(keys.run(), 350u);
}

TEST(EveryKeyEnds, of_scenes_are_where_describe_says) {
  static constexpr std::array kCompanions{
      Companion{"tracks.*", "tracks.0.points", "[{at: [0, 0]}, {at: [10, 0]}]"},
  };
  static constexpr std::array kJoint{
      JointRefusal{"terrain.*.size", End::upper, kGrid},
      JointRefusal{"terrain.*.cell", End::upper, kGrid},
      JointRefusal{"terrain.hills.longest_wave", End::lower, "below two cells"},
      JointRefusal{"rocks.0.smallest", End::upper, kAboveLargest},
      JointRefusal{"rocks.0.largest", End::lower, kBelowSmallest},
      JointRefusal{"trees.0.smallest", End::upper, kAboveLargest},
      JointRefusal{"trees.0.largest", End::lower, kBelowSmallest},
      JointRefusal{"trees.0.density", End::upper, kAreaCount},
      JointRefusal{"trees.0.trunk_diameter", End::upper, "above a fifth of the largest height"},
      JointRefusal{"forests.0.species.0.smallest", End::upper, kAboveLargest},
      JointRefusal{"forests.0.species.0.largest", End::lower, kBelowSmallest},
      JointRefusal{"forests.0.species.0.share", End::lower, "one species must have a share"},
      JointRefusal{"forests.0.half_lengths", End::upper, kAreaCount},
      JointRefusal{"forests.0.density", End::upper, kAreaCount},
      JointRefusal{"forests.0.bushes", End::upper, kAreaCount},
      JointRefusal{"forests.0.fallen", End::upper, kAreaCount},
      JointRefusal{"grass.0.patch", End::upper, "density times its area, at most 200000 stalks"},
      JointRefusal{"soil_regions.0.stretch.from", End::upper, "beyond `to`"},
      JointRefusal{"weather.overlap_start", End::upper, "beyond overlap_end"},
      JointRefusal{"weather.overlap_end", End::lower, "before overlap_start"},
  };
  EveryKey keys(subject<SceneConfiguration>(), kCompanions, kJoint);
  EXPECT_GT(keys.run(), 150u);
}

TEST(EveryKeyEnds, of_buses_are_where_describe_says) {
  static constexpr std::array kJoint{
      JointRefusal{"faults.0.duty", End::upper, kOnce},
      JointRefusal{"faults.0.every", End::upper, kAlways},
  };
  EveryKey keys(subject<BusConfiguration>(), {}, kJoint);
  EXPECT_GT(keys.run(), 10u);
}

TEST(EveryKeyEnds, of_modbus_lines_are_where_describe_says) {
  static constexpr std::array kCompanions{
      Companion{"faults.0.noise.*", "wire", "rtu"},
      Companion{"faults.0.frozen.*", "faults.0.table", "holding"},
      Companion{"faults.0.frozen.*", "faults.0.last", "9"},  // not more than one request reads
  };
  static constexpr std::array kJoint{
      JointRefusal{"response_delay.minimum", End::upper, "above maximum"},
      JointRefusal{"faults.0.duty", End::upper, kOnce},
      JointRefusal{"faults.0.every", End::upper, kAlways},
      JointRefusal{"faults.0.first", End::upper, "a range of addresses needs a table"},
      JointRefusal{"faults.0.last", End::lower, "a range of addresses needs a table"},
  };
  EveryKey keys(subject<ModbusLineConfiguration>(), kCompanions, kJoint);
  EXPECT_GT(keys.run(), 20u);
}

TEST(EveryKeyEnds, of_rigs_are_where_describe_says) {
  static constexpr std::array kJoint{
      JointRefusal{"surroundings.*.faults.0.duty", End::upper, kOnce},
      JointRefusal{"surroundings.*.faults.0.every", End::upper, kAlways},
  };
  EveryKey keys(subject<RigConfiguration>({"scene", "machine", "buses", "modbus", "devices"}), {},
                kJoint);
  EXPECT_GT(keys.run(), 10u);
}

/// Units of keys that all have two ends. Masses, forces, stiffnesses and what is made of them may
/// be of any size: models scale with them, and the structure's own check refuses what does not go
/// with the other members (a step too long, a load too great, a stroke too short).
constexpr std::array<std::string_view, 6> kBoundedUnits{"m", "mm", "cm", "km", "deg", "%"};

/// Every length and angle has two ends: there is a largest scene, and a largest machine.
TEST(EveryKeyEnds, lengths_have_two) {
  const auto look = [](const Subject& subject, const char* of) {
    subject.with_fresh([&](const fields::Part& part) {
      const Forms forms;
      RangedKeys walk({}, &forms);
      part.show(walk);
      for (const RangedKey& key : walk.keys()) {
        const bool bounded = std::ranges::any_of(
            key.attempts, [](const Attempt& attempt) { return attempt.end == End::upper; });
        if (std::ranges::find(kBoundedUnits, key.unit) != kBoundedUnits.end()) {
          EXPECT_TRUE(bounded) << of << ": " << key.label << ", allowed " << key.range;
        }
      }
    });
  };
  look(subject<SceneConfiguration>(), "scene");
  for (std::size_t row = 0; row < machine_types().size(); ++row) {
    MachineConfiguration machine;
    machine.model.choose(row);
    look({[&](const std::function<void(const fields::Part&)>& use) {
            use(fields::Part::of(machine));
          },
          {}},
         "machine");
  }
}

}  // namespace
}  // namespace rigwire::hil
