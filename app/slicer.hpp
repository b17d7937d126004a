#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "command.hpp"

namespace dynasurf::app {

/// Whether these words ask for the description of a command by the Slicer execution model: `ventricle --xml`.
bool asks_for_slicer_description(const std::vector<std::string>& words);

/// The command's arguments as that model's XML, from what the command line declares of them. Texts and numbers without
/// a default are texts there, so that empty means not given; arguments of several numbers are left out.
std::string slicer_description(const CLI::App& command);

/// A call by Slicer, recognised by `--returnparameterfile FILE`. Removes that argument from `words`, and every argument
/// whose value is empty, which is how Slicer leaves one out. Progress is then printed as XML tags on standard output.
class SlicerCall {
 public:
  explicit SlicerCall(std::vector<std::string>& words);
  /// Writes the numbers of the result at `command`'s --out to the file, `name = value` in lines. Throws IoError.
  void write_returned(const CLI::App& program) const;

 private:
  std::string file_;
};

/// Tells one stage, if Slicer called.
void tell_slicer(std::string_view stage, int done, int total);

}  // namespace dynasurf::app
