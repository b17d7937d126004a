#pragma once
#include <string_view>

namespace dynasurf::report {

/// The page of web/ as bundled when building. Its one `{{DATA}}` is where the JSON of a result belongs.
std::string_view page_template();
/// The same for a cloud.
std::string_view cloud_page_template();
/// The page on which many instances of a chain of levels of detail move.
std::string_view lod_page_template();
/// The page of a cohort of studies.
std::string_view cohort_page_template();

}  // namespace dynasurf::report
