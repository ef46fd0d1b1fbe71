// The files of a campaign. The run folders are the source of everything else.
//
//   FOLDER/plan.json            which campaign it is; no other one can run in this folder
//   FOLDER/table.csv            index, seed and parameters of every run
//   FOLDER/runs/000017/         one run
//     rig.yaml                  the effective configuration: `rigwire run` takes it
//     report.json, events.json  figures and events of the run
//     rig.log, program.log      output of the rig and of the field program
//     truth.jsonl               with keep_truth
//     result.json               values, verdicts, drive
//     DONE                      written last, by rename, when all else is on the disk
//   FOLDER/results.sqlite       made anew by collect, as results.csv
//
// A run whose folder has no DONE is run again, whatever else lies there.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hil/campaign/campaign_file.h"
#include "hil/campaign/design.h"

namespace rigwire::hil {

/// What plan.json holds.
struct CampaignPlan {
  std::string name;
  std::filesystem::path file;  ///< The campaign's, as it was run.
  std::string identity;        ///< Hash of the campaign and its rig (identity_of()).
  std::size_t runs = 0;
  std::vector<std::string> parameters;
  std::vector<std::string> criteria;
};

/// table.csv: index, seed and parameters; empty where the rig's own value holds.
[[nodiscard]] std::string table_text(const Campaign& campaign, const std::vector<PlannedRun>& runs);

/// Makes the folder with plan and table, where they are not there. Any number of processes may do
/// so at once. `identity`: of campaign and rig (campaign_run.h). Throws std::invalid_argument when
/// the folder is of another campaign, drivers::EndpointError where it cannot be written.
void prepare_folder(const std::filesystem::path& folder, const LoadedCampaign& campaign,
                    const std::string& identity, const std::vector<PlannedRun>& runs);

/// Whether the folder has a plan.
[[nodiscard]] bool has_plan(const std::filesystem::path& folder);

/// Throws std::invalid_argument for a folder without a plan.
[[nodiscard]] CampaignPlan read_plan(const std::filesystem::path& folder);

/// FOLDER/runs/000017
[[nodiscard]] std::filesystem::path run_folder(const std::filesystem::path& folder,
                                               std::size_t index);
[[nodiscard]] bool is_done(const std::filesystem::path& run_folder);

/// The right to fill a run's folder, which one process has at a time; it ends with the process.
class RunClaim {
 public:
  /// Makes the folder and empties it of what a run that did not end has left; one that is done by
  /// now stays as it is. Throws drivers::EndpointError when another process has it.
  explicit RunClaim(const std::filesystem::path& run_folder);
  ~RunClaim();
  RunClaim(const RunClaim&) = delete;
  RunClaim& operator=(const RunClaim&) = delete;

  /// Everything in the folder is on the disk; then DONE is. Throws drivers::EndpointError.
  void finish() const;

 private:
  std::filesystem::path folder_;
  int lock_ = -1;
};

}  // namespace rigwire::hil
