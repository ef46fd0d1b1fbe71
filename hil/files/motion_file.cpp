#include "hil/files/motion_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "hil/files/mcap_file.h"
#include "protocols/mcap/mcap.h"
#include "sim/samples/port_members.h"

namespace rigwire::hil {
namespace {

namespace mcap = protocols::mcap;
using Json = nlohmann::json;

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegree = std::numbers::pi / 180.0;

[[noreturn]] void refuse(const std::string& file, const std::string& why) {
  throw std::invalid_argument(fmt::format("machine.motion.file: {}: {}", file, why));
}

/// What a link did at one instant of the file.
struct Instant {
  std::optional<Eigen::Isometry3d> X_WL;
  std::optional<sim::LinkMotion> rates;  ///< Its pose is not set.
};

/// Members of a port or of the truth, by name.
struct NumberTable {
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
class Contents {
 public:
  Contents(const MotionSettings& settings, sim::Machine& model) : settings_(settings) {
    for (const std::string_view name : model.link_names()) {
      names_.emplace_back(name);
    }
    links_.resize(names_.size());
    std::vector<PortMember> fields;
    for (const sim::TruthField& field : model.truth_fields()) {
      fields.push_back({field.key, field.count, false});
    }
    truth = NumberTable(fields);
    const auto port = [](NumberTable& table, const auto& sample) {
      table = NumberTable(members_of(sample));
      table.rest.clear();
      append_numbers(sample, table.rest);
    };
    if (const sim::ValvePort* valve_port = model.valve_port()) {
      port(valves, valve_port->valve_sample(kStart));
    }
    if (const sim::VehiclePort* vehicle_port = model.vehicle_port()) {
      port(vehicle, vehicle_port->vehicle_sample(kStart));
    }
    if (const sim::PowerUnitPort* engine_port = model.power_unit_port()) {
      port(power_unit, engine_port->power_unit_sample(kStart));
    }
  }

  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// The link that the file means by that name.
  [[nodiscard]] std::optional<std::size_t> link(std::string_view name) const {
    if (!settings_.frame.empty() && name == settings_.frame) {
      return 0;
    }
    const auto found = std::ranges::find(names_, name);
    return found == names_.end() || (found == names_.begin() && !settings_.frame.empty())
               ? std::nullopt
               : std::optional(static_cast<std::size_t>(found - names_.begin()));
  }
  Instant& at(std::size_t link, std::int64_t time_ns) { return links_[link][time_ns]; }
  void set_zero(std::int64_t zero_ns) { zero_ns_ = zero_ns; }
  [[nodiscard]] bool has_zero() const { return zero_ns_.has_value(); }

  NumberTable truth;
  NumberTable valves;
  NumberTable vehicle;
  NumberTable power_unit;

  [[nodiscard]] sim::MachineRecord record() const;

 private:
  [[nodiscard]] SimTime played(std::int64_t time_ns) const {
    return kStart + Duration{time_ns - *zero_ns_} - settings_.start + settings_.offset;
  }
  [[nodiscard]] std::unique_ptr<sim::MotionTrack> track(std::size_t link) const;
  [[nodiscard]] sim::RecordedNumbers numbers(const NumberTable& table) const {
    sim::RecordedNumbers result(table.steps);
    for (const auto& [time_ns, row] : table.rows) {
      result.add(played(time_ns), row);
    }
    return result;
  }

