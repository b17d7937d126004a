// What takes the place of batch.cpp, collect.cpp and bids.cpp where there is no SQLite, or no other process.
#include "command.hpp"

namespace dynasurf::app {

void add_batch(CLI::App& /*program*/, Command& /*chosen*/) {}
void add_collect(CLI::App& /*program*/, Command& /*chosen*/) {}
void add_bids(CLI::App& /*program*/, Command& /*chosen*/) {}

}  // namespace dynasurf::app
