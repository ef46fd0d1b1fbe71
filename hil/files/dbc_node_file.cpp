#include "hil/files/dbc_node_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "emulators/dbc_node/quantities.h"
#include "fields/constants.h"
#include "fields/units.h"
#include "fields/visitor.h"
#include "hil/configuration/document.h"
#include "hil/configuration/outside_file.h"
#include "hil/configuration/reader.h"
#include "hil/configuration/suggest.h"
#include "protocols/dbc/dbc_reader.h"
#include "protocols/j1939/identifier.h"
#include "protocols/j1939/name.h"

namespace rigwire::hil {

using fields::Choice;
using fields::IntegerRule;
using fields::plain;

namespace {

namespace can = protocols::can;
namespace dbc = protocols::dbc;
namespace j1939 = protocols::j1939;
using emulators::DbcChecksum;
using emulators::NamedQuantity;

constexpr std::array<Choice<DbcSendingBinding>, 6> kSendings{
    {{DbcSendingBinding::as_file, "as_file", "By GenMsgSendType and GenMsgCycleTime of the file."},
     {DbcSendingBinding::cyclic, "cyclic", "By time."},
     {DbcSendingBinding::on_change, "on_change", "When a signal has another raw value."},
     {DbcSendingBinding::cyclic_and_on_change, "cyclic_and_on_change", "Both."},
     {DbcSendingBinding::on_request, "on_request",
      "When a remote frame, or a J1939 request for its group, asks for it."},
     {DbcSendingBinding::never, "never", "Not at all."}}};

/// Units as DBC files spell them, beside those of fields/units.h.
struct Spelling {
  std::string_view written;
  std::string_view unit;
};
constexpr std::array kSpellings{
    Spelling{"\u00b0", "deg"},   Spelling{"degree", "deg"},     Spelling{"degrees", "deg"},
    Spelling{"Degree", "deg"},   Spelling{"grad", "deg"},       Spelling{"\u00b0/s", "deg/s"},
    Spelling{"degps", "deg/s"},  Spelling{"rad/sec", "rad/s"},  Spelling{"deg/sec", "deg/s"},
    Spelling{"\u00b0C", "degC"}, Spelling{"C", "degC"},         Spelling{"deg C", "degC"},
    Spelling{"1/min", "rpm"},    Spelling{"U/min", "rpm"},      Spelling{"RPM", "rpm"},
    Spelling{"m/s^2", "m/s2"},   Spelling{"m/s\u00b2", "m/s2"}, Spelling{"m/sec2", "m/s2"},
    Spelling{"Nm", "N m"},       Spelling{"kph", "km/h"},       Spelling{"kmh", "km/h"},
    Spelling{"km/hr", "km/h"},   Spelling{"sec", "s"},          Spelling{"percent", "%"},
    Spelling{"Bar", "bar"},      Spelling{"meter", "m"},        Spelling{"-", ""},
    Spelling{"m/sec", "m/s"}};

/// How many SI units one of `unit` is; nothing when it is no unit of that dimension.
std::optional<double> size_of(std::string unit, fields::Dimension dimension) {
  const auto spelled = std::ranges::find(kSpellings, std::string_view(unit), &Spelling::written);
  if (spelled != kSpellings.end()) {
    unit = spelled->unit;
  }
  if (dimension == fields::Dimension::none) {
    return 1.0;
  }
  if (unit.empty() && dimension == fields::Dimension::ratio) {
    return 1.0;
  }
  const fields::Unit* found = fields::find_unit(unit, dimension);
  return found == nullptr ? std::nullopt : std::optional(found->numerator / found->denominator);
}

Duration milliseconds(double ms) {
  constexpr double kGreatest_ms = 3'600'000.0;
  return from_seconds(1e-3 * std::clamp(ms, 0.0, kGreatest_ms));
}

/// Puts the two files together.
class Binder {
 public:
  Binder(DbcNodeBinding binding, const Origins& origins, Problems& problems)
      : binding_(std::move(binding)), origins_(origins), problems_(problems) {}

