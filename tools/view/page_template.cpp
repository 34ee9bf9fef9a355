// The assembler's .incbin puts the file into the read-only data of the program.
#include "view/page_template.h"

asm(".section .rodata\n"
    ".global kerf_page_begin\n"
    ".global kerf_page_end\n"
    "kerf_page_begin:\n"
    ".incbin \"" KERF_PAGE
    "\"\n"
    "kerf_page_end:\n"
    ".previous\n");
extern const char kerf_page_begin[], kerf_page_end[];

namespace view {

std::string page_template() { return {kerf_page_begin, kerf_page_end}; }

}  // namespace view
