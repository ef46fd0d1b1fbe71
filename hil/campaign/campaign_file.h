// A campaign: one rig run many times, each run with other values of some keys, and the criteria by
// which its runs are judged.
//
//   name: forest drive
//   rig: unimog_forest                  # a file beside this one, or a name of `rigwire list rigs`
//   clock: real
//   duration: 1 min                     # of simulated time, at most
//   program: [path_follow, --speed, "{speed}", --gnss, "{devices.gnss.path}"]
//   design: latin_hypercube
//   runs: 200
//   parameters:
//     heading: {type: uniform, from: -15 deg, to: -9 deg, keys: [machine.yaw]}
//     speed: {type: values, values: [1, 2, 3]}
//   criteria:
//     arrived: {type: program_exit, status: 0}
//     untouched: {type: no_contact}
//
// docs/campaigns.md is its page, configs/campaigns/forest_drive.yaml the commented example.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "fields/visitor.h"
#include "hil/configuration/problems.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

// Distributions of a parameter's values. A value is text as in a rig's file: "2.5 bar".

struct ListedValues {
  static constexpr fields::Named kNamed{"values", "The values of a list."};

  std::vector<std::string> values;
};
struct SteppedRange {
  static constexpr fields::Named kNamed{"range", "From one number to another in equal steps."};

  std::string from;
  std::string to;    ///< Is a value itself when a whole number of steps leads there.
  std::string step;  ///< Above 0.
};
struct ValuesOfFile {
  static constexpr fields::Named kNamed{"from_file", "A column of a CSV file."};

  std::string file;
  std::string column;  ///< Name of the column, as in the file's first line.
};
struct WeightedChoice {
  static constexpr fields::Named kNamed{"choice", "One of a list, each as often as its weight."};

  std::vector<std::string> values;
  std::vector<double> weights;  ///< One for each value; their sum is free.
};
struct UniformSpread {
  static constexpr fields::Named kNamed{"uniform", "Anywhere between two numbers, evenly."};

  std::string from;
  std::string to;
};
struct LogUniformSpread {
  static constexpr fields::Named kNamed{"log_uniform",
                                        "Anywhere between two numbers, evenly by their logarithm."};

  std::string from;  ///< Above 0.
  std::string to;
};
struct NormalSpread {
  static constexpr fields::Named kNamed{"normal", "About a mean, after the normal distribution."};

  std::string mean;
  std::string deviation;  ///< Standard deviation, before it is cut off.
  std::string lowest;     ///< Where it is cut off; empty: nowhere.
  std::string highest;
};

struct CampaignParameter {
  std::variant<ListedValues, SteppedRange, ValuesOfFile, WeightedChoice, UniformSpread,
               LogUniformSpread, NormalSpread>
      spread;
  /// Keys of the rig that get the value, as `--set` takes them. Empty: the program's words have it.
  std::vector<std::string> keys;
};

enum class CampaignDesign { grid, one_at_a_time, random, latin_hypercube, sobol };
inline constexpr std::array<fields::Choice<CampaignDesign>, 5> kCampaignDesigns{
    {{CampaignDesign::grid, "grid", "Every value with every other."},
     {CampaignDesign::one_at_a_time, "one_at_a_time",
      "The rig as it is, then each value of each parameter alone."},
     {CampaignDesign::random, "random", "Each run by chance."},
     {CampaignDesign::latin_hypercube, "latin_hypercube",
      "By chance, but in as many equal layers as there are runs each layer of each parameter "
      "once."},
     {CampaignDesign::sobol, "sobol",
      "Points of Sobol's sequence, shifted by chance: evenly spread in all parameters together; "
      "runs a power of two."}}};
/// Returns whether the user gives the number of runs.
[[nodiscard]] constexpr bool is_sampled(CampaignDesign design) {
  return design != CampaignDesign::grid && design != CampaignDesign::one_at_a_time;
}

// What a run is judged by. A quantity is a word of `read` and `wait` (hil/world/quantities.h), a
// key of a record of the truth (hil/record/truth_tap.h), an element of a list by its number,
// "wheel_slide_mps.0", or one of kDerivedQuantities (judge.h).

/// A number as a file writes it: "55 deg", or "55" in the own unit of what it is compared with.
struct WrittenValue {
  WrittenValue() = default;
  WrittenValue(double bare);  // NOLINT(google-explicit-constructor)

  std::string text = "0";
};

struct ReachesCriterion {
  static constexpr fields::Named kNamed{
      "reaches", "A quantity is above or below a value once, as `wait` waits for it."};

