// The blocks of FlowForces that a preconditioner begins with.
#include "solver_plugin/norton/flow_forces.hpp"

namespace tomodem::plugin {

using C = law::NortonConstants;

TOMODEM_TWO_PROCESSORS void FlowForces::add_block_parts(std::vector<FlowBlock>& blocks) const {
    const double d = law_.diameter();
    const auto reach = static_cast<float>(C::crown * d), volume = static_cast<float>(C::volume * d * d * d);
    const auto stiffness = static_cast<float>(C::pressure * d * d / C::rest_density) * interval_ * reach;
    const auto surface = static_cast<float>(C::surface);
    constexpr auto bulk = static_cast<float>(1.0 / 9 + C::bulk_viscosity);
    const std::vector<FlowPairs::Row>& rows = pairs_.rows();
    /// Of a particle's own flow and pressure, with its own velocity.
    struct Own {
        Four arm, crowding;
    };
    std::vector<Own> own(static_cast<std::size_t>(count_), Own{});
    // T = V eta (...) A*^-1 r
    const auto through_flow = [&](const FlowFabric& fabric, Four arm, FlowBlock& block) __attribute__((always_inline)) {
        const Four reached = times(fabric.inverse, arm);
        const float size = volume * fabric.viscosity();
        block.diagonal += size * (four(sum_of_three(reached * reached) / 3) + bulk * reached * reached);
        block.off += size * bulk * reached * turned(reached);
    };
    const auto through_pressure = [&](const FlowFabric& fabric, Four crowding, FlowBlock& block)
        __attribute__((always_inline)) {
        block.add(stiffness * fabric.strength(), crowding);
    };
    const auto reached_along = [&](const WallFilms::Film& film, Four arm) __attribute__((always_inline)) {
        return sum_of_three(film.normal * times(fabrics_[film.particle].inverse, arm));
    };
    /// @param share  of the slip in a particle's velocity along the normal
    const auto through_film =
        [](const WallFilms::Film& film, float share, FlowBlock& block) __attribute__((always_inline)) {
        block.add(film.damping * share * share, film.normal);
    };
    for (std::size_t row = 0; row + 1 < rows.size(); ++row)
        for (std::uint32_t k = rows[row].begin; k < rows[row + 1].begin; ++k) {
            const std::int32_t ends[2] = {rows[row].particle, pairs_.other()[k]};
            const PairGeometry pair(pairs_.apart()[k], 1 / reach);
            const float slope = -2 * pair.closeness / reach;
            const float turning = pair.closeness * pair.closeness * pair.over_distance;
            Four tilt[2];  // change of the outward part of each particle with their relative velocity
            for (int side = 0; side < 2; ++side) {
                const Four outward = fabrics_[ends[side]].outward;
                const float along = sum_of_three(outward * pair.direction);
                tilt[side] = surface * ((slope - turning) * along * pair.direction + turning * outward);
            }
            for (int side = 0; side < 2; ++side) {
                const float sign = side == 0 ? 1.0F : -1.0F;
                FlowBlock& block = blocks[ends[side]];
                through_flow(fabrics_[ends[1 - side]], pair.apart, block);
                through_pressure(fabrics_[ends[1 - side]], sign * slope * pair.direction - tilt[1 - side], block);
                if (const WallFilms::Film* const film = films_.of(ends[1 - side]); film != nullptr)
                    through_film(*film, film->depth * reached_along(*film, pair.apart), block);
                block.add(damping_[k], pair.direction);
                own[ends[side]].arm += sign * pair.apart;
                own[ends[side]].crowding += sign * slope * pair.direction + tilt[side];
            }
        }
    for (int i = 0; i < local_count_; ++i) {
        through_flow(fabrics_[i], own[i].arm, blocks[i]);
        through_pressure(fabrics_[i], own[i].crowding, blocks[i]);
        // A particle that nothing touches keeps its velocity.
        blocks[i].diagonal += four(1e-6F * static_cast<float>(d) * fabrics_[i].viscosity());
    }
    for (const WallFilms::Film& film : films_.films())
        through_film(film, 1 - film.depth * reached_along(film, own[film.particle].arm), blocks[film.particle]);
}

/// Where a particle has two walls, one counts in the blocks of its neighbours, which are an approximation anyway.
void FlowForces::prepare_blocks(std::vector<FlowBlock>& blocks) {
    carry_(fabrics_.data(), sizeof(FlowFabric), sizeof(FlowFabric));
    blocks.assign(static_cast<std::size_t>(count_), FlowBlock{});
    add_block_parts(blocks);
    repulsions_.add_blocks(pairs_, interval_, blocks.data());
    films_.add_blocks(interval_, blocks.data());
}

}  // namespace tomodem::plugin
