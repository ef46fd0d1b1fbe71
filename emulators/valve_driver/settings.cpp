// Keys and checks of the valve driver's settings.
#include <stdexcept>
#include <string>

#include "emulators/valve_driver/valve_driver.h"
#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;

constexpr std::array<fields::Choice<ValveReaction>, 4> kReactions{
    {{ValveReaction::neutral, "neutral", "Spools go to neutral."},
     {ValveReaction::hold, "hold", "Spools stay where they are."},
     {ValveReaction::floating, "floating", "Spools connect the ports to the tank."},
     {ValveReaction::position, "position", "Spools go to loss_position, which the master sets."}}};

}  // namespace

void visit(fields::Visitor& v, ValveDriverSettings& p) {
  v.duration("watchdog", p.amplifier.parameters.watchdog, {0, 3'600'000'000'000},
             "Without a request for this long the reaction follows; 0 = never.");
  v.choice("reaction", p.amplifier.parameters.reaction, kReactions,
           "What the outputs do when the watchdog runs out.");
  v.rate("rate", p.sample_period, fields::in("Hz").between(1, 1000),
         "Readings of the transducers per second.");
  visit(v, p.amplifier);
}

void validate(const ValveDriverSettings& settings) {
  fields::check(settings);
  validate(settings.amplifier);
  if (settings.map) {
    validate(*settings.map);
    return;
  }
  const Duration watchdog = settings.amplifier.parameters.watchdog;
  const bool fits = watchdog >= 20ms && watchdog <= 5s && watchdog % 1ms == 0ns;
  if (watchdog != 0ns && !fits) {
    throw std::invalid_argument("valve driver watchdog: found " +
                                std::to_string(to_seconds(watchdog) * 1e3) +
                                " ms, allowed 0 or 20 .. 5000 ms, whole milliseconds");
  }
}

}  // namespace rigwire::emulators