  DbcNodeDescription bind() {
    device_.text = binding_.text;
    if (!read_dbc()) {
      return device_;
    }
    device_.settings.sample_period = binding_.sample_period;
    device_.settings.processing_delay = binding_.processing_delay;
    if (binding_.claims_address) {
      device_.serial = binding_.serial;
      device_.settings.claim = emulators::DbcClaim{
          binding_.source_address,
          pack(emulators::make_name(binding_.name, binding_.serial, binding_.arbitrary_address)),
          binding_.arbitrary_address};
    }
    if (!binding_.node.empty()) {
      const auto& nodes = content_.nodes;
      if (std::ranges::find(nodes, binding_.node) == nodes.end()) {
        report("node", "no such node in the DBC file", binding_.node, nodes);
      }
    }
    collect_moved();
    for (std::size_t i = 0; i < binding_.takes.size(); ++i) {
      take(fmt::format("takes.{}", i), binding_.takes[i]);
    }
    for (std::size_t i = 0; i < binding_.sends.size(); ++i) {
      send(fmt::format("sends.{}", i), binding_.sends[i]);
    }
    send_the_rest();
    if (device_.settings.sent.empty() && device_.settings.taken.empty() && problems_.empty()) {
      report("node", "the device sends and takes nothing", binding_.node,
             std::string("a node of the file, `sends` or `takes`"));
    }
    return std::move(device_);
  }

 private:
  void report(const std::string& path, std::string what, std::string found = {},
              std::string allowed = {}, std::string suggestion = {}) {
    problems_.add({origins_.nearest(path), path, std::move(what), std::move(found),
                   std::move(allowed), std::move(suggestion)});
  }
  void report(const std::string& path, std::string what, const std::string& found,
              const std::vector<std::string>& names) {
    constexpr std::size_t kMostShown = 12;
    std::string near = nearest_word(found, names);
    report(path, std::move(what), "\"" + found + "\"",
           names.size() <= kMostShown ? join_words(names) : fmt::format("{} names", names.size()),
           std::move(near));
  }
  void report(const dbc::Finding& finding) {
    const Location where{dbc_name_, finding.line, finding.column};
    problems_.add({where, "", finding.what, finding.found, finding.allowed, {}});
  }

  bool read_dbc() {
    dbc_name_ = std::make_shared<const std::string>(binding_.dbc);
    std::string text;
    try {
      text = read_outside_file(binding_.dbc, kDbcFile);
    } catch (const FileRefused& refused) {
      report("dbc", refused.path_and_reason(), refused.found(), refused.allowed());
      return false;
    }
    if (text.empty()) {
      report("dbc", "the file is empty", "\"" + binding_.dbc + "\"", std::string("a DBC file"));
      return false;
    }
    dbc::Reading reading = dbc::read(text);
    for (const dbc::Finding& finding : reading.findings) {
      report(finding);
    }
    content_ = std::move(reading.content);
    return reading.findings.empty();
  }

  const dbc::FileMessage* message(const std::string& path, const std::string& name) {
    const dbc::FileMessage* found = content_.find(name);
    if (found == nullptr) {
      std::vector<std::string> names;
      for (const dbc::FileMessage& one : content_.messages) {
        names.push_back(one.layout.name);
      }
      report(path, "no such message in the DBC file", name, names);
    }
    return found;
  }

  /// The place of the signal in its message; nothing after reporting.
  std::optional<std::size_t> signal(const std::string& path, const dbc::FileMessage& message,
                                    const std::string& name) {
    const auto& signals = message.layout.signals;
    const auto found = std::ranges::find(signals, name, &can::OwnedSignal::name);
    if (found == signals.end()) {
      std::vector<std::string> names;
      for (const can::OwnedSignal& one : signals) {
        names.push_back(one.name);
      }
      report(path + ".signal", "no such signal in message " + message.layout.name, name, names);
      return std::nullopt;
    }
    return static_cast<std::size_t>(found - signals.begin());
  }

