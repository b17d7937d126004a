#include "dynasurf/report/page_template.hpp"

// The assembler copies the bundled page into the library: a C++ array of this length would take the compiler seconds.
asm(".section .rodata\n"
    "dynasurf_page_template_begin:\n"
    ".incbin \"" DYNASURF_PAGE_TEMPLATE
    "\"\n"
    "dynasurf_page_template_end:\n"
    ".previous\n");

extern "C" {
extern const char page_template_begin[] asm("dynasurf_page_template_begin");
extern const char page_template_end[] asm("dynasurf_page_template_end");
}

namespace dynasurf {

std::string_view page_template() {
  return {page_template_begin, static_cast<std::size_t>(page_template_end - page_template_begin)};
}

}  // namespace dynasurf
