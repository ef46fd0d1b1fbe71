#include "hil/control/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "hil/configuration/reader.h"
#include "hil/executive/clock.h"

namespace rigwire::hil {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Value& value) {
  switch (value.kind) {
    case Value::Kind::null:
      return nullptr;
    case Value::Kind::scalar:
      return value.scalar;
    case Value::Kind::list: {
      Json list = Json::array();
      for (const Value& item : value.items) {
        list.push_back(json_of(item));
      }
      return list;
    }
    case Value::Kind::map:
      break;
  }
  Json map = Json::object();
  for (const Value::Entry& entry : value.entries) {
    map[entry.key] = json_of(entry.value);
  }
  return map;
}

/// What is written as a map becomes the text that a command holds.
void fold(Value& request, std::string_view key) {
  if (Value* map = request.find(key); map != nullptr && map->kind == Value::Kind::map) {
    const std::string text = json_text(*map);
    *map = Value{.kind = Value::Kind::scalar,
                 .scalar = text,
                 .items = {},
                 .entries = {},
                 .where = map->where,
                 .folder = map->folder};
  }
}

/// Reports words that are longer than a request may have.
void check_words(const Value& value, const std::string& path, Problems& problems) {
  const auto check = [&](const std::string& word, const Location& where) {
    if (word.size() > kMaxRequestWord) {
      problems.add(
          {where, path, "too long", word, fmt::format("at most {} bytes", kMaxRequestWord), ""});
    }
  };
  check(value.scalar, value.where);
  for (const Value& item : value.items) {
    check_words(item, path, problems);
  }
  for (const Value::Entry& entry : value.entries) {
    check(entry.key, entry.where);
    const bool is_folded = value.kind == Value::Kind::map &&
                           entry.value.kind == Value::Kind::scalar && path.empty() &&
                           std::ranges::count(kFoldedKeys, entry.key) != 0;
    if (!is_folded) {
      check_words(entry.value, path.empty() ? entry.key : path + "." + entry.key, problems);
    }
  }
}

/// Gives the map that verb, and no other.
void set_verb(Value& request, std::string_view verb) {
  std::erase_if(request.entries, [](const Value::Entry& entry) { return entry.key == "verb"; });
  request.entries.push_back({"verb", request.where,
                             Value{.kind = Value::Kind::scalar,
                                   .scalar = std::string(verb),
                                   .items = {},
                                   .entries = {},
                                   .where = request.where,
                                   .folder = request.folder}});
}

/// Parses what a command holds as text.
std::optional<Value> parse_keys(const std::string& text, const char* key, Problems& problems) {
  Value keys = parse_request(text, key, problems);
  if (problems.empty()) {
    check_words(keys, key, problems);
  }
  return problems.empty() ? std::optional(std::move(keys)) : std::nullopt;
}

}  // namespace

std::string json_text(const Value& document) {
  return json_of(document).dump();
}

std::optional<Request> read_request(const std::string& text, const std::string& name,
                                    Problems& problems, std::string_view verb) {
  Origins origins;
  Value document = parse_request(text, name, problems);
  if (!problems.empty()) {
    return std::nullopt;  // and what is no text is not written as such
  }
  check_words(document, "", problems);
  if (!problems.empty()) {
    return std::nullopt;
  }
  if (!verb.empty() && document.kind == Value::Kind::map) {
    set_verb(document, verb);
  }
  for (const std::string_view key : kFoldedKeys) {
    fold(document, key);
  }
  Request request;
  Reader(document, problems, origins).read(fields::Part::of(request));
  if (problems.empty()) {
    if (auto* const begins = std::get_if<FaultAddCommand>(&request.command)) {
      begins->keys = parse_keys(begins->fault, "fault", problems);
    } else if (auto* const sets = std::get_if<SetCommand>(&request.command)) {
      sets->keys = parse_keys(sets->set, "set", problems);
    }
  }
  return problems.empty() ? std::optional(std::move(request)) : std::nullopt;
}

ParsedRequest parse_command(const std::string& text, const std::string& name,
                            std::string_view verb) {
  Problems problems;
  ParsedRequest parsed{read_request(text, name, problems, verb), std::nullopt};
  if (!parsed.request) {
    parsed.wrong = problems.sorted().front();
  }
  return parsed;
}

void visit(fields::Visitor& v, RunUntilCommand& p) {
  v.required("time");
  v.duration("time", p.time, {1, fields::kYear_ns}, "From the start of the run.");
}

void visit(fields::Visitor& v, SeekCommand& p) {
  v.required("time");
  v.duration("time", p.time, {0, fields::kYear_ns}, "From the start of the recorded run.");
}

void visit(fields::Visitor& v, StepCommand& p) {
  v.required("length");
  v.duration("length", p.length, {1, fields::kYear_ns}, "How far time goes on.");
}

void visit(fields::Visitor& v, SpeedCommand& p) {
  v.required("factor");
  v.number("factor", p.factor, fields::plain().between(kLeastFactor, kGreatestFactor),
           "Simulated seconds per second of wall time.");
}

void visit(fields::Visitor& v, WaitCommand& p) {
  v.required("quantity");
  v.text("quantity", p.quantity, "Name of a quantity of the machine, as `read` has it.");
  v.boolean("above", p.above, "Whether it is wanted above the value; else below.");
  v.required("value");
  v.number("value", p.value, fields::plain(), "In the quantity's unit.");
  v.duration("limit", p.limit, {1, fields::kYear_ns},
             "Simulated time after which the answer is a refusal.");
}

void visit(fields::Visitor& v, FaultAddCommand& p) {
  v.required("on");
  v.text("on", p.on,
         "Name of a device, \"bus NAME\", \"modbus NAME\", \"air\" or a part of the machine.");
  v.required("fault");
  v.text("fault", p.fault,
         "Its keys as in a rig's file, `type` first: an object, or text. Without `at` it begins as "
         "soon as it can.");
}

void visit(fields::Visitor& v, FaultClearCommand& p) {
  v.required("id");
  v.integer("id", p.id, fields::IntegerRule{1}, "Its number.");
}

void visit(fields::Visitor& v, EventsCommand& p) {
  v.integer("since", p.since, fields::IntegerRule{0},
            "Number of the last event that is known; the answer has those after it.");
  v.boolean("wait", p.wait, "The answer comes when there is a newer one, or the run ends.");
}

void visit(fields::Visitor& v, RecordCommand& p) {
  v.text("folder", p.folder,
         "New or empty: where it is written. At a port a name below the folder of the run.");
  v.texts("only", p.only, "Names of wires, or \"truth\"; everything without.");
  v.boolean("stop", p.stop, "The recording that is on its way ends.");
}

void visit(fields::Visitor& v, SetCommand& p) {
  v.text("on", p.on,
         "What is set: the machine, the air, or a device for which `read` lists something "
         "`settable`.");
  v.required("set");
  v.text(
      "set", p.set,
      "An object, or text. Of the machine set points by their names, null releases one to the "
      "client again; of the air what is in it beside the rig's weather, {rain: 5 mm/h, fog: 40 m, "
      "snow: null}; of a device keys as in a rig's file.");
}

void visit(fields::Visitor& v, Request& p) {
  v.required("verb");
  v.variant("verb", p.command, "What is asked.");
  v.duration("at", p.at, {0, fields::kYear_ns},
             "When it is carried out, from the start of the run; what is over is at once.");
}

}  // namespace rigwire::hil
