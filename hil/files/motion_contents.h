// What a file of motion says, by its own instants, whatever its format: poses and rates of links,
// numbers of the truth and of ports. Readers of formats (motion_mcap.h, motion_csv.h) fill it; what
// it comes to for a machine that is moved by it is record().
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hil/files/motion_file.h"
#include "sim/machine.h"
#include "sim/replay/replayed_machine.h"
#include "sim/samples/port_members.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

/// Throws std::invalid_argument that names the key and the file.
[[noreturn]] void refuse_motion(const std::string& file, const std::string& why);

[[nodiscard]] Eigen::Isometry3d pose_of(const Eigen::Vector3d& p_W, const Eigen::Quaterniond& q);

/// What a link did at one instant of the file.
struct Instant {
  std::optional<Eigen::Isometry3d> X_WL;
  std::optional<sim::LinkMotion> rates;  ///< Its pose is not set.
};

/// Members of a port or of the truth, by name.
struct NumberTable {
  static constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

  NumberTable() = default;
  explicit NumberTable(std::span<const PortMember> members) {
    for (const PortMember& member : members) {
      places.emplace(std::string(member.name), std::pair(rest.size(), member.count));
      rest.insert(rest.end(), member.count, kMissing);
      steps.insert(steps.end(), member.count, member.steps);
    }
  }

  /// Nothing: there is no such member.
  [[nodiscard]] std::optional<std::size_t> place(const std::string& name, std::size_t index) const {
    const auto found = places.find(name);
    return found == places.end() || index >= found->second.second
               ? std::nullopt
               : std::optional(found->second.first + index);
  }
  std::vector<double>& at(std::int64_t time_ns) {
    return rows.try_emplace(time_ns, rest).first->second;
  }

  std::map<std::string, std::pair<std::size_t, std::size_t>> places;
  std::vector<double> rest;  ///< Where the file says nothing.
  std::vector<bool> steps;
  std::map<std::int64_t, std::vector<double>> rows;
};

/// What a file says, by its own instants.
class MotionContents {
 public:
  /// Refers to the settings.
  MotionContents(const MotionSettings& settings, sim::Machine& model);

  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// The link that the file means by that name.
  [[nodiscard]] std::optional<std::size_t> link(std::string_view name) const;
  Instant& at(std::size_t link, std::int64_t time_ns) { return links_[link][time_ns]; }
  void set_zero(std::int64_t zero_ns) { zero_ns_ = zero_ns; }
  [[nodiscard]] bool has_zero() const { return zero_ns_.has_value(); }

  NumberTable truth;
  NumberTable valves;
  NumberTable vehicle;
  NumberTable power_unit;

  /// Throws std::invalid_argument where a machine cannot be moved by it.
  [[nodiscard]] sim::MachineRecord record() const;

 private:
  [[nodiscard]] SimTime played(std::int64_t time_ns) const;
  [[nodiscard]] std::unique_ptr<sim::MotionTrack> track(std::size_t link) const;
  [[nodiscard]] sim::RecordedNumbers numbers(const NumberTable& table) const;

  const MotionSettings& settings_;
  std::vector<std::string> names_;
  std::vector<std::map<std::int64_t, Instant>> links_;
  mutable std::optional<std::int64_t> zero_ns_;
};

}  // namespace rigwire::hil
