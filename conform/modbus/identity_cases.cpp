// Functions 17 and 43/14: MODBUS Application Protocol Specification V1.1b3, sections 6.13 and 6.21.
#include <array>
#include <map>
#include <string>

#include "conform/modbus/modbus_trial.h"
#include "conform/modbus/modbus_words.h"

namespace rigwire::conform {

namespace modbus = protocols::modbus;
using modbus::ExceptionCode;

namespace {

using T = ModbusTrial;

constexpr std::uint8_t kBasic = 1;
constexpr std::uint8_t kRegular = 2;
constexpr std::uint8_t kExtended = 3;
constexpr std::uint8_t kIndividual = 4;
constexpr std::uint8_t kRevision = 2;  ///< The last of the mandatory objects 0 to 2.

Pdu identification(std::uint8_t access, std::uint8_t object) {
  return {43, modbus::kDeviceIdentificationInterface, access, object};
}

struct Part {
  std::uint8_t conformity = 0;
  bool more = false;
  std::uint8_t next = 0;
  std::map<std::uint8_t, std::string> objects;
};

/// One answer, its fields and lists as they have to be; nothing where they are not.
std::optional<Part> part(T& trial, std::uint8_t access, std::uint8_t object) {
  const auto data = trial.accepts(identification(access, object));
  constexpr std::size_t kHead = 6;  // Interface, access, conformity, more, next, count.
  if (!data || !trial.expect(data->size() >= kHead, "six bytes before the objects",
                             std::to_string(data->size()))) {
    return std::nullopt;
  }
  const Pdu& bytes = *data;
  trial.expect(bytes[0] == modbus::kDeviceIdentificationInterface, "interface 14",
               std::to_string(bytes[0]));
  trial.expect(bytes[1] == access, "the access of the request", std::to_string(bytes[1]));
  trial.expect(bytes[3] == 0x00 || bytes[3] == 0xFF, "more follows: 00 or FF",
               std::to_string(bytes[3]));
  Part found{bytes[2], bytes[3] != 0, bytes[4], {}};
  trial.expect(found.more || found.next == 0, "next object 0 where no more follows",
               std::to_string(found.next));
  std::size_t at = kHead;
  for (unsigned i = 0; i < bytes[5]; ++i) {
    if (!trial.expect(at + 2 <= bytes.size() && at + 2 + bytes[at + 1] <= bytes.size(),
                      "as many objects as are counted", "the answer ends before")) {
      return std::nullopt;
    }
    const std::size_t length = bytes[at + 1];
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at) + 2;
    found.objects.emplace(bytes[at],
                          std::string(begin, begin + static_cast<std::ptrdiff_t>(length)));
    at += 2 + length;
  }
  trial.expect(at == bytes.size(), "nothing behind the objects",
               std::to_string(bytes.size() - at) + " bytes");
  return found;
}

/// All answers of a stream, as often as more follows.
std::optional<Part> stream(T& trial, std::uint8_t access) {
  std::optional<Part> all = part(trial, access, 0);
  for (int i = 0; all && all->more && i < 256; ++i) {
    const std::uint8_t next = all->next;
    const auto following = part(trial, access, next);
    if (!following) {
      return std::nullopt;
    }
    if (!trial.expect(
            !following->more || following->next > next, "objects in order",
            "next " + std::to_string(following->next) + " after " + std::to_string(next))) {
      return std::nullopt;
    }
    all->objects.insert(following->objects.begin(), following->objects.end());
    all->more = following->more;
    all->next = following->next;
  }
  return all;
}

void basic(T& trial) {
  const auto all = stream(trial, kBasic);
  if (!all) {
    return;
  }
  for (std::uint8_t object = 0; object <= kRevision; ++object) {
    const auto found = all->objects.find(object);
    trial.expect(found != all->objects.end() && !found->second.empty(),
                 "vendor name, product code and revision",
                 "object " + std::to_string(object) + " is missing or empty");
  }
  trial.expect(all->objects.size() == 3U, "no other object in the basic stream",
               std::to_string(all->objects.size()) + " objects");
}

void conformity(T& trial) {
  const auto found = part(trial, kBasic, 0);
  if (found) {
    const unsigned level = found->conformity & 0x7FU;
    trial.expect(level >= kBasic && level <= kExtended, "1, 2 or 3, with 80 hex for single objects",
                 std::to_string(found->conformity));
  }
}

// The answer must not exceed the requested category. A device that is asked for more than its
// conformity level answers at its own level.
void level(T& trial, std::uint8_t access) {
  const auto found = part(trial, kBasic, 0);
  const auto all = found ? stream(trial, access) : std::nullopt;
  if (!all) {
    return;
  }
  for (const auto& [object, text] : all->objects) {
    const unsigned own = object <= kRevision ? kBasic : object < 0x80 ? kRegular : kExtended;
    trial.expect(own <= access, "objects of that category and those below",
                 "object " + std::to_string(object));
  }
  trial.expect(all->objects.contains(0) && all->objects.contains(kRevision),
               "the mandatory objects before them", "missing");
}

void single(T& trial) {
  const auto found = part(trial, kBasic, 0);
  if (!found) {
    return;
  }
  if ((found->conformity & 0x80U) == 0) {
    return trial.not_applicable("its conformity level has no single objects");
  }
  for (const auto& [object, text] : found->objects) {
    const auto one = part(trial, kIndividual, object);
    if (one) {
      trial.expect(one->objects.size() == 1 && one->objects.contains(object) &&
                       one->objects.at(object) == text,
                   "the object that was asked for, as in the stream", "other");
    }
  }
}

void unknown_object(T& trial) {
  const auto found = part(trial, kBasic, 0);
  if (found && (found->conformity & 0x80U) == 0) {
    return trial.not_applicable("its conformity level has no single objects");
  }
  // 07 to 7F are reserved.
  trial.refuses(identification(kIndividual, 0x70), ExceptionCode::illegal_data_address);
}

// An object that there is not: the stream begins anew (section 6.21).
void stream_from_unknown(T& trial) {
  const auto found = part(trial, kBasic, 0x70);
  if (found) {
    trial.expect(found->objects.contains(0), "the stream from object 0", "other");
  }
}

void server_identifier(T& trial) {
  const auto data = trial.accepts({17});
  if (!data) {
    return;
  }
  trial.expect(!data->empty() && data->size() == 1U + data->front(),
               "a byte count and as many bytes", hex_text(*data, 16));
  trial.expect(data->size() >= 3, "an identifier and the run indicator", hex_text(*data, 16));
}

void run_indicator(T& trial) {
  const auto data = trial.accepts({17});
  if (data && !data->empty()) {
    trial.observe("data " + hex_text(*data, 32) +
                  (data->back() == 0xFF   ? ": runs"
                   : data->back() == 0x00 ? ": does not run"
                                          : ": no run indicator at the end"));
  }
}

struct IdentityRow {
  std::uint8_t function;
  const char* section;
  const char* title;
  Strength strength;
  void (*run)(T&);
};

constexpr std::array kIdentityRows{
    IdentityRow{17, "6.13", "The answer has as many bytes as it counts", kMust, server_identifier},
    IdentityRow{17, "6.13", "What a device reports about itself", Strength::observed,
                run_indicator},
    IdentityRow{17, "6.13", "A request with a byte too many is refused", Strength::should,
                [](T& t) {
                  t.refuses({17, 0}, ExceptionCode::illegal_data_value);
                }},
    IdentityRow{43, "6.21", "The basic stream has the three mandatory objects", kMust, basic},
    IdentityRow{43, "6.21", "The conformity level is one that there is", kMust, conformity},
    IdentityRow{43, "6.21", "The regular stream has objects up to 7F, at the level that there is",
                kMust, [](T& t) { level(t, kRegular); }},
    IdentityRow{43, "6.21", "The extended stream, at the level that there is", kMust,
                [](T& t) { level(t, kExtended); }},
    IdentityRow{43, "6.21", "A single object is as in the stream", kMust, single},
    IdentityRow{43, "6.21", "A single object that there is not is refused", kMust, unknown_object},
    IdentityRow{43, "6.21", "A stream from an object that there is not begins anew", kMust,
                stream_from_unknown},
    IdentityRow{43, "6.21", "An access that there is not is refused", kMust,
                [](T& t) { t.refuses(identification(5, 0), ExceptionCode::illegal_data_value); }},
    IdentityRow{43, "6.21", "An access of 0 is refused", kMust,
                [](T& t) { t.refuses(identification(0, 0), ExceptionCode::illegal_data_value); }},
    IdentityRow{43, "6.20", "An interface that there is not is refused", kMust,
                [](T& t) {
                  t.refuses({43, 0x55, 1, 0}, ExceptionCode::illegal_function);
                }},
};

}  // namespace

std::vector<ModbusCase> modbus_identity_cases() {
  std::vector<ModbusCase> all;
  Citations citations("modbus", kApplicationProtocol);
  for (const IdentityRow& row : kIdentityRows) {
    ModbusCase& made = all.emplace_back();
    made.identity = citations.next(row.section, row.title, row.strength);
    made.needs.function = row.function;
    made.run = row.run;
  }
  constexpr const char* kUnknown = "A device without it does not know the function";
  ModbusCase& no_identifier = all.emplace_back();
  no_identifier.identity = citations.next("6.13", kUnknown);
  no_identifier.needs.without = 17;
  no_identifier.run = [](T& t) { t.refuses({17}, ExceptionCode::illegal_function); };
  ModbusCase& no_identity = all.emplace_back();
  no_identity.identity = citations.next("6.21", kUnknown);
  no_identity.needs.without = 43;
  no_identity.run = [](T& t) { t.refuses(identification(1, 0), ExceptionCode::illegal_function); };
  return all;
}

}  // namespace rigwire::conform
