// Functions 5, 6, 15, 16, 22 and 23: MODBUS Application Protocol Specification V1.1b3,
// sections 6.5, 6.6, 6.11, 6.12, 6.16, 6.17 and their state diagrams. What is written is put back.
#include <algorithm>
#include <array>
#include <string>

#include "conform/modbus/modbus_trial.h"
#include "conform/modbus/modbus_words.h"

namespace rigwire::conform {

namespace modbus = protocols::modbus;
using modbus::ExceptionCode;
using modbus::Table;

namespace {

using T = ModbusTrial;
using Values = std::vector<std::uint16_t>;

unsigned coil(const T& trial) {
  return trial.claims().writable_coils.front().first;
}
unsigned reg(const T& trial) {
  return trial.claims().writable_registers.front().first;
}

/// The first of the ranges, at most `most` of it.
unsigned count_in(const std::vector<AddressRange>& ranges, std::size_t most) {
  return static_cast<unsigned>(std::min(most, ranges.front().size()));
}

std::string text_of(const Values& values) {
  std::string text;
  for (const std::uint16_t value : values) {
    text += (text.empty() ? "" : ", ") + std::to_string(value);
  }
  return text;
}

/// Function 16, with a byte count of its own where it is to be wrong.
Pdu write_registers(unsigned address, const Values& values, unsigned quantity, unsigned bytes) {
  Pdu pdu = with(fields_pdu(16, {address, quantity}), {bytes});
  for (const std::uint16_t value : values) {
    pdu = with(std::move(pdu), {static_cast<unsigned>(value >> 8U), value & 0xFFU});
  }
  return pdu;
}

Pdu write_registers(unsigned address, const Values& values) {
  const auto count = static_cast<unsigned>(values.size());
  return write_registers(address, values, count, 2 * count);
}

Pdu write_coils(unsigned address, const std::vector<bool>& values) {
  const auto count = static_cast<unsigned>(values.size());
  Pdu pdu = with(fields_pdu(15, {address, count}), {(count + 7) / 8});
  const std::size_t begin = pdu.size();
  pdu.resize(begin + (count + 7) / 8);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i]) {
      pdu[begin + i / 8] = static_cast<std::uint8_t>(pdu[begin + i / 8] | 1U << (i % 8));
    }
  }
  return pdu;
}

bool echoed(T& trial, const Pdu& request, std::size_t bytes) {
  const auto answer = trial.ask(request);
  const Pdu expected(request.begin(), request.begin() + static_cast<std::ptrdiff_t>(bytes));
  return answer && trial.expect(*answer == expected, "an answer that repeats " + hex_text(expected),
                                answer_words(*answer));
}

bool reads_back(T& trial, unsigned address, const Values& values) {
  const auto found = trial.registers(3, address, static_cast<unsigned>(values.size()));
  return found &&
         trial.expect(*found == values, "registers read back " + text_of(values), text_of(*found));
}

/// The registers at `address` as they are now; put back when the case ends, by a function that the
/// device has.
class KeptRegisters {
 public:
  KeptRegisters(T& trial, unsigned address, unsigned count)
      : trial_(&trial), address_(address), values_(trial.registers(3, address, count)) {}
  KeptRegisters(const KeptRegisters&) = delete;
  KeptRegisters& operator=(const KeptRegisters&) = delete;
  ~KeptRegisters() {
    if (!values_) {
      return;
    }
    if (trial_->claims().has(16)) {
      static_cast<void>(trial_->ask(write_registers(address_, *values_)));
      return;
    }
    for (std::size_t i = 0; i < values_->size(); ++i) {
      static_cast<void>(
          trial_->ask(fields_pdu(6, {address_ + static_cast<unsigned>(i), (*values_)[i]})));
    }
  }
  [[nodiscard]] const std::optional<Values>& values() const { return values_; }
  /// Each with its lowest bit turned over.
  [[nodiscard]] Values turned() const {
    Values turned = *values_;
    for (std::uint16_t& value : turned) {
      value ^= 1U;
    }
    return turned;
  }

 private:
  T* trial_;
  unsigned address_;
  std::optional<Values> values_;
};

void write_one_coil(T& trial) {
  const auto before = trial.bits(1, coil(trial), 1);
  if (!before) {
    return;
  }
  for (const bool on : {!before->front(), before->front()}) {
    const Pdu request =
        fields_pdu(5, {coil(trial), on ? unsigned{modbus::kCoilOn} : unsigned{modbus::kCoilOff}});
    const auto found =
        echoed(trial, request, request.size()) ? trial.bits(1, coil(trial), 1) : std::nullopt;
    if (!found || !trial.expect(found->front() == on, "the coil reads as it was written",
                                on ? "off after on" : "on after off")) {
      return;
    }
  }
}

