// Descriptors of any device: what a reader makes of them lies inside them.
#include <cstdint>
#include <cstdlib>

#include "protocols/usb/descriptor_reader.h"
#include "protocols/usb/descriptors.h"

namespace {

using namespace rigwire::protocols::usb;

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span bytes(data, size);
  const auto device = decode_device(bytes);
  require(device.consumed() <= size);
  const auto configuration = decode_configuration(bytes);
  require(configuration.consumed() <= size);
  require(!configuration.incomplete() || configuration.shortage().needed > size);
  if (configuration.ok()) {
    std::size_t counted = kConfigurationDescriptorSize + configuration->extra.size();
    for (const InterfaceDescriptor& interface : configuration->interfaces) {
      counted += kInterfaceDescriptorSize + interface.interface.extra.size() +
                 interface.interface.endpoints.size() * kEndpointDescriptorSize;
    }
    require(counted <= configuration.consumed());
  }
  const auto text = decode_text(bytes);
  require(text.consumed() <= size);
  if (text.ok()) {
    require(utf16_from_utf8(*text).has_value());
  }
  return 0;
}
