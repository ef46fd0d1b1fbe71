#include "hil/configuration/utc.h"

namespace rigwire::hil {

fields::Spelling utc_spelling(UtcTime& time) {
  return {.type = "UTC",
          .allowed = "UTC like 2026-06-01T08:00:00Z",
          .print = [&time] { return format_utc(time); },
          .parse =
              [&time](const std::string& text) {
                const UtcTime parsed = parse_utc(text);
                static_cast<void>(Calendar(parsed));  // throws beyond what it can count
                time = parsed;
              }};
}

}  // namespace rigwire::hil