  const MotionSettings& settings_;
  std::vector<std::string> names_;
  std::vector<std::map<std::int64_t, Instant>> links_;
  mutable std::optional<std::int64_t> zero_ns_;
};

/// Each pose replaced by the value there of the parabola that fits its neighbours best, with
/// weights of a normal distribution: noise goes, and a motion of constant acceleration stays as it
/// is.
std::vector<Eigen::Isometry3d> smoothed(const std::vector<SimTime>& times,
                                        const std::vector<Eigen::Isometry3d>& poses,
                                        Duration deviation) {
  constexpr int kReach = 3;
  std::vector<Eigen::Vector4d> turned;
  for (const Eigen::Isometry3d& pose : poses) {
    Eigen::Vector4d q = Eigen::Quaterniond(pose.linear()).coeffs();
    turned.push_back(!turned.empty() && q.dot(turned.back()) < 0.0 ? Eigen::Vector4d(-q) : q);
  }
  std::vector<Eigen::Isometry3d> result = poses;
  std::size_t first = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    while (times[i] - times[first] > kReach * deviation) {
      ++first;
    }
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 3, 7> right = Eigen::Matrix<double, 3, 7>::Zero();
    for (std::size_t k = first; k < poses.size() && times[k] - times[i] <= kReach * deviation;
         ++k) {
      const double u = to_seconds(times[k] - times[i]) / to_seconds(deviation);
      const Eigen::Vector3d basis(1.0, u, u * u);
      const double weight = std::exp(-0.5 * u * u);
      Eigen::Matrix<double, 1, 7> y;
      y << poses[k].translation().transpose(), turned[k].transpose();
      normal += weight * basis * basis.transpose();
      right += weight * basis * y;
    }
    const auto solver = normal.ldlt();
    if (normal.determinant() <= 1e-9) {
      continue;  // too few neighbours for a parabola
    }
    const Eigen::Matrix<double, 3, 7> fit = solver.solve(right);
    result[i].translation() = fit.row(0).head<3>().transpose();
    const Eigen::Vector4d q = fit.row(0).tail<4>().transpose();
    result[i].linear() = Eigen::Quaterniond(q).normalized().toRotationMatrix();
  }
  return result;
}

std::unique_ptr<sim::MotionTrack> Contents::track(std::size_t link) const {
  const auto& instants = links_[link];
  const bool with_rates = std::ranges::any_of(
      instants, [](const auto& entry) { return entry.second.X_WL && entry.second.rates; });
  std::vector<SimTime> times;
  std::vector<Eigen::Isometry3d> poses;
  std::vector<sim::LinkMotion> motions;
  for (const auto& [time_ns, instant] : instants) {
    if (!instant.X_WL || (with_rates && !instant.rates)) {
      continue;
    }
    times.push_back(played(time_ns));
    poses.push_back(*instant.X_WL);
    if (with_rates) {
      motions.push_back(*instant.rates);
      motions.back().X_WL = *instant.X_WL;
    }
  }
  if (times.empty()) {
    return nullptr;
  }
  if (with_rates) {
    if (settings_.smoothing != Duration{0}) {
      refuse(settings_.file,
             "has accelerations of its own, which no smoothing changes: leave "
             "machine.motion.smoothing out");
    }
    return std::make_unique<sim::MotionTrack>(std::move(times), motions);
  }
  if (settings_.smoothing > Duration{0}) {
    poses = smoothed(times, poses, settings_.smoothing);
  }
  return std::make_unique<sim::MotionTrack>(std::move(times), poses);
}

sim::MachineRecord Contents::record() const {
  if (links_.front().empty()) {
    refuse(settings_.file,
           fmt::format("no pose of the machine's first link \"{}\"; machine.motion.frame says what "
                       "the file calls it",
                       names_.front()));
  }
  if (!zero_ns_) {
    zero_ns_ = links_.front().begin()->first;
  }
  sim::MachineRecord record;
  for (std::size_t link = 0; link < links_.size(); ++link) {
    record.links.push_back(track(link));
  }
  if (played(links_.front().rbegin()->first) <= kStart) {
    refuse(settings_.file, "ends before machine.motion.start");
  }
  record.truth = numbers(truth);
  record.valves = numbers(valves);
  record.vehicle = numbers(vehicle);
  record.power_unit = numbers(power_unit);
  return record;
}

Eigen::Isometry3d pose_of(const Eigen::Vector3d& p_W, const Eigen::Quaterniond& q) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = p_W;
  X.linear() = q.normalized().toRotationMatrix();
  return X;
}

// ---- MCAP ----

class McapMotion {
 public:
  McapMotion(const MotionSettings& settings, Contents& contents)
      : settings_(settings), contents_(contents) {}

  void read() {
    each_mcap_record(settings_.file, [&](const mcap::Record& record) { take(record); });
  }

 private:
  enum class Kind { transforms, transform, pose, motion, truth };
  static constexpr std::array<std::pair<std::string_view, Kind>, 5> kSchemas{
      {{"foxglove.FrameTransforms", Kind::transforms},
       {"foxglove.FrameTransform", Kind::transform},
       {"foxglove.PoseInFrame", Kind::pose},
       {"rigwire.Motion", Kind::motion},
       {"rigwire.Truth", Kind::truth}}};

  void take(const mcap::Record& record) {
    if (record.opcode == mcap::Opcode::schema) {
      if (const auto schema = mcap::read_schema(record.content); schema.ok()) {
        schemas_[schema->id] = schema->name;
      }
    } else if (record.opcode == mcap::Opcode::channel) {
      if (const auto channel = mcap::read_channel(record.content); channel.ok()) {
        meet(*channel);
      }
    } else if (record.opcode == mcap::Opcode::message) {
      const auto message = mcap::read_message(record.content);
      const auto kind = message.ok() ? channels_.find(message->channel) : channels_.end();
      if (kind != channels_.end()) {
        try {
          take(kind->second, static_cast<std::int64_t>(message->time_ns),
               Json::parse(message->data));
        } catch (const Json::exception& error) {
          refuse(settings_.file,
                 fmt::format("a message of {} at {} ns: {}", topics_[message->channel],
                             message->time_ns, error.what()));
        }
      }
    }
  }