  /// Whether every one of these signals can be coded. Says which not.
  template <class Bindings>
  bool is_sound(const dbc::FileMessage& message, const Bindings& bindings) {
    std::vector<std::string_view> used;
    for (const auto& binding : bindings) {
      used.push_back(binding.signal);
    }
    const auto findings = dbc::faults_of(message, used);
    for (const dbc::Finding& finding : findings) {
      report(finding);
    }
    return findings.empty();
  }

  static void lay_out(can::OwnedSignal& row, const DbcLayoutBinding& binding) {
    if (binding.scale != 0.0) {
      row.scale = binding.scale;
      row.offset = binding.offset;
      row = can::unlimited(std::move(row));
    }
    if (!binding.unit.empty()) {
      row.unit = binding.unit;
    }
  }

  const NamedQuantity* quantity(const std::string& path, std::span<const NamedQuantity> among,
                                const std::string& name) {
    const NamedQuantity* found = emulators::find_quantity(among, name);
    if (found == nullptr) {
      std::vector<std::string> names;
      for (const NamedQuantity& one : among) {
        names.push_back(one.full_name());
      }
      report(path, "no such quantity", name, names);
      return nullptr;
    }
    if (device_.attachment == "nothing") {
      device_.attachment = found->attachment;
    } else if (device_.attachment != found->attachment) {
      report(path, "a device is attached to one thing, this one to " + device_.attachment,
             "\"" + name + "\"", fmt::format("{}.*", device_.attachment));
      return nullptr;
    }
    return found;
  }

  std::optional<double> unit(const std::string& path, const can::OwnedSignal& row,
                             const NamedQuantity& quantity) {
    const auto size = size_of(row.unit, quantity.dimension);
    if (!size) {
      report(path, "the signal's unit is none of the quantity " + quantity.full_name(),
             row.unit.empty() ? "none" : "\"" + row.unit + "\"",
             fields::allowed_units(quantity.dimension) + "; layout.unit says another");
    }
    return size;
  }

  bool is_checksum(const std::string& path, DbcChecksum method, const can::OwnedSignal& row) {
    const bool fits =
        row.width == 8 && !row.is_float &&
        (row.order == can::ByteOrder::little_endian ? row.bit % 8 == 0 : row.bit % 8 == 7);
    if (method != DbcChecksum::none && !fits) {
      report(path + ".checksum", "a checksum is a byte of its own",
             fmt::format("{} bits from bit {}", row.width, row.bit), std::string("one byte"));
    }
    return method != DbcChecksum::none && fits;
  }
  /// Counts through all that its bits carry.
  bool make_counter(const std::string& path, bool counter, can::OwnedSignal& row) {
    if (counter && row.is_float) {
      report(path + ".counter", "a floating-point signal does not count", row.name,
             std::string("a whole number"));
    }
    if (counter) {
      row.scale = 1.0;
      row.offset = 0.0;
      row.reserved = can::Reserved::none;
      row = can::unlimited(std::move(row));
    }
    return counter;
  }

  /// What only one of can be given. False after reporting.
  bool one_of(const std::string& path, std::initializer_list<std::pair<const char*, bool>> given) {
    std::vector<std::string> names;
    for (const auto& [name, is_given] : given) {
      if (is_given) {
        names.emplace_back(name);
      }
    }
    if (names.size() > 1) {
      report(path, "a signal has one source", join_words(names), std::string("one of them"));
    }
    return names.size() <= 1;
  }

  // What comes in.

