#include "conform/iso_valves/iso_valves_suite.h"

#include <algorithm>
#include <array>

namespace rigwire::conform {

using std::chrono::milliseconds;

namespace {

using T = J1939Trial;
using Claims = IsoValveClaims;
using Bytes = std::vector<std::uint8_t>;

constexpr unsigned kValves = 16;  // Groups of a kind follow each other, one for each valve.
constexpr std::uint32_t kCommand = 65'072;
constexpr std::uint32_t kEstimated = 65'040;
constexpr std::uint32_t kMeasured = 65'056;
constexpr std::uint32_t kFunctionalities = 64'654;
constexpr std::uint32_t kTroubles = 65'226;
constexpr milliseconds kPeriod{100};

// Port flow of command and estimate: 0.4 % a count.
constexpr std::uint8_t kFull = 250;
constexpr std::uint8_t kFifth = 50;
constexpr std::uint8_t kReservedFlow = 0xFC;
constexpr std::uint8_t kNoFlow = 0xFF;  // Not available.

enum State : unsigned { neutral = 0, extend = 1, retract = 2, floating = 3, unassigned = 9 };
enum Exit : unsigned { no_exit = 0, command_timeout = 5, out_of_range = 6 };

unsigned state_of(const Bytes& estimate) {
  return estimate[2] & 0x0FU;
}
unsigned exit_of(const Bytes& estimate) {
  return estimate[4] & 0x3FU;
}
unsigned limit_in(std::uint8_t byte) {
  return byte >> 5U;
}
bool is_flow(std::uint8_t byte) {
  return byte <= kFull || byte >= 0xFE;
}
bool flows(std::uint8_t byte) {
  return byte > 0 && byte <= kFull;
}

// --- what it says by itself ---

/// Each of the group's messages of every valve in a second; `check` says what is wrong with one of
/// eight bytes, or nothing.
template <class Check>
void each_message(T& trial, const Claims& claims, std::uint32_t group, const std::string& expected,
                  const Check& check) {
  const auto heard = trial.listen(std::chrono::seconds(1));
  for (unsigned valve = claims.first_valve; valve < claims.first_valve + claims.valves; ++valve) {
    bool any = false;
    for (const J1939Heard& one : heard) {
      if (one.pgn != group + valve) {
        continue;
      }
      any = true;
      const std::string wrong =
          one.data.size() == 8 ? check(one) : std::to_string(one.data.size()) + " bytes";
      if (!wrong.empty()) {
        trial.show(one);
        trial.expect(false, expected, "valve " + std::to_string(valve) + ": " + wrong);
        return;
      }
    }
    if (!trial.expect(any, "group " + pgn_text(group + valve), "none in a second")) {
      return;
    }
  }
  trial.expect(true, expected, "");
}

template <std::uint32_t kGroup>
void periodic(T& trial, const Claims& claims) {
  const auto heard = trial.listen(std::chrono::seconds(2));
  for (unsigned valve = claims.first_valve; valve < claims.first_valve + claims.valves; ++valve) {
    std::vector<std::chrono::nanoseconds> gaps;
    std::optional<std::chrono::nanoseconds> before;
    for (const J1939Heard& one : heard) {
      if (one.pgn == kGroup + valve) {
        if (before) {
          gaps.push_back(one.at - *before);
        }
        before = one.at;
      }
    }
    if (!trial.expect(gaps.size() >= 3, "group " + pgn_text(kGroup + valve), "seldom or never")) {
      return;
    }
    std::ranges::sort(gaps);
    const auto median = std::chrono::duration_cast<milliseconds>(gaps[gaps.size() / 2]);
    trial.expect(median >= kPeriod * 8 / 10 && median <= kPeriod * 12 / 10,
                 "a median of 100 ms within a fifth", std::to_string(median.count()) + " ms");
  }
}

template <std::uint32_t kGroup>
void eight_bytes(T& trial, const Claims& claims) {
  each_message(trial, claims, kGroup, "eight bytes",
               [](const J1939Heard&) { return std::string(); });
}

template <std::uint32_t kGroup>
void priority(T& trial, const Claims& claims) {
  each_message(trial, claims, kGroup, "priority 3", [](const J1939Heard& one) {
    return one.priority == 3 ? "" : "priority " + std::to_string(one.priority);
  });
}

template <std::uint32_t kGroup>
void flow_range(T& trial, const Claims& claims) {
  each_message(trial, claims, kGroup, "flows of at most 250 counts, or not available",
               [](const J1939Heard& one) {
                 return is_flow(one.data[0]) && is_flow(one.data[1]) ? "" : hex_text(one.data);
               });
}

template <std::uint32_t kGroup, std::size_t kByte>
void limit_status(T& trial, const Claims& claims) {
  each_message(trial, claims, kGroup, "a limit status of 0 to 3, 6 or 7",
               [](const J1939Heard& one) {
                 const unsigned limit = limit_in(one.data[kByte]);
                 return limit == 4 || limit == 5 ? "limit status " + std::to_string(limit) : "";
               });
}

void assigned_state(T& trial, const Claims& claims) {
  each_message(
      trial, claims, kEstimated, "a state of 0 to 3, 10, 14 or 15", [](const J1939Heard& one) {
        const unsigned state = state_of(one.data);
        return state <= floating || state == 10 || state >= 14 ? ""
                                                               : "state " + std::to_string(state);
      });
}

void assigned_fail_safe(T& trial, const Claims& claims) {
  each_message(trial, claims, kEstimated, "a fail-safe mode of block or float, or not available",
               [](const J1939Heard& one) {
                 return std::string(one.data[2] >> 6U == 2 ? "fail-safe mode 2" : "");
               });
}

void one_port(T& trial, const Claims& claims) {
  each_message(trial, claims, kEstimated, "flow out of one port at most",
               [](const J1939Heard& one) {
                 return flows(one.data[0]) && flows(one.data[1]) ? hex_text(one.data) : "";
               });
}

void still_in_neutral(T& trial, const Claims& claims) {
  each_message(trial, claims, kEstimated, "no flow in neutral", [](const J1939Heard& one) {
    return state_of(one.data) == neutral && (flows(one.data[0]) || flows(one.data[1]))
               ? hex_text(one.data)
               : "";
  });
}

void unused_bits(T& trial, const Claims& claims) {
  each_message(trial, claims, kEstimated, "ones in unused bits", [](const J1939Heard& one) {
    constexpr std::array<std::uint8_t, 8> kUnused{0, 0, 0x30, 0x1F, 0xC0, 0xFF, 0xFF, 0xFF};
    for (std::size_t i = 0; i < kUnused.size(); ++i) {
      if ((one.data[i] & kUnused[i]) != kUnused[i]) {
        return hex_text(one.data);
      }
    }
    return std::string();
  });
}

void limits_agree(T& trial, const Claims& claims) {
  std::array<std::optional<unsigned>, kValves> estimated{};
  for (const J1939Heard& one : trial.listen(milliseconds(500))) {
    if (one.pgn >= kEstimated && one.pgn < kEstimated + kValves && one.data.size() == 8) {
      estimated[one.pgn - kEstimated] = limit_in(one.data[3]);
    }
  }
  each_message(trial, claims, kMeasured, "the limit status of estimated flow",
               [&](const J1939Heard& one) {
                 const auto& other = estimated[one.pgn - kMeasured];
                 const unsigned limit = limit_in(one.data[7]);
                 return other == limit ? ""
                                       : std::to_string(limit) + ", of estimated flow " +
                                             (other ? std::to_string(*other) : "nothing");
               });
}

// --- who it is ---

void industry_group(T& trial, const Claims& /*claims*/) {
  if (const auto name = trial.name()) {
    const unsigned group = (*name)[7] >> 4U & 7U;
    trial.expect(group == 2 || group == 0, "industry group 2 (agriculture and forestry) or 0",
                 std::to_string(group));
  }
}

void arbitrary_address(T& trial, const Claims& /*claims*/) {
  if (const auto name = trial.name()) {
    trial.expect(((*name)[7] & 0x80U) != 0, "a node that can take another address",
                 "one that cannot");
  }
}

void function(T& trial, const Claims& claims) {
  if (const auto name = trial.name()) {
    trial.expect((*name)[5] == *claims.function, "function " + std::to_string(*claims.function),
                 std::to_string((*name)[5]));
  }
}

/// Whether a connection's message announces the group.
bool announces(const Bytes& data, std::uint32_t pgn) {
  return data.size() == 8 && (data[0] == 16 || data[0] == 32) &&
         (data[5] | std::uint32_t{data[6]} << 8U | std::uint32_t{data[7]} << 16U) == pgn;
}

void functionalities(T& trial, const Claims& claims) {
  const std::string group = "group " + pgn_text(kFunctionalities);
  if (!trial.request(kFunctionalities)) {
    return;
  }
  const auto deadline = trial.now() + claims.patience + milliseconds(1500);
  while (trial.now() < deadline) {
    const auto found =
        trial.hear({kFunctionalities, T::kTransport, T::kAcknowledgement}, deadline - trial.now());
    if (!found) {
      break;
    }
    if (found->pgn == T::kTransport) {  // Others' broadcasts may come between.
      if (announces(found->data, kFunctionalities)) {
        if (found->data[0] == 16) {
          static_cast<void>(trial.control({255, 1}, kFunctionalities, "abort: that is enough"));
        }
        trial.expect(true, group + " announced", "");
        return;
      }
      continue;
    }
    trial.expect(found->pgn == kFunctionalities && found->data.size() == 8 &&
                     found->data[0] == 0xFF && found->data[1] >= 1 && found->data[2] == 0,
                 group + ": FF, how many, and first of all minimum control function",
                 hex_text(found->data));
    return;
  }
  trial.expect(false, group, "nothing");
}

void troubles(T& trial, const Claims& /*claims*/) {
  std::size_t count = 0;
  for (const J1939Heard& one : trial.listen(milliseconds(3500))) {
    const bool broadcast = one.pgn == T::kTransport && announces(one.data, kTroubles);
    count += one.pgn == kTroubles || broadcast ? 1U : 0U;
  }
  trial.expect(count >= 2 && count <= 6, "2 to 6 in 3.5 s, as some may come on change",
               std::to_string(count));
}

// --- commands ---

Bytes command_of(unsigned state, std::uint8_t flow) {
  constexpr unsigned kUnused = 0x30;  // And fail-safe mode block.
  return {flow, 0xFF, static_cast<std::uint8_t>(state | kUnused), 0xFF, 0xFF, 0xFF, 0xFF, 0xFF};
}

bool send(T& trial, unsigned valve, const Bytes& bytes, std::uint8_t source = T::kOwnAddress) {
  protocols::can::Frame frame;
  frame.extended = true;
  frame.id = 3U << 26U | (kCommand + valve) << 8U | source;
  frame.length = static_cast<std::uint8_t>(bytes.size());
  std::ranges::copy(bytes, frame.data.begin());
  return trial.send(frame, "command of valve " + std::to_string(valve));
}

/// What a valve says last within a time, shown; that it says nothing is found.
std::optional<Bytes> last_estimate(T& trial, unsigned valve, milliseconds span) {
  std::optional<J1939Heard> last;
  for (J1939Heard& one : trial.listen(span)) {
    if (one.pgn == kEstimated + valve) {
      last = std::move(one);
    }
  }
  if (!trial.expect(last.has_value(), "group " + pgn_text(kEstimated + valve),
                    "none in " + std::to_string(span.count()) + " ms")) {
    return std::nullopt;
  }
  trial.show(*last);
  return trial.demand(last->data.size() == 8, "eight bytes", hex_text(last->data))
             ? std::optional(std::move(last->data))
             : std::nullopt;
}

/// What a valve says next, which is found when it is late by two messages.
std::optional<Bytes> next_estimate(T& trial, unsigned valve) {
  trial.drain();
  auto found = trial.hear({kEstimated + valve}, 3 * kPeriod);
  return trial.expect(found.has_value(), "group " + pgn_text(kEstimated + valve),
                      "none in 300 ms") &&
                 trial.demand(found->data.size() == 8, "eight bytes", hex_text(found->data))
             ? std::optional(std::move(found->data))
             : std::nullopt;
}

/// Commands a valve at their rate for a time, and then once more: what it says next.
std::optional<Bytes> keep(T& trial, unsigned valve, const Bytes& bytes, milliseconds span) {
  for (milliseconds at{0}; at < span; at += kPeriod) {
    if (!send(trial, valve, bytes)) {
      return std::nullopt;
    }
    static_cast<void>(trial.listen(kPeriod));
  }
  return send(trial, valve, bytes) ? next_estimate(trial, valve) : std::nullopt;
}

/// Long enough for spools to follow.
constexpr milliseconds kSettled{500};
constexpr milliseconds kShort{200};

bool expect_state(T& trial, const std::optional<Bytes>& estimate, unsigned state,
                  const std::string& expected) {
  return estimate && trial.expect(state_of(*estimate) == state, expected,
                                  "state " + std::to_string(state_of(*estimate)));
}

/// False where the valve does not say so, which is found.
bool to_neutral(T& trial, unsigned valve) {
  return expect_state(trial, keep(trial, valve, command_of(neutral, 0), kShort), neutral,
                      "neutral as commanded");
}

void takes_neutral(T& trial, const Claims& claims) {
  for (unsigned valve = claims.first_valve; valve < claims.first_valve + claims.valves; ++valve) {
    static_cast<void>(to_neutral(trial, valve));
  }
}

void expect_exit(T& trial, const std::optional<Bytes>& estimate, Exit reason,
                 const std::string& expected) {
  if (estimate) {
    trial.expect(exit_of(*estimate) == reason, expected,
                 "exit/reason code " + std::to_string(exit_of(*estimate)));
  }
}

void neutral_has_no_exit(T& trial, const Claims& claims) {
  for (unsigned valve = claims.first_valve; valve < claims.first_valve + claims.valves; ++valve) {
    expect_exit(trial, keep(trial, valve, command_of(neutral, 0), kShort), no_exit,
                "exit/reason code 0 (none)");
  }
}

/// What a moving case does with the first valve once that is in neutral. Neutral is commanded at
/// the end, too, whatever came of it.
template <class Act>
void from_neutral(T& trial, const Claims& claims, const Act& act) {
  const unsigned valve = claims.first_valve;
  if (to_neutral(trial, valve)) {
    act(valve);
  }
  static_cast<void>(to_neutral(trial, valve));
}

template <State kState, std::uint8_t kFlow>
void obeys(T& trial, const Claims& claims) {
  from_neutral(trial, claims, [&](unsigned valve) {
    const auto found = keep(trial, valve, command_of(kState, kFlow), kSettled);
    expect_state(trial, found, kState, "state " + std::to_string(kState));
    if (found && kState != floating) {
      constexpr unsigned kWithin = 10;
      const unsigned told = (*found)[kState == retract ? 1U : 0U];
      trial.expect(told + kWithin >= kFlow && told <= kFlow + kWithin,
                   "the commanded flow within 4 %", std::to_string(told) + " counts of 0.4 %");
    }
  });
}

void alone(T& trial, const Claims& claims) {
  from_neutral(trial, claims, [&](unsigned valve) {
    if (to_neutral(trial, valve + 1) && keep(trial, valve, command_of(extend, kFifth), kSettled)) {
      expect_state(trial, next_estimate(trial, valve + 1), neutral,
                   "neutral of the valve beside it");
    }
  });
}

/// A command that has to be ignored.
void ignored(T& trial, const Claims& claims, const Bytes& bytes) {
  from_neutral(trial, claims, [&](unsigned valve) {
    expect_state(trial, keep(trial, valve, bytes, kShort), neutral,
                 "neutral: the command is ignored");
  });
}
template <unsigned kState, std::uint8_t kFlow>
void ignored(T& trial, const Claims& claims) {
  ignored(trial, claims, command_of(kState, kFlow));
}
void short_command_ignored(T& trial, const Claims& claims) {
  Bytes bytes = command_of(extend, kFifth);
  bytes.resize(4);
  ignored(trial, claims, bytes);
}

void told_out_of_range(T& trial, const Claims& claims) {
  from_neutral(trial, claims, [&](unsigned valve) {
    // The first message may have been under way already. For a valve block these messages are not
    // commands: after a third its time-out would give another exit reason.
    std::optional<Bytes> told;
    for (int i = 0; i < 2 && (!told || exit_of(*told) != out_of_range); ++i) {
      if (!send(trial, valve, command_of(neutral, kFifth)) ||
          !(told = next_estimate(trial, valve))) {
        return;
      }
    }
    expect_exit(trial, told, out_of_range, "exit/reason code 6 (out of range)");
  });
}

/// The valve extends, and has no commands for so long that it must have fallen to neutral; what it
/// says then.
std::optional<Bytes> abandoned(T& trial, const Claims& claims, unsigned valve) {
  return expect_state(trial, keep(trial, valve, command_of(extend, kFifth), kSettled), extend,
                      "extend as commanded")
             ? last_estimate(trial, valve, claims.command_timeout + 3 * kPeriod)
             : std::nullopt;
}

void falls_to_neutral(T& trial, const Claims& claims) {
  from_neutral(trial, claims, [&](unsigned valve) {
    expect_state(trial, abandoned(trial, claims, valve), neutral, "neutral without commands");
  });
}

void tells_timeout(T& trial, const Claims& claims) {
  from_neutral(trial, claims, [&](unsigned valve) {
    expect_exit(trial, abandoned(trial, claims, valve), command_timeout,
                "exit/reason code 5 (command time-out)");
  });
}

void wants_neutral_first(T& trial, const Claims& claims) {
  from_neutral(trial, claims, [&](unsigned valve) {
    if (abandoned(trial, claims, valve)) {
      expect_state(trial, keep(trial, valve, command_of(extend, kFifth), kShort), neutral,
                   "neutral until a command of neutral has come");
    }
  });
}

void stays(T& trial, const Claims& claims) {
  from_neutral(trial, claims, [&](unsigned valve) {
    expect_state(
        trial,
        keep(trial, valve, command_of(extend, kFifth), claims.command_timeout + milliseconds(700)),
        extend, "extend for as long as it is commanded");
  });
}

void first_commander(T& trial, const Claims& claims) {
  from_neutral(trial, claims, [&](unsigned valve) {
    constexpr std::uint8_t kSecond = 0xF0;
    for (int i = 0; i < 4; ++i) {
      if (!send(trial, valve, command_of(extend, kFifth)) ||
          !send(trial, valve, command_of(retract, kFifth), kSecond)) {
        return;
      }
      static_cast<void>(trial.listen(kPeriod));
    }
    expect_state(trial, next_estimate(trial, valve), extend,
                 "extend: the second node's commands are ignored");
  });
}

// --- the table ---

std::string nothing(const Claims& /*claims*/) {
  return {};
}
std::string measured(const Claims& claims) {
  return claims.measured_flow ? "" : "no measured flow is claimed";
}
std::string a_function(const Claims& claims) {
  return claims.function ? "" : "no function is claimed";
}
std::string two_valves(const Claims& claims) {
  return claims.valves < 2 ? "one valve is claimed" : "";
}
std::string a_timeout(const Claims& claims) {
  return claims.command_timeout.count() == 0 ? "no time-out of commands is claimed" : "";
}

struct Row {
  const char* chapter;
  const char* title;
  const char* source;
  Strength strength;
  std::string (*missing)(const Claims&);
  void (*run)(T&, const Claims&);
  Danger danger = Danger::none;
};

constexpr const char* kOfEstimate = "ISO 11783-7, auxiliary valve estimated flow";
constexpr const char* kOfMeasurement = "ISO 11783-7, auxiliary valve measured flow";
constexpr const char* kOfCommand = "ISO 11783-7, auxiliary valve command";
constexpr const char* kOfExit = "ISO 11783-7, exit/reason code; its place by analogy with guidance";
constexpr const char* kOfName = "ISO 11783-5, NAME";
constexpr auto kMoves = Danger::moves;

constexpr std::array kRows{
    Row{"AVEF", "Estimated flow comes every 100 ms", kOfEstimate, kMust, nothing,
        periodic<kEstimated>},
    Row{"AVEF", "Estimated flow has eight bytes", kOfEstimate, kMust, nothing,
        eight_bytes<kEstimated>},
    Row{"AVEF", "Estimated flow has priority 3", kOfEstimate, kShould, nothing,
        priority<kEstimated>},
    Row{"AVEF", "The state is an assigned one", kOfEstimate, kMust, nothing, assigned_state},
    Row{"AVEF", "The fail-safe mode is an assigned one", kOfEstimate, kMust, nothing,
        assigned_fail_safe},
    Row{"AVEF", "Flows are within their range", kOfEstimate, kMust, nothing,
        flow_range<kEstimated>},
    Row{"AVEF", "One port at most has flow", kOfEstimate, kMust, nothing, one_port},
    Row{"AVEF", "Neutral has no flow", kOfEstimate, kMust, nothing, still_in_neutral},
    Row{"AVEF", "The limit status is an assigned one", kOfEstimate, kMust, nothing,
        limit_status<kEstimated, 3>},
    Row{"AVEF", "Unused bits are ones", kOfEstimate, kShould, nothing, unused_bits},
    Row{"AVMF", "Measured flow comes every 100 ms", kOfMeasurement, kMust, measured,
        periodic<kMeasured>},
    Row{"AVMF", "Measured flow has eight bytes", kOfMeasurement, kMust, measured,
        eight_bytes<kMeasured>},
    Row{"AVMF", "Flows are within their range", kOfMeasurement, kMust, measured,
        flow_range<kMeasured>},
    Row{"AVMF", "The limit status is an assigned one", kOfMeasurement, kMust, measured,
        limit_status<kMeasured, 7>},
    Row{"AVMF", "The limit status is that of estimated flow", kOfMeasurement, kMust, measured,
        limits_agree},
    Row{"AVMF", "Measured flow has priority 3", kOfMeasurement, kShould, measured,
        priority<kMeasured>},
    Row{"NAME", "The industry group is agriculture and forestry, or global", kOfName, kMust,
        nothing, industry_group},
    Row{"NAME", "It can take another address", kOfName, kShould, nothing, arbitrary_address},
    Row{"NAME", "The function is the claimed one", kOfName, kMust, a_function, function},
    Row{"FUNC", "Functionalities are answered, minimum control function first", "ISO 11783-12, 6",
        kMust, nothing, functionalities},
    Row{"DM1", "Trouble codes come every second", "SAE J1939-73, DM1", kShould, nothing, troubles},
    Row{"AVC", "Neutral is taken", kOfCommand, kMust, nothing, takes_neutral, kWrites},
    Row{"AVC", "Neutral that was commanded has no exit reason", kOfExit, kShould, nothing,
        neutral_has_no_exit, kWrites},
    Row{"AVC", "Extends by a fifth", kOfCommand, kMust, nothing, obeys<extend, kFifth>, kMoves},
    Row{"AVC", "Retracts by a fifth", kOfCommand, kMust, nothing, obeys<retract, kFifth>, kMoves},
    Row{"AVC", "Floats", kOfCommand, kMust, nothing, obeys<floating, 0>, kMoves},
    Row{"AVC", "The valve beside it stays in neutral", kOfCommand, kMust, two_valves, alone,
        kMoves},
    Row{"AVC", "Extend without a flow is ignored", kOfCommand, kMust, nothing,
        ignored<extend, kNoFlow>, kMoves},
    Row{"AVC", "A reserved flow is ignored", kOfCommand, kMust, nothing,
        ignored<extend, kReservedFlow>, kMoves},
    Row{"AVC", "A state that is not assigned is ignored", kOfCommand, kMust, nothing,
        ignored<unassigned, kFifth>, kMoves},
    Row{"AVC", "Neutral with a flow is reported as out of range", kOfExit, kShould, nothing,
        told_out_of_range, kMoves},
    Row{"AVC", "A command of four bytes is ignored", kOfCommand, kMust, nothing,
        short_command_ignored, kMoves},
    Row{"AVC", "Without commands it goes to neutral", kOfCommand, kMust, a_timeout,
        falls_to_neutral, kMoves},
    Row{"AVC", "The time-out is reported", kOfExit, kShould, a_timeout, tells_timeout, kMoves},
    Row{"AVC", "With commands it stays", kOfCommand, kMust, a_timeout, stays, kMoves},
    Row{"AVC", "Behind a time-out it wants neutral first",
        "Danfoss PVED-CL, intended steering, by analogy", kShould, a_timeout, wants_neutral_first,
        kMoves},
    Row{"AVC", "The first node that commands is obeyed", kOfCommand, kShould, nothing,
        first_commander, kMoves},
};

J1939Device node_of(const IsoValveDevice& device) {
  J1939Device node;
  node.open = device.open;
  node.bounds = device.bounds;
  node.claims.address = device.claims.address;
  node.claims.patience = device.claims.patience;
  return node;
}

}  // namespace

std::vector<IsoValveCase> iso_valve_cases() {
  std::vector<IsoValveCase> all;
  Citations citations("iso11783-valves", "");
  for (const Row& row : kRows) {
    all.push_back({citations.next_in(row.chapter, row.title, row.source, row.strength, row.danger),
                   row.missing, row.run});
  }
  return all;
}

SuiteResult run_iso_valve_suite(const IsoValveDevice& device, const SuiteOptions& options) {
  SuiteResult result;
  result.suite = "iso11783-valves";
  J1939Device node = node_of(device);
  node.bounds->begin();
  prepare_suite([&] { open_line(node); });
  for (const IsoValveCase& each : iso_valve_cases()) {
    if (!is_wanted(each.identity.id, options.wanted)) {
      continue;
    }
    if (auto hindered = hindrance(each.identity, each.missing(device.claims), options)) {
      result.cases.push_back(std::move(*hindered));
      continue;
    }
    result.cases.push_back(try_case(
        each.identity, *node.bounds, [&] { return T(each.identity, node); },
        [&](T& trial) { each.run(trial, device.claims); }));
  }
  return result;
}

IsoValveClaims survey_iso_valves(const IsoValveDevice& device) {
  J1939Device node = node_of(device);
  node.bounds->begin();
  open_line(node);
  IsoValveClaims claims = device.claims;
  std::optional<std::uint8_t> address;
  std::array<bool, kValves> estimated{};
  claims.measured_flow = false;
  const auto begin = node.line->now();
  while (const auto frame = node.line->receive(begin + std::chrono::seconds(2))) {
    const std::uint32_t pgn = frame->id >> 8U & 0x3FFFFU;
    const auto source = static_cast<std::uint8_t>(frame->id);
    if (!frame->extended || frame->remote || (address && *address != source)) {
      continue;
    }
    if (pgn >= kEstimated && pgn < kEstimated + kValves) {
      address = source;
      estimated[pgn - kEstimated] = true;
    }
    claims.measured_flow =
        claims.measured_flow || (address && pgn >= kMeasured && pgn < kMeasured + kValves);
  }
  if (!address) {
    throw Unreachable("no node sends estimated flow on the bus within 2 s");
  }
  const auto first = std::ranges::find(estimated, true);
  claims.address = *address;
  claims.first_valve = static_cast<unsigned>(first - estimated.begin());
  claims.valves = static_cast<unsigned>(std::find(first, estimated.end(), false) - first);
  node.claims.address = claims.address;
  T trial({}, node);
  if (const auto name = trial.name()) {
    claims.function = (*name)[5];
  }
  return claims;
}

}  // namespace rigwire::conform
