// What the build says by macros, as text: MICROFACET_MODULE is the instruction set, and the name of the module.
#pragma once

#define MICROFACET_TEXT_OF(NAME) #NAME
#define MICROFACET_TEXT(NAME) MICROFACET_TEXT_OF(NAME)
#define MICROFACET_NAME "microfacet._core." MICROFACET_TEXT(MICROFACET_MODULE)
