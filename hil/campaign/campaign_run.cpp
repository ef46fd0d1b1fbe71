#include "hil/campaign/campaign_run.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "drivers/child.h"
#include "drivers/descriptor.h"
#include "drivers/endpoints.h"
#include "drivers/temporary_folder.h"
#include "fields/failure_text.h"
#include "fields/rules.h"
#include "hil/campaign/campaign_folder.h"
#include "hil/campaign/judge.h"
#include "hil/configuration/build_facts.h"
#include "hil/configuration/outline.h"
#include "hil/configuration/outside_file.h"
#include "hil/configuration/plain_text.h"
#include "hil/control/control_client.h"
#include "hil/control/ready.h"
#include "hil/control/run.h"
#include "hil/files/private_folder.h"
#include "hil/record/output_file.h"
#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using drivers::Child;
using drivers::Descriptor;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

constexpr milliseconds kReadyPatience{60'000};
/// After SIGINT; a machine is braked and parked in it.
constexpr milliseconds kProgramPatience{10'000};
constexpr milliseconds kRigPatience{10'000};

/// It crashed; what() says why.
class NotJudged : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The user or the engine wants it to end.
struct Interrupted {
  int signal = 0;
};

/// SIGINT, SIGTERM and SIGHUP are read from a descriptor instead of ending the process.
class Signals {
 public:
  Signals() : descriptor_(open()) {}
  ~Signals() { ::sigprocmask(SIG_SETMASK, &before_, nullptr); }
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;
  [[nodiscard]] int descriptor() const { return descriptor_.get(); }
  [[nodiscard]] int read() const {
    signalfd_siginfo told{};
    return ::read(descriptor(), &told, sizeof(told)) == sizeof(told)
               ? static_cast<int>(told.ssi_signo)
               : SIGTERM;
  }

 private:
  int open() {
    sigset_t wanted;
    ::sigemptyset(&wanted);
    for (const int signal : std::array{SIGINT, SIGTERM, SIGHUP}) {
      ::sigaddset(&wanted, signal);
    }
    ::sigprocmask(SIG_BLOCK, &wanted, &before_);
    return ::signalfd(-1, &wanted, SFD_CLOEXEC);
  }

  sigset_t before_{};
  Descriptor descriptor_;
};

/// A folder with a short name: a socket's path has 107 characters at most.
class WireFolder {
 public:
  WireFolder() : folder_(drivers::make_temporary_folder("a folder for the run's wires", "run")) {}
  ~WireFolder() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  WireFolder(const WireFolder&) = delete;
  WireFolder& operator=(const WireFolder&) = delete;
  [[nodiscard]] fs::path wires() const { return folder_ / "rig"; }
  [[nodiscard]] ControlEndpoint control() const {
    ControlEndpoint endpoint;
    endpoint.path = (folder_ / "control").string();
    return endpoint;
  }

 private:
  fs::path folder_;
};

/// Empty where it cannot be read.
std::string content_of(const fs::path& file) {
  try {
    return read_outside_file(file, kResultFile);
  } catch (const FileRefused&) {
    return "";
  }
}

std::string last_line(const fs::path& file) {
  std::string text = content_of(file);
  text.erase(text.find_last_not_of('\n') + 1);
  return printable(text.substr(text.rfind('\n') + 1));
}

/// Returns the index of the first descriptor that can be read, nullopt when `patience` (no limit
/// without it) has passed. Descriptors of -1 are ignored. Throws Interrupted when a signal arrives.
std::optional<std::size_t> first_of(const Signals& signals, const std::vector<int>& descriptors,
                                    std::optional<milliseconds> patience = std::nullopt) {
  std::vector<pollfd> waiting;
  for (const int descriptor : descriptors) {
    waiting.push_back({descriptor, POLLIN, 0});
  }
  waiting.push_back({signals.descriptor(), POLLIN, 0});
  const int timeout = patience ? static_cast<int>(patience->count()) : -1;
  int count = 0;
  do {
    count = ::poll(waiting.data(), waiting.size(), timeout);
  } while (count < 0 && errno == EINTR);
  if (waiting.back().revents != 0) {
    throw Interrupted{signals.read()};
  }
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    if (waiting[i].revents != 0) {
      return i;
    }
  }
  return std::nullopt;
}

/// Asks in a thread; `descriptor` becomes readable when the answer has come, or none will come. The
/// destructor waits for a rig that does not answer until it has ended.
class Asked {
 public:
  Asked(const ControlEndpoint& endpoint, const Json& request)
      : answered_(::eventfd(0, EFD_CLOEXEC)), thread_([this, endpoint, request] {
          try {
            answer_ = Json::parse(ask_control(endpoint, "", request.dump()).body);
          } catch (const std::exception&) {
            // The rig is gone; how it ended says why.
          }
          is_there_ = true;
          const std::uint64_t one = 1;
          static_cast<void>(::write(descriptor(), &one, sizeof(one)) == sizeof(one));
        }) {}
  ~Asked() { thread_.join(); }
  Asked(const Asked&) = delete;
  Asked& operator=(const Asked&) = delete;
  [[nodiscard]] int descriptor() const { return answered_.get(); }
  /// Once `descriptor` is readable: nothing when the rig is gone.
  [[nodiscard]] std::optional<Json> answer() const { return is_there_ ? answer_ : std::nullopt; }

 private:
  Descriptor answered_;
  std::optional<Json> answer_;
  std::atomic<bool> is_there_{false};
  std::thread thread_;
};

/// Value of a key of the effective configuration, without quotes.
std::optional<std::string> configured(const RigConfiguration& configuration,
                                      const std::string& path) {
  const OutlineNode tree = outline(configuration);
  const OutlineNode* node = &tree;
  std::string rest = path;
  while (!rest.empty()) {
    const std::size_t dot = std::min(rest.find('.'), rest.size());
    const auto child = std::ranges::find(node->children, rest.substr(0, dot), &OutlineNode::key);
    if (child == node->children.end()) {
      return std::nullopt;
    }
    node = &*child;
    rest.erase(0, dot + 1);
  }
  if (node->kind != OutlineNode::Kind::scalar) {
    return std::nullopt;
  }
  std::string value = node->value;
  const bool quoted = value.size() >= 2 && value.front() == '"' && value.back() == '"';
  return quoted ? value.substr(1, value.size() - 2) : value;
}

/// Names and units of the machine's quantities in the answer to `read`.
std::vector<StateQuantity> quantities_of(const std::optional<Json>& answer) {
  std::vector<StateQuantity> quantities;
  if (answer && answer->contains("machine")) {
    for (const auto& [name, quantity] : answer->at("machine").at("quantities").items()) {
      quantities.push_back({name, quantity.at("unit").get<std::string>()});
    }
  }
  return quantities;
}

/// One run on its way.
class CampaignRun {
 public:
  CampaignRun(const LoadedCampaign& campaign, const PlannedRun& run, const std::string& rig,
              const fs::path& folder)
      : campaign_(campaign),
        run_(run),
        folder_(folder),
        rig_(load_rig(rig, sets_of(campaign.campaign, run))),
        hash_(config_hash(rig_.configuration)) {
    WholeFile("the effective configuration", folder_ / "rig.yaml")
        .write(print_rig(rig_.configuration));
  }

  [[nodiscard]] const std::string& hash() const { return hash_; }
  [[nodiscard]] double rig_cpu_s() const { return rig_cpu_s_; }

  /// Throws NotJudged and Interrupted.
  RunEvidence operator()(const Signals& signals) {
    const Campaign& campaign = campaign_.campaign;
    const auto limit = steady_clock::now() + campaign.patience;
    ReadyPipe pipe;
    Child rig(folder_ / "rig.log",
              [&] { return run(rig_.configuration, options(pipe.written())); });
    pipe.handed_over();
    const Json ready = when_ready(signals, pipe, rig);
    std::optional<Child> program;
    if (!campaign.program.empty()) {
      const std::vector<std::string> words = filled(ready);
      program.emplace(folder_ / "program.log", [&words] { return drivers::become(words); });
    }
    RunEvidence evidence;
    evidence.truth = folder_ / "truth.jsonl";
    evidence.duration = campaign.duration;
    const auto wait = [&](const Asked& asked, int other) {
      const auto left = std::chrono::ceil<milliseconds>(limit - steady_clock::now());
      if (!first_of(signals, {asked.descriptor(), rig.descriptor(), other},
                    std::max(left, milliseconds{0}))) {
        throw NotJudged(fmt::format("not done within its patience, {}",
                                    fields::print_duration(campaign.patience.count())));
      }
    };
    std::optional<Asked> until;  // joined when the rig has ended
    std::optional<Asked> events;
    std::optional<Asked> state;
    std::optional<Asked> stop;
    try {
      until.emplace(
          wires_.control(),
          Json{{"verb", "run_until"}, {"time", fmt::format("{} ns", campaign.duration.count())}});
      wait(*until, program ? program->descriptor() : -1);
      if (program) {
        const bool by_itself = program->status().has_value();
        evidence.program = {by_itself, program->end(SIGINT, kProgramPatience)};
      }
      events.emplace(wires_.control(), Json{{"verb", "events"}});
      wait(*events, -1);
      if (const auto told = events->answer()) {
        WholeFile("the events", folder_ / "events.json").write(told->dump(1) + "\n");
        state.emplace(wires_.control(), Json{{"verb", "read"}});
        wait(*state, -1);
        evidence.quantities = quantities_of(state->answer());
        stop.emplace(wires_.control(), Json{{"verb", "stop"}});
        wait(*stop, -1);
      }
    } catch (...) {
      end_both(rig, program);
      throw;
    }
    const int status = rig.end(0, kRigPatience);
    rig_cpu_s_ = rig.cpu_s();
    if (status != 0) {
      throw NotJudged(end_text(status));
    }
    evidence.report = Json::parse(content_of(folder_ / "report.json"), nullptr, false);
    if (evidence.report.is_discarded()) {
      throw NotJudged("the rig left no report");
    }
    return evidence;
  }

 private:
  [[nodiscard]] RunOptions options(int ready) const {
    RunOptions options;
    options.clock = parse_clock_mode(campaign_.campaign.clock).value();
    if (!options.clock.paced()) {
      options.clock.kind = ClockMode::Kind::step;  // the same bytes, and a word at its end
    }
    options.report_path = folder_ / "report.json";
    options.truth_path = folder_ / "truth.jsonl";
    options.control = wires_.control();
    options.ready_descriptor = ready;
    options.isolated_folder = wires_.wires();
    options.origins = &rig_.origins;
    return options;
  }

  Json when_ready(const Signals& signals, ReadyPipe& pipe, Child& rig) const {
    const auto end = steady_clock::now() + kReadyPatience;
    std::optional<std::string> line;
    while (!line) {
      const auto left = std::chrono::duration_cast<milliseconds>(end - steady_clock::now());
      if (left.count() <= 0 || !first_of(signals, {pipe.descriptor()}, left)) {
        throw NotJudged("the rig is not ready within a minute");
      }
      try {
        line = pipe.hear();
      } catch (const drivers::EndpointError&) {
        throw NotJudged(end_text(rig.end(SIGTERM, kRigPatience)));
      }
    }
    return Json::parse(*line);
  }

  /// The program's words with everything filled in.
  [[nodiscard]] std::vector<std::string> filled(const Json& ready) const {
    const Campaign& campaign = campaign_.campaign;
    std::map<std::string, std::string> known{{"index", std::to_string(run_.index)},
                                             {"seed", std::to_string(run_.seed)},
                                             {"folder", folder_.string()},
                                             {"campaign", campaign_.file.parent_path().string()}};
    std::size_t column = 0;
    for (const auto& [name, parameter] : campaign.parameters) {
      const auto& value = run_.values[column++];
      if (value) {
        known[name] = *value;
      } else if (!parameter.keys.empty()) {
        known[name] = configured(rig_.configuration, parameter.keys.front()).value_or("");
      }
    }
    const Json& replaced = ready.at("replaced");
    std::vector<std::string> words;
    for (const std::string& word : campaign.program) {
      std::string text = word;
      for (const std::string& name : placeholders(word)) {
        const std::string brace = "{" + name + "}";
        std::optional<std::string> value;
        if (known.contains(name)) {
          value = known[name];
        } else if (replaced.contains(name)) {
          value = replaced[name].get<std::string>();
        } else {
          value = configured(rig_.configuration, name);
        }
        if (!value) {
          throw NotJudged(
              fmt::format("program: nothing is called so, found \"{}\", allowed a "
                          "parameter, a key of the rig, index, seed, folder, campaign",
                          printable(brace)));
        }
        text.replace(text.find(brace), brace.size(), *value);
      }
      words.push_back(text);
    }
    words.front() = found(words.front());
    return words;
  }

  /// Relative to the campaign's file, else beside rigwire, else where the field programs are
  /// installed, else as the shell finds it.
  [[nodiscard]] std::string found(const std::string& program) const {
    std::error_code error;
    if (program.find('/') != std::string::npos) {
      return (campaign_.file.parent_path() / program).lexically_normal().string();
    }
    const fs::path own = fs::read_symlink("/proc/self/exe", error).parent_path();
    for (const fs::path& folder : std::array{own, own / "../libexec/rigwire"}) {
      if (!error && fs::exists(folder / program, error)) {
        return (folder / program).lexically_normal().string();
      }
      error.clear();
    }
    return program;
  }

  [[nodiscard]] std::string end_text(int status) const {
    const std::string said = last_line(folder_ / "rig.log");
    const std::string how = status > 128 ? fmt::format("the rig ended by signal {}", status - 128)
                                         : fmt::format("the rig ended with exit code {}", status);
    return said.empty() ? how : how + ": " + said;
  }

  static void end_both(Child& rig, std::optional<Child>& program) {
    if (program) {
      static_cast<void>(program->end(SIGINT, kProgramPatience));
    }
    static_cast<void>(rig.end(SIGTERM, kRigPatience));
  }

  const LoadedCampaign& campaign_;
  const PlannedRun& run_;
  fs::path folder_;
  LoadedRig rig_;
  std::string hash_;
  WireFolder wires_;
  double rig_cpu_s_ = 0.0;
};

Json json_of(const Verdict& verdict) {
  Json told{{"passed", verdict.passed}, {"at_s", nullptr}, {"text", verdict.text}};
  if (verdict.at_s) {
    told["at_s"] = *verdict.at_s;
  }
  told["detail"] = verdict.detail;
  return told;
}

void tell(Json& result, const Judgement& judgement) {
  result["outcome"] = judgement.first_failure ? "failed" : "passed";
  result["first_failure"] = nullptr;
  if (judgement.first_failure) {
    result["first_failure"] = *judgement.first_failure;
  }
  result["sim_s"] = judgement.end_s;
  for (const auto& [name, verdict] : judgement.verdicts) {
    result["criteria"][name] = json_of(verdict);
  }
  result["track"] = Json::array();
  for (const auto& [at_s, east_m, north_m] : judgement.track) {
    result["track"].push_back(
        {at_s, std::round(1e3 * east_m) / 1e3, std::round(1e3 * north_m) / 1e3});
  }
}

double seconds_since(steady_clock::time_point begin) {
  return std::chrono::duration<double>(steady_clock::now() - begin).count();
}

}  // namespace

std::vector<std::string> sets_of(const Campaign& campaign, const PlannedRun& run) {
  std::vector<std::string> sets = campaign.set;
  std::size_t column = 0;
  for (const auto& [name, parameter] : campaign.parameters) {
    const auto& value = run.values[column++];
    for (const std::string& key : parameter.keys) {
      if (value) {
        sets.push_back(key + "=" + *value);
      }
    }
  }
  sets.push_back("seed=" + std::to_string(run.seed));
  return sets;
}

std::string identity_of(const LoadedCampaign& campaign, const std::string& rig) {
  const LoadedRig base = load_rig(rig, campaign.campaign.set);
  return fmt::format("{:016x}", fnv1a(config_hash(base.configuration), fnv1a(campaign.hash)));
}

RunResult run_one(const LoadedCampaign& campaign, const PlannedRun& run, const std::string& rig,
                  const fs::path& folder) {
  const auto begin = steady_clock::now();
  const fs::path place = run_folder(folder, run.index);
  if (is_done(place)) {
    return {RunEnd::was_done, {}, 0};
  }
  const RunClaim claim(place);
  if (is_done(place)) {
    return {RunEnd::was_done, {}, 0};
  }
  Json result{{"index", run.index},           {"seed", run.seed},     {"version", version()},
              {"parameters", Json::object()}, {"outcome", "crashed"}, {"what", nullptr}};
  std::size_t column = 0;
  for (const auto& [name, parameter] : campaign.campaign.parameters) {
    const auto& value = run.values[column++];
    result["parameters"][name] = value ? Json(*value) : Json(nullptr);
  }
  RunResult ended{RunEnd::crashed, {}, 0};
  const Signals signals;
  try {
    CampaignRun running(campaign, run, rig, fs::absolute(place));
    result["config_hash"] = running.hash();
    const RunEvidence evidence = running(signals);
    if (evidence.program) {
      result["program"] = {{"by_itself", evidence.program->by_itself},
                           {"status", evidence.program->status}};
    }
    tell(result, judge(campaign.campaign, evidence));
    ended.end = result["outcome"] == "passed" ? RunEnd::passed : RunEnd::failed;
    result["wall"] = {{"rig_s", evidence.report.at("wall_s")},
                      {"cpu_s", running.rig_cpu_s()},
                      {"clock_slips", evidence.report.at("clock_slips")}};
  } catch (const Interrupted& interrupted) {
    return {RunEnd::interrupted, "interrupted", interrupted.signal};
  } catch (const std::exception& error) {
    ended.what = fields::failure_text(error, "the run");
    result["what"] = printable(ended.what, "\n");
  }
  if (!campaign.campaign.keep_truth && ended.end != RunEnd::crashed) {
    fs::remove(place / "truth.jsonl");
  }
  result["wall"]["whole_s"] = seconds_since(begin);
  WholeFile("the result", place / "result.json").write(result.dump() + "\n");
  if (ended.end != RunEnd::crashed) {
    claim.finish();
  }
  return ended;
}

}  // namespace rigwire::hil
