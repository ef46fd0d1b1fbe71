#include "protocols/iso11783/functionalities.h"

#include "protocols/vehicle/message.h"

namespace rigwire::protocols::iso11783 {

std::vector<std::uint8_t> make_functionalities(std::span<const SupportedFunctionality> supported) {
  std::vector<std::uint8_t> payload{0xFF, static_cast<std::uint8_t>(supported.size())};
  for (const SupportedFunctionality& one : supported) {
    payload.push_back(static_cast<std::uint8_t>(one.functionality));
    payload.push_back(one.generation);
    payload.push_back(static_cast<std::uint8_t>(one.options.size()));
    payload.insert(payload.end(), one.options.begin(), one.options.end());
  }
  while (payload.size() < vehicle::kMessageBytes) {
    payload.push_back(0xFF);
  }
  return payload;
}

}  // namespace rigwire::protocols::iso11783
