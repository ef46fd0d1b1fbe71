#include "hil/control/control_server.h"

#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "hil/configuration/schema.h"

namespace rigwire::hil {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kJson = "application/json";
constexpr const char* kPrometheus = "text/plain; version=0.0.4; charset=utf-8";

drivers::HttpServerSettings server_settings(const ControlEndpoint& endpoint) {
  drivers::HttpServerSettings settings;
  settings.path = endpoint.path;
  settings.address = endpoint.address;
  settings.port = endpoint.port;
  settings.kept = endpoint.kept;
  settings.clients_max = 64;
  settings.patience = std::chrono::minutes{1};
  return settings;
}

int status_of(Reply::Outcome outcome) {
  switch (outcome) {
    case Reply::Outcome::done:
      return 200;
    case Reply::Outcome::wrong:
      return 400;
    case Reply::Outcome::refused:
      return 409;
    case Reply::Outcome::ended:
      return 410;
  }
  return 500;
}

drivers::HttpResponse complaint(int status, const std::string& what) {
  return {status, kJson, Json{{"ok", false}, {"what", what}}.dump(), {}, false};
}

/// Compares in a time that does not depend on `found`, so that timing reveals nothing about the
/// token.
bool same(std::string_view found, std::string_view wanted) {
  unsigned difference = found.size() == wanted.size() ? 0 : 1;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const char at = i < found.size() ? found[i] : '\0';
    difference |= static_cast<unsigned char>(at ^ wanted[i]);
  }
  return difference == 0;
}

/// What is served where; dispatch, refusals and the description are made of it.
struct Door {
  /// On the thread of the desk; `parsed` is the body of a POST.
  using Serve = void (*)(Desk& desk, ParsedRequest parsed, Desk::Asker asker,
                         const drivers::HttpServer::Respond& respond);

  std::string_view method;
  std::string_view path;
  std::string_view text;
  std::string_view content;  ///< Type of what is answered.
  bool replies;              ///< With a Reply of the desk.
  Serve serve;               ///< Null: what is answered is of no run.
};

Desk::Answer answer_with(const drivers::HttpServer::Respond& respond) {
  return [respond](const Reply& reply) {
    respond({status_of(reply.outcome), kJson, reply.json, {}, false});
  };
}

constexpr std::array<Door, 5> kDoors{{
    {"POST", "/command", "A command of the run.", kJson, true,
     [](Desk& desk, ParsedRequest parsed, Desk::Asker asker, const auto& respond) {
       desk.carry_out_parsed(std::move(parsed), answer_with(respond), asker);
     }},
    {"GET", "/state", StateCommand::kNamed.text, kJson, true,
     [](Desk& desk, ParsedRequest, Desk::Asker, const auto& respond) {
       desk.carry_out(Request{StateCommand{}}, answer_with(respond));
     }},
    {"GET", "/read", ReadCommand::kNamed.text, kJson, true,
     [](Desk& desk, ParsedRequest, Desk::Asker, const auto& respond) {
       desk.carry_out(Request{ReadCommand{}}, answer_with(respond));
     }},
    {"GET", "/metrics", "Counters and lateness of the run.", kPrometheus, false,
     [](Desk& desk, ParsedRequest, Desk::Asker, const auto& respond) {
       respond({200, kPrometheus, desk.metrics(), {}, false});
     }},
    {"GET", "/openapi.json", "This description.", kJson, false, nullptr},
}};

}  // namespace

std::optional<ControlEndpoint> parse_control_endpoint(std::string_view text) {
  ControlEndpoint endpoint;
  constexpr std::string_view kUnix = "unix:";
  if (text.starts_with(kUnix)) {
    endpoint.path = text.substr(kUnix.size());
    return endpoint.path.empty() ? std::nullopt : std::optional(endpoint);
  }
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos || !text.starts_with("127.")) {
    return std::nullopt;
  }
  endpoint.address = text.substr(0, colon);
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data() + colon + 1, end, endpoint.port);
  return error != std::errc{} || stop != end ? std::nullopt : std::optional(endpoint);
}

std::string fresh_token() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw std::runtime_error("the system has no random numbers for a token");
  }
  std::string token;
  for (const unsigned char byte : bytes) {
    token += fmt::format("{:02x}", byte);
  }
  return token;
}