  void meet(const mcap::Channel& channel) {
    for (const auto& [name, kind] : kSchemas) {
      if (schemas_[channel.schema] == name) {
        if (channel.encoding != "json") {
          refuse(settings_.file, fmt::format("topic {}: messages as \"{}\", allowed json",
                                             channel.topic, channel.encoding));
        }
        channels_[channel.id] = kind;
        topics_[channel.id] = channel.topic;
      }
    }
  }

  static Eigen::Vector3d vector(const Json& v) {
    return {v.at("x").get<double>(), v.at("y").get<double>(), v.at("z").get<double>()};
  }
  static Eigen::Quaterniond turn(const Json& q) {
    return {q.at("w").get<double>(), q.at("x").get<double>(), q.at("y").get<double>(),
            q.at("z").get<double>()};
  }
  static Eigen::Vector3d three(const Json& v) {
    return {v.at(0).get<double>(), v.at(1).get<double>(), v.at(2).get<double>()};
  }

  /// By the message's own stamp, where it has one: that of logging is when it came.
  static std::int64_t stamp(const Json& message, std::int64_t logged_ns) {
    const auto found = message.find("timestamp");
    if (found == message.end()) {
      return logged_ns;
    }
    const auto nanoseconds = found->find("nsec") != found->end() ? "nsec" : "nanosec";
    return found->at("sec").get<std::int64_t>() * 1'000'000'000 +
           found->at(nanoseconds).get<std::int64_t>();
  }

  void take_transform(const Json& transform, std::int64_t logged_ns) {
    const auto link = contents_.link(transform.at("child_frame_id").get<std::string>());
    if (!link) {
      return;
    }
    const std::int64_t at_ns = stamp(transform, logged_ns);
    Eigen::Isometry3d X =
        pose_of(vector(transform.at("translation")), turn(transform.at("rotation")));
    if (const auto parent = contents_.link(transform.at("parent_frame_id").get<std::string>())) {
      const auto& X_WP = contents_.at(*parent, at_ns).X_WL;
      if (!X_WP) {
        refuse(settings_.file,
               fmt::format("at {} ns the pose of {} counts from {}, which has none at that instant "
                           "before it",
                           at_ns, contents_.names()[*link], contents_.names()[*parent]));
      }
      X = *X_WP * X;
    }
    contents_.at(*link, at_ns).X_WL = X;
  }

  void take(Kind kind, std::int64_t logged_ns, const Json& message) {
    switch (kind) {
      case Kind::transforms:
        for (const Json& transform : message.at("transforms")) {
          take_transform(transform, logged_ns);
        }
        break;
      case Kind::transform:
        take_transform(message, logged_ns);
        break;
      case Kind::pose: {
        const Json& pose = message.at("pose");
        contents_.at(0, stamp(message, logged_ns)).X_WL =
            pose_of(vector(pose.at("position")), turn(pose.at("orientation")));
        break;
      }
      case Kind::motion:
        take_motion(message, logged_ns);
        break;
      case Kind::truth:
        if (!contents_.has_zero()) {
          contents_.set_zero(logged_ns - std::llround(message.at("sim_s").get<double>() * 1e9));
        }
        take_numbers_of(message, contents_.truth, logged_ns);
        break;
    }
  }

  void take_motion(const Json& message, std::int64_t at_ns) {
    for (const auto& [name, link] : message.at("links").items()) {
      if (const auto index = contents_.link(name)) {
        sim::LinkMotion& rates = contents_.at(*index, at_ns).rates.emplace();
        rates.v_WL_W = three(link.at("velocity_mps"));
        rates.w_WL_W = three(link.at("rate_radps"));
        rates.a_WL_W = three(link.at("acceleration_mps2"));
        rates.alpha_WL_W = three(link.at("angular_acceleration_radps2"));
      }
    }
    const auto port = [&](const char* key, NumberTable& table) {
      if (const auto found = message.find(key); found != message.end() && !table.places.empty()) {
        take_numbers_of(*found, table, at_ns);
      }
    };
    port("valves", contents_.valves);
    port("vehicle", contents_.vehicle);
    port("power_unit", contents_.power_unit);
  }

