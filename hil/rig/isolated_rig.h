// A rig with wires of its own, so that any number of runs stand side by side on one machine, also
// of one and the same rig.
//
// Everything that a wire of the rig is found by is replaced, as by a `--set` of its key:
//
//   path of a pty           FOLDER/wires/NAME, of the bus, line or device
//   address                 one of a network 127.A.B.0/24 that no other run has; addresses that
//                           differ stay different
//   UDP port of a client    one that nobody is bound to, so that it may be bound at any address
//   CAN interface           slcan on a pty: an interface of the host is everybody's
//   memory of a device      FOLDER/memory/NAME, which begins as a copy of the file
//   files of ground truth   FOLDER/NAME
//
// TCP ports stay: their addresses differ. What devices measure and send is the same as without, but
// for what a device tells of its own address; the configuration's hash is that of the rig.
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

/// What becomes of an address beyond this machine.
enum class RemoteAddresses {
  refused,
  kept,  ///< Where nothing is sent.
};

/// `folder` is absolute and exists. Throws drivers::EndpointError, and ConfigurationError for an
/// address that is refused, with the key's place.
[[nodiscard]] std::vector<Replacement> isolating(const RigConfiguration& configuration,
                                                 const Origins& origins,
                                                 const std::filesystem::path& folder,
                                                 drivers::LoopbackClaims& claims,
                                                 RemoteAddresses remote = RemoteAddresses::refused);

/// The configuration with these values. Throws ConfigurationError.
[[nodiscard]] RigConfiguration with(const RigConfiguration& configuration,
                                    const std::vector<Replacement>& replacements);

}  // namespace rigwire::hil