  std::string quantity;
  bool above = true;
  WrittenValue value;
  Duration limit = std::chrono::hours{24};  ///< By then, from the start of the run.
};
struct StaysCriterion {
  static constexpr fields::Named kNamed{"stays",
                                        "A quantity is above or below a value all the time."};

  std::string quantity;
  bool above = true;
  WrittenValue value;
};
struct ArrivesCriterion {
  static constexpr fields::Named kNamed{"arrives", "The machine comes near a place of the map."};

  std::array<double, 2> place_m{0.0, 0.0};
  double radius_m = 2.0;
  Duration after{0};  ///< Being there before does not count.
};
struct NoContactCriterion {
  static constexpr fields::Named kNamed{"no_contact", "Nothing solid pushes the machine."};
};
struct NoSlipCriterion {
  static constexpr fields::Named kNamed{
      "no_slip", "The host kept up: simulated time never fell behind the wall clock."};
};
struct ProgramExitCriterion {
  static constexpr fields::Named kNamed{"program_exit",
                                        "The field program ends by itself, with this status."};

  std::uint8_t status = 0;
};
struct DeviceCriterion {
  static constexpr fields::Named kNamed{"device",
                                        "A figure of a device at the end, by the run's report."};

  std::string device;
  std::string figure = "dropped";  ///< A key of its report; "lateness_us.p99".
  bool above = false;
  WrittenValue value = 1.0;
};

struct CampaignCriterion {
  std::variant<ReachesCriterion, StaysCriterion, ArrivesCriterion, NoContactCriterion,
               NoSlipCriterion, ProgramExitCriterion, DeviceCriterion>
      test;
};

struct Campaign {
  std::string name = "campaign";
  std::string text;
  std::string rig;
  /// Changes applied to every run, as `--set` takes them: "truth.rate=20 Hz".
  std::vector<std::string> set;
  std::string clock = "free";
  Duration duration = std::chrono::seconds{60};
  /// Limit on the wall time of one run; a run that takes longer is ended and not judged.
  Duration patience = std::chrono::hours{1};
  /// The field program and its arguments. {NAME} is replaced by a parameter, {KEY.PATH} by a value
  /// of the run's rig, {index}, {seed}, {folder} by the run's own, {campaign} by this file's
  /// folder.
  std::vector<std::string> program;
  CampaignDesign design = CampaignDesign::grid;
  std::uint32_t runs = 0;  ///< Number of runs, for designs that sample their parameters.
  std::uint64_t seed = 1;
  bool keep_truth = false;
  std::map<std::string, CampaignParameter> parameters;
  std::map<std::string, CampaignCriterion> criteria;
};

void visit(fields::Visitor& v, ListedValues& p);
void visit(fields::Visitor& v, SteppedRange& p);
void visit(fields::Visitor& v, ValuesOfFile& p);
void visit(fields::Visitor& v, WeightedChoice& p);
void visit(fields::Visitor& v, UniformSpread& p);
void visit(fields::Visitor& v, LogUniformSpread& p);
void visit(fields::Visitor& v, NormalSpread& p);
void visit(fields::Visitor& v, CampaignParameter& p);
/// Throws std::invalid_argument for numbers that span nothing or are of different units.
void validate(const CampaignParameter& p);
void visit(fields::Visitor& v, ReachesCriterion& p);
void visit(fields::Visitor& v, StaysCriterion& p);
void visit(fields::Visitor& v, ArrivesCriterion& p);
inline void visit(fields::Visitor&, NoContactCriterion&) {}
inline void visit(fields::Visitor&, NoSlipCriterion&) {}
void visit(fields::Visitor& v, ProgramExitCriterion& p);
void visit(fields::Visitor& v, DeviceCriterion& p);
void visit(fields::Visitor& v, CampaignCriterion& p);
void visit(fields::Visitor& v, Campaign& p);
/// Throws fields::Refused: a design without runs, a parameter that binds nothing, a program with a
/// clock that it cannot follow, a criterion of a program where there is none.
void validate(const Campaign& p);

/// Placeholders of the program's words that are neither a parameter nor a key of the rig.
inline constexpr std::array<std::string_view, 4> kOwnPlaceholders{"index", "seed", "folder",
                                                                  "campaign"};

/// Words in braces: "{speed}" has "speed".
[[nodiscard]] std::vector<std::string> placeholders(const std::string& word);

/// A campaign read from its file.
struct LoadedCampaign {
  Campaign campaign;
  std::filesystem::path file;  ///< Absolute.
  Origins origins;             ///< Where each key of it was written.
  /// 16 hexadecimal digits of what the file says, whatever its comments.
  std::string hash;
};

/// Throws ConfigurationError with all findings.
[[nodiscard]] LoadedCampaign load_campaign(const std::filesystem::path& file);

}  // namespace rigwire::hil
