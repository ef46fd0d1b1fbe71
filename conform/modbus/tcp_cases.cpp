// The header, the connection: MODBUS Messaging on TCP/IP Implementation Guide V1.0b, sections 3.1.3
// and 4.2 to 4.4.
#include <array>
#include <string>
#include <thread>

#include "conform/modbus/modbus_trial.h"
#include "conform/modbus/modbus_words.h"

namespace rigwire::conform {

namespace modbus = protocols::modbus;
using std::chrono::milliseconds;

namespace {

using T = ModbusTrial;

std::vector<std::uint8_t> adu(std::uint16_t transaction, std::uint16_t protocol, std::uint8_t unit,
                              const Pdu& pdu) {
  const modbus::AduBytes bytes = modbus::encode_adu({transaction, protocol, unit}, pdu);
  return {bytes.view().begin(), bytes.view().end()};
}

void echoes_transactions(T& trial) {
  for (const std::uint16_t transaction :
       std::array<std::uint16_t, 4>{0x0000, 0x0001, 0x1234, 0xFFFF}) {
    Pdu pdu;
    if (!trial.send(adu(transaction, 0, trial.claims().unit, trial.any_request()),
                    "transaction " + std::to_string(transaction))) {
      return;
    }
    const auto header = trial.header_of_next(pdu);
    if (!header ||
        !trial.expect(header->transaction == transaction, "the transaction of the request",
                      std::to_string(header->transaction))) {
      return;
    }
  }
}

void protocol_of_answers(T& trial) {
  Pdu pdu;
  if (!trial.send(adu(7, 0, trial.claims().unit, trial.any_request()), "a request")) {
    return;
  }
  if (const auto header = trial.header_of_next(pdu)) {
    trial.expect(header->protocol == 0, "protocol identifier 0", std::to_string(header->protocol));
  }
}

void nothing_behind_tcp(T& trial) {
  if (trial.ask(trial.any_request())) {
    trial.silent(milliseconds(200), "nothing behind the answer");
  }
}

void exception_header(T& trial) {
  Pdu pdu;
  if (!trial.send(adu(0xABCD, 0, trial.claims().unit, {65}), "an unknown function")) {
    return;
  }
  if (const auto header = trial.header_of_next(pdu)) {
    trial.expect(header->transaction == 0xABCD && header->unit == trial.claims().unit,
                 "transaction and unit of the request",
                 std::to_string(header->transaction) + ", unit " + std::to_string(header->unit));
    trial.expect(pdu.size() == 2, "an exception of two bytes", hex_text(pdu, 16));
  }
}

// A foreign protocol's unit is dropped, and its length says where the next begins.
void foreign_protocol(T& trial) {
  if (trial.send(adu(1, 0x1234, trial.claims().unit, trial.any_request()), "protocol 1234 hex") &&
      trial.silent(milliseconds(300), "no answer to a foreign protocol")) {
    static_cast<void>(trial.ask(trial.any_request()));
  }
}

void in_pieces(T& trial, std::size_t piece) {
  const auto request = trial.framed(trial.any_request());
  for (std::size_t at = 0; at < request.size(); at += piece) {
    const auto bytes = std::span(request).subspan(at, std::min(piece, request.size() - at));
    if (!trial.send(bytes, "a piece")) {
      return;
    }
    std::this_thread::sleep_for(milliseconds(10));
  }
  static_cast<void>(trial.answer());
}

void together(T& trial, unsigned count) {
  std::vector<std::uint8_t> bytes;
  for (unsigned i = 0; i < count; ++i) {
    const auto one =
        adu(static_cast<std::uint16_t>(100 + i), 0, trial.claims().unit, trial.any_request());
    bytes.insert(bytes.end(), one.begin(), one.end());
  }
  if (!trial.send(bytes, std::to_string(count) + " requests at once")) {
    return;
  }
  // The answers come in any order: the client matches them by their transaction numbers (4.4.2).
  std::vector<bool> answered(count);
  for (unsigned i = 0; i < count; ++i) {
    Pdu pdu;
    const auto header = trial.header_of_next(pdu);
    if (!header ||
        !trial.expect(header->transaction >= 100 && header->transaction < 100 + count &&
                          !answered[header->transaction - 100U],
                      "each request answered once", std::to_string(header->transaction))) {
      return;
    }
    answered[header->transaction - 100U] = true;
  }
}

void other_unit(T& trial, std::uint8_t unit) {
  if (!trial.send(adu(9, 0, unit, trial.any_request()), "unit " + std::to_string(unit))) {
    return;
  }
  std::vector<std::uint8_t> bytes;
  const auto deadline = ByteLine::Clock::now() + milliseconds(300);
  while (modbus::decode_adu(bytes).incomplete() && trial.line().receive(bytes, deadline)) {
  }
  const auto found = modbus::decode_adu(bytes);
  trial.received(bytes, found.ok() ? answer_words(found->pdu) : "nothing");
  trial.observe(found.ok() ? answer_words(found->pdu) : "no answer");
}

void second_connection(T& trial) {
  const auto beside = trial.another();
  const auto request = adu(3, 0, trial.claims().unit, trial.any_request());
  std::vector<std::uint8_t> bytes;
  trial.note("a second connection");
  trial.expect(beside->send(request) &&
                   beside->receive(bytes, ByteLine::Clock::now() + trial.claims().patience),
               "an answer on a second connection", "none");
  static_cast<void>(trial.ask(trial.any_request()));
}

void many_connections(T& trial) {
  for (int i = 0; i < 20; ++i) {
    trial.reopen();
    if (!trial.ask(trial.any_request())) {
      return;
    }
  }
}

struct TcpRow {
  const char* section;
  const char* title;
  Strength strength;
  void (*run)(T&);
};

constexpr std::array kTcpRows{
    TcpRow{"3.1.3", "Transaction identifiers are repeated", kMust, echoes_transactions},
    TcpRow{"3.1.3", "The protocol identifier of answers is 0", kMust, protocol_of_answers},
    TcpRow{"3.1.3", "The length is that of the answer: nothing comes behind it", kMust,
           nothing_behind_tcp},
    TcpRow{"3.1.3", "An exception has the header of its request", kMust, exception_header},
    TcpRow{"3.1.3", "A data unit of another protocol is dropped", kMust, foreign_protocol},
    TcpRow{"3.1.3", "A request is taken in two pieces: header, data unit", kMust,
           [](T& t) { in_pieces(t, modbus::kMbapHeaderSize); }},
    TcpRow{"3.1.3", "A request is taken byte by byte", kMust, [](T& t) { in_pieces(t, 1); }},
    TcpRow{"4.4.2", "Two requests in one segment are both answered", kShould,
           [](T& t) { together(t, 2); }},
    TcpRow{"4.4.2", "Sixteen requests in one segment are all answered", kShould,
           [](T& t) { together(t, 16); }},
    TcpRow{"4.4.2", "What unit 0 answers", kObserved, [](T& t) { other_unit(t, 0); }},
    TcpRow{"4.4.2", "What unit 255 answers", kObserved, [](T& t) { other_unit(t, 255); }},
    TcpRow{"4.4.2", "What a unit answers that is not there", kObserved,
           [](T& t) { other_unit(t, t.claims().unit == 77 ? 78 : 77); }},
    TcpRow{"4.2", "A second connection is served beside the first", kShould, second_connection},
    TcpRow{"4.2", "Twenty connections, one after the other", kMust, many_connections},
};

}  // namespace

std::vector<ModbusCase> modbus_tcp_cases() {
  std::vector<ModbusCase> all;
  Citations citations("modbus-tcp", "Modbus messaging on TCP/IP V1.0b");
  for (const TcpRow& row : kTcpRows) {
    ModbusCase& made = all.emplace_back();
    made.identity = citations.next(row.section, row.title, row.strength);
    made.needs.tcp = true;
    made.run = row.run;
  }
  return all;
}

}  // namespace rigwire::conform
