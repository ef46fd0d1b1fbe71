// A rig with private wires, so that any number of runs, also of one and the same rig, can run at
// once on one machine.
//
// Everything by which a wire of the rig is found is replaced, as by a `--set` of its key:
//
//   path of a pty           FOLDER/wires/NAME, of the bus, line or device
//   address                 one of a network 127.A.B.0/24 that no other run has; addresses that
//                           differ stay different
//   UDP port of a client    one that no socket is bound to, so that it may be bound at any address
//   CAN interface           slcan on a pty: other programs share an interface of the host
//   memory of a device      FOLDER/memory/NAME, which begins as a copy of the file
//   files of ground truth   FOLDER/NAME
//
// TCP ports stay: their addresses differ. What devices measure and send does not change, but for
// what a device reports of its own address; the configuration's hash is that of the rig.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "drivers/loopback_claims.h"
#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {

struct Replacement {
  std::string key;  ///< "devices.gnss.path"
  std::string value;
};

/// Treatment of an address beyond this machine.
enum class RemoteAddresses {
  refused,
  kept,  ///< For configurations whose rig sends nothing.
};

/// `folder` is absolute and exists. Throws drivers::EndpointError, and ConfigurationError for an
/// address that is refused, with the key's place.
[[nodiscard]] std::vector<Replacement> isolating(const RigConfiguration& configuration,
                                                 const Origins& origins,
                                                 const std::filesystem::path& folder,
                                                 drivers::LoopbackClaims& claims,
                                                 RemoteAddresses remote = RemoteAddresses::refused);

/// Returns the configuration with these values. Throws ConfigurationError.
[[nodiscard]] RigConfiguration with(const RigConfiguration& configuration,
                                    const std::vector<Replacement>& replacements);

}  // namespace rigwire::hil
