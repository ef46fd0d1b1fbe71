#include "emulators/velodyne/web_interface.h"

#include <array>
#include <optional>
#include <utility>

#include "emulators/velodyne/web_documents.h"
#include "emulators/velodyne/web_form.h"

namespace rigwire::emulators {
namespace {

constexpr std::string_view kSave = "/cgi/save";
constexpr std::string_view kReset = "/cgi/reset";

/// Clients send "data=submit", "submit" alone, or nothing.
bool is_command(std::string_view body, const std::string& word) {
  const auto fields = parse_form(body);
  return fields &&
         (fields->empty() || (fields->size() == 1 && (fields->front() == FormField{word, ""} ||
                                                      fields->front() == FormField{"data", word})));
}

WebResponse json(std::string document) {
  return {200, "application/json", std::move(document) + "\n", {}, false};
}

WebResponse done() {
  return {204, {}, {}, {}, false};
}

/// What a GET of that path brings; nothing where there is no document.
std::optional<WebResponse> document(SimTime now, std::string_view path,
                                    const VelodyneControl& control) {
  if (path == "/" || path == "/index.html") {
    return WebResponse{200, "text/html; charset=utf-8", control_page(now, control), {}, false};
  }
  if (path == "/cgi/settings.json") {
    return json(settings_document(control.live_settings()));
  }
  if (path == "/cgi/status.json") {
    return json(status_document(control.live_settings(), control.readings(now)));
  }
  if (path == "/cgi/diag.json") {
    return json(diagnostics_document(control.readings(now), has_diagnostic_arrays(control)));
  }
  if (path == "/cgi/info.json") {
    return json(info_document(control));
  }
  if (path == "/cgi/snapshot.hdl") {
    return json(snapshot_document(now, control));
  }
  return std::nullopt;
}

WebResponse wrong_method(std::string_view allow) {
  return {405, "text/plain", "this target takes " + std::string(allow) + "\n", std::string(allow),
          false};
}

}  // namespace

VelodyneWebInterface::VelodyneWebInterface(VelodyneControl& control, VelodyneWebSettings settings)
    : control_(control), settings_(std::move(settings)) {}

WebResponse VelodyneWebInterface::answer(SimTime now, const WebRequest& request) {
  const std::string_view target = request.target;
  const std::string_view path = target.substr(0, target.find('?'));
  if (path == kSave || path == kReset || is_settings_form(path)) {
    return request.method == "POST" ? post(now, path, request.body) : wrong_method("POST");
  }
  if (auto found = document(now, path, control_)) {
    const bool reads = request.method == "GET" || request.method == "HEAD";
    return reads ? std::move(*found) : wrong_method("GET, HEAD");
  }
  return {404, "text/plain", "nothing here\n", {}, false};
}

WebResponse VelodyneWebInterface::post(SimTime now, std::string_view path, std::string_view body) {
  if (path == kSave) {
    if (!is_command(body, "submit")) {
      return refuse(400, "the body is not data=submit");
    }
    control_.save(now);
    return done();
  }
  if (path == kReset) {
    if (!is_command(body, "reset_system")) {
      return refuse(400, "the body is not data=reset_system");
    }
    control_.reset(now);
    WebResponse response = done();
    response.close = true;
    return response;
  }
  VelodyneLiveSettings wanted = control_.live_settings();
  if (const auto wrong = apply_form(path, body, wanted)) {
    return refuse(400, *wrong);
  }
  if (settings_.objection) {
    if (const std::string objection = settings_.objection(wanted); !objection.empty()) {
      return refuse(403, objection);
    }
  }
  if (wanted != control_.live_settings()) {
    control_.apply(now, wanted);
  }
  return done();
}

WebResponse VelodyneWebInterface::refuse(int status, const std::string& reason) const {
  if (settings_.silent_refusals) {
    return done();
  }
  return {status, "text/plain", reason + "\n", {}, false};
}

}  // namespace rigwire::emulators
