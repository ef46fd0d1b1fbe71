// What `rigwire campaign` does, apart from parsing its options.
#pragma once

#include <string>

#include "hil/command_line/verbs.h"

namespace rigwire::hil {

/// Returns the exit code. Throws ConfigurationError and what run() throws.
[[nodiscard]] int campaign_verb(const CampaignRequest& request, Terminal terminal);

/// Returns the JSON Schema of a campaign's file.
[[nodiscard]] std::string campaign_schema();

}  // namespace rigwire::hil
