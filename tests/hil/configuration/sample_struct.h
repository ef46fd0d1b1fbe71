// A small configuration with one field of every kind, for the tests of the machinery.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "fields/visitor.h"
#include "hil/configuration/outline.h"
#include "hil/configuration/reader.h"
#include "sim/samples/time.h"
#include "sim/samples/vector3.h"

namespace rigwire::hil {

enum class Flavour { sweet, sour };

inline constexpr std::array<fields::Choice<Flavour>, 2> kFlavours{
    {{Flavour::sweet, "sweet", "With sugar."}, {Flavour::sour, "sour", "With lemon."}}};

struct Stone {
  double size_m = 0.5;
  Vector3 position_m{1.0, 2.0, 3.0};
};

inline void visit(fields::Visitor& v, Stone& stone) {
  v.number("size", stone.size_m, fields::in("m").above(0), "Edge.");
  v.vector3("position", stone.position_m, fields::in("m"), "Centre.");
}

struct Pump {
  static constexpr fields::Named kNamed{"pump", "Moves oil."};

  double pressure_pa = 35e6;
  std::uint16_t port = 502;

  friend void validate(const Pump& pump) {
    if (pump.port == 13) {
      throw std::invalid_argument("port 13 brings bad luck");
    }
  }
};

inline void visit(fields::Visitor& v, Pump& pump) {
  v.number("pressure", pump.pressure_pa, fields::in("MPa").between(0, 70), "Relief.");
  v.integer("port", pump.port, {1, 65535}, "Where it listens.");
}

struct Lamp {
  static constexpr fields::Named kNamed{"lamp", "Blinks."};

  Duration period = std::chrono::milliseconds(20);
};

inline void visit(fields::Visitor& v, Lamp& lamp) {
  v.rate("rate", lamp.period, fields::in("Hz").above(0).at_most(1000), "Blinks.");
}

struct Gadget {
  bool enabled = true;
  std::variant<Pump, Lamp> settings;
};

inline void visit(fields::Visitor& v, Gadget& gadget) {
  v.boolean("enabled", gadget.enabled, "Takes part.");
  v.required("type");
  v.variant("type", gadget.settings, "What it is.");
}

struct Sample {
  std::string name = "sample";
  std::string mesh;
  double angle_rad = 0.5;
  Flavour flavour = Flavour::sweet;
  Duration step = std::chrono::milliseconds(1);
  UtcTime start{2026, 6, 1, 8, 0, 0, 0};
  std::vector<double> weights{1.0, 2.5};
  std::vector<std::string> words{"one", "two, three"};
  std::vector<Stone> stones{Stone{}};
  Pump main;
  std::map<std::string, Gadget> gadgets;
};

inline void visit(fields::Visitor& v, Sample& sample) {
  v.text("name", sample.name, "Any text.");
  v.file("mesh", sample.mesh, fields::FileKind::data, "A file.");
  v.number("angle", sample.angle_rad, fields::in("deg").between(-180, 180), "An angle.");
  v.choice("flavour", sample.flavour, kFlavours, "Taste.");
  v.duration("step", sample.step, {1000, 1'000'000'000}, "A span.");
  v.spelled("start", utc_spelling(sample.start), "A date.");
  v.number_list("weights", sample.weights, fields::plain().at_least(0), "Some numbers.");
  v.texts("words", sample.words, "Some words.");
  v.list("stones", sample.stones, "Rocks.");
  v.section("main", sample.main, "The main pump.");
  v.named("gadgets", sample.gadgets, "gadget", "By name.");
}

/// Reads YAML text and returns its findings, one per line.
inline std::string findings(const std::string& yaml, Sample& sample,
                            const std::vector<std::string>& sets = {}, Origins* places = nullptr) {
  Problems problems;
  Value document = parse_document(yaml, "a.yaml", RIGWIRE_SOURCE_DIR, problems);
  for (const std::string& set : sets) {
    apply_set(document, set, problems);
  }
  Origins origins;
  read(document, sample, problems, origins);
  if (places != nullptr) {
    *places = origins;
  }
  std::string text;
  for (const Problem& problem : problems.sorted()) {
    text += (text.empty() ? "" : "\n") + problem.line();
  }
  return text;
}

inline std::string findings(const std::string& yaml) {
  Sample sample;
  return findings(yaml, sample);
}

}  // namespace rigwire::hil
