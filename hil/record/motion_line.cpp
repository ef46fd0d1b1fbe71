#include "hil/record/motion_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <vector>

#include "sim/samples/port_members.h"

namespace rigwire::hil {
namespace {

/// JSON has no number for infinities and NaN.
void append_number(std::string& line, double value) {
  if (std::isfinite(value)) {
    fmt::format_to(std::back_inserter(line), "{:.12g}", value);
  } else {
    line += "null";
  }
}

void append_vector(std::string& line, std::string_view key, const Eigen::Vector3d& v) {
  fmt::format_to(std::back_inserter(line), R"("{}":[{:.12g},{:.12g},{:.12g}])", key, v.x(), v.y(),
                 v.z());
}

template <class Sample>
void append_port(std::string& line, std::string_view key, const std::optional<Sample>& sample) {
  if (!sample) {
    return;
  }
  std::vector<double> numbers;
  append_numbers(*sample, numbers);
  fmt::format_to(std::back_inserter(line), R"(,"{}":{{)", key);
  std::size_t at = 0;
  for (const PortMember& member : members_of(*sample)) {
    fmt::format_to(std::back_inserter(line), R"({}"{}":{})", at == 0 ? "" : ",", member.name,
                   member.count == 1 ? "" : "[");
    for (std::size_t i = 0; i < member.count; ++i, ++at) {
      line += i == 0 ? "" : ",";
      append_number(line, numbers[at]);
    }
    line += member.count == 1 ? "" : "]";
  }
  line += '}';
}

/// Joints whose angles and rates a pair of truth fields holds.
struct JointRow {
  std::string_view angle;  ///< Empty: none, like `rate`.
  std::string_view rate;
  /// Names of the joints; empty: those of the machine's last links.
  std::array<std::string_view, 2> names;
};
constexpr std::array<JointRow, 4> kJointRows{{{"joint_rad", "joint_rate_radps", {}},
                                              {"steer_rad", "", {"front_steer", "rear_steer"}},
                                              {"", "wheel_rate_radps", {}},
                                              {"", "drum_rate_radps", {}}}};

}  // namespace

std::string motion_line(const TruthRecord& record, std::span<const std::string> links) {
  std::string line = R"({"links":{)";
  for (std::size_t i = 0; i < links.size() && i < record.links.size(); ++i) {
    const sim::LinkMotion& link = record.links[i];
    fmt::format_to(std::back_inserter(line), R"({}"{}":{{)", i == 0 ? "" : ",", links[i]);
    append_vector(line, "velocity_mps", link.v_WL_W);
    line += ',';
    append_vector(line, "rate_radps", link.w_WL_W);
    line += ',';
    append_vector(line, "acceleration_mps2", link.a_WL_W);
    line += ',';
    append_vector(line, "angular_acceleration_radps2", link.alpha_WL_W);
    line += '}';
  }
  line += '}';
  append_port(line, "valves", record.valves);
  append_port(line, "vehicle", record.vehicle);
  append_port(line, "power_unit", record.power_unit);
  line += '}';
  return line;
}

JointNames::JointNames(std::span<const sim::TruthField> fields,
                       std::span<const std::string_view> links) {
  const auto place = [&](std::string_view key, std::size_t& count) -> std::ptrdiff_t {
    std::ptrdiff_t at = 0;
    for (const sim::TruthField& field : fields) {
      if (!key.empty() && field.key == key) {
        count = field.count;
        return at;
      }
      at += static_cast<std::ptrdiff_t>(field.count);
    }
    return -1;
  };
  for (const JointRow& row : kJointRows) {
    std::size_t count = 0;
    const std::ptrdiff_t angle = place(row.angle, count);
    const std::ptrdiff_t rate = place(row.rate, count);
    const bool own = !row.names.front().empty();
    if ((angle < 0 && rate < 0) || count > (own ? row.names.size() : links.size())) {
      continue;
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto of = [&](std::ptrdiff_t first) {
        return first < 0 ? first : first + static_cast<std::ptrdiff_t>(i);
      };
      joints_.push_back(
          {std::string(own ? row.names[i] : links[links.size() - count + i]), of(angle), of(rate)});
    }
  }
}

std::string JointNames::line(std::span<const double> truth, std::string_view timestamp) const {
  std::string line = fmt::format(R"({{"timestamp":{},"joints":[)", timestamp);
  const auto put = [&](std::string_view key, std::ptrdiff_t at) {
    if (at >= 0 && std::isfinite(truth[static_cast<std::size_t>(at)])) {
      fmt::format_to(std::back_inserter(line), R"(,"{}":{:.12g})", key,
                     truth[static_cast<std::size_t>(at)]);
    }
  };
  for (const Joint& joint : joints_) {
    fmt::format_to(std::back_inserter(line), R"({}{{"name":"{}")",
                   &joint == joints_.data() ? "" : ",", joint.name);
    put("position", joint.angle);
    put("velocity", joint.rate);
    line += '}';
  }
  line += "]}";
  return line;
}

}  // namespace rigwire::hil
