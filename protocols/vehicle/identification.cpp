#include "protocols/vehicle/identification.h"

namespace rigwire::protocols::vehicle {
namespace {

constexpr char kDelimiter = '*';

void put(Identification& to, char character) {
  if (to.size < to.bytes.size()) {
    to.bytes[to.size++] = static_cast<std::uint8_t>(character);
  }
}

void put(Identification& to, std::initializer_list<std::string_view> fields) {
  for (const std::string_view field : fields) {
    for (const char character : field) {
      const bool printable = character >= ' ' && character <= '~' && character != kDelimiter;
      put(to, printable ? character : '_');
    }
    put(to, kDelimiter);
  }
}

}  // namespace

Identification make_identification(std::initializer_list<std::string_view> fields) {
  Identification identification;
  put(identification, fields);
  return identification;
}

Identification make_software_identification(std::initializer_list<std::string_view> fields) {
  Identification identification;
  put(identification, static_cast<char>(fields.size()));
  put(identification, fields);
  return identification;
}

}  // namespace rigwire::protocols::vehicle
