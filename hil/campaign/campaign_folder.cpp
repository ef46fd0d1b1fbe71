#include "hil/campaign/campaign_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "drivers/endpoints.h"
#include "hil/campaign/csv_table.h"
#include "hil/configuration/outside_file.h"
#include "hil/configuration/plain_text.h"
#include "hil/record/output_file.h"

namespace rigwire::hil {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr const char* kDone = "DONE";
constexpr const char* kLock = "LOCK";

[[noreturn]] void fail(const fs::path& path) {
  throw drivers::EndpointError(
      fmt::format("{}: {}", printable(path.string()), std::strerror(errno)));
}

/// A file or folder; what was written to it survives a loss of power.
void flush_to_disk(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) {
    fail(path);
  }
  const int result = ::fsync(descriptor);
  ::close(descriptor);
  if (result != 0) {
    fail(path);
  }
}

[[noreturn]] void refuse_folder(const fs::path& folder) {
  throw std::invalid_argument(printable(folder.string()) +
                              ": no campaign's folder, allowed one that `rigwire campaign expand "
                              "-o` or `run -o` made");
}

}  // namespace

std::string table_text(const Campaign& campaign, const std::vector<PlannedRun>& runs) {
  std::vector<std::string> line{"index", "seed"};
  for (const auto& [name, parameter] : campaign.parameters) {
    line.push_back(name);
  }
  std::string text = csv_line(line);
  for (const PlannedRun& run : runs) {
    line = {std::to_string(run.index), std::to_string(run.seed)};
    for (const auto& value : run.values) {
      line.push_back(value.value_or(""));
    }
    text += csv_line(line);
  }
  return text;
}

void prepare_folder(const fs::path& folder, const LoadedCampaign& campaign,
                    const std::string& identity, const std::vector<PlannedRun>& runs) {
  std::error_code error;
  fs::create_directories(folder / "runs", error);
  if (error) {
    throw drivers::EndpointError(
        fmt::format("{}: {}", printable(folder.string()), error.message()));
  }
  if (has_plan(folder)) {
    const CampaignPlan plan = read_plan(folder);
    if (plan.identity != identity) {
      throw std::invalid_argument(fmt::format(
          "{}: the folder is of another campaign, found that of {}, allowed a new folder, or "
          "campaign and rig as they were",
          printable(folder.string()), printable(plan.file.string())));
    }
    return;
  }
  Json plan{{"name", campaign.campaign.name}, {"campaign", campaign.file.string()},
            {"identity", identity},           {"runs", runs.size()},
            {"parameters", Json::array()},    {"criteria", Json::array()}};
  for (const auto& [name, parameter] : campaign.campaign.parameters) {
    plan["parameters"].push_back(name);
  }
  for (const auto& [name, criterion] : campaign.campaign.criteria) {
    plan["criteria"].push_back(name);
  }
  WholeFile("the table", folder / "table.csv").write(table_text(campaign.campaign, runs));
  WholeFile("the plan", folder / "plan.json").write(plan.dump(2) + "\n");
}

bool has_plan(const fs::path& folder) {
  std::error_code error;
  return fs::exists(fs::symlink_status(folder / "plan.json", error));
}

CampaignPlan read_plan(const fs::path& folder) {
  try {
    const Json plan = Json::parse(read_outside_file(folder / "plan.json", kResultFile));
    return {plan.at("name"),       plan.at("campaign").get<std::string>(),
            plan.at("identity"),   plan.at("runs"),
            plan.at("parameters"), plan.at("criteria")};
  } catch (const FileRefused& refused) {
    if (!refused.missing()) {
      throw;
    }
    refuse_folder(folder);
  } catch (const nlohmann::json::exception&) {
    refuse_folder(folder);
  }
}

fs::path run_folder(const fs::path& folder, std::size_t index) {
  return folder / "runs" / fmt::format("{:06}", index);
}

bool is_done(const fs::path& run_folder) {
  std::error_code error;
  return fs::exists(run_folder / kDone, error);
}

RunClaim::RunClaim(const fs::path& run_folder) : folder_(run_folder) {
  std::error_code error;
  fs::create_directories(folder_, error);
  const fs::path lock = folder_ / kLock;
  lock_ = ::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (lock_ < 0) {
    fail(lock);
  }
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    const int number = errno;
    ::close(lock_);
    throw drivers::EndpointError(
        fmt::format("{}: {}", printable(folder_.string()),
                    number == EWOULDBLOCK ? "another process is at this run, allowed one at a time"
                                          : std::strerror(number)));
  }
  if (is_done(folder_)) {
    return;
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
    if (entry.path().filename() != kLock) {
      fs::remove_all(entry.path());
    }
  }
}

RunClaim::~RunClaim() {
  ::close(lock_);
}

void RunClaim::finish() const {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
    if (entry.is_regular_file()) {
      flush_to_disk(entry.path());
    }
  }
  const fs::path written = folder_ / "DONE.new";
  const fs::path done = folder_ / kDone;
  std::ofstream(written) << "done\n";
  flush_to_disk(written);
  if (std::rename(written.c_str(), done.c_str()) != 0) {
    fail(done);
  }
  fs::remove(folder_ / kLock);
  flush_to_disk(folder_);
}

}  // namespace rigwire::hil
