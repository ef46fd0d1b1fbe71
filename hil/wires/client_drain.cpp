#include "hil/wires/client_drain.h"

#include <utility>

namespace rigwire::hil {

void ClientDrain::watch(std::string name, const QueuedOutlet& outlet) {
  wires_.push_back({std::move(name), &outlet});
}

bool ClientDrain::waits(Wire& wire) {
  const std::uint64_t left = wire.outlet->left();
  if (left == wire.seen) {
    return false;
  }
  const std::optional<std::size_t> untaken = wire.outlet->untaken();
  if (!untaken || *untaken == 0) {
    wire.given_up.reset();
    wire.seen = left;
    return false;
  }
  if (wire.given_up) {
    if (*untaken >= *wire.given_up) {
      wire.given_up = untaken;  // more has come, nothing was taken
      return false;
    }
    wire.given_up.reset();
  }
  return true;
}

bool ClientDrain::taken() {
  for (Wire& wire : wires_) {
    if (waits(wire)) {
      return false;
    }
  }
  return true;
}

std::vector<std::string> ClientDrain::give_up() {
  std::vector<std::string> names;
  for (Wire& wire : wires_) {
    if (waits(wire)) {
      wire.given_up = wire.outlet->untaken();
      names.push_back(wire.name);
    }
  }
  return names;
}

}  // namespace rigwire::hil
