#include "hil/campaign/criteria_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "fields/units.h"
#include "hil/campaign/bound.h"
#include "hil/campaign/judge.h"
#include "hil/configuration/outline.h"
#include "hil/configuration/suggest.h"
#include "hil/record/number_paths.h"
#include "hil/record/report.h"
#include "hil/record/truth_tap.h"
#include "hil/rig/rig.h"
#include "hil/world/quantities.h"
#include "sim/machine.h"

namespace rigwire::hil {

namespace {

/// Figures of a device that every report has.
std::vector<std::string> figures_of_reports() {
  RunReport report;
  report.devices.emplace_back().name = "device";
  std::vector<std::string> figures =
      number_paths(nlohmann::ordered_json::parse(to_json(report)).at("devices").at("device"));
  std::erase_if(figures, [](const std::string& figure) {
    return figure.starts_with("lateness_us.histogram.");
  });
  return figures;
}

/// A figure that only some reports have: of the device's own counts, of a client that asked.
bool is_figure_of_some(std::string_view figure) {
  return figure.starts_with("counts.") || figure == "last_request.sim_s" ||
         figure.starts_with("lateness_us.histogram.");
}

/// Holds the criteria against what the runs of one rig have.
class CriterionChecks {
 public:
  CriterionChecks(const LoadedCampaign& campaign, const JudgedRig& rig, Problems& problems)
      : campaign_(campaign), rig_(rig), problems_(problems) {}

  void run() {
    for (const auto& [name, criterion] : campaign_.campaign.criteria) {
      path_ = "criteria." + name;
      std::visit([this](const auto& test) { check(test); }, criterion.test);
    }
  }

 private:
  void check(const ReachesCriterion& c) { check_quantity(c.quantity, c.value); }
  void check(const StaysCriterion& c) { check_quantity(c.quantity, c.value); }
  void check(const NoContactCriterion&) {
    if (!rig_.meets_obstacles) {
      report("type", "this machine strikes no obstacles", "no_contact", "another type", "");
    }
  }
  void check(const DeviceCriterion& c) {
    if (std::ranges::count(rig_.devices, c.device) == 0) {
      report("device", "the rig has no such device", quoted(c.device), join_words(rig_.devices),
             nearest_word(c.device, rig_.devices));
      return;
    }
    const std::vector<std::string> figures = figures_of_reports();
    if (std::ranges::count(figures, c.figure) == 0 && !is_figure_of_some(c.figure)) {
      report("figure", "the report has no such figure", quoted(c.figure),
             join_words(figures) + ", counts.NAME", nearest_word(c.figure, figures));
      return;
    }
    check_value(c.value, unit_of_key(c.figure));
  }
  /// The campaign alone decides about these, or every truth has what they need.
  void check(const ArrivesCriterion&) {}
  void check(const NoSlipCriterion&) {}
  void check(const ProgramExitCriterion&) {}

  void check_quantity(const std::string& name, const WrittenValue& value) {
    const bool is_word = find_quantity(rig_.quantities, name).has_value();
    const bool is_key = std::ranges::count(rig_.truth, name) > 0;
    const bool is_derived = std::ranges::find(kDerivedQuantities, name, &fields::Named::name) !=
                            kDerivedQuantities.end();
    if (int{is_word} + int{is_key} + int{is_derived} > 1) {
      report("quantity", "two quantities have this name", quoted(name), "state." + name, "");
    } else if (is_word || is_key || is_derived) {
      check_value(value, unit_of_quantity(name, rig_.quantities));
    } else if (const std::vector<std::string> members = members_of(name); !members.empty()) {
      report("quantity", "this key of the truth holds several numbers", quoted(name),
             join_words(members), "");
    } else {
      std::vector<StateQuantity> words = rig_.quantities;
      for (const fields::Named& derived : kDerivedQuantities) {
        words.push_back({std::string(derived.name), std::string(unit_of_key(derived.name))});
      }
      std::vector<std::string> names;
      std::ranges::transform(words, std::back_inserter(names), &StateQuantity::name);
      names.insert(names.end(), rig_.truth.begin(), rig_.truth.end());
      report("quantity", "the machine has no such quantity", quoted(name),
             list_quantities(words) + ", or a key of the truth", nearest_word(name, names));
    }
  }

  void check_value(const WrittenValue& value, std::string_view own_unit) {
    try {
      static_cast<void>(Bound(value, own_unit));
    } catch (const std::invalid_argument& wrong) {
      report("value", wrong.what(), "", "", "");
    }
  }

  /// Paths of the numbers under a key of the truth.
  [[nodiscard]] std::vector<std::string> members_of(const std::string& key) const {
    std::vector<std::string> members;
    std::ranges::copy_if(rig_.truth, std::back_inserter(members),
                         [&](const std::string& path) { return path.starts_with(key + "."); });
    return members;
  }

