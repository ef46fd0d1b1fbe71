#include "hil/campaign/judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "hil/campaign/bound.h"
#include "hil/configuration/outside_file.h"
#include "hil/configuration/plain_text.h"
#include "hil/configuration/suggest.h"
#include "hil/record/number_paths.h"

namespace rigwire::hil {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr std::size_t kMostPlaces = 200;
/// Key of a record under which the quantities of `read` are.
constexpr std::string_view kState = "state";

/// A record with what is derived from it and from those before.
struct Moment {
  double at_s;
  const Json* record;
  std::array<double, kDerivedQuantities.size()> derived;
};

/// Where the value of a criterion's quantity is in a run.
class JudgedQuantity {
 public:
  JudgedQuantity(std::string criterion, std::string name)
      : criterion_(std::move(criterion)), name_(std::move(name)) {}

  /// Throws std::invalid_argument for a number that the run does not have.
  [[nodiscard]] double at(const Moment& moment) const {
    const auto derived = std::ranges::find(kDerivedQuantities, name_, &fields::Named::name);
    if (derived != kDerivedQuantities.end()) {
      return moment.derived[static_cast<std::size_t>(derived - kDerivedQuantities.begin())];
    }
    if (const Json* const state = find_path(*moment.record, kState);
        state != nullptr && state->contains(name_)) {
      return number_at(*state, name_).value_or(std::numeric_limits<double>::quiet_NaN());
    }
    if (const auto value = number_at(*moment.record, name_)) {
      return *value;
    }
    std::vector<std::string> names;
    for (const fields::Named& quantity : kDerivedQuantities) {
      names.emplace_back(quantity.name);
    }
    for (const std::string& path : number_paths(*moment.record)) {
      names.push_back(path.starts_with("state.") ? path.substr(kState.size() + 1) : path);
    }
    const std::string near = nearest_word(name_, names);
    throw std::invalid_argument(fmt::format(
        "criteria.{}.quantity: the run has no such quantity, found \"{}\"{}", criterion_,
        printable(name_), near.empty() ? "" : ", did you mean " + near + "?"));
  }
  [[nodiscard]] std::string wanted(bool above, const Bound& bound) const {
    return fmt::format("{} {} {}", name_, above ? "above" : "below", bound.text());
  }

 private:
  std::string criterion_;
  std::string name_;
};

/// Throws std::invalid_argument for a unit that the quantity cannot have.
Bound bound_of(const std::string& criterion, const std::string& quantity, const WrittenValue& value,
               const std::vector<StateQuantity>& quantities) {
  try {
    return {value, unit_of_quantity(quantity, quantities)};
  } catch (const std::invalid_argument& wrong) {
    throw std::invalid_argument(fmt::format("criteria.{}.value: {}", criterion, wrong.what()));
  }
}

/// One criterion on its way through a run.
class Watch {
 public:
  virtual ~Watch() = default;
  virtual void look(const Moment& moment) = 0;
  [[nodiscard]] virtual Verdict verdict(const RunEvidence& evidence) const = 0;
};

class Reaches final : public Watch {
 public:
  Reaches(const std::string& name, ReachesCriterion criterion,
          const std::vector<StateQuantity>& quantities)
      : c_(std::move(criterion)),
        quantity_(name, c_.quantity),
        bound_(bound_of(name, c_.quantity, c_.value, quantities)) {}
  void look(const Moment& moment) override {
    const double value = quantity_.at(moment);
    if (at_s_ || moment.at_s > to_seconds(c_.limit)) {
      return;
    }
    best_ = !best_ || (c_.above ? value > *best_ : value < *best_) ? value : *best_;
    if (c_.above ? value > bound_.own() : value < bound_.own()) {
      at_s_ = moment.at_s;
    }
  }
  [[nodiscard]] Verdict verdict(const RunEvidence&) const override {
    return {at_s_.has_value(), at_s_,
            fmt::format("{} {}", at_s_ ? "was" : "was never", quantity_.wanted(c_.above, bound_)),
            best_ ? fmt::format("{} {}", c_.above ? "at most" : "at least", bound_.shown(*best_))
                  : "no record"};
  }

