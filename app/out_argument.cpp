#include "out_argument.hpp"

namespace dynasurf::app {

Argument add_out_folder(CommandLine& command, OutFolder& out, const std::string& what) {
  command.flag("--replace", out.replace, "keep whatever stands at --out under another name, such as RESULT.old-1");
  return command.option("--out", out.path, what + "; an untouched former result there is replaced");
}

Argument add_out_file(CommandLine& command, OutFile& out, const std::string& what) {
  command.flag("--replace", out.replace, "keep a file that stands at --out under another name, such as FILE.old-1");
  return command.option("--out", out.path, what);
}

}  // namespace dynasurf::app
