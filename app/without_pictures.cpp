// What takes the place of show.cpp where there is no cairo.
#include "command.hpp"

namespace dynasurf::app {

void add_show(CLI::App& /*program*/, Command& /*chosen*/) {}

}  // namespace dynasurf::app
