// Functions 1 to 4: MODBUS Application Protocol Specification V1.1b3, sections 6.1 to 6.4 and their
// state diagrams (figures 11 to 14).
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

struct ReadFunction {
  std::uint8_t code;
  Table table;
  std::string_view items;
  unsigned most;  ///< In one request.
};
constexpr std::array<ReadFunction, 4> kReadFunctions{
    {{1, Table::coils, "coils", modbus::kReadBitsMaximum},
     {2, Table::discrete_inputs, "discrete inputs", modbus::kReadBitsMaximum},
     {3, Table::holding_registers, "holding registers", modbus::kReadRegistersMaximum},
     {4, Table::input_registers, "input registers", modbus::kReadRegistersMaximum}}};

bool of_bits(const ReadFunction& function) {
  return function.table == Table::coils || function.table == Table::discrete_inputs;
}

unsigned first_of(const ModbusTrial& trial, const ReadFunction& function) {
  return trial.claims().table(function.table).front().first;
}

/// Whether `count` items from there have been read.
bool read(ModbusTrial& trial, const ReadFunction& function, unsigned address, unsigned count) {
  return of_bits(function) ? trial.bits(function.code, address, count).has_value()
                           : trial.registers(function.code, address, count).has_value();
}

void read_everything(ModbusTrial& trial, const ReadFunction& function) {
  for (const AddressRange& range : trial.claims().table(function.table)) {
    for (std::size_t done = 0; done < range.size(); done += function.most) {
      const auto count =
          static_cast<unsigned>(std::min<std::size_t>(function.most, range.size() - done));
      if (!read(trial, function, range.first + static_cast<unsigned>(done), count)) {
        return;
      }
    }
  }
}

// More than the specification lets a request ask for has exception 3; what it allows has data, or 2
// where the table is shorter.
void ask_for_the_most(ModbusTrial& trial, const ReadFunction& function) {
  const AddressRange& range = trial.claims().table(function.table).front();
  if (range.size() >= function.most) {
    static_cast<void>(read(trial, function, range.first, function.most));
  } else {
    trial.refuses(fields_pdu(function.code, {range.first, function.most}),
                  ExceptionCode::illegal_data_address);
  }
}

void begin_inside_end_outside(ModbusTrial& trial, const ReadFunction& function) {
  for (const AddressRange& range : trial.claims().table(function.table)) {
    if (range.last < 0xFFFF) {
      trial.refuses(fields_pdu(function.code, {range.last, 2}),
                    ExceptionCode::illegal_data_address);
      return;
    }
  }
  trial.not_applicable("the table goes to address 65535");
}

void outside_the_table(ModbusTrial& trial, const ReadFunction& function, unsigned quantity,
                       ExceptionCode code) {
  const auto outside = trial.claims().outside(function.table);
  if (!outside) {
    return trial.not_applicable("the table has every address");
  }
  trial.refuses(fields_pdu(function.code, {*outside, quantity}), code);
}

// What does not change between two reads of a block is the same alone.
void one_by_one(ModbusTrial& trial, const ReadFunction& function) {
  const AddressRange& range = trial.claims().table(function.table).front();
  const auto count = static_cast<unsigned>(std::min<std::size_t>(16, range.size()));
  const auto block = [&](unsigned address, unsigned quantity) {
    std::optional<std::vector<std::uint16_t>> values;
    if (!of_bits(function)) {
      return trial.registers(function.code, address, quantity);
    }
    if (const auto bits = trial.bits(function.code, address, quantity)) {
      values.emplace(bits->begin(), bits->end());
    }
    return values;
  };
  const auto before = block(range.first, count);
  std::vector<std::uint16_t> alone;
  for (unsigned i = 0; before && i < count; ++i) {
    const auto value = block(range.first + i, 1);
    if (!value) {
      return;
    }
    alone.push_back(value->front());
  }
  const auto after = before ? block(range.first, count) : std::nullopt;
  for (std::size_t i = 0; after && i < alone.size(); ++i) {
    trial.expect((*before)[i] != (*after)[i] || alone[i] == (*before)[i],
                 "each item alone as in the block",
                 "address " + std::to_string(range.first + i) + ": " + std::to_string(alone[i]) +
                     " alone, " + std::to_string((*before)[i]) + " in the block");
  }
}

