// The other side of the control server's door, for the command line: one request, one answer.
#pragma once

#include <string>

#include "hil/control/control_server.h"

namespace rigwire::hil {

struct ControlAnswer {
  int status = 0;  ///< HTTP status; control_server.h lists them.
  std::string body;
};

/// Sends a request of commands.h, as JSON or YAML, and waits for its answer without a time limit.
/// `token` is ignored on a Unix socket. Throws drivers::EndpointError when there is no answer.
[[nodiscard]] ControlAnswer ask_control(const ControlEndpoint& endpoint, const std::string& token,
                                        const std::string& request);

}  // namespace rigwire::hil