  /// Rows of the table, rising and each once, as the emulator has them.
  void collect_moved() {
    for (const DbcTakenMessageBinding& taken : binding_.takes) {
      for (const DbcTakenBinding& binding : taken.signals) {
        const NamedQuantity* found =
            emulators::find_quantity(emulators::moved_quantities(), binding.moves);
        if (found != nullptr) {
          device_.settings.moved.push_back(found->index);
        }
      }
    }
    auto& moved = device_.settings.moved;
    std::ranges::sort(moved);
    moved.erase(std::unique(moved.begin(), moved.end()), moved.end());
  }

  void take(const std::string& path, const DbcTakenMessageBinding& binding) {
    const dbc::FileMessage* found = message(path + ".message", binding.message);
    if (found == nullptr || !is_sound(*found, binding.signals) ||
        !check_length(path + ".message", found->layout)) {
      return;
    }
    emulators::DbcTakenMessage taken;
    taken.layout = found->layout;
    taken.timeout = binding.timeout;
    taken.uses.resize(found->layout.signals.size());
    for (std::size_t i = 0; i < binding.signals.size(); ++i) {
      const std::string at = fmt::format("{}.signals.{}", path, i);
      if (const auto place = signal(at, *found, binding.signals[i].signal)) {
        take_signal(at, binding.signals[i], taken.layout.signals[*place], taken.uses[*place]);
      }
    }
    device_.settings.taken.push_back(std::move(taken));
  }

  void take_signal(const std::string& path, const DbcTakenBinding& binding, can::OwnedSignal& row,
                   emulators::DbcUse& use) {
    lay_out(row, binding.layout);
    if (!one_of(path, {{"moves", !binding.moves.empty()},
                       {"counter", binding.counter},
                       {"checksum", binding.checksum != DbcChecksum::none}})) {
      return;
    }
    if (is_checksum(path, binding.checksum, row)) {
      use = emulators::DbcSum{binding.checksum};
    } else if (make_counter(path, binding.counter, row)) {
      use = emulators::DbcCounter{};
    } else if (!binding.moves.empty()) {
      const NamedQuantity* moved =
          quantity(path + ".moves", emulators::moved_quantities(), binding.moves);
      if (moved == nullptr) {
        return;
      }
      if (std::ranges::find(moved_by_, moved->index) != moved_by_.end()) {
        report(path + ".moves", "another signal moves it already", "\"" + binding.moves + "\"",
               std::string("each quantity by one signal"));
      }
      moved_by_.push_back(moved->index);
      if (const auto size = unit(path, row, *moved)) {
        const auto& rows = device_.settings.moved;
        emulators::DbcMove move;
        move.quantity =
            static_cast<std::size_t>(std::ranges::find(rows, moved->index) - rows.begin());
        move.factor = binding.factor * *size;
        move.offset = binding.offset;
        move.safe = safe_value(path, binding.safe, *moved);
        move.clip = binding.clip;
        use = move;
      }
    }
  }

  double safe_value(const std::string& path, const std::string& text,
                    const NamedQuantity& quantity) {
    if (text.empty()) {
      return quantity.neutral;
    }
    const auto written = fields::split_quantity(text);
    const auto size = !written ? std::nullopt
                      : written->unit.empty()
                          ? std::optional(1.0)
                          : size_of(std::string(written->unit), quantity.dimension);
    if (!size || !std::isfinite(written->value)) {
      report(path + ".safe", "no value of " + quantity.full_name(), "\"" + text + "\"",
             "a number in " + fields::allowed_units(quantity.dimension));
      return quantity.neutral;
    }
    return written->value * *size;
  }

  // What goes out.

