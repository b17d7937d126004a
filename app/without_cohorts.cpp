// What takes the place of batch.cpp, collect.cpp, bids.cpp and normal_studies.cpp where there is no SQLite, or no other
// process.
#include "command.hpp"
#include "normal_studies.hpp"

namespace dynasurf::app {

void add_batch(CLI::App& /*program*/, Command& /*chosen*/) {}
void add_collect(CLI::App& /*program*/, Command& /*chosen*/) {}
void add_bids(CLI::App& /*program*/, Command& /*chosen*/) {}
bool is_cohort(const std::filesystem::path& /*folder*/) { return false; }
NormalStudies normal_studies_of(const std::filesystem::path& /*cohort*/, const std::vector<std::string>& /*columns*/,
                                const ColumnValues& /*where*/) {
  return {};
}

}  // namespace dynasurf::app
