#include "cli/commands/built_in_page.h"

#include <cstddef>

#ifdef CHRONORMAL_REPORT_PAGE

// The assembler includes the bytes of the page. In C++, the page would be an array with a number for each byte, which
// takes the compiler long to parse. The assembler for Windows has neither .pushsection nor .hidden.
#ifdef _WIN32
#define CHRONORMAL_SECTION_BEGIN ".section .rdata,\"dr\"\n"
#define CHRONORMAL_SECTION_END ".text\n"
#else
#define CHRONORMAL_SECTION_BEGIN ".pushsection .rodata\n.hidden chronormal_page_begin, chronormal_page_end\n"
#define CHRONORMAL_SECTION_END ".popsection\n"
#endif
asm(CHRONORMAL_SECTION_BEGIN
    ".global chronormal_page_begin, chronormal_page_end\n"
    "chronormal_page_begin: .incbin \"" CHRONORMAL_REPORT_PAGE
    "\"\n"
    "chronormal_page_end:\n" CHRONORMAL_SECTION_END);
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
