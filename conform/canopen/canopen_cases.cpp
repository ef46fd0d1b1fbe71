// SDO and the objects of communication: CiA 301 V4.2.0, 7.2.4.3 and 7.5.
#include <algorithm>
#include <array>

#include "conform/canopen/canopen_trial.h"

namespace rigwire::conform {

namespace {

using T = CanopenTrial;

constexpr ObjectName kDeviceType{0x1000, 0};
constexpr ObjectName kName{0x1008, 0};
constexpr ObjectName kNoObject{0x2F0F, 0};
constexpr ObjectName kNoSub{0x1018, 200};

void shorter(T& trial) {
  if (trial.send(trial.with_node(0x600), {0x40, 0x00, 0x10}, "three bytes")) {
    trial.unanswered("a request of three bytes");
  }
}

void remote(T& trial) {
  Frame frame;
  frame.id = trial.with_node(0x600);
  frame.remote = true;
  frame.length = 8;
  if (trial.send(frame, "a remote frame")) {
    trial.unanswered("a remote frame");
  }
}

void extended(T& trial) {
  Frame frame;
  frame.id = trial.with_node(0x600);
  frame.extended = true;
  frame.length = 8;
  frame.data = {0x40, 0x00, 0x10};
  if (trial.send(frame, "read 1000:0 with 29 bits")) {
    trial.unanswered("a frame of 29 bits");
  }
}

void other_node(T& trial) {
  const std::uint32_t other = trial.claims().node == 127 ? 126U : trial.claims().node + 1U;
  if (trial.send(0x600 + other, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}, "read 1000:0 of another")) {
    trial.unanswered("another node's request");
  }
}

void client_aborts(T& trial) {
  if (trial.request({0x80, 0x00, 0x10, 0, 0, 0, 4, 5}, "abort")) {
    trial.unanswered("an abort");
  }
}

/// What is answered to eight bytes that are no initiate: an abort with one of these codes.
void aborted(T& trial, const CanBytes& bytes, const std::string& words,
             std::initializer_list<std::uint32_t> codes) {
  if (!trial.request(bytes, words)) {
    return;
  }
  if (const auto found = trial.answer()) {
    SdoResult result;
    result.data = *found;
    if (found->front() == 0x80) {
      result.abort = (*found)[4] | (*found)[5] << 8U | (*found)[6] << 16U |
                     static_cast<std::uint32_t>((*found)[7]) << 24U;
    }
    trial.aborts(result, codes);
  }
}

void wrong_toggle(T& trial) {
  if (!trial.request({0x40, 0x08, 0x10, 0}, "read 1008:0")) {
    return;
  }
  const auto first = trial.answer();
  if (!first) {
    return;
  }
  if ((first->front() & 2U) != 0) {
    return trial.not_applicable("its name comes at once");
  }
  aborted(trial, {0x70}, "next segment, with the toggle bit set", {0x05030000});
}

void restarted(T& trial) {
  if (!trial.request({0x40, 0x08, 0x10, 0}, "read 1008:0") || !trial.answer()) {
    return;
  }
  static_cast<void>(trial.number(kDeviceType));
}

void name_is_text(T& trial) {
  const auto name = trial.upload(kName);
  if (name && trial.expect(!name->abort, "a name", name->text())) {
    trial.expect(
        !name->data.empty() &&
            std::ranges::all_of(name->data,
                                [](std::uint8_t c) { return c == 0 || (c >= 0x20 && c < 0x7F); }),
        "printable characters", hex_text(name->data));
  }
}

void same_twice(T& trial) {
  const auto one = trial.number(kDeviceType);
  const auto two = one ? trial.number(kDeviceType) : std::nullopt;
  if (two) {
    trial.expect(*one == *two, "the same device type again", std::to_string(*two));
  }
}

void written_read_only(T& trial) {
  trial.aborts(trial.download(kDeviceType, little(0, 4)), {0x06010002});
}

/// A heartbeat time of a wrong length: nothing changes.
void wrong_length(T& trial, std::size_t bytes, std::initializer_list<std::uint32_t> codes) {
  constexpr ObjectName kHeartbeat{0x1017, 0};
  const auto before = trial.number(kHeartbeat);
  if (before && trial.aborts(trial.download(kHeartbeat, little(0x1111, bytes)), codes)) {
    const auto after = trial.number(kHeartbeat);
    if (after) {
      trial.expect(*after == *before, "what it was", std::to_string(*after));
    }
  }
}

/// Written in segments: announced, sent, read back, and put back.
void in_segments(T& trial) {
  constexpr ObjectName kHeartbeat{0x1017, 0};
  const auto before = trial.number(kHeartbeat);
  if (!before ||
      !trial.request({0x21, 0x17, 0x10, 0, 2, 0, 0, 0}, "write 1017:0, two bytes follow")) {
    return;
  }
  const auto taken = trial.answer();
  if (!taken || !trial.expect(taken->front() == 0x60, "60", hex_text(*taken)) ||
      !trial.request({0x0B, 0xD0, 0x07}, "the only segment: 2000")) {
    return;
  }
  const auto last = trial.answer();
  if (last && trial.expect(last->front() == 0x20, "20", hex_text(*last))) {
    const auto now = trial.number(kHeartbeat);
    if (now) {
      trial.expect(*now == 2000, "2000", std::to_string(*now));
    }
  }
  trial.write(kHeartbeat, little(*before, 2));
}

struct Row {
  const char* section;
  const char* title;
  Strength strength;
  Danger danger;
  ObjectName needs;
  void (*run)(T&);
};
constexpr ObjectName kHeartbeat{0x1017, 0};

const std::array kRows{
    Row{"7.2.4.3.5", "An object is read at once, with its size", kMust, kNone, kDeviceType,
        [](T& t) {
          if (t.request({0x40, 0x00, 0x10, 0}, "read 1000:0")) {
            if (const auto found = t.answer()) {
              t.expect(found->front() == 0x43, "43: four bytes, at once", hex_text(*found));
            }
          }
        }},
    Row{"7.2.4.3.5", "An object is the same when read again", kMust, kNone, kDeviceType,
        same_twice},
    Row{"7.2.4.3.6", "A text is read, in segments where it is longer than four bytes", kMust, kNone,
        kName, name_is_text},
    Row{"7.2.4.3.6", "A segment with a wrong toggle bit is refused", kMust, kNone, kName,
        wrong_toggle},
    Row{"7.2.4.3.6", "A new request ends the transfer before it", kMust, kNone, kName, restarted},
    Row{"7.2.4.3.6", "A segment without a transfer is refused", kMust, kNone, kDeviceType,
        [](T& t) {
          aborted(t, {0x60}, "next segment, of nothing", {0x05040001, 0x05030000});
        }},
    Row{"7.2.4.3.17", "An object that there is not is refused", kMust, kNone, kDeviceType,
        [](T& t) { t.aborts(t.upload(kNoObject), {0x06020000}); }},
    Row{"7.2.4.3.17",
        "A sub-index that there is not is refused",
        kMust,
        kNone,
        {0x1018, 0},
        [](T& t) { t.aborts(t.upload(kNoSub), {0x06090011}); }},
    Row{"7.2.4.3.17", "A sub-index of an object without such is refused", kMust, kNone, kDeviceType,
        [](T& t) {
          t.aborts(t.upload({0x1000, 1}), {0x06090011});
        }},
    Row{"7.2.4.3.17", "A command that there is not is refused", kMust, kNone, kDeviceType,
        [](T& t) {
          aborted(t, {0xE0, 0x00, 0x10, 0}, "command specifier 7", {0x05040001});
        }},
    Row{"7.2.4.3.17", "An abort is not answered", kMust, kNone, kDeviceType, client_aborts},
    Row{"7.2.4.1", "A request of another length than eight is not answered", Strength::should,
        kNone, kDeviceType, shorter},
    Row{"7.2.4.1", "A remote frame is not answered", kMust, kNone, kDeviceType, remote},
    Row{"7.2.4.1", "A frame of 29 bits is not answered", kMust, kNone, kDeviceType, extended},
    Row{"7.2.4.1", "Another node's request is not answered", kMust, kNone, kDeviceType, other_node},
    Row{"7.2.4.3.17", "Writing a read-only object is refused", kMust, kWrites, kDeviceType,
        written_read_only},
    Row{"7.2.4.3.17", "Writing an object that there is not is refused", kMust, kWrites, kDeviceType,
        [](T& t) { t.aborts(t.download(kNoObject, little(0, 4)), {0x06020000}); }},
    Row{"7.2.4.3.17", "Writing too much is refused, nothing changes", kMust, kWrites, kHeartbeat,
        [](T& t) {
          wrong_length(t, 4, {0x06070010, 0x06070012});
        }},
    Row{"7.2.4.3.17", "Writing too little is refused, nothing changes", kMust, kWrites, kHeartbeat,
        [](T& t) {
          wrong_length(t, 1, {0x06070010, 0x06070013});
        }},
    Row{"7.2.4.3.4", "A number is written in a segment", Strength::should, kWrites, kHeartbeat,
        in_segments},
};

struct Object {
  ObjectName name;
  const char* title;
  std::size_t bytes;  ///< 0: a text or a domain.
};
// CiA 301, 7.5.2, and of encoders CiA 406, 6000 to 650B.
constexpr std::array kObjects{
    Object{{0x1000, 0}, "device type", 4},
    Object{{0x1001, 0}, "error register", 1},
    Object{{0x1003, 0}, "number of errors", 1},
    Object{{0x1005, 0}, "COB-ID SYNC", 4},
    Object{{0x1008, 0}, "manufacturer device name", 0},
    Object{{0x1009, 0}, "manufacturer hardware version", 0},
    Object{{0x100A, 0}, "manufacturer software version", 0},
    Object{{0x1010, 0}, "store parameters, highest sub-index", 1},
    Object{{0x1010, 1}, "store all parameters", 4},
    Object{{0x1011, 0}, "restore parameters, highest sub-index", 1},
    Object{{0x1011, 1}, "restore all parameters", 4},
    Object{{0x1014, 0}, "COB-ID EMCY", 4},
    Object{{0x1017, 0}, "producer heartbeat time", 2},
    Object{{0x1018, 0}, "identity, highest sub-index", 1},
    Object{{0x1018, 1}, "vendor", 4},
    Object{{0x1018, 2}, "product code", 4},
    Object{{0x1018, 3}, "revision number", 4},
    Object{{0x1018, 4}, "serial number", 4},
    Object{{0x1021, 0}, "electronic data sheet", 0},
    Object{{0x1022, 0}, "format of the data sheet", 2},
    Object{{0x1200, 0}, "SDO server, highest sub-index", 1},
    Object{{0x1200, 1}, "COB-ID client to server", 4},
    Object{{0x1200, 2}, "COB-ID server to client", 4},
    Object{{0x1800, 0}, "TPDO1, highest sub-index", 1},
    Object{{0x1800, 1}, "TPDO1, COB-ID", 4},
    Object{{0x1800, 2}, "TPDO1, transmission type", 1},
    Object{{0x1800, 3}, "TPDO1, inhibit time", 2},
    Object{{0x1800, 5}, "TPDO1, event timer", 2},
    Object{{0x1801, 1}, "TPDO2, COB-ID", 4},
    Object{{0x1801, 2}, "TPDO2, transmission type", 1},
    Object{{0x1A00, 0}, "TPDO1, mapped objects", 1},
    Object{{0x1A00, 1}, "TPDO1, first mapped object", 4},
    Object{{0x1A01, 0}, "TPDO2, mapped objects", 1},
    Object{{0x1A01, 1}, "TPDO2, first mapped object", 4},
    Object{{0x6000, 0}, "operating parameters", 2},
    Object{{0x6001, 0}, "measuring units per revolution", 4},
    Object{{0x6002, 0}, "total measuring range", 4},
    Object{{0x6003, 0}, "preset value", 4},
    Object{{0x6004, 0}, "position value", 4},
    Object{{0x6030, 1}, "speed value", 2},
    Object{{0x6200, 0}, "cyclic timer", 2},
    Object{{0x6500, 0}, "operating status", 2},
    Object{{0x6501, 0}, "single-turn resolution", 4},
    Object{{0x6502, 0}, "distinguishable revolutions", 2},
    Object{{0x6503, 0}, "alarms", 2},
    Object{{0x6504, 0}, "supported alarms", 2},
    Object{{0x6505, 0}, "warnings", 2},
    Object{{0x6506, 0}, "supported warnings", 2},
    Object{{0x6507, 0}, "profile and software version", 4},
    Object{{0x6508, 0}, "operating time", 4},
    Object{{0x6509, 0}, "offset value", 4},
    Object{{0x650B, 0}, "serial number of the encoder", 4},
};

/// What identifiers and counts have to be among each other.
void identifiers(T& trial) {
  const auto node = trial.claims().node;
  const auto request = trial.number({0x1200, 1});
  const auto answer = request ? trial.number({0x1200, 2}) : std::nullopt;
  if (answer) {
    trial.expect(*request == 0x600U + node && *answer == 0x580U + node,
                 "600 and 580 with the node-ID", std::to_string(*request));
  }
}

void emergency(T& trial) {
  if (const auto id = trial.number({0x1014, 0})) {
    trial.expect((*id & 0x7FFU) == 0x80U + trial.claims().node, "80 with the node-ID",
                 std::to_string(*id));
  }
}

void errors_listed(T& trial) {
  const auto count = trial.number({0x1003, 0});
  if (count) {
    const auto next =
        trial.upload({0x1003, static_cast<std::uint8_t>(std::min<std::uint32_t>(*count + 1, 254))});
    trial.aborts(next, {0x08000024, 0x06090011});
  }
}

void mapping(T& trial, std::uint16_t index) {
  const auto count = trial.number({index, 0});
  if (!count) {
    return;
  }
  std::uint32_t bits = 0;
  for (std::uint32_t i = 1; i <= *count; ++i) {
    const auto entry = trial.number({index, static_cast<std::uint8_t>(i)});
    if (!entry) {
      return;
    }
    bits += *entry & 0xFFU;
    const auto object = trial.upload(
        {static_cast<std::uint16_t>(*entry >> 16U), static_cast<std::uint8_t>(*entry >> 8U)});
    if (!object ||
        !trial.expect(!object->abort, "a mapped object that can be read", object->text()) ||
        !trial.expect(object->data.size() * 8 == (*entry & 0xFFU),
                      "the length of the object in its mapping", object->text())) {
      return;
    }
  }
  trial.expect(bits <= 64, "64 bits at most", std::to_string(bits));
}

void no_signature(T& trial, std::uint16_t index) {
  trial.aborts(trial.download({index, 1}, little(0x12345678, 4)),
               {0x08000020, 0x08000022, 0x08000000});
}

}  // namespace

