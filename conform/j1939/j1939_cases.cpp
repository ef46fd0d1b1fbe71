// Addresses, requests and transport: SAE J1939-81, 4.2; SAE J1939-21, 5.4 and 5.10; and the groups
// of SAE J1939-71 (digital annex) that come by themselves.
#include <algorithm>
#include <array>
#include <cmath>

#include "conform/j1939/j1939_trial.h"

namespace rigwire::conform {

namespace {

using T = J1939Trial;
using Bytes = std::vector<std::uint8_t>;
using std::chrono::milliseconds;

constexpr std::uint32_t kNoGroup = 0xFFFE;  // Proprietary B, used by no node here.
constexpr std::uint8_t kUnused = 0xC5;      // An address that no node is to have.

// --- addresses ---

void claims_when_asked(T& trial, std::uint8_t destination) {
  if (!trial.request(T::kClaim, destination)) {
    return;
  }
  if (const auto found = trial.claim()) {
    trial.expect(found->destination == T::kEverybody, "a claim to everybody",
                 std::to_string(found->destination));
    trial.expect(found->priority == 6, "priority 6", std::to_string(found->priority));
  }
}

void same_name(T& trial) {
  const auto one = trial.name();
  const auto two = one ? trial.name() : std::nullopt;
  if (two) {
    trial.expect(*one == *two, "the same NAME again", hex_text(*two));
  }
}

void reserved_bit(T& trial) {
  if (const auto name = trial.name()) {
    trial.expect(((*name)[6] & 1U) == 0, "bit 48 of the NAME 0", hex_text(*name));
  }
}

void defends(T& trial) {
  const auto name = trial.name();
  if (!name) {
    return;
  }
  Bytes higher = *name;  // The higher NAME loses.
  higher[0] = static_cast<std::uint8_t>(higher[0] ^ 1U);
  higher[7] = static_cast<std::uint8_t>(higher[7] | 0x80U);
  higher[6] = 0xFE;
  if (std::lexicographical_compare(higher.rbegin(), higher.rend(), name->rbegin(), name->rend())) {
    return trial.not_applicable("its NAME is the highest");
  }
  if (trial.send(T::kClaim, T::kEverybody, higher, "a claim of its address by a higher NAME",
                 trial.claims().address)) {
    if (const auto found = trial.claim()) {
      trial.expect(found->data == *name, "its own claim again", hex_text(found->data));
    }
  }
}

// --- requests ---

void refused(T& trial) {
  if (!trial.request(kNoGroup)) {
    return;
  }
  const auto found = trial.hear({T::kAcknowledgement}, trial.claims().patience);
  if (!trial.expect(found.has_value(), "a negative acknowledgement", "none") ||
      !trial.expect(found->data.size() == 8, "eight bytes", hex_text(found->data))) {
    return;
  }
  const Bytes& data = found->data;
  trial.expect(data[0] == 1, "control byte 1 (negative)", hex_text(data));
  trial.expect(data[2] == 0xFF && data[3] == 0xFF, "FF in the reserved bytes", hex_text(data));
  trial.expect(data[4] == T::kOwnAddress, "the address of who asked in byte 5", hex_text(data));
  trial.expect(data[5] == (kNoGroup & 0xFFU) && data[6] == kNoGroup >> 8U && data[7] == 0,
               "the group in bytes 6 to 8", hex_text(data));
}

void refused_to_everybody(T& trial) {
  if (trial.request(kNoGroup)) {
    const auto found = trial.hear({T::kAcknowledgement}, trial.claims().patience);
    if (trial.expect(found.has_value(), "a negative acknowledgement", "none")) {
      trial.expect(found->destination == T::kEverybody, "an acknowledgement to everybody",
                   "to " + std::to_string(found->destination));
    }
  }
}

void wrong_length(T& trial) {
  if (trial.send(T::kRequest, trial.claims().address, {0x00, 0xEE}, "a request of two bytes")) {
    trial.silent({T::kClaim, T::kAcknowledgement}, "a request of two bytes");
  }
}

void other_address(T& trial) {
  if (trial.request(T::kClaim, kUnused)) {
    trial.silent({T::kClaim, T::kAcknowledgement}, "another node's request");
  }
}

void other_frame(T& trial, bool remote) {
  protocols::can::Frame frame;
  frame.extended = remote;
  frame.remote = remote;
  frame.id =
      remote ? 6U << 26U | (T::kRequest | trial.claims().address) << 8U | T::kOwnAddress : 0x1EA;
  frame.length = 3;
  frame.data = {0x00, 0xEE, 0x00};
  if (trial.send(frame, remote ? "a request as a remote frame" : "a frame of 11 bits")) {
    trial.silent({T::kClaim, T::kAcknowledgement}, remote ? "a remote frame" : "11 bits");
  }
}

/// The group comes: in one frame, or announced.
void answered(T& trial, std::uint32_t pgn) {
  if (!trial.request(pgn)) {
    return;
  }
  const auto found = trial.hear({pgn, T::kTransport, T::kAcknowledgement},
                                trial.claims().patience + milliseconds(1500));
  if (!trial.expect(found.has_value(), "group " + pgn_text(pgn), "nothing")) {
    return;
  }
  if (found->pgn == T::kTransport) {
    const bool announced =
        found->data.size() == 8 && (found->data[0] == 16 || found->data[0] == 32) &&
        (found->data[5] | found->data[6] << 8U | found->data[7] << 16U) == static_cast<int>(pgn);
    trial.expect(announced, "group " + pgn_text(pgn) + " announced", hex_text(found->data));
    if (announced && found->data[0] == 16) {
      static_cast<void>(trial.control({255, 1}, pgn, "abort: that is enough"));
    }
    static_cast<void>(trial.listen(milliseconds(500)));
    return;
  }
  trial.expect(found->pgn == pgn, "group " + pgn_text(pgn),
               "an acknowledgement: " + hex_text(found->data));
}

// --- transport ---

struct Announced {
  std::uint32_t pgn = 0;
  std::size_t bytes = 0;
  std::size_t packets = 0;
  /// Destination of its packets; others may go to all nodes meanwhile.
  std::uint8_t destination = 0;
};

/// Returns the announcement of the requested long group; `code` 16 to this node, 32 to all.
std::optional<Announced> announced(T& trial, std::uint8_t code, std::uint8_t destination) {
  const auto pgn = long_group_of(trial.claims());
  if (!trial.request(*pgn, destination)) {
    return std::nullopt;
  }
  const auto deadline = trial.now() + trial.claims().patience + milliseconds(1500);
  while (trial.now() < deadline) {
    const auto found = trial.hear({T::kTransport, *pgn}, deadline - trial.now());
    if (!found) {
      break;
    }
    if (found->pgn == *pgn) {
      trial.not_applicable("group " + pgn_text(*pgn) + " fits into a frame");
      return std::nullopt;
    }
    const Bytes& data = found->data;
    if (!trial.demand(data.size() == 8, "eight bytes", hex_text(data))) {
      return std::nullopt;
    }
    const std::uint32_t of = data[5] | std::uint32_t{data[6]} << 8U | std::uint32_t{data[7]} << 16U;
    if (data[0] != code || of != *pgn) {
      continue;
    }
    const Announced made{of, data[1] | std::size_t{data[2]} << 8U, data[3], found->destination};
    trial.expect(made.bytes >= 9 && made.bytes <= 1785, "9 to 1785 bytes",
                 std::to_string(made.bytes));
    trial.expect(made.packets == (made.bytes + 6) / 7, "as many packets as the bytes take",
                 std::to_string(made.packets) + " for " + std::to_string(made.bytes));
    return made;
  }
  trial.expect(false, "transport of " + pgn_text(*pgn) + " announced", "none");
  return std::nullopt;
}

/// Packets `first` to `last`, one after the other.
bool packets(T& trial, const Announced& of, std::size_t first, std::size_t last,
             std::vector<CanLine::Clock::time_point>* times = nullptr) {
  for (std::size_t i = first; i <= last; ++i) {
    const auto found = trial.hear({T::kPackets}, milliseconds(1000), of.destination);
    if (!trial.expect(found.has_value(), "packet " + std::to_string(i), "none in a second") ||
        !trial.expect(found->data.size() == 8, "eight bytes in each packet",
                      hex_text(found->data)) ||
        !trial.expect(found->data[0] == i, "packet " + std::to_string(i),
                      std::to_string(found->data[0]))) {
      return false;
    }
    if (times != nullptr) {
      times->push_back(trial.now());
    }
    if (i == of.packets) {
      for (std::size_t byte = of.bytes - 7 * (i - 1); byte < 7; ++byte) {
        trial.expect(found->data[1 + byte] == 0xFF, "FF behind the last byte",
                     hex_text(found->data));
      }
    }
  }
  return trial.fine();
}

void acknowledge_end(T& trial, const Announced& of) {
  static_cast<void>(trial.control(
      {19, static_cast<std::uint8_t>(of.bytes), static_cast<std::uint8_t>(of.bytes >> 8U),
       static_cast<std::uint8_t>(of.packets)},
      of.pgn, "end of message"));
}

bool clear_to_send(T& trial, const Announced& of, std::size_t count, std::size_t next) {
  return trial.control({17, static_cast<std::uint8_t>(count), static_cast<std::uint8_t>(next)},
                       of.pgn,
                       "clear to send " + std::to_string(count) + " from " + std::to_string(next));
}

/// Neither packets nor control to us.
bool nothing_more(T& trial, milliseconds span, const std::string& expected) {
  const auto more = trial.hear({T::kPackets, T::kTransport}, span, T::kOwnAddress);
  return trial.expect(!more.has_value(), expected, more ? frame_text(more->frame) : "");
}

void broadcast(T& trial) {
  const auto of = announced(trial, 32, T::kEverybody);
  std::vector<CanLine::Clock::time_point> times;
  if (!of || !packets(trial, *of, 1, of->packets, &times)) {
    return;
  }
  for (std::size_t i = 1; i < times.size(); ++i) {
    const double gap = std::chrono::duration<double, std::milli>(times[i] - times[i - 1]).count();
    // What a host adds to a bus's times.
    constexpr double kHost_ms = 10.0;
    trial.expect(gap >= 50.0 - kHost_ms && gap <= 200.0 + kHost_ms, "50 to 200 ms between packets",
                 std::to_string(std::llround(gap)) + " ms");
  }
}

void to_us(T& trial) {
  const auto of = announced(trial, 16, trial.claims().address);
  if (of && clear_to_send(trial, *of, of->packets, 1) && packets(trial, *of, 1, of->packets)) {
    acknowledge_end(trial, *of);
  }
}

void one_by_one(T& trial) {
  const auto of = announced(trial, 16, trial.claims().address);
  for (std::size_t i = 1; of && i <= of->packets; ++i) {
    if (!clear_to_send(trial, *of, 1, i) || !packets(trial, *of, i, i)) {
      return;
    }
    if (!nothing_more(trial, milliseconds(60), "no more packets than are asked for")) {
      return;
    }
  }
  if (of) {
    acknowledge_end(trial, *of);
  }
}

void once_more(T& trial) {
  const auto of = announced(trial, 16, trial.claims().address);
  if (of && clear_to_send(trial, *of, of->packets, 1) && packets(trial, *of, 1, of->packets) &&
      clear_to_send(trial, *of, 1, 1) && packets(trial, *of, 1, 1) &&
      nothing_more(trial, milliseconds(60),
                   "nothing more behind it until the next clear to send")) {
    acknowledge_end(trial, *of);
  }
}

void held(T& trial) {
  const auto of = announced(trial, 16, trial.claims().address);
  for (int i = 0; of && i < 3; ++i) {
    if (!clear_to_send(trial, *of, 0, 0xFF)) {
      return;
    }
    if (!nothing_more(trial, milliseconds(400), "nothing while it is held")) {
      return;
    }
  }
  if (of && clear_to_send(trial, *of, of->packets, 1) && packets(trial, *of, 1, of->packets)) {
    acknowledge_end(trial, *of);
  }
}

void aborted(T& trial) {
  const auto of = announced(trial, 16, trial.claims().address);
  if (of && clear_to_send(trial, *of, 1, 1) && packets(trial, *of, 1, 1) &&
      trial.control({255, 1}, of->pgn, "abort") && trial.fine()) {
    // Longer than it waits for an answer (T3): it has forgotten the connection.
    static_cast<void>(nothing_more(trial, milliseconds(1500), "nothing after an abort"));
  }
}

void gives_up(T& trial) {
  const auto of = announced(trial, 16, trial.claims().address);
  if (!of) {
    return;
  }
  // T3 is 1250 ms.
  const auto found = trial.hear({T::kTransport}, milliseconds(2500), T::kOwnAddress);
  if (trial.expect(found.has_value(), "an abort after 1250 ms without an answer", "none")) {
    trial.expect(found->data.front() == 255, "an abort (255)", hex_text(found->data));
  }
}

void too_long(T& trial) {
  if (!trial.control({16, 0xFA, 0x06, 255, 255}, kNoGroup, "request to send 1786 bytes")) {
    return;
  }
  const auto found = trial.hear({T::kTransport}, trial.claims().patience);
  trial.expect(!found || found->data.front() == 255, "an abort, or nothing",
               found ? hex_text(found->data) : "");
}

// --- groups ---

struct Number {
  unsigned bit;   ///< From the first, least significant.
  unsigned bits;  ///< 8, 16 or 32.
  const char* name;
};
struct Group {
  std::uint32_t pgn;
  const char* name;
  std::size_t bytes;  ///< 0: more than eight, or of any length.
  std::uint8_t priority;
  std::array<Number, 5> numbers;  ///< Entries after the last have no bits.
};
constexpr std::array kGroups{
    Group{61441, "EBC1", 8, 6, {{{8, 8, "brake pedal position"}}}},
    Group{61443, "EEC2", 8, 3, {{{8, 8, "accelerator pedal"}, {16, 8, "load at current speed"}}}},
    Group{61444,
          "EEC1",
          8,
          3,
          {{{8, 8, "demanded torque"},
            {16, 8, "actual torque"},
            {24, 16, "engine speed"},
            {56, 8, "engine demand"}}}},
    Group{61445, "ETC2", 8, 6, {{{0, 8, "selected gear"}, {24, 8, "current gear"}}}},
    Group{65215, "EBC2", 8, 6, {{{0, 16, "front axle speed"}}}},
    Group{65247, "EEC3", 8, 6, {{{0, 8, "friction torque"}, {8, 16, "desired speed"}}}},
    Group{65248, "VD", 8, 6, {{{0, 32, "trip distance"}, {32, 32, "total distance"}}}},
    Group{65253, "HOURS", 8, 6, {{{0, 32, "engine hours"}, {32, 32, "engine revolutions"}}}},
    Group{65256,
          "VDS",
          8,
          6,
          {{{0, 16, "bearing"}, {16, 16, "speed"}, {32, 16, "pitch"}, {48, 16, "altitude"}}}},
    Group{65257, "LFC1", 8, 6, {{{0, 32, "trip fuel"}, {32, 32, "total fuel"}}}},
    Group{
        65262,
        "ET1",
        8,
        6,
        {{{0, 8, "coolant temperature"}, {8, 8, "fuel temperature"}, {16, 16, "oil temperature"}}}},
    Group{65263,
          "EFL/P1",
          8,
          6,
          {{{0, 8, "fuel pressure"},
            {16, 8, "oil level"},
            {24, 8, "oil pressure"},
            {56, 8, "coolant level"}}}},
    Group{65265, "CCVS1", 8, 6, {{{8, 16, "wheel-based speed"}}}},
    Group{65266, "LFE1", 8, 6, {{{0, 16, "fuel rate"}, {16, 16, "fuel economy"}}}},
    Group{65267, "VP", 8, 6, {{{0, 32, "latitude"}, {32, 32, "longitude"}}}},
    Group{65269, "AMB", 8, 6, {{{0, 8, "barometric pressure"}, {24, 16, "ambient temperature"}}}},
    Group{65271, "VEP1", 8, 6, {{{32, 16, "battery potential"}}}},
    Group{65276, "DD1", 8, 6, {{{0, 8, "washer fluid"}, {8, 8, "fuel level"}}}},
    Group{65226, "DM1", 0, 6, {{{}}}},
    Group{65227, "DM2", 0, 6, {{{}}}},
    Group{65251, "EC1", 0, 6, {{{}}}},
    Group{65259, "CI", 0, 6, {{{}}}},
    Group{65260, "VI", 0, 6, {{{}}}},
    Group{64965, "ECUID", 0, 6, {{{}}}},
    // In some nodes it fits into one frame: the last group that transport is tested with.
    Group{65242, "SOFT", 0, 6, {{{}}}},
};

const PeriodicGroup& claim_of(const T& trial, std::uint32_t pgn) {
  return *std::ranges::find(trial.claims().periodic, pgn, &PeriodicGroup::pgn);
}

std::vector<J1939Heard> several(T& trial, std::uint32_t pgn) {
  const auto span = std::clamp<std::chrono::milliseconds>(claim_of(trial, pgn).period * 12,
                                                          milliseconds(1000), milliseconds(16'000));
  auto all = trial.listen(span);
  std::erase_if(all, [&](const J1939Heard& heard) { return heard.pgn != pgn; });
  for (std::size_t i = 0; i < std::min<std::size_t>(all.size(), 6); ++i) {
    trial.show(all[i]);
  }
  return all;
}

void comes_in_time(T& trial, std::uint32_t pgn) {
  const auto all = several(trial, pgn);
  if (!trial.expect(all.size() >= 3, "three at least", std::to_string(all.size()))) {
    return;
  }
  std::vector<double> gaps;
  for (std::size_t i = 1; i < all.size(); ++i) {
    gaps.push_back(std::chrono::duration<double, std::milli>(all[i].at - all[i - 1].at).count());
  }
  std::ranges::sort(gaps);
  const double median = gaps[gaps.size() / 2];
  const auto period = static_cast<double>(claim_of(trial, pgn).period.count());
  trial.expect(std::abs(median - period) <= 0.1 * period + 3.0,
               "a median of " + std::to_string(std::llround(period)) + " ms",
               std::to_string(std::llround(median)) + " ms");
}

/// SAE J1939-71, 5.1.3: numbers up to FA.., errors FE.., not available FF..; what is between is
/// reserved or a parameter's own indicator.
void numbers(T& trial, const Group& group) {
  for (const J1939Heard& heard : several(trial, group.pgn)) {
    if (!trial.expect(heard.data.size() == group.bytes, std::to_string(group.bytes) + " bytes",
                      hex_text(heard.data))) {
      return;
    }
    for (const Number& number : group.numbers) {
      if (number.bits == 0) {
        break;
      }
      const std::uint8_t top = heard.data[(number.bit + number.bits) / 8 - 1];
      trial.expect(
          top <= 0xFA || top >= 0xFE,
          std::string(number.name) + " as a number (to FA..), an error (FE..) or nothing (FF..)",
          hex_text(heard.data));
    }
  }
}

void priority(T& trial, const Group& group) {
  for (const J1939Heard& heard : several(trial, group.pgn)) {
    trial.expect(heard.priority == group.priority, "priority " + std::to_string(group.priority),
                 std::to_string(heard.priority));
  }
}

struct NetworkRow {
  const char* section;
  const char* title;
  void (*run)(T&);
  Strength strength = Strength::must;
  Danger danger = Danger::none;
};

}  // namespace

std::optional<std::uint32_t> long_group_of(const J1939Claims& claims) {
  for (const Group& group : kGroups) {
    const bool diagnostics = group.pgn == 65226 || group.pgn == 65227;
    if (group.bytes == 0 && !diagnostics &&
        std::ranges::find(claims.requested, group.pgn) != claims.requested.end()) {
      return group.pgn;
    }
  }
  return std::nullopt;
}

std::vector<std::uint32_t> groups_to_ask_for() {
  std::vector<std::uint32_t> all;
  for (const Group& group : kGroups) {
    all.push_back(group.pgn);
  }
  return all;
}

std::vector<J1939Case> j1939_network_cases() {
  std::vector<J1939Case> all;
  Citations names("j1939-81", "SAE J1939-81");
  Citations requests("j1939", "SAE J1939-21");
  const std::array claims{NetworkRow{"4.2.1", "It answers a request for its address claim",
                                     [](T& t) { claims_when_asked(t, t.claims().address); }},
                          NetworkRow{"4.2.1", "It answers a global request for address claims",
                                     [](T& t) { claims_when_asked(t, T::kEverybody); }},
                          NetworkRow{"4.1.1", "Its NAME stays the same", same_name},
                          NetworkRow{"4.1.1", "The reserved bit of its NAME is 0", reserved_bit},
                          NetworkRow{"4.2.2", "It defends its address against a higher NAME",
                                     defends, Strength::must, Danger::writes}};
  for (const NetworkRow& row : claims) {
    all.push_back(
        {.identity = names.next(row.section, row.title, row.strength, row.danger), .run = row.run});
  }
  const std::array asked{
      NetworkRow{"5.4.4", "A group that it does not have is refused", refused},
      NetworkRow{"5.4.4", "An acknowledgement goes to everybody", refused_to_everybody,
                 Strength::should},
      NetworkRow{"5.4.2", "Asked for by everybody it is not refused",
                 [](T& t) {
                   if (t.request(kNoGroup, T::kEverybody)) {
                     t.silent({T::kAcknowledgement}, "a request to everybody");
                   }
                 }},
      NetworkRow{"5.4.2", "A request of two bytes is not answered", wrong_length, Strength::should},
      NetworkRow{"5.4.2", "Another node's request is not answered", other_address},
      NetworkRow{"5.2", "A remote frame is not answered", [](T& t) { other_frame(t, true); }},
      NetworkRow{"5.2", "A frame of 11 bits is not answered", [](T& t) { other_frame(t, false); }}};
  for (const NetworkRow& row : asked) {
    all.push_back({.identity = requests.next(row.section, row.title, row.strength, row.danger),
                   .run = row.run});
  }
  for (const Group& group : kGroups) {
    J1939Case& made = all.emplace_back();
    made.identity = requests.next("5.4.2", std::string("A request of ") + group.name + ", " +
                                               pgn_text(group.pgn) + ", is answered");
    made.requested = group.pgn;
    made.run = [&group](T& trial) { answered(trial, group.pgn); };
  }
  return all;
}

std::vector<J1939Case> j1939_transport_cases() {
  Citations citations("j1939", "SAE J1939-21");
  const std::array rows{
      NetworkRow{"5.10.2", "A long group to everybody is announced and sent, 50 to 200 ms apart",
                 broadcast},
      NetworkRow{"5.10.3", "A long group to one is announced, and sent when it may", to_us},
      NetworkRow{"5.10.3", "Only as many packets are sent as are asked for", one_by_one},
      NetworkRow{"5.10.3", "A packet is sent again when it is asked for", once_more},
      NetworkRow{"5.10.3", "Nothing is sent while it is held", held},
      NetworkRow{"5.10.3", "Aborted it sends no more", aborted},
      NetworkRow{"5.10.2.4", "Without an answer it gives up", gives_up},
      NetworkRow{"5.10.3", "More than 1785 bytes are not taken", too_long, Strength::should}};
  std::vector<J1939Case> all;
  for (const NetworkRow& row : rows) {
    all.push_back({.identity = citations.next(row.section, row.title, row.strength, row.danger),
                   .long_group = true,
                   .run = row.run});
  }
  return all;
}

std::vector<J1939Case> j1939_group_cases() {
  std::vector<J1939Case> all;
  Citations citations("j1939-71", "SAE J1939-71");
  for (const Group& group : kGroups) {
    const auto add = [&](const std::string& title, Strength strength, std::function<void(T&)> run) {
      J1939Case& made = all.emplace_back();
      made.identity = citations.next_in(group.name, std::string(group.name) + " " + title,
                                        "SAE J1939-71, group " + pgn_text(group.pgn), strength);
      made.periodic = group.pgn;
      made.run = std::move(run);
    };
    add("comes in its claimed period", Strength::must,
        [&group](T& trial) { comes_in_time(trial, group.pgn); });
    if (group.bytes > 0) {
      add("has its length, and numbers in their range", Strength::must,
          [&group](T& trial) { numbers(trial, group); });
      add("has its priority", Strength::should, [&group](T& trial) { priority(trial, group); });
    }
  }
  return all;
}

}  // namespace rigwire::conform