  void send(const std::string& path, const DbcSentMessageBinding& binding) {
    const dbc::FileMessage* found = message(path + ".message", binding.message);
    if (found == nullptr) {
      return;
    }
    if (std::ranges::find(listed_, found) != listed_.end()) {
      report(path + ".message", "listed already", "\"" + binding.message + "\"",
             std::string("each message once"));
      return;
    }
    listed_.push_back(found);
    if (!is_sound(*found, binding.signals) || binding.send == DbcSendingBinding::never) {
      return;
    }
    emulators::DbcSentMessage sent = sent_as(*found);
    plan(path, binding, *found, sent);
    for (std::size_t i = 0; i < binding.signals.size(); ++i) {
      const std::string at = fmt::format("{}.signals.{}", path, i);
      if (const auto place = signal(at, *found, binding.signals[i].signal)) {
        show(at, binding.signals[i], sent.layout.signals[*place], sent.shows[*place]);
      }
    }
    device_.settings.sent.push_back(std::move(sent));
  }

  /// The messages of the node that the binding does not list.
  void send_the_rest() {
    for (const dbc::FileMessage& message : content_.messages) {
      const bool of_node =
          std::ranges::find(message.senders, binding_.node) != message.senders.end();
      if (binding_.node.empty() || !of_node ||
          std::ranges::find(listed_, &message) != listed_.end()) {
        continue;
      }
      const auto findings = dbc::faults_of(message, {});
      if (!findings.empty()) {
        report(findings.front());
        continue;
      }
      if (!check_length("node", message.layout)) {
        continue;
      }
      emulators::DbcSentMessage sent = sent_as(message);
      sent.on_request = sent.period == Duration{0} && !sent.on_change;
      device_.settings.sent.push_back(std::move(sent));
    }
  }

  /// Returns the message with the settings of the DBC file alone.
  emulators::DbcSentMessage sent_as(const dbc::FileMessage& message) {
    emulators::DbcSentMessage sent;
    sent.layout = message.layout;
    const dbc::SendType type = dbc::send_type(message.send_type);
    sent.period = milliseconds(message.period_ms);
    sent.on_change = type.on_change;
    sent.on_request = type.on_request;
    if ((sent.on_change || sent.on_request) && !type.by_time) {
      sent.period = Duration{0};
    }
    sent.start_delay = milliseconds(message.start_delay_ms);
    sent.least_distance = milliseconds(message.least_distance_ms);
    for (std::size_t s = 0; s < message.signals.size(); ++s) {
      sent.shows.push_back({start_value(message, s), emulators::DbcHeld{}});
    }
    return sent;
  }

  static std::uint64_t start_value(const dbc::FileMessage& message, std::size_t s) {
    const can::OwnedSignal& row = message.layout.signals[s];
    if (const auto start = message.signals[s].start_value) {
      can::OwnedSignal counts = row;
      counts.scale = 1.0;
      counts.offset = 0.0;
      counts.reserved = can::Reserved::none;
      return can::to_raw(can::unlimited(std::move(counts)), *start);
    }
    return row.reserved != can::Reserved::none ? can::not_available_value(row.width)
                                               : can::to_raw(row, 0.0);
  }

  void plan(const std::string& path, const DbcSentMessageBinding& binding,
            const dbc::FileMessage& message, emulators::DbcSentMessage& sent) {
    using enum DbcSendingBinding;
    const Duration period =
        binding.period > Duration{0} ? binding.period : milliseconds(message.period_ms);
    const bool by_time = binding.send == cyclic || binding.send == cyclic_and_on_change;
    if (binding.send != as_file) {
      sent.on_change = binding.send == on_change || binding.send == cyclic_and_on_change;
      sent.on_request = binding.send == on_request;
      sent.period = by_time ? period : Duration{0};
    } else if (binding.period > Duration{0}) {
      sent.period = binding.period;
    }
    if (by_time && sent.period == Duration{0}) {
      report(path + ".period", "neither file says how often it is sent", "",
             std::string("a period, or GenMsgCycleTime"));
    }
    if (binding.period > Duration{0} && binding.send != as_file && !by_time) {
      report(path + ".period", "it is not sent by time", "", std::string("send: cyclic"));
    }
    if (!binding.after.empty()) {
      const auto& taken = device_.settings.taken;
      const auto first = std::ranges::find_if(taken, [&](const emulators::DbcTakenMessage& one) {
        return one.layout.name == binding.after;
      });
      if (first == taken.end()) {
        report(path + ".after", "no message that is taken", "\"" + binding.after + "\"",
               std::string("one of `takes`"));
      } else {
        sent.after = static_cast<std::size_t>(first - taken.begin());
      }
    }
    if (binding.send == as_file && sent.period == Duration{0} && !sent.on_change &&
        !sent.on_request && binding.after.empty()) {
      report(path + ".send", "neither file says when it is sent", "",
             std::string("period, send or after; GenMsgSendType, GenMsgCycleTime"));
    }
    if (binding.priority >= 0) {
      if (!message.layout.j1939) {
        report(path + ".priority", "the message is none of J1939", std::to_string(binding.priority),
               std::string("VFrameFormat J1939PG"));
      }
      j1939::Identifier identifier = j1939::unpack(sent.layout.id);
      identifier.priority = static_cast<std::uint8_t>(binding.priority);
      sent.layout.id = j1939::pack(identifier);
    }
    check_length(path + ".message", sent.layout);
  }