void refuse_other_coil_values(T& trial) {
  const auto before = trial.bits(1, coil(trial), 1);
  if (!before) {
    return;
  }
  for (const unsigned value : {0x0001U, 0x00FFU, 0xFF01U, 0x1234U}) {
    trial.refuses(fields_pdu(5, {coil(trial), value}), ExceptionCode::illegal_data_value);
  }
  const auto after = trial.bits(1, coil(trial), 1);
  trial.expect(!after || *after == *before, "the coil as it was", "changed");
}

void write_one_register(T& trial) {
  const KeptRegisters kept(trial, reg(trial), 1);
  if (!kept.values()) {
    return;
  }
  const Pdu request = fields_pdu(6, {reg(trial), kept.turned().front()});
  if (echoed(trial, request, request.size())) {
    reads_back(trial, reg(trial), kept.turned());
  }
}

void write_some_coils(T& trial) {
  const unsigned count = count_in(trial.claims().writable_coils, 20);
  const auto before = trial.bits(1, coil(trial), count);
  if (!before) {
    return;
  }
  std::vector<bool> turned = *before;
  turned.flip();
  for (const std::vector<bool>& values : {turned, *before}) {
    const auto found = echoed(trial, write_coils(coil(trial), values), 5)
                           ? trial.bits(1, coil(trial), count)
                           : std::nullopt;
    if (!found || !trial.expect(*found == values, "coils read as they were written", "other")) {
      return;
    }
  }
}

void write_some_registers(T& trial) {
  const unsigned count =
      count_in(trial.claims().writable_registers, modbus::kWriteRegistersMaximum);
  const KeptRegisters kept(trial, reg(trial), count);
  if (kept.values() && echoed(trial, write_registers(reg(trial), kept.turned()), 5)) {
    reads_back(trial, reg(trial), kept.turned());
  }
}

// Checks that a refused request has written nothing.
void refused_unwritten(T& trial, const std::function<Pdu(const Values& turned)>& request,
                       ExceptionCode code) {
  const KeptRegisters kept(trial, reg(trial), 1);
  if (kept.values()) {
    trial.refuses(request(kept.turned()), code);
    reads_back(trial, reg(trial), *kept.values());
  }
}

void partly_outside(T& trial) {
  const std::vector<AddressRange>& table = trial.claims().table(Table::holding_registers);
  const auto last = std::ranges::find_if(trial.claims().writable_registers, [&](const auto& range) {
    return range.last < 0xFFFF && !trial.claims().claims(Table::holding_registers, range.last + 1U);
  });
  if (table.empty() || last == trial.claims().writable_registers.end()) {
    return trial.not_applicable(
        "no writable register is followed by an address without a register");
  }
  const KeptRegisters kept(trial, last->last, 1);
  if (kept.values()) {
    trial.refuses(write_registers(last->last, {kept.turned().front(), 0}),
                  ExceptionCode::illegal_data_address);
    reads_back(trial, last->last, *kept.values());
  }
}

void mask(T& trial) {
  const KeptRegisters kept(trial, reg(trial), 1);
  if (!kept.values()) {
    return;
  }
  const std::uint16_t before = kept.values()->front();
  const auto bit = static_cast<std::uint16_t>(before & 1U);
  // Result = (before AND and) OR (or AND NOT and): nothing; the lowest bit turned over.
  const std::array<std::array<unsigned, 3>, 2> masks{
      {{0xFFFF, 0x0001, before},
       {0xFFFE, 1U - bit, static_cast<unsigned>(before & 0xFFFEU) | (1U - bit)}}};
  for (const auto& [and_mask, or_mask, result] : masks) {
    const Pdu request = fields_pdu(22, {reg(trial), and_mask, or_mask});
    if (!echoed(trial, request, request.size()) ||
        !reads_back(trial, reg(trial), {static_cast<std::uint16_t>(result)})) {
      return;
    }
  }
}

/// Function 23: reads `quantity` from where it writes `values`.
Pdu read_write(unsigned address, unsigned quantity, const Values& values, unsigned written,
               unsigned bytes) {
  Pdu pdu = with(fields_pdu(23, {address, quantity, address, written}), {bytes});
  for (const std::uint16_t value : values) {
    pdu = with(std::move(pdu), {static_cast<unsigned>(value >> 8U), value & 0xFFU});
  }
  return pdu;
}

void write_before_read(T& trial) {
  const KeptRegisters kept(trial, reg(trial), 1);
  if (!kept.values()) {
    return;
  }
  const std::uint16_t value = kept.turned().front();
  const auto data = trial.accepts(read_write(reg(trial), 1, {value}, 1, 2));
  const Pdu expected = with({}, {2, static_cast<unsigned>(value >> 8U), value & 0xFFU});
  if (data) {
    trial.expect(*data == expected, "what was written, read: " + hex_text(expected),
                 hex_text(*data));
  }
}

