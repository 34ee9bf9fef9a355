// The assembler's .incbin puts the file into the read-only data of the program.
#include "live/page_text.h"

asm(".section .rodata\n"
    ".global kerf_live_page_begin\n"
    ".global kerf_live_page_end\n"
    "kerf_live_page_begin:\n"
    ".incbin \"" KERF_PAGE
    "\"\n"
    "kerf_live_page_end:\n"
    ".previous\n");
extern const char kerf_live_page_begin[], kerf_live_page_end[];

namespace live {

std::string page_text() { return {kerf_live_page_begin, kerf_live_page_end}; }

}  // namespace live
