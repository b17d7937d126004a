#pragma once
#include <string>

namespace CLI {
class App;
}

namespace dynasurf::app {

/// Gives --memory-limit to every command that reads studies, clouds or meshes. `text` receives what the user says.
void add_memory_limit(CLI::App& program, std::string& text);

}  // namespace dynasurf::app
