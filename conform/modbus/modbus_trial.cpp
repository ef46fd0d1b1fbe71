#include "conform/modbus/modbus_trial.h"

#include <algorithm>
#include <array>
#include <thread>

#include "conform/modbus/modbus_words.h"
#include "protocols/modbus/pdu.h"

namespace rigwire::conform {

namespace modbus = protocols::modbus;
using std::chrono::milliseconds;

namespace {

// A pause that a driver, a pseudo-terminal or an adapter makes within a frame is shorter.
constexpr milliseconds kFrameEnds{50};
constexpr std::size_t kLongestFrame = 256;  // bytes, with address and check

std::vector<std::uint8_t> copy(std::span<const std::uint8_t> bytes) {
  return {bytes.begin(), bytes.end()};
}

}  // namespace

Pdu fields_pdu(std::uint8_t function, std::initializer_list<unsigned> words) {
  Pdu pdu{function};
  for (const unsigned word : words) {
    pdu.push_back(static_cast<std::uint8_t>(word >> 8U));
    pdu.push_back(static_cast<std::uint8_t>(word));
  }
  return pdu;
}

Pdu with(Pdu pdu, std::initializer_list<unsigned> bytes) {
  for (const unsigned byte : bytes) {
    pdu.push_back(static_cast<std::uint8_t>(byte));
  }
  return pdu;
}

std::unique_ptr<ByteLine> ModbusDevice::connect() const {
  bounds->check();
  return bounded(open_bytes(endpoint), bounds);
}

ModbusTrial::ModbusTrial(CaseIdentity identity, ModbusDevice& device)
    : Trial(std::move(identity)), device_(&device) {
  reopen();
}

void ModbusTrial::reopen() {
  arrived_.clear();
  if (!serial() || device_->line == nullptr || device_->line->closed()) {
    device_->line.reset();
    device_->line = device_->connect();
    return;
  }
  std::vector<std::uint8_t> old;
  const auto end = ByteLine::Clock::now() + kDrain;
  while (ByteLine::Clock::now() < end &&
         device_->line->receive(old, ByteLine::Clock::now() + milliseconds(5))) {
    old.clear();
  }
}

Pdu ModbusTrial::any_request() const {
  struct Reading {
    std::uint8_t function;
    modbus::Table table;
  };
  constexpr std::array<Reading, 4> kReading{{{3, modbus::Table::holding_registers},
                                             {4, modbus::Table::input_registers},
                                             {1, modbus::Table::coils},
                                             {2, modbus::Table::discrete_inputs}}};
  for (const auto& [function, table] : kReading) {
    if (claims().has(function) && !claims().table(table).empty()) {
      return fields_pdu(function, {claims().table(table).front().first, 1});
    }
  }
  return fields_pdu(3, {0, 1});
}

bool ModbusTrial::send(std::span<const std::uint8_t> bytes, std::string words) {
  sent(bytes, std::move(words));
  asked_ = ByteLine::Clock::now();
  return expect(line().send(bytes), "the device takes what is sent", "the connection is closed");
}

std::vector<std::uint8_t> ModbusTrial::framed(const Pdu& request) {
  if (serial()) {
    return copy(modbus::encode_rtu(claims().unit, request).view());
  }
  modbus::MbapHeader header;
  header.transaction = ++device_->transaction;
  header.unit = claims().unit;
  return copy(modbus::encode_adu(header, request).view());
}

std::optional<Pdu> ModbusTrial::ask(const Pdu& request) {
  if (serial()) {
    const modbus::RtuTiming timing{endpoint().rate, claims().character};
    std::this_thread::sleep_for(timing.frame_silence() + milliseconds(1));
  }
  if (!send(framed(request), request_words(request))) {
    return std::nullopt;
  }
  return answer();
}

std::optional<Pdu> ModbusTrial::answer() {
  const auto deadline = asked_ + claims().patience;
  std::optional<Pdu> pdu = serial() ? serial_answer(deadline) : tcp_answer(deadline);
  took_ = ByteLine::Clock::now() - asked_;
  return pdu;
}

std::optional<modbus::MbapHeader> ModbusTrial::header_of_next(Pdu& pdu) {
  const auto deadline = asked_ + claims().patience;
  while (true) {
    const auto found = modbus::decode_adu(arrived_);
    if (found.ok()) {
      const auto bytes = std::span(arrived_).first(found.consumed());
      received(bytes, answer_words(found->pdu));
      const modbus::MbapHeader header = found->header;
      pdu = copy(found->pdu);
      arrived_.erase(arrived_.begin(),
                     arrived_.begin() + static_cast<std::ptrdiff_t>(found.consumed()));
      return header;
    }
    if (!found.incomplete()) {
      received(arrived_, "no data unit");
      demand(false, "a header with a length of 2 to 254", hex_text(arrived_, 16));
      return std::nullopt;
    }
    if (!line().receive(arrived_, deadline)) {
      if (!arrived_.empty()) {
        received(arrived_, "the begin of a data unit");
      }
      expect(false, "an answer within " + std::to_string(claims().patience.count()) + " ms",
             line().closed()    ? "the connection was closed"
             : arrived_.empty() ? "none"
                                : "only " + std::to_string(arrived_.size()) + " bytes of one");
      return std::nullopt;
    }
  }
}

std::optional<Pdu> ModbusTrial::tcp_answer(ByteLine::Clock::time_point /*deadline*/) {
  Pdu pdu;
  const auto header = header_of_next(pdu);
  if (!header) {
    return std::nullopt;
  }
  const bool framed_well =
      demand(header->transaction == device_->transaction,
             "transaction " + std::to_string(device_->transaction),
             std::to_string(header->transaction)) &&
      demand(header->protocol == modbus::kModbusProtocol, "protocol identifier 0",
             std::to_string(header->protocol)) &&
      demand(header->unit == claims().unit, "unit " + std::to_string(claims().unit),
             std::to_string(header->unit));
  return framed_well ? std::optional(pdu) : std::nullopt;
}

std::optional<Pdu> ModbusTrial::serial_answer(ByteLine::Clock::time_point deadline) {
  // An answer that begins in time may end behind the deadline; noise ends it there.
  const modbus::RtuTiming timing{endpoint().rate, claims().character};
  const auto end = deadline + timing.characters(kLongestFrame) + kFrameEnds;
  while (true) {
    const auto now = ByteLine::Clock::now();
    const bool more =
        line().receive(arrived_, arrived_.empty() ? deadline : std::min(now + kFrameEnds, end));
    const auto frame = modbus::decode_rtu(arrived_);
    const bool whole = frame.ok() && !modbus::decode_response(frame->pdu).incomplete();
    if (more && !whole && arrived_.size() <= kLongestFrame) {
      continue;
    }
    if (!more && arrived_.empty()) {
      expect(false, "an answer within " + std::to_string(claims().patience.count()) + " ms",
             "none");
      return std::nullopt;
    }
    received(arrived_, frame.ok() ? answer_words(frame->pdu) : "no frame");
    const bool framed_well =
        demand(frame.ok(), "a frame with a right check", hex_text(arrived_, 16)) &&
        demand(frame->address == claims().unit, "address " + std::to_string(claims().unit),
               std::to_string(frame->address));
    std::optional<Pdu> pdu;
    if (framed_well) {
      pdu = copy(frame->pdu);
    }
    arrived_.clear();
    return pdu;
  }
}

bool ModbusTrial::silent(milliseconds within, const std::string& about) {
  const auto deadline = ByteLine::Clock::now() + within;
  while (line().receive(arrived_, deadline)) {
  }
  const bool nothing = arrived_.empty();
  if (!nothing) {
    received(arrived_, "not expected");
  }
  const std::string got = hex_text(arrived_, 16);
  arrived_.clear();
  return expect(nothing, about, got);
}

bool ModbusTrial::refuses(const Pdu& request, modbus::ExceptionCode code) {
  const std::optional<Pdu> found = ask(request);
  if (!found) {
    return false;
  }
  const auto flagged = static_cast<std::uint8_t>(request[0] | modbus::kExceptionFlag);
  const bool refused = found->size() == 2 && (*found)[0] == flagged;
  return expect(refused && (*found)[1] == static_cast<std::uint8_t>(code),
                "exception " + exception_words(static_cast<std::uint8_t>(code)),
                answer_words(*found));
}

std::optional<Pdu> ModbusTrial::accepts(const Pdu& request) {
  const std::optional<Pdu> found = ask(request);
  if (!found ||
      !expect((*found)[0] == request[0], "an answer of function " + std::to_string(request[0]),
              answer_words(*found))) {
    return std::nullopt;
  }
  return Pdu(found->begin() + 1, found->end());
}

std::optional<std::vector<std::uint16_t>> ModbusTrial::registers(std::uint8_t function,
                                                                 unsigned address, unsigned count) {
  const std::optional<Pdu> data = accepts(fields_pdu(function, {address, count}));
  if (!data ||
      !expect(data->size() == 1U + 2U * count && (*data)[0] == 2U * count,
              "a byte count of twice the quantity, and as many bytes", hex_text(*data, 16))) {
    return std::nullopt;
  }
  std::vector<std::uint16_t> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    values[i] = static_cast<std::uint16_t>((*data)[1 + 2 * i] * 256U + (*data)[2 + 2 * i]);
  }
  return values;
}