  /// Longer messages go by transport, which wants an address.
  bool check_length(const std::string& path, const can::OwnedMessage& layout) {
    constexpr unsigned kFrameBytes = 8;
    const bool fits = layout.length <= kFrameBytes || binding_.claims_address;
    if (!fits) {
      report(path, layout.name + " is longer than a frame, and the device claims no address",
             fmt::format("{} bytes", layout.length), std::string("claims_address: true"));
    }
    return fits;
  }

  void show(const std::string& path, const DbcSentBinding& binding, can::OwnedSignal& row,
            emulators::DbcShown& shown) {
    lay_out(row, binding.layout);
    if (!one_of(path, {{"quantity", !binding.quantity.empty()},
                       {"value", !binding.value.empty()},
                       {"counter", binding.counter},
                       {"checksum", binding.checksum != DbcChecksum::none},
                       {"echo", !binding.echo.empty()}})) {
      return;
    }
    if (is_checksum(path, binding.checksum, row)) {
      shown.source = emulators::DbcSum{binding.checksum};
    } else if (make_counter(path, binding.counter, row)) {
      shown.start_raw = 0;
      shown.source = emulators::DbcCounter{};
    } else if (!binding.quantity.empty()) {
      measure(path, binding, row, shown);
    } else if (!binding.value.empty()) {
      shown.start_raw = value(path, binding.value, row);
    } else if (!binding.echo.empty()) {
      echo(path, binding.echo, shown);
    }
  }

  void measure(const std::string& path, const DbcSentBinding& binding, const can::OwnedSignal& row,
               emulators::DbcShown& shown) {
    const NamedQuantity* found =
        quantity(path + ".quantity", emulators::measured_quantities(), binding.quantity);
    const auto size = found == nullptr ? std::nullopt : unit(path, row, *found);
    if (!size) {
      return;
    }
    auto& rows = device_.settings.measured;
    auto place = std::ranges::find(rows, found->index);
    if (place == rows.end()) {
      place = rows.insert(rows.end(), found->index);
    }
    shown.source = emulators::DbcMeasured{static_cast<std::size_t>(place - rows.begin()),
                                          binding.factor / *size, binding.offset, binding.filter};
  }

  std::uint64_t value(const std::string& path, const std::string& text,
                      const can::OwnedSignal& row) {
    const auto named = std::ranges::find(row.values, text, &can::OwnedNamedValue::text);
    if (named != row.values.end()) {
      return static_cast<std::uint64_t>(named->raw) & can::greatest_raw(row.width);
    }
    double number = 0.0;
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, number);
    if (error != std::errc{} || stop != end || !(number >= row.lower && number <= row.upper)) {
      std::vector<std::string> names;
      for (const can::OwnedNamedValue& one : row.values) {
        names.push_back(one.text);
      }
      report(path + ".value", "no value of " + row.name, "\"" + text + "\"",
             fmt::format("{} .. {}{}{}", fields::shortest(row.lower), fields::shortest(row.upper),
                         names.empty() ? "" : ", ", join_words(names)),
             nearest_word(text, names));
      return 0;
    }
    return can::to_raw(row, number);
  }

