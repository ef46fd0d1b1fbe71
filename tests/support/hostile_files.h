// What somebody may put in the place of a file that a configuration names.
#pragma once

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace rigwire::test {

struct HostileFile {
  std::string path;
  std::string refusal;  ///< What is to be said of it, behind its path.
};

/// Returns a file of that many bytes which takes no room on disk.
inline std::string make_sparse(const std::filesystem::path& file, std::uint64_t bytes) {
  std::ofstream(file).flush();
  if (::truncate(file.c_str(), static_cast<off_t>(bytes)) != 0) {
    throw std::runtime_error("no file of " + std::to_string(bytes) + " bytes can be made here");
  }
  return file.string();
}

inline std::string make_fifo(const std::filesystem::path& file) {
  if (::mkfifo(file.c_str(), 0600) != 0) {
    throw std::runtime_error("cannot make a FIFO for the test");
  }
  return file.string();
}

/// A directory, a FIFO, a socket, devices, a loop of links and links to some of them; for who is
/// not root also a file that may not be read. All are made in `folder`, which is to be short.
inline std::vector<HostileFile> make_hostile_files(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  const std::string kIrregular = ": not a regular file, found ";
  std::vector<HostileFile> files;
  const auto add = [&](const fs::path& file, const std::string& refusal) {
    files.push_back({file.string(), refusal});
  };
  fs::create_directory(folder / "directory");
  add(folder / "directory", kIrregular + "a directory");
  add(make_fifo(folder / "pipe"), kIrregular + "a FIFO");
  fs::create_symlink("pipe", folder / "link_to_pipe");
  add(folder / "link_to_pipe", kIrregular + "a FIFO");
  for (const char* device : {"/dev/zero", "/dev/full", "/dev/random"}) {
    add(device, kIrregular + "a character device");
  }
  fs::create_symlink("/dev/zero", folder / "link_to_zero");
  add(folder / "link_to_zero", kIrregular + "a character device");
  fs::create_symlink("loop_b", folder / "loop_a");
  fs::create_symlink("loop_a", folder / "loop_b");
  add(folder / "loop_a", ": Too many levels of symbolic links");

  const int listener = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  (folder / "socket").string().copy(address.sun_path, sizeof(address.sun_path) - 1);
  const bool bound =
      ::bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  ::close(listener);
  if (!bound) {
    throw std::runtime_error("cannot make a socket for the test");
  }
  add(folder / "socket", kIrregular + "a socket");

  if (::geteuid() != 0) {
    std::ofstream(folder / "unreadable") << "text";
    fs::permissions(folder / "unreadable", fs::perms::none);
    add(folder / "unreadable", ": Permission denied");
  }
  return files;
}

}  // namespace rigwire::test