struct WritingRow {
  std::uint8_t function;
  const char* section;
  const char* title;
  Strength strength;
  Danger danger;
  void (*run)(T&);
};

void outside(T& trial, Table table, const std::function<Pdu(unsigned address)>& request) {
  const auto address = trial.claims().outside(table);
  if (!address) {
    return trial.not_applicable("the table has every address");
  }
  trial.refuses(request(*address), ExceptionCode::illegal_data_address);
}

const std::array kWritingRows{
    WritingRow{5, "6.5", "A coil is written, and the answer repeats the request", kMust, kWrites,
               write_one_coil},
    WritingRow{5, "6.5", "A value beside 0000 and FF00 is refused, and the coil stays", kMust,
               kWrites, refuse_other_coil_values},
    WritingRow{5, "6.5", "A coil outside the table is refused", kMust, kWrites,
               [](T& t) {
                 outside(t, Table::coils, [](unsigned a) { return fields_pdu(5, {a, 0}); });
               }},
    WritingRow{5, "6.5", "A request that ends within its value is refused", kShould, kWrites,
               [](T& t) {
                 t.refuses(with(fields_pdu(5, {coil(t)}), {0}), ExceptionCode::illegal_data_value);
               }},
    WritingRow{6, "6.6", "A register is written, and the answer repeats the request", kMust,
               kWrites, write_one_register},
    WritingRow{6, "6.6", "A register outside the table is refused", kMust, kWrites,
               [](T& t) {
                 outside(t, Table::holding_registers, [](unsigned a) {
                   return fields_pdu(6, {a, 0});
                 });
               }},
    WritingRow{6, "6.6", "A request that ends within its value is refused, nothing is written",
               kShould, kWrites,
               [](T& t) {
                 refused_unwritten(
                     t, [&](const Values&) { return with(fields_pdu(6, {reg(t)}), {0}); },
                     ExceptionCode::illegal_data_value);
               }},
    WritingRow{15, "6.11", "Coils are written; the answer has address and quantity", kMust, kWrites,
               write_some_coils},
    WritingRow{
        15, "6.11", "A quantity of 0 is refused", kMust, kWrites,
        [](T& t) {
          t.refuses(with(fields_pdu(15, {coil(t), 0}), {0}), ExceptionCode::illegal_data_value);
        }},
    WritingRow{
        15, "6.11", "A quantity above 1968 is refused", kMust, kWrites,
        [](T& t) {
          Pdu request = with(fields_pdu(15, {coil(t), modbus::kWriteCoilsMaximum + 1}), {247});
          request.resize(6 + 247);
          t.refuses(request, ExceptionCode::illegal_data_value);
        }},
    WritingRow{15, "6.11", "A byte count that does not fit the quantity is refused", kMust, kWrites,
               [](T& t) {
                 t.refuses(with(fields_pdu(15, {coil(t), 1}), {2, 0, 0}),
                           ExceptionCode::illegal_data_value);
               }},
    WritingRow{15, "6.11", "Coils outside the table are refused", kMust, kWrites,
               [](T& t) {
                 outside(t, Table::coils, [](unsigned a) {
                   return with(fields_pdu(15, {a, 1}), {1, 0});
                 });
               }},
    WritingRow{
        15, "6.11", "A request with fewer bytes than it counts is refused", kShould, kWrites,
        [](T& t) {
          t.refuses(with(fields_pdu(15, {coil(t), 9}), {2, 0}), ExceptionCode::illegal_data_value);
        }},
    WritingRow{16, "6.12", "Registers are written; the answer has address and quantity", kMust,
               kWrites, write_some_registers},
    WritingRow{16, "6.12", "A quantity of 0 is refused", kMust, kWrites,
               [](T& t) {
                 t.refuses(write_registers(reg(t), {}, 0, 0), ExceptionCode::illegal_data_value);
               }},
    WritingRow{16, "6.12", "A quantity of 124 is refused", kMust, kWrites,
               [](T& t) {
                 Pdu request = with(fields_pdu(16, {reg(t), 124}), {248});
                 request.resize(modbus::kPduMaximum);
                 t.refuses(request, ExceptionCode::illegal_data_value);
               }},
    WritingRow{16, "6.12",
               "A byte count that is not twice the quantity is refused, nothing is written", kMust,
               kWrites,
               [](T& t) {
                 refused_unwritten(
                     t, [&](const Values& turned) { return write_registers(reg(t), turned, 1, 3); },
                     ExceptionCode::illegal_data_value);
               }},
    WritingRow{16, "6.12", "Registers outside the table are refused", kMust, kWrites,
               [](T& t) {
                 outside(t, Table::holding_registers,
                         [](unsigned a) { return write_registers(a, {0}); });
               }},
    WritingRow{16, "6.12",
               "A range that ends outside the table is refused, nothing of it is written", kMust,
               kWrites, partly_outside},
    WritingRow{16, "6.12",
               "A request with fewer bytes than it counts is refused, nothing is written", kShould,
               kWrites,
               [](T& t) {
                 refused_unwritten(
                     t,
                     [&](const Values& turned) {
                       return with(fields_pdu(16, {reg(t), 1}),
                                   {2, static_cast<unsigned>(turned.front() >> 8U)});
                     },
                     ExceptionCode::illegal_data_value);
               }},
    WritingRow{22, "6.16",
               "Bits are set and cleared by the formula; the answer repeats the request", kMust,
               kWrites, mask},
    WritingRow{22, "6.16", "A register outside the table is refused", kMust, kWrites,
               [](T& t) {
                 outside(t, Table::holding_registers, [](unsigned a) {
                   return fields_pdu(22, {a, 0xFFFF, 0});
                 });
               }},
    WritingRow{22, "6.16", "A request that ends within its masks is refused", kShould, kWrites,
               [](T& t) {
                 t.refuses(fields_pdu(22, {reg(t), 0xFFFF}), ExceptionCode::illegal_data_value);
               }},
    WritingRow{23, "6.17", "What is written is read by the same request", kMust, kWrites,
               write_before_read},
    WritingRow{23, "6.17", "Reading none is refused, nothing is written", kMust, kWrites,
               [](T& t) {
                 refused_unwritten(
                     t, [&](const Values& v) { return read_write(reg(t), 0, v, 1, 2); },
                     ExceptionCode::illegal_data_value);
               }},
    WritingRow{23, "6.17", "Reading 126 is refused, nothing is written", kMust, kWrites,
               [](T& t) {
                 refused_unwritten(
                     t, [&](const Values& v) { return read_write(reg(t), 126, v, 1, 2); },
                     ExceptionCode::illegal_data_value);
               }},
    WritingRow{23, "6.17", "Writing none is refused", kMust, kWrites,
               [](T& t) {
                 t.refuses(read_write(reg(t), 1, {}, 0, 0), ExceptionCode::illegal_data_value);
               }},
    WritingRow{23, "6.17", "Writing 122 is refused", kMust, kWrites,
               [](T& t) {
                 Pdu request = read_write(reg(t), 1, {}, 122, 244);
                 request.resize(modbus::kPduMaximum);
                 t.refuses(request, ExceptionCode::illegal_data_value);
               }},
    WritingRow{23, "6.17",
               "A byte count that is not twice the quantity is refused, nothing is written", kMust,
               kWrites,
               [](T& t) {
                 refused_unwritten(
                     t, [&](const Values& v) { return read_write(reg(t), 1, v, 1, 4); },
                     ExceptionCode::illegal_data_value);
               }},
    WritingRow{23, "6.17", "Registers outside the table are refused", kMust, kWrites,
               [](T& t) {
                 outside(t, Table::holding_registers,
                         [](unsigned a) { return read_write(a, 1, {0}, 1, 2); });
               }},
};