std::vector<ModbusCase> cases_of(const ReadFunction& function) {
  const std::string section = "6." + std::to_string(function.code);
  const std::string items(function.items);
  std::vector<ModbusCase> cases;
  Citations citations("modbus", kApplicationProtocol);
  const auto add = [&](std::string title, Strength strength,
                       void (*run)(ModbusTrial&, const ReadFunction&)) {
    ModbusCase& made = cases.emplace_back();
    made.identity = citations.next(section, std::move(title), strength);
    made.needs.function = function.code;
    made.run = [run, &function](ModbusTrial& trial) { run(trial, function); };
  };
  using F = ReadFunction;
  const std::string most = std::to_string(function.most);
  add("One of the " + items + ", the first", Strength::must,
      [](T& t, const F& f) { static_cast<void>(read(t, f, first_of(t, f), 1)); });
  add("All claimed " + items + ", as many at once as a request holds", Strength::must,
      read_everything);
  add("The last of the " + items + " alone", Strength::must, [](T& t, const F& f) {
    static_cast<void>(read(t, f, t.claims().table(f.table).back().last, 1));
  });
  add("Each of the " + items + " alone as in a block", Strength::must, one_by_one);
  add("A quantity of 0 is refused", Strength::must, [](T& t, const F& f) {
    t.refuses(fields_pdu(f.code, {first_of(t, f), 0}), ExceptionCode::illegal_data_value);
  });
  add("A quantity of " + most + " is not refused for being too large", Strength::must,
      ask_for_the_most);
  add("A quantity of one more than " + most + " is refused", Strength::must, [](T& t, const F& f) {
    t.refuses(fields_pdu(f.code, {first_of(t, f), f.most + 1}), ExceptionCode::illegal_data_value);
  });
  add("A quantity of 65535 is refused", Strength::must, [](T& t, const F& f) {
    t.refuses(fields_pdu(f.code, {first_of(t, f), 0xFFFF}), ExceptionCode::illegal_data_value);
  });
  add("An address outside the table is refused", Strength::must,
      [](T& t, const F& f) { outside_the_table(t, f, 1, ExceptionCode::illegal_data_address); });
  add("A range that begins in the table and ends outside is refused as a whole", Strength::must,
      begin_inside_end_outside);
  add("A range past address 65535 is refused", Strength::must, [](T& t, const F& f) {
    t.refuses(fields_pdu(f.code, {0xFFFF, 2}), ExceptionCode::illegal_data_address);
  });
  add("The quantity is looked at before the address", Strength::should,
      [](T& t, const F& f) { outside_the_table(t, f, 0, ExceptionCode::illegal_data_value); });
  add("A request that ends within its quantity is refused", Strength::should, [](T& t, const F& f) {
    t.refuses(with(fields_pdu(f.code, {first_of(t, f)}), {0}), ExceptionCode::illegal_data_value);
  });
  add("A request with a byte too many is refused", Strength::should, [](T& t, const F& f) {
    t.refuses(with(fields_pdu(f.code, {first_of(t, f), 1}), {0}),
              ExceptionCode::illegal_data_value);
  });
  add("A device without " + items + " does not know the function", Strength::must,
      [](T& t, const F& f) {
        t.refuses(fields_pdu(f.code, {0, 1}), ExceptionCode::illegal_function);
      });
  cases.back().needs = {.without = function.code};
  return cases;
}

}  // namespace

std::vector<ModbusCase> modbus_reading_cases() {
  std::vector<ModbusCase> all;
  for (const ReadFunction& function : kReadFunctions) {
    std::ranges::move(cases_of(function), std::back_inserter(all));
  }
  return all;
}

}  // namespace rigwire::conform
