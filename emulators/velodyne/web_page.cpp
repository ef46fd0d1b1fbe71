#include "emulators/velodyne/web_page.h"

#include <cmath>

#include "protocols/markup.h"

namespace rigwire::emulators {
namespace {

using protocols::escape_markup;
using protocols::velodyne::ReturnMode;

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

std::string control_page(SimTime now, const VelodyneControl& control) {
  const VelodyneLiveSettings& s = control.live_settings();
  const VelodyneReadings r = control.readings(now);
  const std::string title = "Simulated " + escape_markup(control.model_name());
  std::string page = "<!DOCTYPE html>\n<html lang=en><head><meta charset=utf-8><title>" + title +
                     "</title></head><body>\n<h1>" + title + "</h1>\n<p>Serial number " +
                     escape_markup(control.serial_number()) + ", rotor at " +
                     std::to_string(std::lround(r.motor_rpm)) +
                     " rpm. A setting that is taken answers with an empty page.</p>\n";
  page += form("/cgi/setting",
               switch_input("laser", s.laser_on) + "<label>returns <select name=returns>" +
                   option("Strongest", s.return_mode == ReturnMode::strongest) +
                   option("Last", s.return_mode == ReturnMode::last) +
                   option("Dual", s.return_mode == ReturnMode::dual) + "</select></label> " +
                   input("rpm", static_cast<int>(s.rotor_rpm)),
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
