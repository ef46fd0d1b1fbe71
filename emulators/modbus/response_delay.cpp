#include "emulators/modbus/response_delay.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::emulators {
namespace {

constexpr std::array<fields::Choice<DelayDistribution>, 3> kDistributions{
    {{DelayDistribution::constant, "constant", "Always `typical`."},
     {DelayDistribution::uniform, "uniform", "Between `minimum` and `maximum`."},
     {DelayDistribution::normal, "normal",
      "Mean `typical`, deviation `sigma`, held within `minimum` .. `maximum`."}}};

}  // namespace

void visit(fields::Visitor& v, ResponseDelaySettings& p) {
  constexpr fields::DurationRule kRule{0, 10'000'000'000};
  v.choice("distribution", p.distribution, kDistributions, "How the delay is drawn.");
  v.only_if(p.distribution != DelayDistribution::uniform, "distribution",
            "distribution: constant or normal", [&p, &kRule](fields::Visitor& w) {
              w.duration("typical", p.typical, kRule,
                         "The delay when constant, its mean when normal.");
            });
  v.only_if(p.distribution == DelayDistribution::normal, "distribution", "distribution: normal",
            [&p, &kRule](fields::Visitor& w) {
              w.duration("sigma", p.sigma, kRule, "Standard deviation of the delay.");
            });
  v.only_if(p.distribution != DelayDistribution::constant, "distribution",
            "distribution: uniform or normal", [&p, &kRule](fields::Visitor& w) {
              w.duration("minimum", p.minimum, kRule, "Shortest delay.");
              w.duration("maximum", p.maximum, kRule, "Longest delay.");
            });
}

void validate(const ResponseDelaySettings& settings) {
  fields::check(settings);
  if (settings.minimum > settings.maximum) {
    throw std::invalid_argument("modbus response delay, minimum: found " +
                                fields::print_duration(settings.minimum.count()) +
                                ", allowed up to maximum, " +
                                fields::print_duration(settings.maximum.count()));
  }
}

ResponseDelay::ResponseDelay(const ResponseDelaySettings& settings, std::uint64_t seed)
    : settings_(settings), random_(seed) {
  validate(settings);
}

Duration ResponseDelay::draw() {
  switch (settings_.distribution) {
    case DelayDistribution::constant:
      return settings_.typical;
    case DelayDistribution::uniform:
      return settings_.minimum +
             from_seconds(to_seconds(settings_.maximum - settings_.minimum) * random_.uniform());
    case DelayDistribution::normal:
      break;
  }
  return std::clamp(
      settings_.typical + from_seconds(to_seconds(settings_.sigma) * random_.normal()),
      settings_.minimum, settings_.maximum);
}

}  // namespace rigwire::emulators
