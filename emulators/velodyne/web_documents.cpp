#include "emulators/velodyne/web_documents.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "protocols/markup.h"

namespace rigwire::emulators {
namespace {

using protocols::escape_markup;
using protocols::velodyne::PulseState;
using protocols::velodyne::ReturnMode;

std::string quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
    }
    if (static_cast<unsigned char>(c) >= 0x20) {
      result += c;
    }
  }
  return result + '"';
}

/// {"name":value,...}; values are JSON already.
class Object {
 public:
  Object& add(std::string_view name, std::string_view json) {
    text_ += (text_.size() > 1 ? "," : "") + quoted(name) + ":" + std::string(json);
    return *this;
  }
  Object& text(std::string_view name, std::string_view value) { return add(name, quoted(value)); }
  Object& number(std::string_view name, std::int64_t value) {
    return add(name, std::to_string(value));
  }
  [[nodiscard]] std::string end() const { return text_ + "}"; }

 private:
  std::string text_ = "{";
};

std::string_view switch_name(bool on) {
  return on ? "On" : "Off";
}

std::string_view name_of(ReturnMode mode) {
  switch (mode) {
    case ReturnMode::last:
      return "Last";
    case ReturnMode::dual:
      return "Dual";
    case ReturnMode::strongest:
      break;
  }
  return "Strongest";
}

std::string_view name_of(PulseState state) {
  switch (state) {
    case PulseState::synchronizing:
      return "Synchronizing";
    case PulseState::locked:
      return "Locked";
    case PulseState::error:
      return "Error";
    case PulseState::absent:
      break;
  }
  return "Absent";
}

/// Counts for a voltage at the converter.
int counts(double voltage_v) {
  constexpr double kCountsPerVolt = 4096.0 / 5.0;
  return static_cast<int>(std::lround(std::clamp(voltage_v * kCountsPerVolt, 0.0, 4095.0)));
}

template <std::size_t kSize>
std::string array_of(const std::array<int, kSize>& values) {
  std::string text = "[";
  for (const int value : values) {
    text += (text.size() > 1 ? "," : "") + std::to_string(value);
  }
  return text + "]";
}

/// Returns a MAC address that depends only on the serial number; its first three bytes are the
/// maker's.
std::string hardware_address(std::string_view serial) {
  std::uint32_t hash = 2166136261U;  // FNV-1a
  for (const char c : serial) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 16777619U;
  }
  std::array<char, 18> text{};
  std::snprintf(text.data(), text.size(), "60-76-88-%02x-%02x-%02x", (hash >> 16U) & 0xFFU,
                (hash >> 8U) & 0xFFU, hash & 0xFFU);
  return text.data();
}

std::string input(std::string_view name, std::string_view value) {
  return std::string("<label>") + std::string(name) + " <input size=16 name=" + std::string(name) +
         " value=\"" + escape_markup(value) + "\"></label> ";
}

std::string input(std::string_view name, int value) {
  return input(name, std::to_string(value));
}

std::string option(std::string_view name, bool chosen) {
  return std::string(chosen ? "<option selected>" : "<option>") + std::string(name) + "</option>";
}

std::string switch_input(std::string_view name, bool on) {
  return std::string("<label>") + std::string(name) + " <select name=" + std::string(name) + ">" +
         option("on", on) + option("off", !on) + "</select></label> ";
}

std::string form(std::string_view path, std::string_view inputs, std::string_view button) {
  return "<form method=post action=\"" + std::string(path) + "\"><p>" + std::string(inputs) +
         "<button>" + std::string(button) + "</button></p></form>\n";
}

}  // namespace

int temperature_counts(double temperature_c) {
  const double root = temperature_c + 1481.96;
  return counts(1.8639 - 3.88e-6 * (root * root - 2.1962e6));
}

int input_voltage_counts(double voltage_v) {
  return counts(voltage_v / 11.0);
}

int input_current_counts(double current_a) {
  return counts(2.5 + current_a / 10.0);
}

std::string settings_document(const VelodyneLiveSettings& s) {
  return Object()
      .text("laser", switch_name(s.laser_on))
      .text("returns", name_of(s.return_mode))
      .number("rpm", static_cast<std::int64_t>(s.rotor_rpm))
      .add("fov", Object().number("start", s.view_start_deg).number("end", s.view_end_deg).end())
      .add("phaselock", Object()
                            .text("enabled", switch_name(s.phase_lock))
                            .text("offset", std::to_string(s.phase_lock_offset_centideg))
                            .end())
      .add("host", Object()
                       .text("addr", s.host_address)
                       .text("dport", std::to_string(s.data_port))
                       .text("tport", std::to_string(s.telemetry_port))
                       .end())
      .add("net", Object()
                      .text("addr", s.net_address)
                      .text("mask", s.net_mask)
                      .text("gateway", s.net_gateway)
                      .text("dhcp", switch_name(s.net_dhcp))
                      .end())
      .end();
}

std::string status_document(const VelodyneLiveSettings& s, const VelodyneReadings& r) {
  // Lasers that are switched on wait for a rotor that turns: they must not burn into one spot.
  const std::string_view laser = r.laser_on ? "On" : s.laser_on ? "Disabled" : "Off";
  return Object()
      .add(
          "gps",
          Object().text("pps_state", name_of(r.pulse_state)).text("position", r.gps_position).end())
      .add("motor", Object()
                        .text("state", switch_name(r.motor_on))
                        .number("rpm", std::lround(r.motor_rpm))
                        .text("lock", switch_name(r.motor_locked))
                        .number("phase", r.motor_phase_centideg)
                        .end())
      .add("laser", Object().text("state", laser).end())
      .end();
}