 private:
  ReachesCriterion c_;
  JudgedQuantity quantity_;
  Bound bound_;
  std::optional<double> at_s_;
  std::optional<double> best_;
};

class Stays final : public Watch {
 public:
  Stays(const std::string& name, StaysCriterion criterion,
        const std::vector<StateQuantity>& quantities)
      : c_(std::move(criterion)),
        quantity_(name, c_.quantity),
        bound_(bound_of(name, c_.quantity, c_.value, quantities)) {}
  void look(const Moment& moment) override {
    const double value = quantity_.at(moment);
    seen_ = true;
    const bool holds = c_.above ? value > bound_.own() : value < bound_.own();
    worst_ = !worst_ || (c_.above ? value < *worst_ : value > *worst_) ? value : *worst_;
    if (!holds && !at_s_) {
      at_s_ = moment.at_s;
    }
  }
  [[nodiscard]] Verdict verdict(const RunEvidence&) const override {
    const bool passed = seen_ && !at_s_;
    return {passed, at_s_,
            fmt::format("{} {}", passed ? "stayed" : "was not", quantity_.wanted(c_.above, bound_)),
            worst_ ? "at worst " + bound_.shown(*worst_) : "no record"};
  }

 private:
  StaysCriterion c_;
  JudgedQuantity quantity_;
  Bound bound_;
  bool seen_ = false;
  std::optional<double> at_s_;
  std::optional<double> worst_;
};

class Arrives final : public Watch {
 public:
  explicit Arrives(const ArrivesCriterion& criterion) : c_(criterion) {}
  void look(const Moment& moment) override {
    if (moment.at_s < to_seconds(c_.after)) {
      return;
    }
    const Json& place = moment.record->at("position_m");
    const double away_m = std::hypot(place.at(0).get<double>() - c_.place_m[0],
                                     place.at(1).get<double>() - c_.place_m[1]);
    nearest_m_ = std::min(nearest_m_, away_m);
    if (!at_s_ && away_m <= c_.radius_m) {
      at_s_ = moment.at_s;
    }
  }
  [[nodiscard]] Verdict verdict(const RunEvidence&) const override {
    return {at_s_.has_value(), at_s_, at_s_ ? "arrived" : "never arrived",
            fmt::format("nearest {:.2f} m", nearest_m_)};
  }

 private:
  ArrivesCriterion c_;
  double nearest_m_ = std::numeric_limits<double>::infinity();
  std::optional<double> at_s_;
};

class NoContact final : public Watch {
 public:
  void look(const Moment& moment) override {
    const Json* const contact = find_path(*moment.record, "contact");
    if (contact == nullptr) {
      throw std::invalid_argument(
          "no_contact: this machine has no contact with obstacles, allowed a level of detail that "
          "has");
    }
    seen_ = true;
    if (!at_s_ && contact->at("touching").get<bool>()) {
      at_s_ = moment.at_s;
      body_ = contact->at("body").get<std::string>();
      with_ = contact->at("with").get<std::string>();
    }
  }
  [[nodiscard]] Verdict verdict(const RunEvidence&) const override {
    return {seen_ && !at_s_, at_s_,
            at_s_ ? fmt::format("{} hit {}", body_, with_) : "touched nothing",
            seen_ ? "" : "no record"};
  }

