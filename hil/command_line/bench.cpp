#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "hil/command_line/verbs.h"

namespace rigwire::hil {

int bench_verb(const std::vector<std::string>& arguments, Terminal terminal) {
  const std::filesystem::path program =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / "rigwire-bench";
  // argv as execv() takes it: the program's name first, a null pointer last.
  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);
  terminal.out.flush();
  ::execv(words.front().c_str(), pointers.data());
  const int error = errno;
  terminal.err << fmt::format("rigwire: cannot start {}: {}", words.front(), std::strerror(error))
               << (error == ENOENT ? "; build it: scripts/build.sh release rigwire-bench\n" : "\n");
  return static_cast<int>(ExitCode::environment);
}

}  // namespace rigwire::hil
