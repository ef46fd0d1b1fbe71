#include "hil/files/valve_map_file.h"

#include <fmt/format.h>

#include <map>
#include <stdexcept>
#include <utility>

#include "fields/visitor.h"
#include "hil/configuration/document.h"
#include "hil/configuration/reader.h"

namespace rigwire::hil {

using namespace emulators;

namespace {

/// Keeps the reader from checking the map as a whole: its faults belong to single registers.
struct ValveMapFile {
  ValveMap map;
};

inline void visit(fields::Visitor& v, ValveMapFile& p) {
  visit(v, p.map);
}

void check_registers(const ValveMap& map, const Origins& origins, Problems& problems) {
  std::map<std::pair<ModbusTable, unsigned>, std::string> owners;
  for (std::size_t i = 0; i < map.registers.size(); ++i) {
    const ValveRegister& entry = map.registers[i];
    const std::string path = fmt::format("registers.{}", i);
    const auto report = [&](const std::string& key, const std::string& what) {
      problems.add(
          {origins.nearest(path + key), path + key, what, "\"" + entry.name + "\"", {}, {}});
    };
    const bool writable_table =
        entry.table == ModbusTable::coils || entry.table == ModbusTable::holding_registers;
    if (const std::string fault = fault_of(entry, writable_table); !fault.empty()) {
      report("", fault);
      continue;
    }
    for (unsigned address : addresses_of(entry)) {
      const auto [owner, fresh] = owners.emplace(std::pair(entry.table, address), entry.name);
      if (!fresh) {
        report(".address", fmt::format("{} address {} belongs to \"{}\" already",
                                       name_of(entry.table), address, owner->second));
        break;
      }
    }
  }
}

ValveMap read_valve_map(const Value& document, Problems problems) {
  ValveMapFile file;
  Origins origins;
  if (problems.empty()) {
    read(document, file, problems, origins);
  }
  if (problems.empty()) {
    check_registers(file.map, origins, problems);
  }
  if (problems.empty()) {
    try {
      validate(file.map);
    } catch (const std::invalid_argument& error) {
      problems.add({document.where, "", error.what(), {}, {}, {}});
    }
  }
  problems.throw_if_any();
  return file.map;
}

}  // namespace

ValveMap load_valve_map(const std::string& file) {
  Problems problems;
  const Value document = load_document(file, problems);
  return read_valve_map(document, std::move(problems));
}

ValveMap parse_valve_map(const std::string& text, const std::string& name) {
  Problems problems;
  const Value document = parse_document(text, name, ".", problems);
  return read_valve_map(document, std::move(problems));
}

}  // namespace rigwire::hil
