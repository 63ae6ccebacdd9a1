#pragma once
#include "solver_plugin/pairs/two_processors.hpp"

namespace tomodem::plugin {

/// Four numbers in one register: a vector and a fourth number that is as good as free. Compilers have this extension
/// for every processor.
typedef float Four __attribute__((vector_size(16)));

TOMODEM_INLINE Four four(float x) {
    return Four{x, x, x, x};
}
TOMODEM_INLINE float sum_of_three(Four v) {
    return v[0] + v[1] + v[2];
}
TOMODEM_INLINE Four with_fourth(Four vector, float fourth) {
    return Four{vector[0], vector[1], vector[2], fourth};
}
/// Of a symmetric matrix, by its rows, and a vector.
TOMODEM_INLINE Four times(const Four* rows, Four vector) {
    return vector[0] * rows[0] + vector[1] * rows[1] + vector[2] * rows[2];
}
/// {y, z, x, fourth}
TOMODEM_INLINE Four turned(Four v) {
    return Four{v[1], v[2], v[0], v[3]};
}

}  // namespace tomodem::plugin
