#include "hil/files/motion_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "fields/constants.h"
#include "hil/configuration/plain_text.h"
#include "hil/files/mcap_file.h"

namespace rigwire::hil {
namespace {

class CsvMotion {
 public:
  CsvMotion(const MotionSettings& settings, MotionContents& contents, const sim::Machine& model,
            const sim::LocalFrame& frame)
      : settings_(settings), contents_(contents), model_(model), frame_(frame) {}

  void read() {
    std::string rest;
    read_pieces(
        settings_.file, kMotionFile, [&](std::span<const std::uint8_t> bytes) -> std::size_t {
          const auto end = std::ranges::find(bytes, static_cast<std::uint8_t>('\n'));
          const auto length = static_cast<std::size_t>(end - bytes.begin());
          if (length > kMaxLineBytes) {
            refuse_motion(
                settings_.file,
                fmt::format("line {}: too long, found more than {} bytes, allowed at most {}",
                            number_ + 1, kMaxLineBytes, size_text(kMaxLineBytes)));
          }
          rest.assign(reinterpret_cast<const char*>(bytes.data()), length);
          if (end == bytes.end()) {
            return 0;
          }
          take_line(std::exchange(rest, {}));
          return length + 1;
        });
    if (!rest.empty()) {
      take_line(rest);
    }
  }

 private:
  using Row = std::map<std::string, double, std::less<>>;

  static std::vector<std::string> split(std::string_view line) {
    std::vector<std::string> fields(1);
    bool quoted = false;
    for (const char letter : line) {
      if (letter == '"') {
        quoted = !quoted;
      } else if (letter == ',' && !quoted) {
        fields.emplace_back();
      } else if (letter != '\r' && (letter != ' ' || !fields.back().empty())) {
        fields.back() += letter;
      }
    }
    return fields;
  }

  void take_line(const std::string& line) {
    ++number_;
    if (line.empty() || line == "\r" || line.front() == '#') {
      return;
    }
    std::vector<std::string> fields = split(line);
    if (names_.empty()) {
      take_names(std::move(fields));
      return;
    }
    if (fields.size() != names_.size()) {
      refuse_motion(settings_.file, fmt::format("line {}: found {} fields, allowed {}", number_,
                                                fields.size(), names_.size()));
    }
    Row row;
    for (std::size_t i = 0; i < fields.size(); ++i) {
      double value = NumberTable::kMissing;
      const char* const end = fields[i].data() + fields[i].size();
      const auto [stop, error] = std::from_chars(fields[i].data(), end, value);
      const bool is_number =
          !fields[i].empty() && error == std::errc{} && stop == end && std::isfinite(value);
      if (!fields[i].empty() && !is_number && wanted(names_[i])) {
        refuse_motion(settings_.file, fmt::format("line {}: {}: no number, found \"{}\"", number_,
                                                  names_[i], printable(fields[i])));
      }
      if (is_number) {
        row.emplace(names_[i], value);
      }
    }
    take_row(row);
  }

  [[nodiscard]] static bool wanted(std::string_view name) {
    return name == kSimTime || name == kTime || name.ends_with("_m") || name.ends_with("_deg");
  }

  void take_names(std::vector<std::string> names) {
    names_ = std::move(names);
    const auto has = [&](std::string_view name) {
      return std::ranges::find(names_, name) != names_.end();
    };
    time_ = has(kSimTime) ? kSimTime : kTime;
    if (!has(time_)) {
      refuse_motion(settings_.file,
                    fmt::format("no column of time, allowed {} or {}", kTime, kSimTime));
    }
  }

  [[nodiscard]] static std::optional<Eigen::Vector3d> three(const Row& row, const std::string& of,
                                                            std::array<const char*, 3> names) {
    Eigen::Vector3d v;
    for (int i = 0; i < 3; ++i) {
      const auto found = row.find(of + names[static_cast<std::size_t>(i)]);
      if (found == row.end()) {
        return std::nullopt;
      }
      v[i] = found->second;
    }
    return v;
  }
  [[nodiscard]] static std::optional<double> one(const Row& row, const std::string& name) {
    const auto found = row.find(name);
    return found == row.end() ? std::nullopt : std::optional(found->second);
  }

  [[nodiscard]] std::optional<Eigen::Vector3d> place(const Row& row, const std::string& of) const {
    for (const auto& names :
         {std::array{"x_m", "y_m", "z_m"}, std::array{"east_m", "north_m", "up_m"},
          std::array{"position_m.0", "position_m.1", "position_m.2"}}) {
      if (auto p_W = three(row, of, names)) {
        return p_W;
      }
    }
    if (const auto p = three(row, of, {"latitude_deg", "longitude_deg", "height_m"})) {
      if (std::abs(p->x()) > 90.0 || std::abs(p->y()) > 360.0) {
        refuse_motion(settings_.file, fmt::format("line {}: no place on Earth", number_));
      }
      return frame_.to_world({p->x(), p->y(), p->z()});
    }
    return std::nullopt;
  }

