// Every line that parses writes back to a line that parses to the same; the splitter stays bounded.
#include <cstdint>
#include <cstdlib>
#include <span>

#include "protocols/slcan/slcan.h"

namespace slcan = rigwire::protocols::slcan;

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  slcan::LineSplitter splitter;
  for (const std::uint8_t byte : std::span(data, size)) {
    const auto line = splitter.push(byte);
    if (!line) {
      continue;
    }
    require(line->text.size() <= slcan::kLongestLine);
    if (const auto command = slcan::parse_command(line->text); command.ok()) {
      require(command.consumed() == line->text.size());
      const slcan::Text text = slcan::write_command(*command);
      const auto again = slcan::parse_command(text.span().first(text.size - 1));
      require(again.ok() && *again == *command);
    }
    if (const auto reply = slcan::parse_reply(line->text); reply.ok()) {
      require(reply.consumed() == line->text.size());
      if (reply->kind == slcan::ReplyKind::frame) {
        require(reply->frame.length <= 8);
        const slcan::Text text = slcan::write_reply(*reply);
        const auto again = slcan::parse_reply(text.span().first(text.size - 1));
        require(again.ok() && *again == *reply);
      }
    }
  }
  return 0;
}