 private:
  bool seen_ = false;
  std::optional<double> at_s_;
  std::string body_;
  std::string with_;
};

class NoSlip final : public Watch {
 public:
  void look(const Moment&) override {}
  [[nodiscard]] Verdict verdict(const RunEvidence& evidence) const override {
    const Json& first = evidence.report.at("overrun").at("first");
    const bool passed = evidence.report.at("clock_slips").get<std::size_t>() == 0;
    return {passed,
            passed || first.empty() ? std::nullopt
                                    : std::optional(first.at(0).at("sim_s").get<double>()),
            passed ? "the host kept up" : "simulated time fell behind the wall clock",
            fmt::format("{:.3f} s", evidence.report.at("slipped_s").get<double>())};
  }
};

class ProgramExit final : public Watch {
 public:
  explicit ProgramExit(ProgramExitCriterion criterion) : c_(criterion) {}
  void look(const Moment&) override {}
  [[nodiscard]] Verdict verdict(const RunEvidence& evidence) const override {
    const ProgramEnd end = evidence.program.value_or(ProgramEnd{});
    return {end.by_itself && end.status == c_.status, std::nullopt,
            end.by_itself ? fmt::format("the program ended with status {}", end.status)
                          : "the program did not end in time",
            ""};
  }

 private:
  ProgramExitCriterion c_;
};

class DeviceFigure final : public Watch {
 public:
  DeviceFigure(std::string name, DeviceCriterion criterion)
      : name_(std::move(name)),
        c_(std::move(criterion)),
        bound_(bound_of(name_, c_.figure, c_.value, {})) {}
  void look(const Moment&) override {}
  [[nodiscard]] Verdict verdict(const RunEvidence& evidence) const override {
    const Json& devices = evidence.report.at("devices");
    if (!devices.contains(c_.device)) {
      std::vector<std::string> names;
      for (const auto& [device, figures] : devices.items()) {
        names.push_back(device);
      }
      throw std::invalid_argument(
          fmt::format("criteria.{}.device: no such device, found \"{}\", allowed {}", name_,
                      printable(c_.device), join_words(names)));
    }
    const auto value = number_at(devices[c_.device], c_.figure);
    if (!value) {
      const std::string near = nearest_word(c_.figure, number_paths(devices[c_.device]));
      throw std::invalid_argument(
          fmt::format("criteria.{}.figure: the report has no such figure, found \"{}\"{}", name_,
                      printable(c_.figure), near.empty() ? "" : ", did you mean " + near + "?"));
    }
    const bool passed = c_.above ? *value > bound_.own() : *value < bound_.own();
    return {passed, std::nullopt,
            fmt::format("{} of {} {} {} {}", c_.figure, c_.device, passed ? "is" : "is not",
                        c_.above ? "above" : "below", bound_.text()),
            bound_.shown(*value)};
  }

