#include "emulators/velodyne/web_form.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <span>
#include <utility>

namespace rigwire::emulators {
namespace {

char lower_case(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

std::optional<std::string> decode(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '+') {
      c = ' ';
    } else if (c == '%') {
      unsigned code = 0;
      const std::string_view digits = text.substr(i + 1, 2);
      const auto [end, error] =
          std::from_chars(digits.data(), digits.data() + digits.size(), code, 16);
      if (digits.size() != 2 || error != std::errc() || end != digits.data() + 2) {
        return std::nullopt;
      }
      c = static_cast<char>(code);
      i += 2;
    }
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F) {
      return std::nullopt;
    }
    decoded += c;
  }
  return decoded;
}

}  // namespace

std::optional<std::vector<FormField>> parse_form(std::string_view body) {
  while (body.ends_with('\n') || body.ends_with('\r')) {  // what a script's `echo` leaves behind
    body.remove_suffix(1);
  }
  std::vector<FormField> fields;
  while (!body.empty()) {
    const std::size_t end = std::min(body.find('&'), body.size());
    const std::string_view piece = body.substr(0, end);
    body.remove_prefix(std::min(end + 1, body.size()));
    if (piece.empty()) {
      continue;
    }
    const std::size_t equals = std::min(piece.find('='), piece.size());
    auto name = decode(piece.substr(0, equals));
    auto value = decode(piece.substr(std::min(equals + 1, piece.size())));
    if (!name || !value) {
      return std::nullopt;
    }
    fields.push_back({std::move(*name), std::move(*value)});
  }
  return fields;
}

std::optional<bool> parse_switch(std::string_view text) {
  if (same_word(text, "on")) {
    return true;
  }
  if (same_word(text, "off")) {
    return false;
  }
  return std::nullopt;
}

std::optional<int> parse_number(std::string_view text, int lower, int upper) {
  int value = 0;
  const bool digits =
      !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (!digits || error != std::errc() || value < lower || value > upper) {
    return std::nullopt;
  }
  return value;
}

bool is_ipv4_address(std::string_view text) {
  constexpr int kNumbers = 4;
  constexpr std::size_t kDigits = 3;
  for (int number = 0; number < kNumbers; ++number) {
    const bool last = number == kNumbers - 1;
    const std::size_t end = last ? text.size() : text.find('.');
    if (end > kDigits ||  // npos, too
        !parse_number(text.substr(0, end), 0, 255)) {
      return false;
    }
    text.remove_prefix(last ? end : end + 1);
  }
  return true;
}

bool same_word(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, {}, lower_case, lower_case);
}