struct Written {
  std::uint8_t function;
  const char* section;
  Pdu request;
};

}  // namespace

std::vector<ModbusCase> modbus_writing_cases() {
  std::vector<ModbusCase> all;
  Citations citations("modbus", kApplicationProtocol);
  const std::array<Written, 6> absent{{{5, "6.5", fields_pdu(5, {0, 0})},
                                       {6, "6.6", fields_pdu(6, {0, 0})},
                                       {15, "6.11", with(fields_pdu(15, {0, 1}), {1, 0})},
                                       {16, "6.12", write_registers(0, {0})},
                                       {22, "6.16", fields_pdu(22, {0, 0xFFFF, 0})},
                                       {23, "6.17", read_write(0, 1, {0}, 1, 2)}}};
  for (const Written& function : absent) {
    for (const WritingRow& row : kWritingRows) {
      if (row.function != function.function) {
        continue;
      }
      ModbusCase& made = all.emplace_back();
      made.identity = citations.next(row.section, row.title, row.strength, row.danger);
      const bool coils = row.function == 5 || row.function == 15;
      made.needs.function = row.function;
      made.needs.writable_coils = coils;
      made.needs.writable_registers = !coils;
      made.run = row.run;
    }
    ModbusCase& made = all.emplace_back();
    made.identity =
        citations.next(function.section, "A device without it does not know the function",
                       Strength::must, Danger::writes);
    made.needs.without = function.function;
    made.run = [request = function.request](T& trial) {
      trial.refuses(request, ExceptionCode::illegal_function);
    };
  }
  return all;
}

}  // namespace rigwire::conform
