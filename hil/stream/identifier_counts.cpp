#include "hil/stream/identifier_counts.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hil/stream/wire_reading.h"

namespace rigwire::hil {

using Json = nlohmann::ordered_json;

std::string identifier_text(const protocols::can::Frame& frame) {
  return fmt::format("{:0{}X}", frame.id, frame.extended ? 8 : 3);
}

void IdentifierCounts::take(const protocols::can::Frame& frame, bool of_client) {
  // In arbitration the eleven highest bits come first, and of equal ones those without extension.
  const std::uint32_t highest = frame.extended ? frame.id : frame.id << 18U;
  Identifier& identifier = identifiers_[{highest, frame.extended}];
  ++identifier.count;
  identifier.newest = frame;
  identifier.of_client = of_client;
}

std::string IdentifierCounts::json(std::span<const protocols::can::OwnedMessage> messages) const {
  Json list = Json::array();
  for (const auto& [key, identifier] : identifiers_) {
    list.push_back({{"id", identifier_text(identifier.newest)},
                    {"count", identifier.count},
                    {"size", identifier.newest.payload().size()},
                    {"from", identifier.of_client ? "client" : "device"},
                    {"text", read_frame(identifier.newest, messages).text}});
  }
  return Json{{"identifiers", std::move(list)}}.dump(-1, ' ', false,
                                                     Json::error_handler_t::replace);
}

}  // namespace rigwire::hil
