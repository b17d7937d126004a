#pragma once
#include <string_view>

namespace dynasurf {

/// The page of web/ as bundled when building. Its one `{{DATA}}` is where the JSON of a result belongs.
std::string_view page_template();

}  // namespace dynasurf
