#pragma once

namespace tomodem::plugin {

/// Four numbers in one register: a vector and a fourth number that is as good as free. Compilers have this extension
/// for every processor.
typedef float Four __attribute__((vector_size(16)));

/// A function that is compiled for old processors and for those with AVX2 and FMA; the one that fits is taken at the
/// start of the program. What it calls must be inlined to be compiled twice.
#define TOMODEM_TWO_PROCESSORS __attribute__((target_clones("arch=haswell", "default")))
#define TOMODEM_INLINE [[gnu::always_inline]] inline

TOMODEM_INLINE Four four(float x) {
    return Four{x, x, x, x};
}
TOMODEM_INLINE float sum_of_three(Four v) {
    return v[0] + v[1] + v[2];
}
/// {y, z, x, fourth}
TOMODEM_INLINE Four turned(Four v) {
    return Four{v[1], v[2], v[0], v[3]};
}

}  // namespace tomodem::plugin
