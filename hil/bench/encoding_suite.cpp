#include <fmt/format.h>

#include "hil/bench/encoding_bench.h"
#include "hil/bench/suites.h"

namespace rigwire::hil {

nlohmann::json bench_encoding(std::ostream& text) {
  nlohmann::json json;
  text << fmt::format("{:<24} {:<16} {:>6} {:>8} {:>12} {:>12} {:>9}  {}\n", "message", "wire",
                      "bytes", "ns", "per second", "wire limit", "ratio", "error after decoding");
  for (const MessageCost& cost : measure_messages()) {
    const double ratio = cost.per_second / cost.wire_limit_per_second;
    std::string error = fmt::format("{:.3g} {}", cost.worst_error, cost.error_unit);
    if (cost.half_count > 0.0) {
      error += fmt::format(", half a count is {:.3g}", cost.half_count);
    }
    text << fmt::format("{:<24} {:<16} {:>6} {:>8.1f} {:>12.0f} {:>12.0f} {:>8.0f}x  {}\n",
                        cost.message, cost.wire, cost.bytes, cost.nanoseconds, cost.per_second,
                        cost.wire_limit_per_second, ratio, error);
    json["messages"].push_back({{"message", cost.message},
                                {"wire", cost.wire},
                                {"bytes", cost.bytes},
                                {"ns", cost.nanoseconds},
                                {"per_second", cost.per_second},
                                {"wire_limit_per_second", cost.wire_limit_per_second},
                                {"ratio", ratio},
                                {"worst_error", cost.worst_error},
                                {"error_unit", cost.error_unit},
                                {"half_count", cost.half_count}});
  }
  return json;
}

}  // namespace rigwire::hil
