// RTU frames and the functions of serial lines: MODBUS over Serial Line V1.02, sections 2.2 and
// 2.5.1; MODBUS Application Protocol Specification V1.1b3, sections 6.7 to 6.10.
#include <array>
#include <string>
#include <thread>

#include "conform/modbus/modbus_trial.h"
#include "conform/modbus/modbus_words.h"
#include "protocols/modbus/pdu.h"

namespace rigwire::conform {

namespace modbus = protocols::modbus;
using modbus::ExceptionCode;
using std::chrono::milliseconds;

namespace {

using T = ModbusTrial;
constexpr milliseconds kSilence{300};

Pdu loopback() {
  return fields_pdu(modbus::kDiagnostics, {0, 0xA537});
}
/// One item of what it has, else what is refused.
std::vector<std::uint8_t> frame(std::uint8_t address, const Pdu& pdu) {
  const modbus::RtuBytes bytes = modbus::encode_rtu(address, pdu);
  return {bytes.view().begin(), bytes.view().end()};
}

// Not answered; what comes next is.
void unanswered(T& trial, const std::vector<std::uint8_t>& bytes, const std::string& what) {
  if (trial.send(bytes, what) && trial.silent(kSilence, "no answer to " + what)) {
    static_cast<void>(trial.ask(trial.any_request()));
  }
}

void wrong_check(T& trial) {
  auto bytes = frame(trial.claims().unit, trial.any_request());
  bytes.back() ^= 1U;
  unanswered(trial, bytes, "a frame with a wrong check");
}

void other_address(T& trial) {
  const std::uint8_t unit = trial.claims().unit == 77 ? 78 : 77;
  unanswered(trial, frame(unit, trial.any_request()), "another address");
}

void broadcast(T& trial) {
  unanswered(trial, frame(modbus::kBroadcastAddress, trial.any_request()), "a broadcast");
}

void too_short(T& trial) {
  auto bytes = frame(trial.claims().unit, trial.any_request());
  bytes.resize(3);
  unanswered(trial, bytes, "a frame of three bytes");
}

void after_noise(T& trial) {
  if (trial.send(std::array<std::uint8_t, 5>{0xFF, 0x00, 0xA5, 0x5A, 0x01}, "noise")) {
    std::this_thread::sleep_for(milliseconds(20));
    trial.reopen();
    static_cast<void>(trial.ask(trial.any_request()));
  }
}

void nothing_behind(T& trial) {
  if (trial.ask(trial.any_request())) {
    trial.silent(milliseconds(200), "nothing behind the answer");
  }
}

void repeats_the_query(T& trial) {
  const auto answer = trial.ask(loopback());
  if (answer) {
    trial.expect(*answer == loopback(), "the request repeated", answer_words(*answer));
  }
}

/// A counter of function 8.
std::optional<unsigned> counter(T& trial, modbus::SubFunction which) {
  const auto data =
      trial.accepts(fields_pdu(modbus::kDiagnostics, {static_cast<unsigned>(which), 0}));
  if (!data || !trial.expect(data->size() == 4, "sub-function and a value", hex_text(*data))) {
    return std::nullopt;
  }
  return (*data)[2] * 256U + (*data)[3];
}

void counts_messages(T& trial) {
  const auto before = counter(trial, modbus::SubFunction::bus_message_count);
  if (!before || !trial.ask(trial.any_request())) {
    return;
  }
  const auto after = counter(trial, modbus::SubFunction::bus_message_count);
  if (after) {
    trial.expect(((*after - *before) & 0xFFFFU) == 2, "two messages more",
                 std::to_string((*after - *before) & 0xFFFFU));
  }
}

void counts_wrong_checks(T& trial) {
  const auto before = counter(trial, modbus::SubFunction::bus_communication_error_count);
  if (!before) {
    return;
  }
  auto bytes = frame(trial.claims().unit, trial.any_request());
  bytes.back() ^= 1U;
  if (!trial.send(bytes, "a frame with a wrong check") ||
      !trial.silent(kSilence, "no answer to it")) {
    return;
  }
  const auto after = counter(trial, modbus::SubFunction::bus_communication_error_count);
  if (after) {
    trial.expect(((*after - *before) & 0xFFFFU) == 1, "one error more",
                 std::to_string((*after - *before) & 0xFFFFU));
  }
}

void counts_events(T& trial) {
  const auto events = [&]() -> std::optional<unsigned> {
    const auto data = trial.accepts({modbus::kGetCommEventCounter});
    if (!data || !trial.expect(data->size() == 4, "status and counter", hex_text(*data))) {
      return std::nullopt;
    }
    return (*data)[2] * 256U + (*data)[3];
  };
  const auto before = events();
  if (!before || !trial.ask(trial.any_request()) ||
      !trial.refuses(fields_pdu(3, {0, 0}), ExceptionCode::illegal_data_value)) {
    return;
  }
  const auto after = events();
  if (after) {
    // Successful ones count, exceptions and this function itself do not.
    trial.expect(((*after - *before) & 0xFFFFU) == 1, "one event more",
                 std::to_string((*after - *before) & 0xFFFFU));
  }
}

struct EventLog {
  unsigned events = 0;    ///< Event count, as in function 11.
  unsigned messages = 0;  ///< Message count, as in diagnostics.
  Pdu log;                ///< The newest first.
};

constexpr std::uint8_t kGetCommEventLog = 12;

/// Returns the event log of function 12; nullopt if the answer is no log, which is recorded.
std::optional<EventLog> event_log(T& trial) {
  constexpr std::size_t kFields = 6;  // Status and two counts.
  constexpr std::size_t kMostEvents = 64;
  const auto data = trial.accepts({kGetCommEventLog});
  if (!data || !trial.expect(data->size() > kFields && data->size() <= 1 + kFields + kMostEvents &&
                                 data->front() + 1U == data->size(),
                             "a byte count of 6 to 70, and as many bytes", hex_text(*data, 16))) {
    return std::nullopt;
  }
  const auto word = [&](std::size_t at) { return (*data)[at] * 256U + (*data)[at + 1]; };
  trial.expect(word(1) == 0 || word(1) == 0xFFFF, "a status of 0000 or FFFF", hex_text(*data, 4));
  return EventLog{word(3), word(5), Pdu(data->begin() + 1 + kFields, data->end())};
}

void known_events(T& trial) {
  if (const auto found = event_log(trial)) {
    for (const std::uint8_t event : found->log) {
      // Received, sent, listening only from now on, restarted.
      trial.expect((event & 0x80U) != 0 || (event & 0xC0U) == 0x40U || event == 4 || event == 0,
                   "events of the four types", hex_text(found->log));
    }
  }
}

void counts_as_function_11(T& trial) {
  const auto data = trial.accepts({modbus::kGetCommEventCounter});
  const auto found = data && data->size() == 4 ? event_log(trial) : std::nullopt;
  if (found) {
    const unsigned counted = (*data)[2] * 256U + (*data)[3];
    trial.expect(found->events == counted, std::to_string(counted) + ", as function 11 reports",
                 std::to_string(found->events));
  }
}

void counts_as_diagnostics(T& trial) {
  const auto before = counter(trial, modbus::SubFunction::bus_message_count);
  const auto found = before ? event_log(trial) : std::nullopt;
  if (found) {
    trial.expect(((found->messages - *before) & 0xFFFFU) == 1, "one message more than diagnostics",
                 std::to_string((found->messages - *before) & 0xFFFFU));
  }
}

enum class Document : std::uint8_t { line, application };

struct SerialRow {
  std::uint8_t function;
  Document document;
  const char* section;
  const char* title;
  Strength strength;
  void (*run)(T&);
  std::uint8_t and_function = 0;  ///< 0: no other.
};
constexpr auto kLine = Document::line;
constexpr auto kApplication = Document::application;

constexpr std::array kSerialRows{
    SerialRow{3, kLine, "2.5.1", "A frame with a wrong check is not answered", kMust, wrong_check},
    SerialRow{3, kLine, "2.5.1", "A frame of fewer than four bytes is not answered", kMust,
              too_short},
    SerialRow{3, kLine, "2.5.1", "A frame after noise and a silence is answered", kMust,
              after_noise},
    SerialRow{3, kLine, "2.5.1", "Nothing comes behind an answer", kMust, nothing_behind},
    SerialRow{3, kLine, "2.2", "Another address is not answered", kMust, other_address},
    SerialRow{3, kLine, "2.2", "A broadcast is not answered", kMust, broadcast},
    SerialRow{7, kApplication, "6.7", "Exception status is a byte", kMust,
              [](T& t) {
                if (const auto data = t.accepts({modbus::kReadExceptionStatus})) {
                  t.expect(data->size() == 1, "one byte", hex_text(*data));
                }
              }},
    SerialRow{8, kApplication, "6.8", "Query data are returned", kMust, repeats_the_query},
    SerialRow{
        8, kApplication, "6.8", "A sub-function that there is not is refused", kMust,
        [](T& t) {
          t.refuses(fields_pdu(modbus::kDiagnostics, {0x7FFF, 0}), ExceptionCode::illegal_function);
        }},
    SerialRow{8, kApplication, "6.8", "Data where there are none is refused", kMust,
              [](T& t) {
                t.refuses(
                    fields_pdu(modbus::kDiagnostics,
                               {static_cast<unsigned>(modbus::SubFunction::bus_message_count), 1}),
                    ExceptionCode::illegal_data_value);
              }},
    SerialRow{8, kApplication, "6.8", "Messages on the line are counted", kMust, counts_messages},
    SerialRow{8, kApplication, "6.8", "Wrong checks are counted", kMust, counts_wrong_checks},
    SerialRow{11, kApplication, "6.9", "Answered requests are counted, exceptions are not", kMust,
              counts_events},
    SerialRow{12, kApplication, "6.10", "The log has a status, counts and at most 64 events", kMust,
              [](T& t) { static_cast<void>(event_log(t)); }},
    SerialRow{12, kApplication, "6.10", "Its events are of the four types", kMust, known_events},
    SerialRow{11, kApplication, "6.10", "Its event count is that of function 11", kMust,
              counts_as_function_11, 12},
    SerialRow{8, kApplication, "6.10", "Its message count is that of diagnostics", Strength::should,
              counts_as_diagnostics, 12},
};

}  // namespace

std::vector<ModbusCase> modbus_serial_cases() {
  std::vector<ModbusCase> all;
  Citations line("modbus-rtu", "Modbus over serial line V1.02");
  Citations application("modbus", kApplicationProtocol);
  for (const SerialRow& row : kSerialRows) {
    ModbusCase& made = all.emplace_back();
    Citations& citations = row.document == Document::line ? line : application;
    made.identity = citations.next(row.section, row.title, row.strength);
    made.needs.function = row.function;
    made.needs.and_function = row.and_function;
    made.needs.serial = true;
    made.run = row.run;
  }
  return all;
}

}  // namespace rigwire::conform
