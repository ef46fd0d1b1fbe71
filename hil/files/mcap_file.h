// Files of pieces that are read from the front, among them MCAP.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

#include "protocols/mcap/mcap.h"

namespace rigwire::hil {

/// A file from its front in pieces that `take` makes of it: it is given what is there and answers
/// how much of it it took; 0: it needs more. The rest of a file that ends in the middle is left.
/// Throws drivers::EndpointError where the file cannot be read.
void read_pieces(const std::filesystem::path& path,
                 const std::function<std::size_t(std::span<const std::uint8_t>)>& take);

/// Calls `use` for each record of an MCAP file, also those within chunks. Throws as read_pieces(),
/// and std::invalid_argument naming file and place where it is malformed or compressed.
void each_mcap_record(const std::filesystem::path& path,
                      const std::function<void(const protocols::mcap::Record&)>& use);

/// Whether a file begins as MCAP. False: it cannot be read, too.
[[nodiscard]] bool is_mcap(const std::filesystem::path& path);

}  // namespace rigwire::hil
