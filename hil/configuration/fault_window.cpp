#include "hil/configuration/fault_window.h"

#include <fmt/format.h>

#include "sim/random.h"

namespace rigwire::hil {

FaultWindow fault_window(std::string_view where, std::string name, const FaultPeriod& when) {
  FaultWindow window{std::string(where), std::move(name), when.begin(), when.end(), {}};
  if (when.waits()) {
    window.waits_for = fmt::format("{} {} {:g}", when.when.quantity,
                                   when.when.above ? "above" : "below", when.when.value);
  }
  return window;
}

std::uint64_t fault_stream(std::uint64_t seed, std::string_view where, std::string_view name,
                           Duration at) {
  return sim::RandomStream(seed, fmt::format("{}/faults/{}/{}", where, name, at.count())).bits();
}

}  // namespace rigwire::hil