ControlServer::ControlServer(boost::asio::io_context& io, const ControlEndpoint& endpoint,
                             std::string token, Desk& desk, Dashboard* dashboard)
    : endpoint_(endpoint),
      token_(std::move(token)),
      desk_(desk),
      desk_thread_(io, desk.io()),
      dashboard_(endpoint.path.empty() ? dashboard : nullptr),
      server_(io, server_settings(endpoint)) {
  endpoint_.port = server_.port();
  if (dashboard_ != nullptr) {
    server_.on_web_socket([this](const drivers::HttpRequest& request) { return admit(request); });
  }
  server_.start_patiently(
      [this](const drivers::HttpRequest& request, const drivers::HttpServer::Respond& respond) {
        serve(request, respond);
      });
}

std::string ControlServer::address() const {
  return endpoint_.path.empty() ? fmt::format("{}:{}", endpoint_.address, endpoint_.port)
                                : "unix:" + endpoint_.path;
}

std::string ControlServer::page_address() const {
  return fmt::format("http://{}/#{}", address(), token_);
}

std::optional<drivers::HttpResponse> ControlServer::objection_to_origin(
    const drivers::HttpRequest& request) const {
  if (dashboard_ == nullptr && !request.origin.empty()) {
    return complaint(403, "requests of pages are not served (header Origin)");
  }
  if (!endpoint_.path.empty()) {
    return std::nullopt;
  }
  if (request.host != address() && request.host != fmt::format("localhost:{}", endpoint_.port)) {
    return complaint(403, "another Host than " + address());
  }
  if (!request.origin.empty() && request.origin != "http://" + request.host) {
    return complaint(403, "requests of other pages are not served (header Origin)");
  }
  return std::nullopt;
}

std::optional<drivers::HttpResponse> ControlServer::objection(
    const drivers::HttpRequest& request) const {
  if (auto refusal = objection_to_origin(request)) {
    return refusal;
  }
  if (endpoint_.path.empty() && !same(request.authorization, "Bearer " + token_)) {
    return complaint(401, "no \"Authorization: Bearer TOKEN\" with the run's token");
  }
  return std::nullopt;
}

std::optional<drivers::HttpResponse> ControlServer::page(
    const drivers::HttpRequest& request) const {
  const PageFile* const file =
      dashboard_ == nullptr ? nullptr : dashboard_->files().find(request.target);
  if (file == nullptr) {
    return std::nullopt;
  }
  if (auto refusal = objection_to_origin(request)) {
    return refusal;
  }
  if (request.method != "GET" && request.method != "HEAD") {
    drivers::HttpResponse refusal = complaint(405, "allowed GET " + request.target);
    refusal.allow = "GET, HEAD";
    return refusal;
  }
  drivers::HttpResponse response{200, file->type, file->content, {}, false};
  response.headers = {
      {"Content-Security-Policy",
       fmt::format("default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: "
                   "blob:; connect-src 'self' ws://{}; base-uri 'none'; form-action 'none'; "
                   "frame-ancestors 'none'",
                   request.host)},
      {"X-Content-Type-Options", "nosniff"},
      {"Referrer-Policy", "no-referrer"},
      {"Cross-Origin-Resource-Policy", "same-origin"},
      {"Cache-Control", "no-cache"}};
  return response;
}

drivers::WebSocketAnswer ControlServer::admit(const drivers::HttpRequest& request) {
  drivers::WebSocketAnswer answer;
  constexpr std::string_view kStream = "/stream";
  constexpr std::string_view kToken = "?token=";
  const std::string_view target = request.target;
  const std::string_view path = target.substr(0, target.find('?'));
  const std::string_view query = target.substr(path.size());
  if (auto refusal = objection_to_origin(request)) {
    answer.refusal = std::move(refusal);
  } else if (path != kStream) {
    answer.refusal = complaint(404, fmt::format("allowed {} as a WebSocket", kStream));
  } else if (!same(request.authorization, "Bearer " + token_) &&
             !(query.starts_with(kToken) && same(query.substr(kToken.size()), token_))) {
    answer.refusal = complaint(401, "no ?token=TOKEN with the run's token");
  } else {
    return dashboard_->viewers().admit(request);
  }
  return answer;
}

