// What a campaign asks its runs for, held against the rig before any run begins.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "hil/campaign/campaign_file.h"
#include "hil/configuration/problems.h"
#include "hil/executive/truth_source.h"
#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {

/// What the runs of one rig can be judged by.
struct JudgedRig {
  std::vector<StateQuantity> quantities;  ///< Quantities of the machine, as `read` lists them.
  std::vector<std::string> truth;         ///< Paths of the numbers of each record of the truth.
  bool meets_obstacles = false;           ///< The truth has `contact`.
  std::vector<std::string> devices;
};

/// Makes the rig's machine in its scene, without wires. Throws std::exception where it cannot.
[[nodiscard]] JudgedRig judged_rig(const RigConfiguration& configuration);

/// Adds one finding for each criterion that runs of this rig could not be judged by, at its place
/// in the campaign's file.
void check_criteria(const LoadedCampaign& campaign, const JudgedRig& rig, Problems& problems);

/// The rigs of a campaign, one after the other. Each machine is made once, however many rigs differ
/// in its numbers alone.
class CriteriaCheck {
 public:
  explicit CriteriaCheck(const LoadedCampaign& campaign) : campaign_(campaign) {}

  void look(const RigConfiguration& configuration);
  /// Throws ConfigurationError with all findings, and where no rig of a kind could be made.
  void finish();

 private:
  void look_at_program(const RigConfiguration& configuration);

  const LoadedCampaign& campaign_;
  Problems problems_;
  std::set<std::string> seen_;  ///< Kinds of rigs.
  /// Kinds of which none could be made so far, with the reason.
  std::map<std::string, std::string> failed_;
  std::set<std::string> said_;  ///< Lines of findings.
};

}  // namespace rigwire::hil