  void echo(const std::string& path, const std::string& text, emulators::DbcShown& shown) {
    const auto& taken = device_.settings.taken;
    for (std::size_t m = 0; m < taken.size(); ++m) {
      const auto& layout = taken[m].layout;
      for (std::size_t s = 0; s < layout.signals.size(); ++s) {
        if (text == layout.name + "." + layout.signals[s].name) {
          shown.source = emulators::DbcEcho{m, s};
          return;
        }
      }
    }
    report(path + ".echo", "no signal of a message that is taken", "\"" + text + "\"",
           std::string("Message.Signal, with the message in `takes`"));
  }

  DbcNodeBinding binding_;
  const Origins& origins_;
  Problems& problems_;
  DbcNodeDescription device_;
  dbc::FileContent content_;
  std::shared_ptr<const std::string> dbc_name_;
  std::vector<const dbc::FileMessage*> listed_;
  std::vector<std::size_t> moved_by_;
};

}  // namespace

void visit(fields::Visitor& v, DbcLayoutBinding& p) {
  v.number("scale", p.scale, plain(), "Value of a count; 0: as the DBC file says.");
  v.number("offset", p.offset, plain(), "Value of raw 0, with `scale`.");
  v.check(p.scale != 0.0 || p.offset == 0.0, "offset", "means nothing without a scale");
  v.text("unit", p.unit, "Unit of the value; empty: as the DBC file says.");
}

void visit(fields::Visitor& v, DbcSentBinding& p) {
  v.required("signal");
  v.text("signal", p.signal, "Signal of the message.");
  v.text("quantity", p.quantity, "What it shows, for example joint.angle.");
  v.number("factor", p.factor, plain(), "The quantity is multiplied by it.");
  v.number("offset", p.offset, plain(), "Added to it, in the signal's unit.");
  v.duration("filter", p.filter, {0, kHour_ns}, "Time constant of a low-pass; 0 = none.");
  const bool shows = !p.quantity.empty();
  constexpr const char* kShowsNone = "it shows no quantity";
  v.check(shows || p.factor == 1.0, "factor", kShowsNone);
  v.check(shows || p.offset == 0.0, "offset", kShowsNone);
  v.check(shows || p.filter == Duration{0}, "filter", kShowsNone);
  v.text("value", p.value, "What it always shows: a number in its unit, or a name of the file.");
  v.boolean("counter", p.counter, "It counts frames.");
  v.choice("checksum", p.checksum, emulators::kDbcChecksums,
           "It is a checksum of the other bytes.");
  v.text("echo", p.echo, "It repeats what came in: Message.Signal of `takes`.");
  v.section("layout", p.layout, "In place of what the DBC file says.");
}

void visit(fields::Visitor& v, DbcSentMessageBinding& p) {
  v.required("message");
  v.text("message", p.message, "Message of the DBC file.");
  v.choice("send", p.send, kSendings, "When it is sent.");
  v.duration("period", p.period, {0, kHour_ns}, "From frame to frame; 0 = as the DBC file says.");
  v.text("after", p.after, "Also after each message of this name that is taken.");
  v.integer("priority", p.priority, IntegerRule{-1, 7},
            "Priority of J1939; -1 = as the DBC file says.");
  v.list("signals", p.signals, "What its signals show; others hold their start value.");
}

