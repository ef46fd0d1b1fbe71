// A device's supply switched by hand: a fault without an end, which is ended.
#pragma once

#include "emulators/supply.h"

namespace rigwire::test {

/// From `now` on. Nothing happens where it is so already.
template <class Device>
void switch_supply(Device& device, SimTime now, bool on) {
  device.advance(now);
  emulators::Supply& supply = device.supply();
  if (supply.on() == on) {
    return;
  }
  if (!on) {
    supply.begin({{.at = now - kStart}, emulators::NoSupplyFault{}});
  } else {
    const auto last = supply.book().list().back().id;
    supply.end(last, now);
  }
  device.advance(now);
}

}  // namespace rigwire::test
