#include "protocols/canopen/eds.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <string_view>
#include <vector>

#include "protocols/canopen/communication_objects.h"

namespace rigwire::protocols::canopen {
namespace {

/// CiA 306, 7.1: object types.
constexpr unsigned kVariable = 7;
constexpr unsigned kArray = 8;
constexpr unsigned kRecord = 9;

struct Compound {
  std::uint16_t index;
  unsigned type;
  std::string_view name;
};
/// Objects with sub-indices; the table of entries has their parts only.
constexpr std::array kCompounds{Compound{0x1003, kArray, "Pre-defined error field"},
                                Compound{0x1010, kArray, "Store parameters"},
                                Compound{0x1011, kArray, "Restore default parameters"},
                                Compound{0x1018, kRecord, "Identity object"},
                                Compound{0x1200, kRecord, "SDO server parameter"},
                                Compound{0x1800, kRecord, "TPDO1 communication parameter"},
                                Compound{0x1801, kRecord, "TPDO2 communication parameter"},
                                Compound{0x1A00, kRecord, "TPDO1 mapping parameter"},
                                Compound{0x1A01, kRecord, "TPDO2 mapping parameter"},
                                Compound{0x6030, kArray, "Speed value"}};

constexpr std::array<std::uint16_t, 3> kMandatory{0x1000, 0x1001, 0x1018};

std::string hex(std::uint64_t value, int digits) {
  std::array<char, 20> text{};
  std::snprintf(text.data(), text.size(), "%0*llX", digits, static_cast<unsigned long long>(value));
  return text.data();
}

class File {
 public:
  void section(const std::string& name) {
    text_ += (text_.empty() ? "[" : "\r\n[") + name + "]\r\n";
  }
  void line(std::string_view key, const std::string& value) {
    text_.append(key).append("=").append(value).append("\r\n");
  }
  void number(std::string_view key, std::uint64_t value) { line(key, std::to_string(value)); }
  void hexadecimal(std::string_view key, std::uint64_t value, int digits) {
    line(key, "0x" + hex(value, digits));
  }
  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

/// A number as its type has it: signed ones in decimal, which every reader takes the same way.
std::string value_text(const ObjectEntry& entry, std::int64_t value) {
  return is_signed(entry.type) ? std::to_string(value)
                               : "0x" + hex(static_cast<std::uint64_t>(value),
                                            static_cast<int>(2 * size_of(entry.type)));
}

void write_entry(File& file, const std::string& section, const ObjectEntry& entry,
                 const EdsDefault& at_delivery) {
  file.section(section);
  file.line("ParameterName", std::string(entry.name));
  file.hexadecimal("ObjectType", kVariable, 1);
  file.hexadecimal("DataType", static_cast<std::uint8_t>(entry.type), 4);
  constexpr std::array<const char*, 3> kAccess{"const", "ro", "rw"};
  file.line("AccessType", kAccess[static_cast<std::size_t>(entry.access)]);
  file.line("DefaultValue", at_delivery(entry));
  file.line("PDOMapping", entry.has(EntryFlag::kMappable) ? "1" : "0");
  const auto bits = static_cast<unsigned>(8 * size_of(entry.type));
  if (entry.access == Access::read_write && bits != 0) {
    const std::int64_t least = is_signed(entry.type) ? -(std::int64_t{1} << (bits - 1)) : 0;
    const std::int64_t most = (std::int64_t{1} << (is_signed(entry.type) ? bits - 1 : bits)) - 1;
    if (entry.lower > least || entry.upper < most) {
      file.line("LowLimit", value_text(entry, entry.lower));
      file.line("HighLimit", value_text(entry, entry.upper));
    }
  }
}

void write_list(File& file, const std::string& section, const std::vector<std::uint16_t>& indices) {
  file.section(section);
  file.number("SupportedObjects", indices.size());
  for (std::size_t i = 0; i < indices.size(); ++i) {
    file.hexadecimal(std::to_string(i + 1), indices[i], 4);
  }
}

void write_objects(File& file, std::span<const ObjectEntry> table,
                   const std::vector<std::uint16_t>& indices, const EdsDefault& at_delivery) {
  for (const std::uint16_t index : indices) {
    const auto of_index = [index](const ObjectEntry& entry) {
      return entry.address.index == index;
    };
    const auto first = std::ranges::find_if(table, of_index);
    const auto parts = std::ranges::count_if(table, of_index);
    const auto* const compound = std::ranges::find(kCompounds, index, &Compound::index);
    if (parts == 1 && compound == kCompounds.end()) {
      write_entry(file, hex(index, 4), *first, at_delivery);
      continue;
    }
    file.section(hex(index, 4));
    file.line("ParameterName", compound == kCompounds.end() ? "Object " + hex(index, 4)
                                                            : std::string(compound->name));
    file.hexadecimal("ObjectType", compound == kCompounds.end() ? kRecord : compound->type, 1);
    file.number("SubNumber", static_cast<std::uint64_t>(parts));
    for (const ObjectEntry& entry : std::span(first, static_cast<std::size_t>(parts))) {
      write_entry(file, hex(index, 4) + "sub" + hex(entry.address.sub, 1), entry, at_delivery);
    }
  }
}

}  // namespace

std::string make_eds(const EdsDevice& device, std::span<const ObjectEntry> table,
                     const EdsDefault& at_delivery) {
  File file;
  file.section("FileInfo");
  file.line("FileName", device.file);
  file.line("FileVersion", "1");
  file.line("FileRevision", "0");
  file.line("EDSVersion", "4.0");
  file.line("Description", device.description);
  file.line("CreationTime", "00:00AM");
  file.line("CreationDate", "01-01-2026");
  file.line("CreatedBy", device.vendor_name);
  file.section("DeviceInfo");
  file.line("VendorName", device.vendor_name);
  file.hexadecimal("VendorNumber", device.vendor, 8);
  file.line("ProductName", device.product_name);
  file.hexadecimal("ProductNumber", device.product, 8);
  file.hexadecimal("RevisionNumber", device.revision, 8);
  file.line("OrderCode", device.product_name);
  for (const char* rate_kbps : {"10", "20", "50", "125", "250", "500", "800", "1000"}) {
    file.line(std::string("BaudRate_") + rate_kbps, "1");
  }
  file.line("SimpleBootUpMaster", "0");
  file.line("SimpleBootUpSlave", "1");
  file.line("Granularity", "8");
  file.line("DynamicChannelsSupported", "0");
  file.line("GroupMessaging", "0");
  file.line("NrOfRXPDO", "0");
  file.number("NrOfTXPDO", kTransmitPdos);
  file.line("LSS_Supported", "1");
  file.section("DummyUsage");
  for (char type = '1'; type <= '7'; ++type) {
    file.line(std::string("Dummy000") + type, "0");
  }
  file.section("Comments");
  file.line("Lines", "0");

  constexpr std::uint16_t kFirstOfMaker = 0x2000;
  constexpr std::uint16_t kFirstOfProfile = 0x6000;
  std::vector<std::uint16_t> mandatory;
  std::vector<std::uint16_t> optional;
  std::vector<std::uint16_t> makers;
  for (const ObjectEntry& entry : table) {
    const std::uint16_t index = entry.address.index;
    auto& list = std::ranges::find(kMandatory, index) != kMandatory.end() ? mandatory
                 : index >= kFirstOfMaker && index < kFirstOfProfile      ? makers
                                                                          : optional;
    if (list.empty() || list.back() != index) {
      list.push_back(index);
    }
  }
  const std::array lists{std::pair{"MandatoryObjects", &mandatory},
                         std::pair{"OptionalObjects", &optional},
                         std::pair{"ManufacturerObjects", &makers}};
  for (const auto& [name, indices] : lists) {
    write_list(file, name, *indices);
    write_objects(file, table, *indices, at_delivery);
  }
  return file.take();
}

}  // namespace rigwire::protocols::canopen
