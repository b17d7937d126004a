#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "dynasurf/cohort/detail/cases.hpp"
#include "dynasurf/cohort/detail/cohort_statistics.hpp"

namespace dynasurf::cohort {

/// The page of a cohort, one file that loads nothing: distributions, scatter and agreement plots, all studies with the
/// worst first, keyboard triage, links to the reports. The slices of the 200 worst are in it as pictures; polar maps
/// and volume curves of all. `second` is another cohort of the same studies, to be compared with, or null. `published`
/// is the folder where the page will stand, from which links lead to the reports. Throws IoError.
void write_cohort_page(const Cohort& cohort, const std::vector<StatisticRow>& statistics, const Cohort* second,
                       const std::filesystem::path& published, const std::filesystem::path& path);

/// The report of a study, as an address from the folder of the tables: where there is one, the page that can run the
/// study again.
std::string report_link(const std::filesystem::path& tables, const std::filesystem::path& cohort,
                        const std::string& id);

}  // namespace dynasurf::cohort
