#include <fmt/format.h>

#include "bench/encoding_bench.h"
#include "bench/suites.h"
#include "bench/table.h"

namespace rigwire::bench {

nlohmann::json bench_encoding(std::ostream& text) {
  nlohmann::json json;
  const Table table(text, {{"message", "<24"},
                           {"wire", "<16"},
                           {"bytes", ">6"},
                           {"ns", ">8"},
                           {"per second", ">12"},
                           {"wire limit", ">12"},
                           {"ratio", ">9"},
                           {" error after decoding", ""}});
  table.head();
  for (const MessageCost& cost : measure_messages()) {
    const double ratio = cost.per_second / cost.wire_limit_per_second;
    std::string error = fmt::format(" {:.3g} {}", cost.worst_error, cost.error_unit);
    if (cost.half_count > 0.0) {
      error += fmt::format(", half a count is {:.3g}", cost.half_count);
    }
    json["messages"].push_back(table.row(
        {word("message", cost.message), word("wire", cost.wire), count("bytes", cost.bytes),
         number("ns", cost.nanoseconds, "{:.1f}"), number("per_second", cost.per_second, "{:.0f}"),
         number("wire_limit_per_second", cost.wire_limit_per_second, "{:.0f}"),
         number("ratio", ratio, "{:.0f}x"), shown(error), stored("worst_error", cost.worst_error),
         stored("error_unit", cost.error_unit), stored("half_count", cost.half_count)}));
  }
  return json;
}

}  // namespace rigwire::bench
