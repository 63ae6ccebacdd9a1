#include "solver_plugin/quasi_static/flow_kernel.hpp"

#include <cstring>
#include <stdexcept>

namespace tomodem::plugin {

void FlowKernel::carry(void* first, std::size_t stride, std::size_t size) {
    first_ = static_cast<char*>(first);
    stride_ = stride;
    size_ = size;
    if (carried() > most_carried) throw std::logic_error("FlowKernel: an exchange has no room for so much");
    exchange();
}

void FlowKernel::pack(int i, double* numbers) const {
    std::memcpy(numbers, first_ + static_cast<std::size_t>(i) * stride_, size_);
}

void FlowKernel::unpack(int i, const double* numbers) {
    std::memcpy(first_ + static_cast<std::size_t>(i) * stride_, numbers, size_);
}

}  // namespace tomodem::plugin
