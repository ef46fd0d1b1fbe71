// Every line that parses writes back to a line that parses to the same; the splitter stays bounded.
// What a client may set (filters, timing registers) is defined for every value.
#include <cstdint>
#include <cstdlib>
#include <span>

#include "protocols/slcan/acceptance_filter.h"
#include "protocols/slcan/bit_rate.h"
#include "protocols/slcan/slcan.h"

namespace slcan = rigwire::protocols::slcan;

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

static slcan::AcceptanceFilter take_setting(slcan::AcceptanceFilter filter,
                                            const slcan::Command& command) {
  switch (command.verb) {
    case slcan::Verb::acceptance_code:
      filter.code = command.number;
      break;
    case slcan::Verb::acceptance_mask:
      filter.mask = command.number;
      break;
    case slcan::Verb::filter_mode:
      filter.single = command.number != 0;
      break;
    case slcan::Verb::bit_timing:
      if (const auto rate = slcan::rate_of_registers(static_cast<std::uint16_t>(command.number))) {
        require(*rate >= 5'000 && *rate <= 1'000'000);
      }
      break;
    default:
      break;
  }
  return filter;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  slcan::LineSplitter splitter;
  slcan::AcceptanceFilter filter;
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
      filter = take_setting(filter, *command);
    }
    if (const auto reply = slcan::parse_reply(line->text); reply.ok()) {
      require(reply.consumed() == line->text.size());
      if (reply->kind == slcan::ReplyKind::bus_state ||
          reply->kind == slcan::ReplyKind::bus_errors) {
        const auto report = slcan::report_of(*reply);
        require(slcan::state_line(report) || slcan::error_line(report) || reply->number == 0);
      }
      if (reply->kind == slcan::ReplyKind::frame) {
        require(reply->frame.length <= 8);
        require(slcan::AcceptanceFilter{}.accepts(reply->frame));
        (void)filter.accepts(reply->frame);
        const slcan::Text text = slcan::write_reply(*reply);
        const auto again = slcan::parse_reply(text.span().first(text.size - 1));
        require(again.ok() && *again == *reply);
      }
    }
  }
  return 0;
}
