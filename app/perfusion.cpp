#include "command.hpp"
#include "command_line.hpp"

namespace dynasurf::app {

void add_perfusion(CLI::App& program, Command& chosen) {
  CLI::App& perfusion =
      add_group(program, "perfusion", "Normal maps of perfusion, scores against them, rest compared with stress");
  add_perfusion_build(perfusion, chosen);
  add_perfusion_score(perfusion, chosen);
  add_perfusion_compare(perfusion, chosen);
}

}  // namespace dynasurf::app
