#include "dynasurf/report/program_page.hpp"

#include <span>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/report/detail/page_parts.hpp"

namespace dynasurf::report {
namespace {

constexpr std::uintmax_t most_bytes = std::uintmax_t{1} << 30;

void require_few(const std::vector<PageFile>& files) {
  std::uintmax_t bytes = 0;
  for (const auto& [name, file] : files) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (error) throw IoError(file.string() + ": " + error.message());
    bytes += size;
  }
  if (bytes > most_bytes)
    throw InputError(files.front().file.string() + ": " + std::to_string(bytes) + " bytes in " +
                     std::to_string(files.size()) + " files; a page takes at most " + std::to_string(most_bytes));
}

}  // namespace

std::string page_with_files(std::string_view page, const std::vector<PageFile>& files) {
  constexpr std::string_view place = R"( id="given">)";
  const std::size_t at = page.find(place);
  if (at == std::string_view::npos || !page.substr(at + place.size()).starts_with("</script>"))
    throw InputError("the page has no place for files; expected dynasurf.html as ./dev web makes it");
  require_few(files);
  detail::Json given{{"files", detail::Json::array()}};
  for (const auto& [name, file] : files) {
    detail::Bytes bytes(std::filesystem::file_size(file));
    io::ByteSource source(file, io::ByteSource::Packing::plain);
    source.read(std::as_writable_bytes(std::span(bytes)), "the file");
    given["files"].push_back({{"path", name}, {"deflated", detail::packed(bytes)}});
  }
  std::string filled(page.substr(0, at + place.size()));
  filled += detail::text_for_html(given);
  filled += page.substr(at + place.size());
  return filled;
}

}  // namespace dynasurf::report
