// The web face of a device: requests and responses as HTTP has them, without its bytes. The server
// that carries them is a driver (drivers/http_server.h).
#pragma once

#include <string>
#include <string_view>

#include "sim/samples/time.h"

namespace rigwire::emulators {

struct WebRequest {
  std::string method;  ///< "GET", "POST", … as received.
  std::string target;  ///< Path with query, as received: "/cgi/status.json".
  std::string body;
};

struct WebResponse {
  int status = 200;
  std::string content_type;  ///< Empty: no header and no body.
  std::string body;
  std::string allow;   ///< With status 405: the methods that the target has, "GET, HEAD".
  bool close = false;  ///< The connection ends after this response.
};

class WebDevice {
 public:
  virtual ~WebDevice() = default;
  /// The answer to one request that is complete at `now`. Times never decrease.
  [[nodiscard]] virtual WebResponse answer(SimTime now, const WebRequest& request) = 0;
};

}  // namespace rigwire::emulators
