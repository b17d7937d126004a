#pragma once
#include <string>
#include <string_view>

namespace dynasurf::io {

/// One gzip member holding `content`, without a name or a time: the same content gives the same bytes.
std::string gzip(std::string_view content);

}  // namespace dynasurf::io