std::string diagnostics_document(const VelodyneReadings& r, bool arrays) {
  // Supplies that nothing in the simulation changes have a healthy value.
  constexpr double kHighVoltage_v = -141.0;
  Object top;
  top.number("hv", counts(5.0 + kHighVoltage_v / 101.0))
      .number("ad_temp", 602)
      .number("lm20_temp", temperature_counts(r.top_temperature_c))
      .number("pwr_5v", counts(5.07 / 2.0))
      .number("pwr_2_5v", counts(2.5))
      .number("pwr_3_3v", counts(3.28));
  if (arrays) {
    top.number("pwr_raw", counts(1.75));
  } else {
    top.number("pwr_5v_raw", counts(5.35 / 2.0));
  }
  top.number("pwr_vccint", counts(1.19));
  Object bottom;
  bottom.number("i_out", input_current_counts(r.input_current_a))
      .number("pwr_1_2v", counts(1.2))
      .number("lm20_temp", temperature_counts(r.bottom_temperature_c))
      .number("pwr_5v", counts(5.02 / 2.0))
      .number("pwr_2_5v", counts(2.5))
      .number("pwr_3_3v", counts(3.3))
      .number("pwr_v_in", input_voltage_counts(r.input_voltage_v))
      .number("pwr_1_25v", arrays ? counts(1.25) : 0);
  Object document;
  document.add("volt_temp", Object().add("top", top.end()).add("bot", bottom.end()).end())
      .number("vhv", 412);
  if (arrays) {
    const std::string statistic = Object().number("mean", 14).number("stddev", 1).end();
    document.add("adc_nf", array_of(std::array{14, 14}))
        .add("adc_stats", "[" + statistic + "," + statistic + "]")
        .number("ixe", 1)
        .add("adctp_stat", array_of(std::array{0, 0, 0, 0}));
  } else {
    document.number("adc_nf", 14).number("ixe", 1);
  }
  return document.end();
}

std::string info_document(const VelodyneControl& control) {
  constexpr std::int64_t kVersion = (3 << 24) + (0 << 16) + (41 << 8) + 1;  // 3.0.41.1
  const std::string image = Object().number("version", kVersion).end();
  return Object()
      .text("model", control.model_name())
      .text("serial", control.serial_number())
      .text("mac_addr", hardware_address(control.serial_number()))
      .add("image", Object().add("failsafe", image).add("application", image).end())
      .end();
}

std::string snapshot_document(SimTime now, const VelodyneControl& control) {
  const VelodyneLiveSettings& settings = control.live_settings();
  const VelodyneReadings readings = control.readings(now);
  return Object()
      .add("info", info_document(control))
      .add("config", settings_document(settings))
      .add("status", status_document(settings, readings))
      .add("diag", diagnostics_document(readings, has_diagnostic_arrays(control)))
      .end();
}

bool has_diagnostic_arrays(const VelodyneControl& control) {
  const std::string_view model = control.model_name();
  return model.starts_with("VLP-32") || model.starts_with("VLS");
}

std::string control_page(SimTime now, const VelodyneControl& control) {
  const VelodyneLiveSettings& s = control.live_settings();
  const VelodyneReadings r = control.readings(now);
  const std::string title = "Simulated " + escape_markup(control.model_name());
  std::string page = "<!DOCTYPE html>\n<html lang=en><head><meta charset=utf-8><title>" + title +
                     "</title></head><body>\n<h1>" + title + "</h1>\n<p>Serial number " +
                     escape_markup(control.serial_number()) + ", rotor at " +
                     std::to_string(std::lround(r.motor_rpm)) +
                     " rpm. A setting that is taken answers with an empty page.</p>\n";
  std::string returns;
  for (const ReturnMode mode : {ReturnMode::strongest, ReturnMode::last, ReturnMode::dual}) {
    returns += option(name_of(mode), s.return_mode == mode);
  }
  page += form("/cgi/setting",
               switch_input("laser", s.laser_on) + "<label>returns <select name=returns>" +
                   returns + "</select></label> " + input("rpm", static_cast<int>(s.rotor_rpm)),
               "Set");
  page += form("/cgi/setting/fov", input("start", s.view_start_deg) + input("end", s.view_end_deg),
               "Set the field of view");
  page +=
      form("/cgi/setting/phaselock",
           switch_input("enabled", s.phase_lock) + input("offset", s.phase_lock_offset_centideg),
           "Set the phase lock");
  page += form("/cgi/setting/host",
               input("addr", s.host_address) + input("dport", s.data_port) +
                   input("tport", s.telemetry_port),
               "Set the destination");
  page += form("/cgi/setting/net",
               input("addr", s.net_address) + input("mask", s.net_mask) +
                   input("gateway", s.net_gateway) + switch_input("dhcp", s.net_dhcp),
               "Set the sensor's own address");
  page += form("/cgi/save", "<input type=hidden name=data value=submit>", "Save");
  page += form("/cgi/reset", "<input type=hidden name=data value=reset_system>", "Reset");
  page += "<p>Documents:";
  for (const char* name :
       {"settings.json", "status.json", "diag.json", "info.json", "snapshot.hdl"}) {
    page += std::string(" <a href=\"/cgi/") + name + "\">" + name + "</a>";
  }
  return page + "</p>\n</body></html>\n";
}

}  // namespace rigwire::emulators
