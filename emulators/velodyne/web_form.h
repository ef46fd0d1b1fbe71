// The forms by which a client changes the sensor's settings: their bodies, which are
// application/x-www-form-urlencoded (URL Standard, section 5.1), "laser=on&rpm=600", which fields
// each path takes, and what is allowed in them (web_interface.h has the list).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "emulators/velodyne/velodyne_control.h"

namespace rigwire::emulators {

struct FormField {
  std::string name;
  std::string value;

  friend bool operator==(const FormField&, const FormField&) = default;
};

/// The fields in their order; a field without "=" has an empty value; empty pieces between "&" are
/// none. Nothing when an escape is not two hexadecimal digits, or hides a control character.
[[nodiscard]] std::optional<std::vector<FormField>> parse_form(std::string_view body);

/// "on" and "off" in any case.
[[nodiscard]] std::optional<bool> parse_switch(std::string_view text);

/// Decimal digits alone, from `lower` to `upper`.
[[nodiscard]] std::optional<int> parse_number(std::string_view text, int lower, int upper);

/// An IPv4 address of four decimal numbers.
[[nodiscard]] bool is_ipv4_address(std::string_view text);

/// Equal but for the case of ASCII letters.
[[nodiscard]] bool same_word(std::string_view a, std::string_view b);

/// "/cgi/setting", "/cgi/setting/fov" and so on.
[[nodiscard]] bool is_settings_form(std::string_view path);

/// Changes `live` by the fields of `body`. Returns what is wrong with them, naming field, value and
/// what is allowed; `live` is then to be thrown away. Precondition: is_settings_form(path).
[[nodiscard]] std::optional<std::string> apply_form(std::string_view path, std::string_view body,
                                                    VelodyneLiveSettings& live);

}  // namespace rigwire::emulators
