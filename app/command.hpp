#pragma once
#include <functional>
#include <stop_token>

namespace CLI {
class App;
}

namespace dynasurf::app {

/// How the program ends.
enum ExitCode { done = 0, bad_usage = 1, bad_input = 2, not_trustworthy = 3 };

/// What runs once the command line is understood. `stop` becomes requested at Ctrl-C.
using Command = std::function<ExitCode(std::stop_token stop)>;

// One function per subcommand: declares its arguments and sets `chosen` when the user names it.
void add_ventricle(CLI::App& program, Command& chosen);
void add_cloud(CLI::App& program, Command& chosen);
void add_lod(CLI::App& program, Command& chosen);
void add_borders(CLI::App& program, Command& chosen);
void add_info(CLI::App& program, Command& chosen);
void add_phantom(CLI::App& program, Command& chosen);
void add_measure(CLI::App& program, Command& chosen);
void add_options(CLI::App& program, Command& chosen);
void add_rerun(CLI::App& program, Command& chosen);
void add_solid(CLI::App& program, Command& chosen);
void add_organ(CLI::App& program, Command& chosen);
void add_batch(CLI::App& program, Command& chosen);
void add_collect(CLI::App& program, Command& chosen);
void add_bids(CLI::App& program, Command& chosen);
void add_motion(CLI::App& program, Command& chosen);
void add_show(CLI::App& program, Command& chosen);
void add_view(CLI::App& program, Command& chosen);
void add_perfusion(CLI::App& program, Command& chosen);

// What stands behind `perfusion`.
void add_perfusion_build(CLI::App& perfusion, Command& chosen);
void add_perfusion_score(CLI::App& perfusion, Command& chosen);
void add_perfusion_compare(CLI::App& perfusion, Command& chosen);

}  // namespace dynasurf::app
