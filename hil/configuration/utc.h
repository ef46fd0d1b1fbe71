// Calendar time as a file writes it.
#pragma once

#include "fields/visitor.h"
#include "sim/samples/calendar.h"

namespace rigwire::hil {

/// "2026-06-01T08:00:00Z". Refers to `time`, which must outlive it.
[[nodiscard]] fields::Spelling utc_spelling(UtcTime& time);

}  // namespace rigwire::hil
