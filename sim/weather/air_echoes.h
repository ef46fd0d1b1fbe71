// The strongest echoes of a beam, few enough for AirPath, kept in order of range.
#pragma once

#include "sim/weather/weather.h"

namespace rigwire::sim {

/// Adds an echo; when there is no place left the faintest one goes.
inline void add_echo(AirPath& path, const AirEcho& echo) {
  std::size_t place = path.echo_count;
  if (path.echo_count == kMaxAirEchoes) {
    place = 0;
    for (std::size_t i = 1; i < kMaxAirEchoes; ++i) {
      if (path.echoes[i].energy < path.echoes[place].energy) {
        place = i;
      }
    }
    if (path.echoes[place].energy >= echo.energy) {
      return;
    }
    for (; place + 1 < kMaxAirEchoes; ++place) {
      path.echoes[place] = path.echoes[place + 1];
    }
  } else {
    ++path.echo_count;
  }
  for (; place > 0 && path.echoes[place - 1].range_m > echo.range_m; --place) {
    path.echoes[place] = path.echoes[place - 1];
  }
  path.echoes[place] = echo;
}

}  // namespace rigwire::sim
