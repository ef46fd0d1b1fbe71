// Files of pieces that are read from the front, among them MCAP.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

#include "hil/configuration/outside_file.h"
#include "protocols/mcap/mcap.h"

namespace rigwire::hil {

/// The largest record or packet, in bytes: all of it is in memory at once.
inline constexpr std::uint64_t kMaxUnitBytes = 256 * kMebibyte;

/// A file from its front in pieces that `take` makes of it: it is given what is there and answers
/// how much of it it took; 0: it needs more. The rest of a file that ends in the middle is left.
/// Throws drivers::EndpointError where the file cannot be opened, FileRefused where it has more
/// than `limit` or `take` needs more than kMaxUnitBytes at once.
void read_pieces(const std::filesystem::path& path, FileLimit limit,
                 const std::function<std::size_t(std::span<const std::uint8_t>)>& take);

/// Calls `use` for each record of an MCAP file, also those within chunks. Throws as read_pieces(),
/// and std::invalid_argument naming file and place where it is malformed or compressed.
void each_mcap_record(const std::filesystem::path& path, FileLimit limit,
                      const std::function<void(const protocols::mcap::Record&)>& use);

/// Whether a file begins as MCAP. False: it cannot be read, too.
[[nodiscard]] bool is_mcap(const std::filesystem::path& path);

}  // namespace rigwire::hil
