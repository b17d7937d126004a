#pragma once
#include <string>
#include <string_view>

namespace dynasurf::app {

/// Text as valid UTF-8: each byte that belongs to no character is written as four characters, "\xe9". For names of
/// files, which are bytes, where they enter JSON and HTML.
std::string valid_utf8(std::string_view text);

/// Text that a terminal may show: as `valid_utf8`, and control characters (all but newline and tab), and those that
/// turn the direction of writing, stand as "\u009b". In JSON, where such characters occur in strings alone, it means
/// the same as before.
std::string printable(std::string_view text);

/// A path as it stands in an address: every byte but letters, digits and "/-_.~" as "%E4".
std::string address_of(std::string_view path);

}  // namespace dynasurf::app
