// The forms by which a client changes the sensor's settings: which fields each path takes, and what
// is allowed in them (web_interface.h has the list).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "emulators/velodyne/velodyne_control.h"

namespace rigwire::emulators {

/// "/cgi/setting", "/cgi/setting/fov" and so on.
[[nodiscard]] bool is_settings_form(std::string_view path);

/// Changes `live` by the fields of `body`. Returns what is wrong with them, naming field, value and
/// what is allowed; `live` is then to be thrown away. Precondition: is_settings_form(path).
[[nodiscard]] std::optional<std::string> apply_form(std::string_view path, std::string_view body,
                                                    VelodyneLiveSettings& live);

}  // namespace rigwire::emulators
