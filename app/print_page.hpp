#pragma once
#include <filesystem>

namespace dynasurf::app {

/// The Chromium that prints: chromium, chromium-browser or google-chrome of PATH. Throws IoError when there is none.
std::filesystem::path find_browser();

/// Whether a page is complete as it is read, or draws itself by a script and says so in its title.
enum class PageKind { plain, drawn };

/// Prints a page of ours to a PDF of A4 pages, without a display and without a network. Throws IoError when the browser
/// fails or takes longer than two minutes.
void print_page(const std::filesystem::path& html, const std::filesystem::path& pdf, PageKind kind = PageKind::drawn);

}  // namespace dynasurf::app