 private:
  std::string name_;
  DeviceCriterion c_;
  Bound bound_;
};

struct MakeWatch {
  const std::string& name;
  const std::vector<StateQuantity>& quantities;
  std::unique_ptr<Watch> operator()(const ReachesCriterion& c) const {
    return std::make_unique<Reaches>(name, c, quantities);
  }
  std::unique_ptr<Watch> operator()(const StaysCriterion& c) const {
    return std::make_unique<Stays>(name, c, quantities);
  }
  std::unique_ptr<Watch> operator()(const ArrivesCriterion& c) const {
    return std::make_unique<Arrives>(c);
  }
  std::unique_ptr<Watch> operator()(const NoContactCriterion&) const {
    return std::make_unique<NoContact>();
  }
  std::unique_ptr<Watch> operator()(const NoSlipCriterion&) const {
    return std::make_unique<NoSlip>();
  }
  std::unique_ptr<Watch> operator()(const ProgramExitCriterion& c) const {
    return std::make_unique<ProgramExit>(c);
  }
  std::unique_ptr<Watch> operator()(const DeviceCriterion& c) const {
    return std::make_unique<DeviceFigure>(name, c);
  }
};

/// In the order of kDerivedQuantities.
void derive(Moment& moment, const Json* before, double travelled_before_m) {
  const auto numbers = [&](const char* key) {
    return moment.record->at(key).get<std::vector<double>>();
  };
  const std::vector<double> v = numbers("velocity_mps");
  const std::vector<double> q = numbers("attitude_wxyz");
  const std::vector<double> p = numbers("position_m");
  // Columns of the rotation matrix of the unit quaternion: where x, y and z of the body point.
  const double x_east = 1.0 - 2.0 * (q.at(2) * q.at(2) + q.at(3) * q.at(3));
  const double x_north = 2.0 * (q.at(1) * q.at(2) + q.at(0) * q.at(3));
  const double x_up = 2.0 * (q.at(1) * q.at(3) - q.at(0) * q.at(2));
  const double y_up = 2.0 * (q.at(2) * q.at(3) + q.at(0) * q.at(1));
  const double z_up = 1.0 - 2.0 * (q.at(1) * q.at(1) + q.at(2) * q.at(2));
  double moved_m = 0.0;
  if (before != nullptr) {
    moved_m =
        std::hypot(p.at(0) - before->at(0).get<double>(), p.at(1) - before->at(1).get<double>());
  }
  moment.derived = {std::hypot(v.at(0), v.at(1), v.at(2)), kDegrees * std::atan2(x_north, x_east),
                    kDegrees * std::asin(std::clamp(x_up, -1.0, 1.0)),
                    kDegrees * std::atan2(y_up, z_up), travelled_before_m + moved_m};
}

/// Every second one is left out when there are too many, so that they stay evenly spread.
void thin(std::vector<std::array<double, 3>>& track) {
  for (std::size_t i = 1; 2 * i < track.size(); ++i) {
    track[i] = track[2 * i];
  }
  track.resize((track.size() + 1) / 2);
}

std::optional<std::string> first_failure(const std::map<std::string, Verdict>& verdicts) {
  std::optional<std::string> first;
  double earliest_s = std::numeric_limits<double>::infinity();
  for (const auto& [name, verdict] : verdicts) {
    const double at_s = verdict.at_s.value_or(std::numeric_limits<double>::max());
    if (!verdict.passed && at_s < earliest_s) {
      first = name;
      earliest_s = at_s;
    }
  }
  return first;
}

}  // namespace

Judgement judge(const Campaign& campaign, const RunEvidence& evidence) {
  std::map<std::string, std::unique_ptr<Watch>> watches;
  for (const auto& [name, criterion] : campaign.criteria) {
    watches[name] = std::visit(MakeWatch{name, evidence.quantities}, criterion.test);
  }
  Judgement judgement;
  std::optional<LineReader> truth;
  try {
    truth.emplace(evidence.truth, kRecordingFile);
  } catch (const FileRefused& refused) {
    throw std::runtime_error(refused.missing() ? "the run left no truth"
                                               : "the truth: " + refused.rest());
  }
  Moment moment{};
  std::optional<Json> before;
  std::array<double, 3> last{};
  std::size_t stride = 1;
  std::size_t records = 0;
  for (std::string line; truth->next(line); ++records) {
    const Json record = Json::parse(line, nullptr, false);
    if (record.is_discarded()) {
      throw std::runtime_error(
          fmt::format("the truth is not complete: record {} is cut off", records + 1));
    }
    moment.record = &record;
    moment.at_s = moment.record->at("sim_s").get<double>();
    if (moment.at_s > to_seconds(evidence.duration)) {
      break;
    }
    derive(moment, before ? &*before : nullptr, moment.derived.back());
    before = moment.record->at("position_m");
    judgement.end_s = moment.at_s;
    last = {moment.at_s, before->at(0).get<double>(), before->at(1).get<double>()};
    if (records % stride == 0) {
      judgement.track.push_back(last);
      if (judgement.track.size() >= kMostPlaces) {
        thin(judgement.track);
        stride *= 2;
      }
    }
    for (const auto& [name, watch] : watches) {
      watch->look(moment);
    }
  }
  // A run that ended before its first record is judged by what else it left.
  if (!judgement.track.empty() && judgement.track.back() != last) {
    judgement.track.push_back(last);
  }
  for (const auto& [name, watch] : watches) {
    judgement.verdicts[name] = watch->verdict(evidence);
  }
  judgement.first_failure = first_failure(judgement.verdicts);
  return judgement;
}

}  // namespace rigwire::hil
