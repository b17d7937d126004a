#include "out_argument.hpp"

#include <CLI/CLI.hpp>

namespace dynasurf::app {

CLI::Option* add_out_folder(CLI::App& command, OutFolder& out, const std::string& what) {
  command.add_flag("--replace", out.replace, "keep whatever stands at --out under another name, such as RESULT.old-1");
  return command.add_option("--out", out.path, what + "; an untouched former result there is replaced");
}

CLI::Option* add_out_file(CLI::App& command, OutFile& out, const std::string& what) {
  command.add_flag("--replace", out.replace, "keep a file that stands at --out under another name, such as FILE.old-1");
  return command.add_option("--out", out.path, what);
}

}  // namespace dynasurf::app
