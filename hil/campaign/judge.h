// Whether a run was as it should be: the criteria of a campaign over what the run left.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/campaign/campaign_file.h"
#include "hil/executive/truth_source.h"

namespace rigwire::hil {

/// Quantities that a record of the truth has not under a key of its own. Each name ends with its
/// unit.
inline constexpr std::array<fields::Named, 5> kDerivedQuantities{
    {{"speed_mps", "Speed of the first link over the ground's axes, never negative."},
     {"heading_deg", "Direction of its x axis, left from east, -180 to 180."},
     {"pitch_deg", "Angle of its x axis, up from level."},
     {"roll_deg", "About its x axis, the right side down positive."},
     {"travelled_m", "Length of the way of the first link over the map, from the run's start."}}};

/// How a field program ended.
struct ProgramEnd {
  bool by_itself = false;  ///< Else it was ended with the run.
  int status = 0;          ///< 128 + n after signal n.
};

/// What a run left behind.
struct RunEvidence {
  std::filesystem::path truth;  ///< JSON lines of hil/record/truth_tap.h.
  /// Quantities of the machine, as `read` lists them: the truth has their values, this list their
  /// units.
  std::vector<StateQuantity> quantities;
  nlohmann::ordered_json report;
  std::optional<ProgramEnd> program;
  Duration duration{0};  ///< Records of the truth after it are ignored.
};

struct Verdict {
  bool passed = false;
  std::optional<double> at_s;  ///< When it was decided; nothing: at the end.
  std::string text;            ///< What was found, without numbers that differ from run to run.
  std::string detail;          ///< The numbers.
};

struct Judgement {
  std::map<std::string, Verdict> verdicts;  ///< By criterion.
  /// The criterion that failed first: the earliest of those with an instant, else by name.
  std::optional<std::string> first_failure;
  /// [sim_s, east_m, north_m] of the first link, 200 at most, the last one included.
  std::vector<std::array<double, 3>> track;
  double end_s = 0.0;  ///< Time of the last record, s.
};

/// Throws std::invalid_argument for a quantity, device or figure that the run does not have, with
/// the nearest of those that it has; std::runtime_error for a truth that is not complete.
[[nodiscard]] Judgement judge(const Campaign& campaign, const RunEvidence& evidence);

}  // namespace rigwire::hil
