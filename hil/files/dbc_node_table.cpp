#include "hil/files/dbc_node_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "emulators/dbc_node/quantities.h"
#include "fields/units.h"
#include "fields/visitor.h"

namespace rigwire::hil {

namespace can = protocols::can;
using emulators::NamedQuantity;

std::string markdown_table(const DbcNodeDescription& device) {
  std::string text =
      "| message | identifier | when | signal | bits | step | unit | shows or moves |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- |\n";
  const auto head = [](const can::OwnedMessage& layout) {
    return fmt::format("| `{}` | 0x{:0{}X} |", layout.name, layout.id, layout.extended ? 8 : 3);
  };
  const auto bits = [](const can::OwnedSignal& row) {
    return fmt::format("`{}` | {}\\|{}{} | {}{} | {} |", row.name, row.bit, row.width,
                       row.order == can::ByteOrder::little_endian ? "" : " Motorola",
                       fields::shortest(row.scale),
                       row.offset == 0.0 ? "" : fmt::format(" {:+g}", row.offset), row.unit);
  };
  const auto name = [&](std::span<const NamedQuantity> among, std::size_t index) {
    const auto found = std::ranges::find_if(among, [&](const NamedQuantity& quantity) {
      return quantity.attachment == device.attachment && quantity.index == index;
    });
    return found == among.end() ? std::string() : found->full_name();
  };
  for (const emulators::DbcSentMessage& sent : device.settings.sent) {
    std::string when =
        sent.period > Duration{0} ? "every " + fields::print_duration(sent.period.count()) : "";
    for (const auto& [is_it, word] :
         {std::pair{sent.on_change, "on change"}, std::pair{sent.on_request, "on request"},
          std::pair{sent.after.has_value(), "after another"}}) {
      when += is_it ? (when.empty() ? "" : ", ") + std::string(word) : "";
    }
    for (std::size_t s = 0; s < sent.shows.size(); ++s) {
      const emulators::DbcSource& source = sent.shows[s].source;
      std::string shows = fmt::format("0x{:X}", sent.shows[s].start_raw);
      if (const auto* measured = std::get_if<emulators::DbcMeasured>(&source)) {
        shows =
            name(emulators::measured_quantities(), device.settings.measured[measured->quantity]);
      } else if (std::holds_alternative<emulators::DbcCounter>(source)) {
        shows = "counter";
      } else if (std::holds_alternative<emulators::DbcSum>(source)) {
        shows = "checksum";
      } else if (std::holds_alternative<emulators::DbcEcho>(source)) {
        shows = "echo";
      }
      text += fmt::format("{} {} | {} {} |\n", head(sent.layout), when,
                          bits(sent.layout.signals[s]), shows);
    }
  }
  for (const emulators::DbcTakenMessage& taken : device.settings.taken) {
    for (std::size_t s = 0; s < taken.uses.size(); ++s) {
      if (const auto* move = std::get_if<emulators::DbcMove>(&taken.uses[s])) {
        text +=
            fmt::format("{} taken | {} {} |\n", head(taken.layout), bits(taken.layout.signals[s]),
                        name(emulators::moved_quantities(), device.settings.moved[move->quantity]));
      }
    }
  }
  return text;
}

}  // namespace rigwire::hil
