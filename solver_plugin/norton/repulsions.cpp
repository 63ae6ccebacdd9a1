#include "solver_plugin/norton/repulsions.hpp"

#include <cmath>

namespace tomodem::plugin {
namespace {

using C = law::NortonConstants;

/// Of the corner of a push, over strength d^2: a pair that begins to push would have the solver step to and fro.
constexpr float push_rounding = 0.01F;

float separation(const FlowPairs::Pushing& pair, const Four* velocity) {
    return sum_of_three((velocity[pair.particle] - velocity[pair.other]) * (pair.apart / pair.apart[3]));
}

}  // namespace

float Repulsions::Push::at(float straight) {
    const float root = std::sqrt(straight * straight + rounding * rounding);
    share = 0.5F * (1 + straight / root);
    return 0.5F * (straight + root);
}

void Repulsions::find_cores(const LawAtRate& law, const FlowPairs& pairs, const std::vector<FlowFabric>& fabrics) {
    const auto core = static_cast<float>(C::core * law.diameter());
    const auto half_stiffness = static_cast<float>(0.5 * C::core_stiffness * law.diameter());
    cores_.clear();
    const std::vector<FlowPairs::Row>& rows = pairs.rows();
    for (std::size_t row = 0; row + 1 < rows.size(); ++row)
        for (std::uint32_t k = rows[row].begin; k < rows[row + 1].begin; ++k) {
            const float overlap = core - pairs.apart()[k][3];
            if (overlap <= 0) continue;
            const std::int32_t i = rows[row].particle, j = pairs.other()[k];
            cores_.push_back({k, i, j, half_stiffness * (fabrics[i].strength() + fabrics[j].strength()), overlap});
        }
}

/// How a push grows is taken from the pair alone: with what the neighbours change, the forces would have no energy, and
/// the system no symmetry.
void Repulsions::find_pushes(const LawAtRate& law, const FlowPairs& pairs, const std::vector<FlowFabric>& fabrics) {
    const double d = law.diameter();
    const auto reach = static_cast<float>(C::crown * d), core = static_cast<float>(C::core * d);
    const auto half_core = static_cast<float>(0.5 * C::core_stiffness * d);
    const auto pressure = static_cast<float>(C::pressure * d * d / C::rest_density);
    const auto per_strength = static_cast<float>(C::background * d * d);
    pushes_.clear();
    for (const FlowPairs::Pushing& one : pairs.pushing()) {
        const PairGeometry pair(one.apart, 1 / reach);
        const FlowFabric &own = fabrics[one.particle], &theirs = fabrics[one.other];
        const float strengths = own.strength() + theirs.strength(), overlap = core - pair.distance;
        const float pressures =
            own.pressure() - own.background(per_strength) + theirs.pressure() - theirs.background(per_strength);
        Push push{2 * pair.closeness * pressures, 4 * pair.closeness * pair.closeness / reach * pressure * strengths,
                  push_rounding * strengths * static_cast<float>(d * d), 0};
        if (overlap > 0) {
            push.force += half_core * strengths * overlap;
            push.stiffness += half_core * strengths;
        }
        pushes_.push_back(push);
    }
}

void Repulsions::find(const LawAtRate& law, const FlowPairs& pairs, const std::vector<FlowFabric>& fabrics) {
    find_cores(law, pairs, fabrics);
    find_pushes(law, pairs, fabrics);
}

void Repulsions::add(const FlowPairs& pairs, const Four* velocity, float interval, bool whole, Four* net) {
    for (const Core& core : cores_) {
        const Four apart = pairs.apart()[core.pair], direction = apart / apart[3];
        const float parting = sum_of_three((velocity[core.particle] - velocity[core.other]) * direction);
        const float size = whole ? core.force(parting, interval) : -interval * core.stiffness * parting;
        const Four force = with_fourth(size * direction, 0);
        net[core.particle] += force;
        net[core.other] -= force;
    }
    for (std::size_t k = 0; k < pushes_.size(); ++k) {
        const FlowPairs::Pushing& one = pairs.pushing()[k];
        Push& push = pushes_[k];
        const float change = -interval * push.stiffness * separation(one, velocity);
        const float size = whole ? push.at(push.force + change) : push.share * change;
        const Four force = with_fourth(size * (one.apart / one.apart[3]), 0);
        net[one.particle] += force;
        net[one.other] -= force;
    }
}

void Repulsions::add_blocks(const FlowPairs& pairs, float interval, FlowBlock* blocks) const {
    for (const Core& core : cores_) {
        const Four apart = pairs.apart()[core.pair];
        for (const std::int32_t i : {core.particle, core.other})
            blocks[i].add(interval * core.stiffness, apart / apart[3]);
    }
    for (std::size_t k = 0; k < pushes_.size(); ++k) {
        const FlowPairs::Pushing& one = pairs.pushing()[k];
        for (const std::int32_t i : {one.particle, one.other})
            blocks[i].add(interval * pushes_[k].share * pushes_[k].stiffness, one.apart / one.apart[3]);
    }
}

void Repulsions::add_virials(const FlowPairs& pairs, FlowSums* sums) const {
    for (const Core& core : cores_) {
        const Four apart = pairs.apart()[core.pair];
        const Four force = core.stiffness * core.overlap / apart[3] * apart;
        for (const std::int32_t i : {core.particle, core.other}) {
            sums[i].moment[0] += with_fourth(0.5F * force * apart, 0);
            sums[i].moment[1] += 0.5F * force * turned(apart);
        }
    }
}

float Repulsions::push(std::size_t k, const FlowPairs& pairs, const Four* velocity, float interval) const {
    Push push = pushes_[k];
    return push.at(push.force - interval * push.stiffness * separation(pairs.pushing()[k], velocity));
}

double Repulsions::energy(int local_count) const {
    double energy = 0;
    for (const Core& core : cores_)
        energy += (core.other < local_count ? 0.5 : 0.25) * core.stiffness * core.overlap * core.overlap;
    return energy;
}

}  // namespace tomodem::plugin