namespace {

using protocols::velodyne::ReturnMode;
using Live = VelodyneLiveSettings;

bool set_switch(bool& target, std::string_view text) {
  const auto value = parse_switch(text);
  target = value.value_or(target);
  return value.has_value();
}

template <class Number>
bool set_number(Number& target, std::string_view text, int lower, int upper) {
  const auto value = parse_number(text, lower, upper);
  target = value ? static_cast<Number>(*value) : target;
  return value.has_value();
}

bool set_address(std::string& target, std::string_view text) {
  if (!is_ipv4_address(text)) {
    return false;
  }
  target = text;
  return true;
}

bool set_returns(Live& live, std::string_view text) {
  constexpr std::array<std::pair<std::string_view, ReturnMode>, 3> kNames{
      {{"Strongest", ReturnMode::strongest},
       {"Last", ReturnMode::last},
       {"Dual", ReturnMode::dual}}};
  const auto found =
      std::ranges::find_if(kNames, [&](const auto& name) { return same_word(text, name.first); });
  if (found == kNames.end()) {
    return false;
  }
  live.return_mode = found->second;
  return true;
}

bool set_speed(Live& live, std::string_view text) {
  const auto rpm = parse_number(text, 0, 1200);
  if (!rpm || (*rpm != 0 && *rpm < 300) || *rpm % 60 != 0) {
    return false;
  }
  live.rotor_rpm = *rpm;
  return true;
}

/// Accepts and ignores a field that some firmware's web pages send and that has no meaning for this
/// sensor.
bool ignore(Live& /*live*/, std::string_view /*text*/) {
  return true;
}

struct Field {
  std::string_view name;
  std::string_view allowed;
  bool (*set)(Live&, std::string_view);
};

constexpr std::string_view kSwitch = "on or off";
constexpr std::string_view kDegrees = "0 to 359";
constexpr std::string_view kPort = "1 to 65535";
constexpr std::string_view kAddress = "an address like 192.168.1.100";

constexpr std::array<Field, 3> kSetting{{
    {"laser", kSwitch, [](Live& s, std::string_view v) { return set_switch(s.laser_on, v); }},
    {"returns", "Strongest, Last or Dual", set_returns},
    {"rpm", "0, or 300 to 1200 in steps of 60", set_speed},
}};
constexpr std::array<Field, 3> kView{{
    {"start", kDegrees,
     [](Live& s, std::string_view v) { return set_number(s.view_start_deg, v, 0, 359); }},
    {"end", kDegrees,
     [](Live& s, std::string_view v) { return set_number(s.view_end_deg, v, 0, 359); }},
    {"pwrsaven", "", ignore},
}};
constexpr std::array<Field, 4> kHost{{
    {"addr", kAddress, [](Live& s, std::string_view v) { return set_address(s.host_address, v); }},
    {"dport", kPort,
     [](Live& s, std::string_view v) { return set_number(s.data_port, v, 1, 65535); }},
    {"tport", kPort,
     [](Live& s, std::string_view v) { return set_number(s.telemetry_port, v, 1, 65535); }},
    {"udpcs", "", ignore},
}};
constexpr std::array<Field, 5> kNet{{
    {"addr", kAddress, [](Live& s, std::string_view v) { return set_address(s.net_address, v); }},
    {"mask", kAddress, [](Live& s, std::string_view v) { return set_address(s.net_mask, v); }},
    {"gateway", kAddress,
     [](Live& s, std::string_view v) { return set_address(s.net_gateway, v); }},
    {"dhcp", kSwitch, [](Live& s, std::string_view v) { return set_switch(s.net_dhcp, v); }},
    {"mac_addr", "", ignore},
}};
constexpr std::array<Field, 3> kPhaseLock{{
    {"enabled", kSwitch, [](Live& s, std::string_view v) { return set_switch(s.phase_lock, v); }},
    {"offset", "0 to 35999 hundredths of a degree",
     [](Live& s, std::string_view v) {
       return set_number(s.phase_lock_offset_centideg, v, 0, 35999);
     }},
    {"offsetInput", "", ignore},  // what the page's visitor typed; `offset` is made from it
}};

struct Form {
  std::string_view path;
  std::span<const Field> fields;
};
constexpr std::array<Form, 5> kForms{{{"/cgi/setting", kSetting},
                                      {"/cgi/setting/fov", kView},
                                      {"/cgi/setting/host", kHost},
                                      {"/cgi/setting/net", kNet},
                                      {"/cgi/setting/phaselock", kPhaseLock}}};

const Form* find_form(std::string_view path) {
  const auto found = std::ranges::find(kForms, path, &Form::path);
  return found == kForms.end() ? nullptr : &*found;
}

}  // namespace

bool is_settings_form(std::string_view path) {
  return find_form(path) != nullptr;
}

std::optional<std::string> apply_form(std::string_view path, std::string_view body,
                                      VelodyneLiveSettings& live) {
  const Form* form = find_form(path);
  assert(form != nullptr);
  const auto fields = parse_form(body);
  if (!fields) {
    return "the body is not application/x-www-form-urlencoded";
  }
  if (fields->empty()) {
    return "the body names no field";
  }
  for (const FormField& given : *fields) {
    const auto field = std::ranges::find(form->fields, given.name, &Field::name);
    if (field == form->fields.end()) {
      std::string names;
      for (const Field& known : form->fields) {
        names += (names.empty() ? "" : ", ") + std::string(known.name);
      }
      return "no field '" + given.name + "' here; there are " + names;
    }
    if (!field->set(live, given.value)) {
      return given.name + " is '" + given.value + "'; allowed: " + std::string(field->allowed);
    }
  }
  return std::nullopt;
}

}  // namespace rigwire::emulators