void visit(fields::Visitor& v, DbcTakenBinding& p) {
  v.required("signal");
  v.text("signal", p.signal, "Signal of the message.");
  v.text("moves", p.moves, "What it moves, for example valves.opening_1.");
  v.number("factor", p.factor, plain(), "The signal's value is multiplied by it.");
  v.number("offset", p.offset, plain(), "Added to it, in the quantity's SI unit.");
  v.text("safe", p.safe, "Before the first message and after the time-out; empty = neutral.");
  v.boolean("clip", p.clip, "Beyond its limits the limit counts; else what came before does.");
  const bool moves = !p.moves.empty();
  constexpr const char* kMovesNothing = "it moves nothing";
  v.check(moves || p.factor == 1.0, "factor", kMovesNothing);
  v.check(moves || p.offset == 0.0, "offset", kMovesNothing);
  v.check(moves || p.safe.empty(), "safe", kMovesNothing);
  v.check(moves || p.clip, "clip", kMovesNothing);
  v.boolean("counter", p.counter, "A frame in which it is not one more is refused.");
  v.choice("checksum", p.checksum, emulators::kDbcChecksums,
           "A frame in which it is wrong is refused.");
  v.section("layout", p.layout, "In place of what the DBC file says.");
}

void visit(fields::Visitor& v, DbcTakenMessageBinding& p) {
  v.required("message");
  v.text("message", p.message, "Message of the DBC file.");
  v.duration("timeout", p.timeout, {0, kHour_ns}, "Then the safe values hold; 0 = never.");
  v.list("signals", p.signals, "What its signals are for; others are not looked at.");
}

void visit(fields::Visitor& v, DbcNodeBinding& p) {
  v.text("text", p.text, "What the device is.");
  v.required("dbc");
  v.file("dbc", p.dbc, fields::FileKind::dbc, "The DBC file, relative to this one.");
  v.text("node", p.node, "Its node in the DBC file: it sends what that one does; empty = none.");
  v.boolean("claims_address", p.claims_address, "It claims an address (SAE J1939-81).");
  v.integer("source_address", p.source_address, IntegerRule{0, 253}, "Preferred address.");
  v.boolean("arbitrary_address", p.arbitrary_address, "It may take another one when it loses.");
  v.integer("serial", p.serial, IntegerRule{0, 0x1FFFFF}, "Serial number in the NAME.");
  emulators::visit(v, p.name);
  const DbcNodeBinding fresh;
  constexpr const char* kClaimsNone = "it claims no address";
  const bool claims = p.claims_address;
  v.check(claims || p.source_address == fresh.source_address, "source_address", kClaimsNone);
  v.check(claims || p.arbitrary_address == fresh.arbitrary_address, "arbitrary_address",
          kClaimsNone);
  v.check(claims || p.serial == fresh.serial, "serial", kClaimsNone);
  v.check(claims || p.name.manufacturer == 0, "manufacturer", kClaimsNone);
  v.check(claims || p.name.function == 0, "function", kClaimsNone);
  v.check(claims || p.name.function_instance == 0, "function_instance", kClaimsNone);
  v.check(claims || p.name.device_class == 0, "device_class", kClaimsNone);
  v.check(claims || p.name.industry_group == 0, "industry_group", kClaimsNone);
  v.duration("sample_period", p.sample_period, {kMillisecond_ns, 10 * kSecond_ns},
             "How often it measures.");
  v.duration("processing_delay", p.processing_delay, {0, kSecond_ns},
             "From an event to its frame.");
  v.list("sends", p.sends, "Messages that it sends, as far as the DBC file does not say all.");
  v.list("takes", p.takes, "Messages that it takes.");
}

DbcNodeDescription load_dbc_node(const std::string& file) {
  Problems problems;
  const Value document = load_document(file, problems);
  DbcNodeBinding binding;
  Origins origins;
  if (problems.empty()) {
    read(document, binding, problems, origins);
  }
  DbcNodeDescription device;
  if (problems.empty()) {
    device = Binder(std::move(binding), origins, problems).bind();
  }
  problems.throw_if_any();
  return device;
}

}  // namespace rigwire::hil
