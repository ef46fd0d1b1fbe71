// rigwire campaign expand, run, collect and report.
#include "hil/campaign/campaign_verbs.h"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <map>
#include <set>
#include <system_error>

#include "hil/campaign/campaign_report.h"
#include "hil/campaign/campaign_run.h"
#include "hil/campaign/collect.h"
#include "hil/campaign/criteria_check.h"
#include "hil/campaign/spread.h"
#include "hil/command_line/config_files.h"
#include "hil/configuration/schema.h"
#include "hil/record/output_file.h"
#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {

namespace {

namespace fs = std::filesystem;

int code(ExitCode exit_code) {
  return static_cast<int>(exit_code);
}

int refuse(Terminal terminal, const std::string& what) {
  terminal.err << "rigwire: campaign: " << what << "\nTry: rigwire campaign --help\n";
  return code(ExitCode::usage);
}

/// A file beside the campaign's, else as `rigwire run` finds it.
std::string rig_of(const LoadedCampaign& campaign) {
  const fs::path beside = campaign.file.parent_path() / campaign.campaign.rig;
  std::error_code error;
  return fs::exists(fs::symlink_status(beside, error)) ? beside.lexically_normal().string()
                                                       : find_rig(campaign.campaign.rig);
}

/// A file by its path, or by its name in the folders of configurations.
std::string find_campaign(const std::string& campaign) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(campaign, error))) {
    for (const ConfigFile& file : config_files("campaigns")) {
      if (file.name == campaign || file.name + ".yaml" == campaign) {
        return file.path;
      }
    }
  }
  return campaign;
}

/// Returns runs that have the minimum and the maximum of each numeric parameter, or each of its
/// words: a value that a rig refuses by itself is in one of these.
std::vector<PlannedRun> outermost(const std::vector<PlannedRun>& runs, std::size_t parameters) {
  std::set<std::size_t> chosen{0};
  for (std::size_t i = 0; i < parameters; ++i) {
    std::map<std::string, std::size_t> words;
    std::map<double, std::size_t> numbers;
    for (const PlannedRun& run : runs) {
      if (!run.values[i]) {
        continue;
      }
      if (const auto number = numeric(*run.values[i])) {
        numbers.emplace(number->number, run.index);
      } else {
        words.emplace(*run.values[i], run.index);
      }
    }
    for (const auto& [word, run] : words) {
      chosen.insert(run);
    }
    if (!numbers.empty()) {
      chosen.insert(numbers.begin()->second);
      chosen.insert(numbers.rbegin()->second);
    }
  }
  std::vector<PlannedRun> found;
  for (const std::size_t index : chosen) {
    found.push_back(runs[index]);
  }
  return found;
}

/// Loads the rig as its outermost runs have it, and holds criteria and program against it. Throws
/// ConfigurationError with what a run would refuse or could not be judged by.
void check_plan(const LoadedCampaign& campaign, const std::vector<PlannedRun>& runs,
                const std::string& rig) {
  CriteriaCheck check(campaign);
  for (const PlannedRun& run : outermost(runs, campaign.campaign.parameters.size())) {
    check.look(load_rig(rig, sets_of(campaign.campaign, run)).configuration);
  }
  check.finish();
}

int expand(const CampaignRequest& request, Terminal terminal) {
  const LoadedCampaign campaign = load_campaign(find_campaign(request.target));
  const std::vector<PlannedRun> runs = plan_runs(campaign.campaign);
  const std::string rig = rig_of(campaign);
  check_plan(campaign, runs, rig);
  if (request.output.empty()) {
    terminal.out << table_text(campaign.campaign, runs);
  } else {
    prepare_folder(request.output, campaign, identity_of(campaign, rig), runs);
    terminal.out << fmt::format("{}: {} runs, index 0 to {}\n", request.output, runs.size(),
                                runs.size() - 1);
  }
  return code(ExitCode::done);
}