void ControlServer::serve(const drivers::HttpRequest& request,
                          const drivers::HttpServer::Respond& respond) {
  if (const auto response = page(request)) {
    respond(*response);
    return;
  }
  if (const auto refusal = objection(request)) {
    respond(*refusal);
    return;
  }
  const auto* const door = std::ranges::find(kDoors, request.target, &Door::path);
  if (door == kDoors.end()) {
    std::string all;
    for (const Door& one : kDoors) {
      all += fmt::format("{}{} {}", all.empty() ? "" : ", ", one.method, one.path);
    }
    respond(complaint(404, "allowed " + all));
    return;
  }
  const bool reads = door->method == "GET" && request.method == "HEAD";
  if (request.method != door->method && !reads) {
    drivers::HttpResponse refusal =
        complaint(405, fmt::format("allowed {} {}", door->method, door->path));
    refusal.allow = door->method == "GET" ? "GET, HEAD" : std::string(door->method);
    respond(refusal);
    return;
  }
  if (door->serve == nullptr) {
    respond({200, kJson, control_api(), {}, false});
    return;
  }
  // Here, and not where the wires are.
  ParsedRequest parsed =
      door->method == "POST" ? parse_command(request.body, "the request") : ParsedRequest{};
  desk_thread_.go(
      [this, door, parsed = std::move(parsed), respond = desk_thread_.back(respond)]() mutable {
        door->serve(desk_, std::move(parsed),
                    endpoint_.path.empty() ? Desk::Asker::anybody : Desk::Asker::owner, respond);
      });
}

namespace {

/// The schema of a request as it comes over a wire: it includes no file.
Json request_schema() {
  Json schema = Json::parse(schema_of(Request{}, "A command of a run."));
  schema["properties"].erase("include");
  const Json needs = schema["else"];
  schema.erase("if");
  schema.erase("else");
  schema["required"] = needs["required"];
  for (const Json& one : needs["allOf"]) {
    schema["allOf"].push_back(one);
  }
  for (Json& one : schema["allOf"]) {
    if (one["then"].contains("properties")) {
      for (const std::string_view key : kFoldedKeys) {
        const auto found = one["then"]["properties"].find(key);
        if (found != one["then"]["properties"].end() && found->is_object()) {
          (*found)["type"].push_back("object");
        }
      }
    }
  }
  return schema;
}

}  // namespace

std::string control_api() {
  const Json reply{
      {"type", "object"},
      {"required", {"ok"}},
      {"properties",
       {{"ok", {{"type", "boolean"}}},
        {"time_ns", {{"type", "integer"}, {"description", "Simulated time of the answer."}}},
        {"paused", {{"type", "boolean"}, {"description", "Whether simulated time is paused."}}},
        {"what", {{"type", "string"}, {"description", "Why it was not done."}}},
        {"path", {{"type", "string"}, {"description", "Key that is wrong."}}},
        {"found", {{"type", "string"}}},
        {"allowed", {{"type", "string"}}}}}};
  const auto response = [](const char* description) {
    return Json{{"description", description},
                {"content", {{kJson, {{"schema", {{"$ref", "#/components/schemas/Reply"}}}}}}}};
  };
  const Json refusals{{"401", response("At a port: without the run's token.")},
                      {"403", response("Request of a page, or with another Host.")}};
  const Json outcomes{{"200", response("Done.")},
                      {"400", response("No request: what is wrong, and where.")},
                      {"409", response("Not now, or not with this run.")},
                      {"410", response("The run ended before.")}};
  Json paths = Json::object();
  for (const Door& door : kDoors) {
    Json operation{{"summary", door.text}};
    if (door.method == "POST") {
      operation["requestBody"] = {
          {"required", true},
          {"content", {{kJson, {{"schema", {{"$ref", "#/components/schemas/Request"}}}}}}}};
    }
    if (door.replies) {
      operation["responses"] = outcomes;
    } else {
      const char* const type = door.content == kJson ? "object" : "string";
      operation["responses"]["200"] = {
          {"description", door.text},
          {"content", {{std::string(door.content), {{"schema", {{"type", type}}}}}}}};
    }
    operation["responses"].update(refusals);
    paths[std::string(door.path)][door.method == "POST" ? "post" : "get"] = operation;
  }
  return Json{{"openapi", "3.1.0"},
              {"info", {{"title", "Control of a Rigwire run"}, {"version", "1"}}},
              {"paths", paths},
              {"components", {{"schemas", {{"Request", request_schema()}, {"Reply", reply}}}}}}
      .dump(2);
}

}  // namespace rigwire::hil