std::optional<std::vector<bool>> ModbusTrial::bits(std::uint8_t function, unsigned address,
                                                   unsigned count) {
  const std::optional<Pdu> data = accepts(fields_pdu(function, {address, count}));
  const std::size_t bytes = (count + 7U) / 8U;
  if (!data || !expect(data->size() == 1U + bytes && (*data)[0] == bytes,
                       "a byte count of an eighth of the quantity, and as many bytes",
                       hex_text(*data, 16))) {
    return std::nullopt;
  }
  std::vector<bool> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    values[i] = (((*data)[1 + i / 8]) >> (i % 8) & 1U) != 0;
  }
  if (count % 8 != 0) {
    expect((data->back() >> (count % 8)) == 0, "unused bits of the last byte are 0",
           hex_text(*data, 16));
  }
  return values;
}

std::string missing(const ModbusNeeds& needs, const ModbusDevice& device) {
  const ModbusClaims& claims = device.claims;
  if (needs.tcp && device.serial()) {
    return "of TCP";
  }
  if (needs.serial && !device.serial()) {
    return "of serial lines";
  }
  for (const std::uint8_t function : std::array{needs.function, needs.and_function}) {
    if (function != 0 && !claims.has(function)) {
      return "function " + std::to_string(function) + " is not claimed";
    }
  }
  if (needs.without != 0 && claims.has(needs.without)) {
    return "function " + std::to_string(needs.without) + " is claimed";
  }
  if (needs.writable_coils && claims.writable_coils.empty()) {
    return "no coil may be written";
  }
  if (needs.writable_registers && claims.writable_registers.empty()) {
    return "no register may be written";
  }
  if (needs.file && claims.files.empty()) {
    return "no file is claimed";
  }
  if (needs.writable_file && claims.writable_files.empty()) {
    return "no file may be written";
  }
  if (needs.queue && claims.queues.empty()) {
    return "no queue is claimed";
  }
  return "";
}

}  // namespace rigwire::conform
