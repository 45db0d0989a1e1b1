#include "cli/commands/built_in_page.h"

#include <cstddef>

#ifdef CHRONORMAL_REPORT_PAGE

// The assembler includes the file. A compiler would have to parse an array with a number for each byte.
asm(".pushsection .rodata\n"
    ".global chronormal_page_begin, chronormal_page_end\n"
    ".hidden chronormal_page_begin, chronormal_page_end\n"
    "chronormal_page_begin: .incbin \"" CHRONORMAL_REPORT_PAGE
    "\"\n"
    "chronormal_page_end:\n"
    ".popsection\n");
extern "C" const char chronormal_page_begin[], chronormal_page_end[];

namespace chronormal::cli {
std::string_view built_in_page() noexcept {
  return {chronormal_page_begin, static_cast<std::size_t>(chronormal_page_end - chronormal_page_begin)};
}
}  // namespace chronormal::cli

#else

namespace chronormal::cli {
std::string_view built_in_page() noexcept { return {}; }
}  // namespace chronormal::cli

#endif
