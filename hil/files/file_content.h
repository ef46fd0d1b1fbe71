// What the files that a rig names bring into a run, for its hash: two runs of one hash have read
// the same.
#pragma once

#include <string>

#include "fields/visitor.h"

namespace rigwire::hil {

/// A FileContent (hil/configuration/outline.h). Counts, by kind:
///
/// | kind | what |
/// | --- | --- |
/// | data and all that are not named here | its bytes |
/// | mesh | its bytes and those of every file that load_model() opens for it |
/// | geoid | its bytes, of kEgm96File where no file is named |
/// | valve_map, dbc_node | its values and those of what it includes, and the files that it names |
/// | memory | its bytes; nothing where there is none |
///
/// A file that cannot be read as its kind counts by its bytes, one that cannot be read at all by
/// its name. Reads files to their end, in pieces; meshes and YAML with their parsers.
[[nodiscard]] std::string file_content(const std::string& path, fields::FileKind kind);

}  // namespace rigwire::hil
