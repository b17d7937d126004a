#include "dynasurf/report/detail/page_template.hpp"

#if defined(__wasm__)
// The assembler of WebAssembly knows no plain section: clang's #embed does it, which GCC has from version 15 on.
#pragma clang diagnostic ignored "-Wc23-extensions"
namespace {
// ccache knows no #embed and would give an object with older pages; it keeps no object of a source with this directive.
[[maybe_unused]] constexpr char not_to_be_cached[] = ".incbin \"";
constexpr char report_page[] = {
#embed DYNASURF_REPORT_PAGE
};
constexpr char cloud_page[] = {
#embed DYNASURF_CLOUD_PAGE
};
// The page in a browser makes neither cohorts nor pages of many instances.
constexpr std::string_view no_page = "<!doctype html><script type=\"application/json\" id=\"data\">{{DATA}}</script>\n";
}  // namespace

namespace dynasurf::report {

std::string_view page_template() { return {report_page, sizeof report_page}; }
std::string_view cloud_page_template() { return {cloud_page, sizeof cloud_page}; }
std::string_view cohort_page_template() { return no_page; }
std::string_view lod_page_template() { return no_page; }

}  // namespace dynasurf::report
#else
// The assembler copies the bundled pages into the library: a C++ array of this length would take the compiler seconds.
#define DYNASURF_EMBED(name, file)  \
  asm(".section .rodata\n" name     \
      "_begin:\n"                   \
      ".incbin \"" file "\"\n" name \
      "_end:\n"                     \
      ".previous\n")
DYNASURF_EMBED("dynasurf_report_page", DYNASURF_REPORT_PAGE);
DYNASURF_EMBED("dynasurf_cloud_page", DYNASURF_CLOUD_PAGE);
DYNASURF_EMBED("dynasurf_lod_page", DYNASURF_LOD_PAGE);
DYNASURF_EMBED("dynasurf_cohort_page", DYNASURF_COHORT_PAGE);

extern "C" {
extern const char report_page_begin[] asm("dynasurf_report_page_begin");
extern const char report_page_end[] asm("dynasurf_report_page_end");
extern const char cloud_page_begin[] asm("dynasurf_cloud_page_begin");
extern const char cloud_page_end[] asm("dynasurf_cloud_page_end");
extern const char lod_page_begin[] asm("dynasurf_lod_page_begin");
extern const char lod_page_end[] asm("dynasurf_lod_page_end");
extern const char cohort_page_begin[] asm("dynasurf_cohort_page_begin");
extern const char cohort_page_end[] asm("dynasurf_cohort_page_end");
}

namespace dynasurf::report {
namespace {

std::string_view between(const char* begin, const char* end) { return {begin, end}; }

}  // namespace

std::string_view page_template() { return between(report_page_begin, report_page_end); }
std::string_view cloud_page_template() { return between(cloud_page_begin, cloud_page_end); }
std::string_view cohort_page_template() { return between(cohort_page_begin, cohort_page_end); }
std::string_view lod_page_template() { return between(lod_page_begin, lod_page_end); }

}  // namespace dynasurf::report
#endif