std::vector<CanopenCase> canopen_sdo_cases(Citations& cia301) {
  std::vector<CanopenCase> all;
  for (const Row& row : kRows) {
    all.push_back(
        {cia301.next(row.section, row.title, row.strength, row.danger), {row.needs}, row.run});
  }
  return all;
}

std::vector<CanopenCase> canopen_object_cases(Citations& cia301) {
  std::vector<CanopenCase> all;
  for (const Object& object : kObjects) {
    const bool encoder = object.name.index >= 0x6000;
    const std::string name = text_of(object.name);
    CanopenCase& made = all.emplace_back();
    made.identity = cia301.next_in(
        encoder ? "406" : "7.5.2",
        "Object " + name + ", " + object.title + ", is read" +
            (object.bytes > 0 ? ": " + std::to_string(8 * object.bytes) + " bits" : ""),
        encoder ? "CiA 406 V3.2, object " + name : "CiA 301 V4.2.0, 7.5.2, object " + name);
    made.needs = {object.name};
    made.run = [&object](T& trial) {
      const auto found = trial.upload(object.name);
      if (found && trial.expect(!found->abort, "it is read", found->text()) && object.bytes > 0) {
        trial.expect(found->data.size() == object.bytes, std::to_string(object.bytes) + " bytes",
                     found->text());
      }
    };
  }
  const auto add = [&](std::string title, std::vector<ObjectName> needs, Danger danger,
                       void (*run)(T&)) {
    all.push_back({cia301.next("7.5.2", std::move(title), kMust, danger), std::move(needs), run});
  };
  add("The identifiers of SDO are the predefined ones", {{0x1200, 1}, {0x1200, 2}}, kNone,
      identifiers);
  add("The identifier of emergencies is the predefined one", {{0x1014, 0}}, kNone, emergency);
  add("Errors beyond those that are counted are none", {{0x1003, 0}}, kNone, errors_listed);
  add("What TPDO1 carries can be read, and has 64 bits at most", {{0x1A00, 0}}, kNone,
      [](T& t) { mapping(t, 0x1A00); });
  add("What TPDO2 carries can be read, and has 64 bits at most", {{0x1A01, 0}}, kNone,
      [](T& t) { mapping(t, 0x1A01); });
  add("Storing without the signature is refused", {{0x1010, 1}}, kWrites,
      [](T& t) { no_signature(t, 0x1010); });
  add("Restoring without the signature is refused", {{0x1011, 1}}, kWrites,
      [](T& t) { no_signature(t, 0x1011); });
  add("A number of errors other than 0 is refused", {{0x1003, 0}}, kWrites, [](T& t) {
    t.aborts(t.download({0x1003, 0}, little(1, 1)), {0x06090030, 0x06090031});
  });
  return all;
}

}  // namespace rigwire::conform
