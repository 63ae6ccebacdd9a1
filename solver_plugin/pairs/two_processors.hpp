#pragma once

/// A function that is compiled for old processors and for those with AVX2 and FMA; the one that fits is taken at the
/// start of the program. What it calls must be inlined to be compiled twice.
#define TOMODEM_TWO_PROCESSORS __attribute__((target_clones("arch=haswell", "default")))
#define TOMODEM_INLINE [[gnu::always_inline]] inline
