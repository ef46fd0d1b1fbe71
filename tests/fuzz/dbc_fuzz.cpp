// Any text is read as a DBC file or refused, and what is read can be asked and coded.
#include <array>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "protocols/dbc/dbc_reader.h"

namespace can = rigwire::protocols::can;
namespace dbc = rigwire::protocols::dbc;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const dbc::Reading reading =
      dbc::read(std::string_view(reinterpret_cast<const char*>(data), size));
  for (const dbc::FileMessage& message : reading.content.messages) {
    if (message.signals.size() != message.layout.signals.size()) {
      std::abort();
    }
    std::vector<std::string_view> used;
    for (const can::OwnedSignal& signal : message.layout.signals) {
      used.emplace_back(signal.name);
    }
    const auto findings = dbc::faults_of(message, used);
    std::array<std::uint8_t, 8> payload{0xA5, 0x5A};
    for (std::size_t i = 0; i < message.layout.signals.size(); ++i) {
      const can::Reading value = can::get(message.layout, i, payload);
      can::put(message.layout.signals[i], payload, value.number());
    }
  }
  return 0;
}
