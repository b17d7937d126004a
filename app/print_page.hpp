#pragma once
#include <filesystem>
#include <stop_token>

namespace dynasurf::app {

/// The Chromium that prints: chromium, chromium-browser or google-chrome of PATH. Throws IoError when there is none.
std::filesystem::path find_browser();

/// Whether a page is complete as it is read, or draws itself by a script and says so in its title.
enum class PageKind { plain, drawn };

/// Prints a page of ours to a PDF of A4 pages, without a display and without a network. Throws IoError when the browser
/// fails or takes longer than two minutes, and Cancelled soon after `stop` is requested. The browser does not outlive
/// this process; what a killed run left in the folder for temporary files goes away with the next run that prints.
/// Call it from the main thread (see run_quietly).
void print_page(const std::filesystem::path& html, const std::filesystem::path& pdf, const std::stop_token& stop,
                PageKind kind = PageKind::drawn);

}  // namespace dynasurf::app
