// RTU frames and the functions of serial lines: MODBUS over Serial Line V1.02, sections 2.2 and
// 2.5.1; MODBUS Application Protocol Specification V1.1b3, sections 6.7 to 6.9.
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

enum class Document : std::uint8_t { line, application };

struct Row {
  std::uint8_t function;
  Document document;
  const char* section;
  const char* title;
  Strength strength;
  void (*run)(T&);
};
constexpr auto kMust = Strength::must;
constexpr auto kLine = Document::line;
constexpr auto kApplication = Document::application;

constexpr std::array kRows{
    Row{3, kLine, "2.5.1", "A frame with a wrong check is not answered", kMust, wrong_check},
    Row{3, kLine, "2.5.1", "A frame of fewer than four bytes is not answered", kMust, too_short},
    Row{3, kLine, "2.5.1", "A frame after noise and a silence is answered", kMust, after_noise},
    Row{3, kLine, "2.5.1", "Nothing comes behind an answer", kMust, nothing_behind},
    Row{3, kLine, "2.2", "Another address is not answered", kMust, other_address},
    Row{3, kLine, "2.2", "A broadcast is not answered", kMust, broadcast},
    Row{7, kApplication, "6.7", "Exception status is a byte", kMust,
        [](T& t) {
          if (const auto data = t.accepts({modbus::kReadExceptionStatus})) {
            t.expect(data->size() == 1, "one byte", hex_text(*data));
          }
        }},
    Row{8, kApplication, "6.8", "Query data are returned", kMust, repeats_the_query},
    Row{8, kApplication, "6.8", "A sub-function that there is not is refused", kMust,
        [](T& t) {
          t.refuses(fields_pdu(modbus::kDiagnostics, {0x7FFF, 0}), ExceptionCode::illegal_function);
        }},
    Row{8, kApplication, "6.8", "Data where there are none is refused", kMust,
        [](T& t) {
          t.refuses(fields_pdu(modbus::kDiagnostics,
                               {static_cast<unsigned>(modbus::SubFunction::bus_message_count), 1}),
                    ExceptionCode::illegal_data_value);
        }},
    Row{8, kApplication, "6.8", "Messages on the line are counted", kMust, counts_messages},
    Row{8, kApplication, "6.8", "Wrong checks are counted", kMust, counts_wrong_checks},
    Row{11, kApplication, "6.9", "Answered requests are counted, exceptions are not", kMust,
        counts_events},
};

}  // namespace

std::vector<ModbusCase> modbus_serial_cases() {
  std::vector<ModbusCase> all;
  Citations line("modbus-rtu", "Modbus over serial line V1.02");
  Citations application("modbus", kApplicationProtocol);
  for (const Row& row : kRows) {
    ModbusCase& made = all.emplace_back();
    Citations& citations = row.document == Document::line ? line : application;
    made.identity = citations.next(row.section, row.title, row.strength);
    made.needs.function = row.function;
    made.needs.serial = true;
    made.run = row.run;
  }
  return all;
}

}  // namespace rigwire::conform
