// Commands that are understood stay within their ranges, whatever a client sends; the splitter
// stays bounded.
#include <cstdint>
#include <cstdlib>
#include <span>

#include "protocols/socketcand/socketcand.h"

namespace socketcand = rigwire::protocols::socketcand;

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  socketcand::ElementSplitter splitter;
  for (const std::uint8_t byte : std::span(data, size)) {
    const auto element = splitter.push(static_cast<char>(byte));
    if (!element) {
      continue;
    }
    require(element->size() <= socketcand::kLongestElement);
    require(element->front() == '<' && element->back() == '>');
    const socketcand::Command command = socketcand::parse_command(*element);
    require(command.frame.length <= 8 && command.interval.count() >= 0);
    require(command.frame.id <= (command.frame.extended ? 0x1FFF'FFFFU : 0x7FFU));
    require(command.masks.size() <= socketcand::kMostMasks);
    const std::string text =
        socketcand::frame_element(command.frame, {}, socketcand::DataStyle::together);
    require(text.front() == '<' && text.back() == '>');
  }
  return 0;
}
