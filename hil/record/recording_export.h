// Topics of a recording's truth as tables, for spreadsheets and pandas.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string_view>

#include "hil/record/recording_writer.h"

namespace rigwire::hil {

/// By TruthTrack, as the command line has them.
inline constexpr std::array<std::string_view, kTruthTracks> kExportedTopics{
    "truth", "transforms", "antenna", "statistics", "events", "motion", "joints", "points"};

/// Writes a line of column names and a line for each message: `sim_s`, exact to the nanosecond,
/// then every member that any message has, in the order in which they appear; members of members
/// are joined by a point, elements of lists are numbered from 0. What a message does not have is
/// left empty. Numbers as they are recorded, texts in quotes (RFC 4180). Reads the recording twice;
/// holds one message. Returns how many there were. Throws as read_recording(), and
/// drivers::EndpointError where the file cannot be written.
std::size_t export_csv(const std::filesystem::path& folder, TruthTrack topic,
                       const std::filesystem::path& file);

}  // namespace rigwire::hil