  /// Nothing: no columns of an attitude. Throws for one that is none.
  [[nodiscard]] std::optional<Eigen::Quaterniond> attitude(const Row& row,
                                                           const std::string& of) const {
    for (const auto& names :
         {std::array{"qw", "qx", "qy", "qz"},
          std::array{"attitude_wxyz.0", "attitude_wxyz.1", "attitude_wxyz.2", "attitude_wxyz.3"}}) {
      const auto xyz = three(row, of, {names[1], names[2], names[3]});
      const auto w = one(row, of + names[0]);
      if (xyz && w) {
        const Eigen::Quaterniond q(*w, xyz->x(), xyz->y(), xyz->z());
        if (std::abs(q.norm() - 1.0) > 0.01) {
          refuse_motion(settings_.file,
                        fmt::format("line {}: the attitude's length is {:.4g}, allowed 1", number_,
                                    q.norm()));
        }
        return q.normalized();
      }
    }
    const double roll_rad = kDegree * one(row, of + "roll_deg").value_or(0.0);
    const double pitch_rad = kDegree * one(row, of + "pitch_deg").value_or(0.0);
    const auto turned = [&](double yaw_rad, double down_rad) {
      return Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) *
                                Eigen::AngleAxisd(down_rad, Eigen::Vector3d::UnitY()) *
                                Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitX()));
    };
    if (const auto yaw_deg = one(row, of + "yaw_deg")) {
      return turned(kDegree * *yaw_deg, pitch_rad);
    }
    if (const auto heading_deg = one(row, of + "heading_deg")) {
      return turned(kDegree * (90.0 - *heading_deg), -pitch_rad);  // as navigation counts
    }
    return std::nullopt;
  }

  void take_row(const Row& row) {
    const auto time_s = one(row, std::string(time_));
    if (!time_s || !(std::abs(*time_s) < 9e9)) {
      refuse_motion(settings_.file, fmt::format("line {}: no time", number_));
    }
    const auto at_ns =
        static_cast<std::int64_t>(std::llround(static_cast<long double>(*time_s) * 1e9L));
    if (last_ns_ && at_ns <= *last_ns_) {
      refuse_motion(settings_.file, fmt::format("line {}: the time does not rise", number_));
    }
    last_ns_ = at_ns;
    if (time_ == kSimTime) {
      contents_.set_zero(0);
    }
    for (std::size_t link = 0; link < contents_.names().size(); ++link) {
      const std::string of = link == 0 ? "" : contents_.names()[link] + ".";
      const auto p_W = place(row, of);
      const auto q = attitude(row, of);
      if (p_W && q) {
        contents_.at(link, at_ns).X_WL = pose_of(*p_W, *q);
      } else if (link == 0) {
        refuse_motion(
            settings_.file,
            fmt::format("line {}: no {} of the machine's first link", number_,
                        p_W ? "attitude (qw, qx, qy, qz, or yaw_deg or heading_deg with "
                              "pitch_deg and roll_deg)"
                            : "place (x_m, y_m, z_m or latitude_deg, longitude_deg, height_m)"));
      }
    }
    take_joints(row, at_ns);
    for (const auto& [name, value] : row) {
      take_number(name, value, at_ns);
    }
  }

  /// Links of an arm by its joints: the swing about z, left positive, the others about y, upwards
  /// positive, each against the link before.
  void take_joints(const Row& row, std::int64_t at_ns) {
    const auto fields = model_.truth_fields();
    const auto links = model_.links();
    if (fields.empty() || fields.front().key != kJoints ||
        fields.front().count + 1 != links.size()) {
      return;
    }
    std::size_t numbers = 0;
    for (const sim::TruthField& field : fields) {
      numbers += field.count;
    }
    std::vector<double> rest(numbers);
    model_.read_truth(rest);
    for (std::size_t link = 1; link < links.size(); ++link) {
      const auto angle_rad = one(row, fmt::format("{}.{}", kJoints, link - 1));
      const auto& X_WP = contents_.at(link - 1, at_ns).X_WL;
      auto& X_WL = contents_.at(link, at_ns).X_WL;
      if (X_WL || !angle_rad || !X_WP) {
        continue;
      }
      const double turned_rad = *angle_rad - rest[link - 1];
      const Eigen::Isometry3d X_PL = links[link - 1].X_WL.inverse() * links[link].X_WL;
      X_WL = *X_WP * X_PL *
             (link == 1 ? Eigen::AngleAxisd(turned_rad, Eigen::Vector3d::UnitZ())
                        : Eigen::AngleAxisd(-turned_rad, Eigen::Vector3d::UnitY()));
    }
  }

  /// "spool.2" of the truth, "valves.supply_pressure_pa" of a port.
  void take_number(std::string_view name, double value, std::int64_t at_ns) {
    const std::array<std::pair<std::string_view, NumberTable*>, 4> tables{
        {{"valves.", &contents_.valves},
         {"vehicle.", &contents_.vehicle},
         {"power_unit.", &contents_.power_unit},
         {"", &contents_.truth}}};
    for (const auto& [prefix, table] : tables) {
      if (!name.starts_with(prefix)) {
        continue;
      }
      std::string_view rest = name.substr(prefix.size());
      std::size_t index = 0;
      if (const std::size_t point = rest.rfind('.'); point != std::string_view::npos) {
        const char* const end = rest.data() + rest.size();
        if (std::from_chars(rest.data() + point + 1, end, index).ptr == end) {
          rest = rest.substr(0, point);
        }
      }
      if (const auto place = table->place(std::string(rest), index)) {
        table->at(at_ns)[*place] = value;
      }
      return;
    }
  }

  static constexpr std::string_view kSimTime = "sim_s";
  static constexpr std::string_view kTime = "time_s";
  static constexpr std::string_view kJoints = "joint_rad";

  const MotionSettings& settings_;
  MotionContents& contents_;
  const sim::Machine& model_;
  const sim::LocalFrame& frame_;
  std::vector<std::string> names_;
  std::string_view time_ = kTime;
  std::size_t number_ = 0;
  std::optional<std::int64_t> last_ns_;
};

}  // namespace

void read_csv_motion(const MotionSettings& settings, MotionContents& contents,
                     const sim::Machine& model, const sim::LocalFrame& frame) {
  CsvMotion(settings, contents, model, frame).read();
}

}  // namespace rigwire::hil
