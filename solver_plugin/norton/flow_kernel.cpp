#include "solver_plugin/norton/flow_kernel.hpp"

#include <cstring>
#include <stdexcept>

namespace tomodem::plugin {

FlowKernel::FlowKernel() {
    forces_.set_carry([this](void* first, std::size_t stride, std::size_t size) { carry(first, stride, size); });
}

/// By the highest rate of the load, a sample would slip where it flows slowly and M is small.
double FlowKernel::load_rate(double start) const {
    const double rate = law().at_rest ? 0 : surroundings().rate(start);
    return rate == 0 ? law().flow_rate : rate;
}

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
