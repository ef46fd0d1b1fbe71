// What a node does by itself and on command: CiA 301 V4.2.0, 7.2.8 (network management, heartbeat),
// 7.2.2 and 7.2.5 (PDO, SYNC), and of encoders CiA 406.
//
// Who changes a state puts the node back to pre-operational, where it was when it had booted.
#include <algorithm>
#include <array>
#include <cmath>

#include "conform/canopen/canopen_trial.h"

namespace rigwire::conform {

namespace {

using T = CanopenTrial;
using std::chrono::milliseconds;

constexpr std::uint8_t kStart = 0x01;
constexpr std::uint8_t kStop = 0x02;
constexpr std::uint8_t kPreOperational = 0x80;
constexpr std::uint8_t kResetNode = 0x81;
constexpr std::uint8_t kResetCommunication = 0x82;
constexpr ObjectName kHeartbeatTime{0x1017, 0};
constexpr ObjectName kPosition{0x6004, 0};

std::string in_ms(double value) {
  return std::to_string(std::llround(value)) + " ms";
}

/// Half of the distances between frames are this far apart, within a tenth and 3 ms.
void period(T& trial, const std::vector<T::Heard>& heard, double wanted_ms, std::size_t least) {
  if (!trial.expect(heard.size() >= least, std::to_string(least) + " at least",
                    std::to_string(heard.size()))) {
    return;
  }
  std::vector<double> gaps;
  for (std::size_t i = 1; i < heard.size(); ++i) {
    gaps.push_back(
        std::chrono::duration<double, std::milli>(heard[i].at - heard[i - 1].at).count());
  }
  std::ranges::sort(gaps);
  const double median = gaps[gaps.size() / 2];
  trial.expect(std::abs(median - wanted_ms) <= 0.1 * wanted_ms + 3.0,
               "a median of " + in_ms(wanted_ms), in_ms(median));
}

void heartbeats(T& trial) {
  trial.with_heartbeat([&] {
    const auto all = trial.listen(trial.with_node(0x700), milliseconds(1500));
    period(trial, all, 100.0, 10);
    for (const auto& each : all) {
      trial.expect(each.frame.length == 1, "one byte", frame_text(each.frame));
    }
  });
}

void no_heartbeat(T& trial) {
  const auto before = trial.number(kHeartbeatTime);
  if (before && trial.write(kHeartbeatTime, little(0, 2))) {
    const auto all = trial.listen(trial.with_node(0x700), milliseconds(800));
    trial.expect(all.empty(), "none with a time of 0", std::to_string(all.size()));
    trial.write(kHeartbeatTime, little(*before, 2));
  }
}

void state_after(T& trial, std::uint8_t command, std::uint8_t state, const std::string& name) {
  trial.with_heartbeat([&] {
    if (trial.command(command, name)) {
      trial.expect_state(state, name);
    }
  });
}

void stopped_is_silent(T& trial) {
  trial.with_heartbeat([&] {
    if (trial.command(kStop, "stop") && trial.expect_state(0x04, "stopped") &&
        trial.request({0x40, 0x00, 0x10, 0}, "read 1000:0")) {
      trial.unanswered("SDO of a node that is stopped");
    }
  });
}

void no_pdo_before(T& trial) {
  trial.with_heartbeat([&] {
    if (trial.command(kPreOperational, "be pre-operational") &&
        trial.expect_state(0x7F, "pre-operational")) {
      const auto all = trial.listen(trial.with_node(0x180), milliseconds(400));
      trial.expect(all.empty(), "no PDO", std::to_string(all.size()));
    }
  });
}

void boots_again(T& trial, std::uint8_t command, const std::string& name) {
  if (!trial.command(command, name)) {
    return;
  }
  bool booted = false;
  const auto deadline = trial.now() + std::chrono::seconds(5);
  while (!booted && trial.now() < deadline) {
    const auto frame = trial.hear(trial.with_node(0x700), deadline - trial.now());
    booted = frame && frame->length == 1 && frame->data[0] == 0;
  }
  trial.expect(booted, "a boot-up message (700 with the node-ID, one byte 00)", "none in 5 s");
  static_cast<void>(trial.command(kPreOperational, "be pre-operational"));
}

void unaffected(T& trial, const CanBytes& bytes, const std::string& words) {
  trial.with_heartbeat([&] {
    if (trial.command(kPreOperational, "be pre-operational") &&
        trial.expect_state(0x7F, "pre-operational") && trial.send(0x000, bytes, words)) {
      trial.expect_state(0x7F, "pre-operational");
    }
  });
}

/// Runs while operational.
void operational(T& trial, const std::function<void()>& run) {
  if (trial.command(kStart, "start")) {
    run();
    static_cast<void>(trial.command(kPreOperational, "be pre-operational"));
  }
}

void timed_pdo(T& trial, std::uint32_t timer_ms) {
  const auto type = trial.number({0x1800, 2});
  const auto timer = type ? trial.number({0x1800, 5}) : std::nullopt;
  if (!timer) {
    return;
  }
  if (trial.write({0x1800, 2}, little(255, 1)) && trial.write({0x1800, 5}, little(timer_ms, 2))) {
    operational(trial, [&] {
      period(trial, trial.listen(trial.with_node(0x180), milliseconds(20 * timer_ms)), timer_ms,
             10);
    });
  }
  trial.write({0x1800, 5}, little(*timer, 2));
  trial.write({0x1800, 2}, little(*type, 1));
}

void length_of_pdo(T& trial) {
  const auto count = trial.number({0x1A00, 0});
  std::uint32_t bits = 0;
  for (std::uint32_t i = 1; count && i <= *count; ++i) {
    bits += trial.number({0x1A00, static_cast<std::uint8_t>(i)}).value_or(0) & 0xFFU;
  }
  operational(trial, [&] {
    const auto frame = trial.hear(trial.with_node(0x180), std::chrono::seconds(2));
    if (!frame) {
      return trial.not_applicable("no TPDO1 came in 2 s");
    }
    trial.expect(frame->length * 8U == bits, std::to_string(bits / 8) + " bytes, as are mapped",
                 frame_text(*frame));
  });
}

void on_synchronisation(T& trial, std::uint32_t every) {
  const auto type = trial.number({0x1801, 2});
  if (!type || !trial.write({0x1801, 2}, little(every, 1))) {
    return;
  }
  operational(trial, [&] {
    static_cast<void>(trial.listen(trial.with_node(0x280), milliseconds(50)));
    std::uint32_t came = 0;
    constexpr std::uint32_t kTimes = 6;
    for (std::uint32_t i = 0; i < kTimes; ++i) {
      trial.drain();
      if (!trial.send(0x080, {}, "SYNC")) {
        return;
      }
      came += trial.hear(trial.with_node(0x280), milliseconds(60)) ? 1 : 0;
    }
    trial.expect(came == kTimes / every, std::to_string(kTimes / every) + " of TPDO2 to six SYNC",
                 std::to_string(came));
  });
  trial.write({0x1801, 2}, little(*type, 1));
}

void pdo_off(T& trial) {
  const auto id = trial.number({0x1800, 1});
  if (!id || !trial.write({0x1800, 1}, little(*id | 0x80000000U, 4))) {
    return;
  }
  operational(trial, [&] {
    const auto all = trial.listen(trial.with_node(0x180), milliseconds(400));
    trial.expect(all.empty(), "no TPDO1 that does not exist", std::to_string(all.size()));
  });
  trial.write({0x1800, 1}, little(*id, 4));
}

void mapped_value(T& trial) {
  const auto entry = trial.number({0x1A00, 1});
  if (!entry) {
    return;
  }
  if (*entry != 0x60040020) {
    return trial.not_applicable("TPDO1 does not begin with 6004:0");
  }
  operational(trial, [&] {
    const auto before = trial.number(kPosition);
    const auto frame =
        before ? trial.hear(trial.with_node(0x180), std::chrono::seconds(2)) : std::nullopt;
    const auto after = frame ? trial.number(kPosition) : std::nullopt;
    if (!after) {
      return;
    }
    std::uint32_t told = 0;
    for (unsigned i = 0; i < 4; ++i) {
      told |= std::uint32_t{frame->data[i]} << (8 * i);
    }
    // Where it turns meanwhile nothing can be said.
    trial.expect(*before != *after || told == *before, "the position that SDO reads",
                 std::to_string(told) + ", not " + std::to_string(*before));
  });
}

// --- CiA 406 ---

void is_encoder(T& trial) {
  if (const auto type = trial.number({0x1000, 0})) {
    trial.expect((*type & 0xFFFFU) == 406, "profile 406 in the low word", std::to_string(*type));
  }
}

void turns(T& trial) {
  const auto type = trial.number({0x1000, 0});
  const auto revolutions = type ? trial.number({0x6502, 0}) : std::nullopt;
  if (revolutions) {
    const std::uint32_t kind = *type >> 16U;
    trial.expect((kind == 1) == (*revolutions == 1), "1 in the high word with one revolution alone",
                 std::to_string(kind) + " with " + std::to_string(*revolutions));
  }
}

void status_of_parameters(T& trial) {
  const auto set = trial.number({0x6000, 0});
  const auto status = set ? trial.number({0x6500, 0}) : std::nullopt;
  if (status) {
    trial.expect((*set & 5U) == (*status & 5U), "direction and scaling of 6000 in 6500",
                 std::to_string(*status));
  }
}

void position_in_range(T& trial) {
  const auto set = trial.number({0x6000, 0});
  const auto range = set ? trial.number({0x6002, 0}) : std::nullopt;
  const auto steps = range ? trial.number({0x6501, 0}) : std::nullopt;
  const auto revolutions = steps ? trial.number({0x6502, 0}) : std::nullopt;
  const auto position = revolutions ? trial.number(kPosition) : std::nullopt;
  if (position) {
    const std::uint64_t all = (*set & 4U) != 0 ? *range : std::uint64_t{*steps} * *revolutions;
    trial.expect(*position < all, "a position below " + std::to_string(all),
                 std::to_string(*position));
  }
}

void subset(T& trial, ObjectName found, ObjectName supported) {
  const auto some = trial.number(found);
  const auto all = some ? trial.number(supported) : std::nullopt;
  if (all) {
    trial.expect((*some & ~*all) == 0, "none that is not supported", std::to_string(*some));
  }
}

void same_timer(T& trial) {
  const auto cyclic = trial.number({0x6200, 0});
  const auto event = cyclic ? trial.number({0x1800, 5}) : std::nullopt;
  if (event) {
    trial.expect(*cyclic == *event, "the event timer of TPDO1", std::to_string(*cyclic));
  }
}

void other_direction(T& trial) {
  const auto before = trial.number({0x6000, 0});
  if (!before || !trial.write({0x6000, 0}, little(*before ^ 1U, 2))) {
    return;
  }
  const auto status = trial.number({0x6500, 0});
  if (status) {
    trial.expect((*status & 1U) == ((*before ^ 1U) & 1U), "the direction that was set",
                 std::to_string(*status));
  }
  trial.write({0x6000, 0}, little(*before, 2));
}

struct LiveRow {
  const char* section;
  const char* title;
  Danger danger;
  std::vector<ObjectName> needs;
  void (*run)(T&);
  Strength strength = Strength::must;
};

const std::vector<LiveRow>& network_rows() {
  static const std::vector<LiveRow> rows{
      {"7.2.8.3.2.2", "Heartbeats come with their time", kWrites, {kHeartbeatTime}, heartbeats},
      {"7.2.8.3.2.2", "With a time of 0 there are none", kWrites, {kHeartbeatTime}, no_heartbeat},
      {"7.2.8.3.1.1",
       "Started it is operational",
       kWrites,
       {kHeartbeatTime},
       [](T& t) { state_after(t, kStart, 0x05, "operational"); }},
      {"7.2.8.3.1.1",
       "Stopped it is stopped",
       kWrites,
       {kHeartbeatTime},
       [](T& t) { state_after(t, kStop, 0x04, "stopped"); }},
      {"7.2.8.3.1.1",
       "It becomes pre-operational",
       kWrites,
       {kHeartbeatTime},
       [](T& t) { state_after(t, kPreOperational, 0x7F, "pre-operational"); }},
      {"7.2.8.3.1.1",
       "Another node's command is not its own",
       kWrites,
       {kHeartbeatTime},
       [](T& t) {
         const auto other =
             static_cast<std::uint8_t>(t.claims().node == 127 ? 126 : t.claims().node + 1);
         unaffected(t, {kStart, other}, "start of another node");
       }},
      {"7.2.8.3.1.1",
       "A command that there is not does nothing",
       kWrites,
       {kHeartbeatTime},
       [](T& t) {
         unaffected(t, {0x77, t.claims().node}, "command 77");
       }},
      {"7.2.8.3.1.1",
       "A command of one byte does nothing",
       kWrites,
       {kHeartbeatTime},
       [](T& t) { unaffected(t, {kStart}, "start, without a node-ID"); }},
      {"7.2.8.3.1.1",
       "Communication that is reset boots",
       kWrites,
       {},
       [](T& t) { boots_again(t, kResetCommunication, "reset communication"); }},
      {"7.2.8.3.1.1",
       "A node that is reset boots",
       kWrites,
       {},
       [](T& t) { boots_again(t, kResetNode, "reset node"); }},
      {"7.2.8.2.1", "Stopped it answers no SDO", kWrites, {kHeartbeatTime}, stopped_is_silent},
      {"7.2.8.2.1", "Pre-operational it sends no PDO", kWrites, {kHeartbeatTime}, no_pdo_before},
  };
  return rows;
}

const std::vector<LiveRow>& pdo_rows() {
  static const std::vector<LiveRow> rows{
      {"7.2.2",
       "TPDO1 comes with an event timer of 50 ms",
       kWrites,
       {{0x1800, 2}, {0x1800, 5}},
       [](T& t) { timed_pdo(t, 50); }},
      {"7.2.2",
       "TPDO1 comes with an event timer of 100 ms",
       kWrites,
       {{0x1800, 2}, {0x1800, 5}},
       [](T& t) { timed_pdo(t, 100); }},
      {"7.2.2", "TPDO1 has as many bytes as are mapped", kWrites, {{0x1A00, 0}}, length_of_pdo},
      {"7.2.2", "TPDO1 carries what SDO reads", kWrites, {{0x1A00, 1}, kPosition}, mapped_value},
      {"7.2.2", "A PDO that does not exist does not come", kWrites, {{0x1800, 1}}, pdo_off},
      {"7.2.5",
       "TPDO2 comes after each SYNC",
       kWrites,
       {{0x1801, 2}},
       [](T& t) { on_synchronisation(t, 1); }},
      {"7.2.5",
       "TPDO2 comes after each third SYNC",
       kWrites,
       {{0x1801, 2}},
       [](T& t) { on_synchronisation(t, 3); }},
  };
  return rows;
}

const std::vector<LiveRow>& encoder_rows() {
  static const std::vector<LiveRow> rows{
      {"1000", "The device type is an encoder's", kNone, {kPosition}, is_encoder},
      {"1000",
       "The device type distinguishes single-turn and multi-turn encoders",
       kNone,
       {{0x6502, 0}},
       turns},
      {"6500",
       "The status is as the parameters are set",
       kNone,
       {{0x6000, 0}, {0x6500, 0}},
       status_of_parameters},
      {"6004",
       "The position is within its range",
       kNone,
       {{0x6000, 0}, {0x6002, 0}, {0x6501, 0}, {0x6502, 0}, kPosition},
       position_in_range},
      {"6503",
       "Alarms are such as are supported",
       kNone,
       {{0x6503, 0}, {0x6504, 0}},
       [](T& t) {
         subset(t, {0x6503, 0}, {0x6504, 0});
       }},
      {"6505",
       "Warnings are such as are supported",
       kNone,
       {{0x6505, 0}, {0x6506, 0}},
       [](T& t) {
         subset(t, {0x6505, 0}, {0x6506, 0});
       }},
      {"6200",
       "The cyclic timer is the event timer of TPDO1",
       kNone,
       {{0x6200, 0}, {0x1800, 5}},
       same_timer,
       Strength::should},
      {"6000",
       "Another direction is taken, and put back",
       kWrites,
       {{0x6000, 0}, {0x6500, 0}},
       other_direction},
      {"6001",
       "No measuring units per revolution are refused",
       kWrites,
       {{0x6001, 0}},
       [](T& t) {
         t.aborts(t.download({0x6001, 0}, little(0, 4)), {0x06090030, 0x06090032});
       }},
      {"6004",
       "The position cannot be written",
       kWrites,
       {kPosition},
       [](T& t) { t.aborts(t.download(kPosition, little(0, 4)), {0x06010002}); }},
  };
  return rows;
}

std::vector<CanopenCase> cases_of(const std::vector<LiveRow>& rows, Citations& citations) {
  std::vector<CanopenCase> all;
  for (const LiveRow& row : rows) {
    all.push_back(
        {citations.next(row.section, row.title, row.strength, row.danger), row.needs, row.run});
  }
  return all;
}

}  // namespace

std::vector<CanopenCase> canopen_network_cases(Citations& cia301) {
  return cases_of(network_rows(), cia301);
}

std::vector<CanopenCase> canopen_pdo_cases(Citations& cia301) {
  return cases_of(pdo_rows(), cia301);
}

std::vector<CanopenCase> canopen_encoder_cases() {
  Citations cia406("canopen-406", "CiA 406 V3.2, object");
  return cases_of(encoder_rows(), cia406);
}

}  // namespace rigwire::conform