/// "17", or "0-19".
std::optional<std::pair<std::size_t, std::size_t>> indices(const std::string& text) {
  std::size_t first = 0;
  const char* const end = text.data() + text.size();
  const auto [after, error] = std::from_chars(text.data(), end, first);
  if (error != std::errc()) {
    return std::nullopt;
  }
  if (after == end) {
    return std::pair(first, first);
  }
  std::size_t last = 0;
  const auto [rest, wrong] = std::from_chars(after + 1, end, last);
  return *after == '-' && wrong == std::errc() && rest == end && first <= last
             ? std::optional(std::pair(first, last))
             : std::nullopt;
}

int run_some(const CampaignRequest& request, Terminal terminal) {
  const LoadedCampaign campaign = load_campaign(find_campaign(request.target));
  const std::vector<PlannedRun> runs = plan_runs(campaign.campaign);
  const auto wanted = indices(request.index);
  if (!wanted || wanted->second >= runs.size()) {
    return refuse(terminal,
                  fmt::format("--index: found \"{}\", allowed 0 .. {}, or two of them: 0-{}",
                              request.index, runs.size() - 1, runs.size() - 1));
  }
  const std::string rig = rig_of(campaign);
  const std::string identity = identity_of(campaign, rig);
  if (!has_plan(request.output)) {
    check_plan(campaign, runs, rig);  // a plan that is there was checked when it was made
  }
  prepare_folder(request.output, campaign, identity, runs);
  ExitCode end = ExitCode::done;
  for (std::size_t index = wanted->first; index <= wanted->second; ++index) {
    const RunResult result = run_one(campaign, runs[index], rig, request.output);
    switch (result.end) {
      case RunEnd::was_done:
        terminal.out << fmt::format("run {}: done before\n", index);
        break;
      case RunEnd::passed:
        terminal.out << fmt::format("run {}: passed\n", index);
        break;
      case RunEnd::failed:
        terminal.out << fmt::format("run {}: failed\n", index);
        break;
      case RunEnd::crashed:
        terminal.err << fmt::format("rigwire: run {}: {}\n", index, result.what);
        end = ExitCode::failure;
        break;
      case RunEnd::interrupted:
        return 128 + result.signal;
    }
  }
  return code(end);
}

int collect(const CampaignRequest& request, Terminal terminal) {
  const CampaignTable table = read_rows(request.target);
  write_tables(request.target, table);
  for (std::size_t i = 0; i < kOutcomes.size(); ++i) {
    terminal.out << fmt::format("{}{} {}", i == 0 ? "" : ", ", table.count(static_cast<Outcome>(i)),
                                kOutcomes[i]);
  }
  terminal.out << "\n";
  return code(ExitCode::done);
}

int report(const CampaignRequest& request, Terminal terminal) {
  const CampaignTable table = read_rows(request.target);
  if (!request.html.empty()) {
    WholeFile("the page", request.html).write(report_page(table, request.axes));
  }
  if (request.html != "-") {
    terminal.out << report_text(table);
  }
  return code(ExitCode::done);
}

}  // namespace

int campaign_verb(const CampaignRequest& request, Terminal terminal) {
  const bool runs = request.action == "run";
  const bool reports = request.action == "report";
  if (!runs && !reports && request.action != "expand" && request.action != "collect") {
    return refuse_word("action", request.action, {"expand", "run", "collect", "report"}, terminal);
  }
  if (runs == request.index.empty()) {
    return refuse(terminal, "--index is of run, which needs it");
  }
  if (runs ? request.output.empty() : !request.output.empty() && request.action != "expand") {
    return refuse(terminal, "-o is of expand and of run, which needs it");
  }
  if (!reports && !(request.html.empty() && request.axes.empty())) {
    return refuse(terminal, "--html and --axes are of report");
  }
  if (!request.axes.empty() && (request.axes.size() != 2 || request.html.empty())) {
    return refuse(terminal, "--axes: allowed two parameters, X,Y, with --html");
  }
  return runs                          ? run_some(request, terminal)
         : reports                     ? report(request, terminal)
         : request.action == "collect" ? collect(request, terminal)
                                       : expand(request, terminal);
}

std::string campaign_schema() {
  return schema_of(Campaign{}, "Rigwire: a campaign");
}

}  // namespace rigwire::hil