  /// Members that the table has, a number or a list of them; null is no number.
  static void take_numbers_of(const Json& message, NumberTable& table, std::int64_t at_ns) {
    for (const auto& [name, value] : message.items()) {
      const auto put = [&, &key = name](std::size_t index, const Json& number) {
        if (const auto place = table.place(key, index)) {
          table.at(at_ns)[*place] = number.is_null() ? kMissing : number.get<double>();
        }
      };
      if (value.is_array()) {
        for (std::size_t i = 0; i < value.size(); ++i) {
          put(i, value[i]);
        }
      } else if (!value.is_object() && !value.is_string() && !value.is_boolean()) {
        put(0, value);
      }
    }
  }

  const MotionSettings& settings_;
  Contents& contents_;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, Kind> channels_;
  std::map<std::uint16_t, std::string> topics_;
};

// ---- CSV ----

class CsvMotion {
 public:
  CsvMotion(const MotionSettings& settings, Contents& contents, const sim::Machine& model,
            const sim::LocalFrame& frame)
      : settings_(settings), contents_(contents), model_(model), frame_(frame) {}

  void read() {
    std::string rest;
    read_pieces(settings_.file, [&](std::span<const std::uint8_t> bytes) -> std::size_t {
      const auto end = std::ranges::find(bytes, static_cast<std::uint8_t>('\n'));
      const auto length = static_cast<std::size_t>(end - bytes.begin());
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
      refuse(settings_.file, fmt::format("line {}: found {} fields, allowed {}", number_,
                                         fields.size(), names_.size()));
    }
    Row row;
    for (std::size_t i = 0; i < fields.size(); ++i) {
      double value = kMissing;
      const char* const end = fields[i].data() + fields[i].size();
      const auto [stop, error] = std::from_chars(fields[i].data(), end, value);
      if (!fields[i].empty() && (error != std::errc{} || stop != end) && wanted(names_[i])) {
        refuse(settings_.file,
               fmt::format("line {}: {}: no number, found \"{}\"", number_, names_[i], fields[i]));
      }
      if (!fields[i].empty() && error == std::errc{} && stop == end) {
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
      refuse(settings_.file, fmt::format("no column of time, allowed {} or {}", kTime, kSimTime));
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
      if (const auto p_W = three(row, of, names)) {
        return p_W;
      }
    }
    if (const auto p = three(row, of, {"latitude_deg", "longitude_deg", "height_m"})) {
      if (std::abs(p->x()) > 90.0 || std::abs(p->y()) > 360.0) {
        refuse(settings_.file, fmt::format("line {}: no place on Earth", number_));
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
          refuse(settings_.file, fmt::format("line {}: the attitude's length is {:.4g}, allowed 1",
                                             number_, q.norm()));
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
      refuse(settings_.file, fmt::format("line {}: no time", number_));
    }
    const auto at_ns =
        static_cast<std::int64_t>(std::llround(static_cast<long double>(*time_s) * 1e9L));
    if (last_ns_ && at_ns <= *last_ns_) {
      refuse(settings_.file, fmt::format("line {}: the time does not rise", number_));
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
        refuse(settings_.file,
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
  Contents& contents_;
  const sim::Machine& model_;
  const sim::LocalFrame& frame_;
  std::vector<std::string> names_;
  std::string_view time_ = kTime;
  std::size_t number_ = 0;
  std::optional<std::int64_t> last_ns_;
};

}  // namespace

void visit(fields::Visitor& v, MotionSettings& p) {
  static constexpr fields::DurationRule kSpan{0, 1'000'000'000'000'000};
  v.file("file", p.file, fields::FileKind::data,
         "Recorded motion (truth.mcap of a recording, MCAP or CSV of poses) that the machine makes "
         "in place of its own; empty = none.");
  v.only_if(!p.file.empty(), "file", "a file: the machine moves itself", [&p](fields::Visitor& w) {
    w.text("frame", p.frame,
           "What the file calls the machine's first link; empty = as the machine does.");
    w.duration("start", p.start, kSpan, "Where the piece begins, from the file's zero.");
    w.duration("offset", p.offset, kSpan, "From the start of the run to the piece's.");
    w.duration("smoothing", p.smoothing, fields::DurationRule{0, 10'000'000'000},
               "Of poses without accelerations: standard deviation of the window that is averaged; "
               "0 = as they are.");
  });
}

sim::MachineRecord read_motion(const MotionSettings& settings, sim::Machine& model,
                               const sim::LocalFrame& frame) {
  Contents contents(settings, model);
  if (is_mcap(settings.file)) {
    McapMotion(settings, contents).read();
  } else {
    CsvMotion(settings, contents, model, frame).read();
  }
  return contents.record();
}

}  // namespace rigwire::hil
