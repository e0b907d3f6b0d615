// SPDX-License-Identifier: MIT
//
// Included into every source: the module runs with glibc 2.34 and later. Of the functions that it calls, hypot alone
// has a younger version, which sets no errno.
#pragma once

#include <features.h>

#if defined(__GLIBC__) && defined(__x86_64__)
__asm__(".symver hypot, hypot@GLIBC_2.2.5");
__asm__(".symver hypotf, hypotf@GLIBC_2.2.5");
#endif