  static std::string quoted(const std::string& text) { return "\"" + text + "\""; }

  void report(const char* key, std::string what, std::string found, std::string allowed,
              std::string suggestion) {
    const std::string path = path_ + "." + key;
    problems_.add({campaign_.origins.nearest(path), path, std::move(what), std::move(found),
                   std::move(allowed), std::move(suggestion)});
  }

  const LoadedCampaign& campaign_;
  const JudgedRig& rig_;
  Problems& problems_;
  std::string path_;  ///< Key path of the criterion that is checked.
};

/// Everything of a machine but its numbers, which decide nothing about names.
void add_kind(const OutlineNode& node, std::string& kind) {
  kind += node.key + "=";
  if (node.kind == OutlineNode::Kind::scalar && !fields::split_quantity(node.value)) {
    kind += node.value;
  }
  kind += '{';
  for (const OutlineNode& child : node.children) {
    add_kind(child, kind);
  }
  kind += '}';
}

/// Rigs of one kind have the same quantities and devices.
std::string kind_of(const RigConfiguration& configuration) {
  std::string kind;
  add_kind(outline(configuration.machine), kind);
  for (const auto& [name, device] : configuration.devices) {
    kind += fmt::format(";{}:{}", name, device.type());
  }
  return kind;
}

/// Whether a key path leads anywhere in a configuration.
bool has_key(const OutlineNode& tree, std::string_view path) {
  const OutlineNode* node = &tree;
  while (!path.empty()) {
    const std::size_t dot = std::min(path.find('.'), path.size());
    const auto child = std::ranges::find(node->children, path.substr(0, dot), &OutlineNode::key);
    if (child == node->children.end()) {
      return false;
    }
    node = &*child;
    path.remove_prefix(std::min(dot + 1, path.size()));
  }
  return true;
}

}  // namespace

JudgedRig judged_rig(const RigConfiguration& configuration) {
  const MachineInScene built = build_machine_in_scene(configuration);
  const RigView view = view_of(configuration);
  std::vector<std::string> antennas = view.receivers;
  antennas.insert(antennas.end(), view.base_stations.begin(), view.base_stations.end());
  JudgedRig rig{state_quantities(*built.machine),
                truth_numbers(*built.machine, antennas),
                built.machine->contact_report() != nullptr,
                {}};
  for (const auto& [name, device] : configuration.devices) {
    rig.devices.push_back(name);
  }
  return rig;
}

void check_criteria(const LoadedCampaign& campaign, const JudgedRig& rig, Problems& problems) {
  CriterionChecks(campaign, rig, problems).run();
}

void CriteriaCheck::look(const RigConfiguration& configuration) {
  const std::string kind = kind_of(configuration);
  if (seen_.contains(kind)) {
    return;
  }
  try {
    const JudgedRig rig = judged_rig(configuration);
    seen_.insert(kind);
    failed_.erase(kind);
    Problems found;
    check_criteria(campaign_, rig, found);
    for (const Problem& problem : found.sorted()) {
      // Several rigs may have the same fault.
      if (said_.insert(problem.path).second) {
        problems_.add(problem);
      }
    }
    look_at_program(configuration);
  } catch (const std::exception& error) {
    failed_.emplace(kind, error.what());
  }
}

void CriteriaCheck::look_at_program(const RigConfiguration& configuration) {
  const Campaign& campaign = campaign_.campaign;
  const OutlineNode tree = outline(configuration);
  for (std::size_t i = 0; i < campaign.program.size(); ++i) {
    const std::string path = fmt::format("program.{}", i);
    for (const std::string& name : placeholders(campaign.program[i])) {
      const bool known = campaign.parameters.contains(name) ||
                         std::ranges::count(kOwnPlaceholders, name) > 0 || has_key(tree, name);
      if (!known && said_.insert(path + name).second) {
        std::vector<std::string> words(kOwnPlaceholders.begin(), kOwnPlaceholders.end());
        for (const auto& [parameter, spread] : campaign.parameters) {
          words.push_back(parameter);
        }
        problems_.add({campaign_.origins.nearest(path), path, "nothing is called so",
                       "\"{" + name + "}\"", join_words(words) + ", or a key of the rig",
                       nearest_word(name, words)});
      }
    }
  }
}

void CriteriaCheck::finish() {
  for (const auto& [kind, reason] : failed_) {
    if (said_.insert(reason).second) {
      problems_.add({campaign_.origins.nearest("rig"), "rig",
                     "a run of this rig could not begin: " + reason, "", "", ""});
    }
  }
  problems_.throw_if_any();
}

}  // namespace rigwire::hil
