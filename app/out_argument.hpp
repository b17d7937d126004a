#pragma once
#include <filesystem>
#include <string>

#include "dynasurf/io/detail/atomic_file.hpp"

#include "command_line.hpp"

namespace dynasurf::app {

/// --out and --replace, of every command that writes a folder.
struct OutFolder {
  std::string path;
  bool replace = false;

  bool is_asked() const { return !path.empty(); }
  io::Existing existing() const { return replace ? io::Existing::move_aside : io::Existing::replace; }
};

/// `what` says what the folder is for.
Argument add_out_folder(CommandLine& command, OutFolder& out, const std::string& what);

/// --out and --replace, of every command that writes one file. An existing file is never written over.
struct OutFile {
  std::string path;
  bool replace = false;

  io::Existing existing() const { return replace ? io::Existing::move_aside : io::Existing::refuse; }
};

Argument add_out_file(CommandLine& command, OutFile& out, const std::string& what);

/// What is printed of a former file or folder that --replace moved aside; empty when there was none.
template <class Output>
std::string line_of_moved(const Output& output) {
  return output.moved_to() ? "moved aside: " + output.moved_to()->string() + "\n" : std::string();
}

}  // namespace dynasurf::app
