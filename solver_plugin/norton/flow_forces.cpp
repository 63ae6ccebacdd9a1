#include "solver_plugin/norton/flow_forces.hpp"

#include <algorithm>
#include <cmath>

namespace tomodem::plugin {
namespace {

using C = law::NortonConstants;

/// {x, y, z, -fourth} of the other particle of a pair: what is opposite, and what is the same.
constexpr Four opposite{-1, -1, -1, 1};

}  // namespace

void FlowForces::clear_sums() {
    sums_.assign(static_cast<std::size_t>(count_), FlowSums{});
}

TOMODEM_TWO_PROCESSORS void FlowForces::sum_fabric() {
    const auto over_reach = static_cast<float>(1 / (C::crown * law_.diameter()));
    const std::vector<FlowPairs::Row>& rows = pairs_.rows();
    const std::int32_t* const other = pairs_.other();
    const Four* const apart = pairs_.apart();
    for (std::size_t row = 0; row + 1 < rows.size(); ++row) {
        Four diagonal{}, off{}, outward{};
        for (std::uint32_t k = rows[row].begin; k < rows[row + 1].begin; ++k) {
            const PairGeometry pair(apart[k], over_reach);
            const float weight = pair.closeness * pair.closeness;
            const Four squares = with_fourth(pair.apart * pair.apart, weight);
            const Four mixed = pair.apart * turned(pair.apart), away = pair.direction * weight;
            // Half of the weights: with none, a flow across an interface is seen as it is, with all, one along it.
            const float own_share = 0.5F * (1 + this->weight(k)), other_share = 2 - own_share;
            FlowSums& theirs = sums_[other[k]];
            theirs.moment[0] += with_fourth(other_share * squares, weight);
            theirs.moment[1] += other_share * mixed;
            theirs.outward -= away;
            diagonal += with_fourth(own_share * squares, weight);
            off += own_share * mixed;
            outward += away;
        }
        FlowSums& own = sums_[rows[row].particle];
        own.moment[0] += diagonal;
        own.moment[1] += off;
        own.outward += outward;
    }
    // Where two objects meet, their particles are still at a surface of their own.
    for (int i = 0; i < local_count_; ++i) fabrics_[i].outward[3] = sum_of_three(sums_[i].outward * sums_[i].outward);
    // But it is no free surface any more.
    for (const FlowPairs::Pushing& one : pairs_.pushing()) {
        const PairGeometry pair(one.apart, over_reach);
        const float weight = pair.closeness * pair.closeness;
        sums_[one.particle].outward += pair.direction * weight;
        sums_[one.other].outward -= pair.direction * weight;
        sums_[one.particle].moment[0][3] += weight;
        sums_[one.other].moment[0][3] += weight;
    }
}

void FlowForces::find_fabric() {
    const double d = law_.diameter();
    for (int i = 0; i < local_count_; ++i) {
        const FlowSums& sums = sums_[i];
        const double strength = law_.strength(type_[i]);
        const double diagonal[3] = {sums.moment[0][0], sums.moment[0][1], sums.moment[0][2]};
        const double mixed[3] = {sums.moment[1][0], sums.moment[1][1], sums.moment[1][2]};
        const double floor = law::norton_fabric_floor(d, diagonal, mixed);
        const double xx = sums.moment[0][0] + floor, yy = sums.moment[0][1] + floor, zz = sums.moment[0][2] + floor;
        const double xy = sums.moment[1][0], yz = sums.moment[1][1], zx = sums.moment[1][2];
        const double cofactor[6] = {yy * zz - yz * yz, xx * zz - zx * zx, xx * yy - xy * xy,
                                    yz * zx - xy * zz, xy * zx - xx * yz, xy * yz - yy * zx};
        const double over = 1 / (xx * cofactor[0] + xy * cofactor[3] + zx * cofactor[5]);
        float inverse[6];
        for (int c = 0; c < 6; ++c) inverse[c] = static_cast<float>(cofactor[c] * over);
        double squares = C::smoothing * C::smoothing;
        for (int c = 0; c < 3; ++c) squares += static_cast<double>(sums.outward[c]) * sums.outward[c];
        const double length = std::sqrt(squares);
        const double outside = fabrics_[i].outward[3] / (C::inside * C::inside);
        const double inside = std::max(0.0, 1 - outside * outside);
        const double density = sums.moment[0][3] + C::surface * (length - C::smoothing);
        const double pressure = C::pressure * d * d * strength * (density / C::rest_density - 1) +
                                C::background * d * d * strength * inside;
        FlowFabric& fabric = fabrics_[i];
        fabric.inverse[0] = Four{inverse[0], inverse[3], inverse[5], static_cast<float>(pressure)};
        fabric.inverse[1] = Four{inverse[3], inverse[1], inverse[4], 0};
        fabric.inverse[2] = Four{inverse[5], inverse[4], inverse[2], static_cast<float>(strength)};
        fabric.outward = with_fourth(sums.outward / static_cast<float>(length), static_cast<float>(inside));
    }
}

TOMODEM_TWO_PROCESSORS void FlowForces::add_moments(const Four* velocity) {
    const auto over_reach = static_cast<float>(1 / (C::crown * law_.diameter()));
    const std::vector<FlowPairs::Row>& rows = pairs_.rows();
    const std::int32_t* const other = pairs_.other();
    const Four* const apart = pairs_.apart();
    FlowSums* const all = sums_.data();
    for (std::size_t row = 0; row + 1 < rows.size(); ++row) {
        const std::int32_t i = rows[row].particle;
        const Four own = velocity[i];
        Four x{}, y{}, z{}, outward{};
        for (std::uint32_t k = rows[row].begin; k < rows[row + 1].begin; ++k) {
            const std::int32_t j = other[k];
            const PairGeometry pair(apart[k], over_reach);
            const Four speed = own - velocity[j];
            const float own_weight = weight(k), other_weight = 2 - own_weight;
            const Four of_x = pair.apart * speed[0], of_y = pair.apart * speed[1], of_z = pair.apart * speed[2];
            const float separation = sum_of_three(speed * pair.direction);
            const float crowding = -2 * pair.closeness * over_reach * separation;
            const float turning = pair.closeness * pair.closeness * pair.over_distance;
            const Four tilt =
                with_fourth(pair.direction * (crowding - turning * separation) + speed * turning, crowding);
            FlowSums& theirs = all[j];
            theirs.moment[0] += other_weight * of_x;
            theirs.moment[1] += other_weight * of_y;
            theirs.moment[2] += other_weight * of_z;
            theirs.outward += opposite * tilt;
            x += own_weight * of_x;
            y += own_weight * of_y;
            z += own_weight * of_z;
            outward += tilt;
        }
        FlowSums& mine = all[i];
        mine.moment[0] += x;
        mine.moment[1] += y;
        mine.moment[2] += z;
        mine.outward += outward;
    }
}

/// With fresh viscosities the pressure is the whole of it, else its change alone.
TOMODEM_TWO_PROCESSORS void FlowForces::find_states(bool fresh_viscosity) {
    const double d = law_.diameter();
    const auto volume = static_cast<float>(C::volume * d * d * d), surface = static_cast<float>(C::surface);
    const auto bulk = static_cast<float>(C::bulk_viscosity);
    const auto stiffness = static_cast<float>(C::pressure * d * d / C::rest_density) * interval_;
    // The square of a rate must stay in the range of single precision: rates are taken in units of the load's.
    const auto over_rate = static_cast<float>(1 / law_.law().flow_rate);
    const auto least = static_cast<float>(law_.law().min_rate / law_.law().flow_rate);
    for (int i = 0; i < local_count_; ++i) {
        const FlowSums& sums = sums_[i];
        FlowFabric& fabric = fabrics_[i];
        FlowState& state = states_[i];
        Four gradient[3];
        for (int a = 0; a < 3; ++a) gradient[a] = times(fabric.inverse, sums.moment[a]);
        const Four diagonal{gradient[0][0], gradient[1][1], gradient[2][2], 0};
        const Four off{gradient[0][1] + gradient[1][0], gradient[1][2] + gradient[2][1],
                       gradient[2][0] + gradient[0][2], 0};
        const float growth = sum_of_three(diagonal);
        if (fresh_viscosity) {
            const law::NortonMaterial& material = law_.law().materials[type_[i]];
            const Four deviator = (diagonal - four(growth / 3)) * over_rate, shear = off * over_rate;
            float square = 2.0F / 3 * (sum_of_three(deviator * deviator) + 0.5F * sum_of_three(shear * shear));
            square = law_.law().at_rest ? 1 : square + least * least;
            const auto exponent = static_cast<float>(0.5 * (material.rate_sensitivity - 1));
            const double at_flow_rate =
                material.consistency * std::pow(law_.law().flow_rate, material.rate_sensitivity - 1);
            fabric.inverse[1][3] = static_cast<float>(at_flow_rate) * std::pow(square, exponent);
        }
        const float viscosity = fabric.viscosity();
        const float shear = 2.0F / 3 * viscosity, mean = (bulk * viscosity - shear / 3) * growth;
        const Four xyz = shear * diagonal + four(mean), mixed = 0.5F * shear * off;
        const Four stress[3] = {
            {xyz[0], mixed[0], mixed[2], 0}, {mixed[0], xyz[1], mixed[1], 0}, {mixed[2], mixed[1], xyz[2], 0}};
        const float pressed =
            stiffness * fabric.strength() * (sums.outward[3] + surface * sum_of_three(fabric.outward * sums.outward));
        const float pressure = fresh_viscosity ? fabric.pressure() + pressed : pressed;
        // The inverse is symmetric: its columns are its rows.
        for (int b = 0; b < 3; ++b) state.traction[b] = volume * times(stress, fabric.inverse[b]);
        if (fresh_viscosity)
            for (int b = 0; b < 3; ++b) state.traction[b] += corrections_[i].column[b];
        state.traction[0][3] = pressure;
        state.traction[1][3] = viscosity;
        state.diagonal = diagonal;
        state.off = off;
        state.lateral = surface * pressure * fabric.outward;
    }
}

TOMODEM_TWO_PROCESSORS void FlowForces::add_forces(const Four* velocity) {
    const auto reach = static_cast<float>(C::crown * law_.diameter());
    const auto share = static_cast<float>(2 * C::pair_share * law_.diameter());
    const std::vector<FlowPairs::Row>& rows = pairs_.rows();
    const std::int32_t* const other = pairs_.other();
    const Four* const apart = pairs_.apart();
    const FlowState* const states = states_.data();
    for (std::size_t row = 0; row + 1 < rows.size(); ++row) {
        const std::int32_t i = rows[row].particle;
        const FlowState& own = states[i];
        Four sum{};
        for (std::uint32_t k = rows[row].begin; k < rows[row + 1].begin; ++k) {
            const std::int32_t j = other[k];
            const FlowState& theirs = states[j];
            const PairGeometry pair(apart[k], 1 / reach);
            const float one = own.viscosity(), two = theirs.viscosity();
            damping_[k] = share * one / (one + two) * two;
            Four force = viscous_force(pair, velocity[i] - velocity[j], own, theirs, damping_[k], weight(k));
            const float load = std::sqrt(sum_of_three(force * force));
            force = with_fourth(force + pressure_force(pair, own, theirs, reach), load);
            net_[j] += opposite * force;
            sum += force;
        }
        net_[i] += sum;
    }
}

TOMODEM_TWO_PROCESSORS void FlowForces::add_changes(const Four* direction) {
    const auto reach = static_cast<float>(C::crown * law_.diameter());
    const std::vector<FlowPairs::Row>& rows = pairs_.rows();
    const std::int32_t* const other = pairs_.other();
    const Four* const apart = pairs_.apart();
    const float* const damping = damping_.data();
    const FlowState* const states = states_.data();
    Four* const net = net_.data();
    for (std::size_t row = 0; row + 1 < rows.size(); ++row) {
        const std::int32_t i = rows[row].particle;
        const FlowState& own = states[i];
        Four sum{};
        for (std::uint32_t k = rows[row].begin; k < rows[row + 1].begin; ++k) {
            const std::int32_t j = other[k];
            const PairGeometry pair(apart[k], 1 / reach);
            const Four force = viscous_force(pair, direction[i] - direction[j], own, states[j], damping[k], weight(k)) +
                               pressure_force(pair, own, states[j], reach);
            net[j] -= force;
            sum += force;
        }
        net[i] += sum;
    }
}

void FlowForces::place(const ParticleView& particles, bool renumbered) {
    local_count_ = particles.local_count;
    count_ = particles.count;
    pairs_.find(particles, C::crown * law_.diameter(), renumbered);
    type_.resize(static_cast<std::size_t>(count_));
    for (int i = 0; i < count_; ++i) type_[i] = static_cast<std::uint8_t>(particles.type[i] - 1);
    const auto count = static_cast<std::size_t>(count_);
    fabrics_.resize(count);
    states_.resize(count);
    net_.resize(count);
    damping_.resize(pairs_.size());
    weights_.clear();
    corrections_.assign(static_cast<std::size_t>(local_count_), Correction{});
    set_walls({});
    find_geometry();
    repulsions_.find(law_, pairs_, fabrics_);
}

void FlowForces::find_geometry() {
    clear_sums();
    sum_fabric();
    find_fabric();
    carry_(fabrics_.data(), sizeof(FlowFabric), sizeof(FlowFabric));
    clear_sums();
}

/// States with these velocities, ghosts included.
void FlowForces::find_flow(const Four* velocity) {
    add_moments(velocity);
    find_states(true);
    clear_sums();
    films_.add_to_states(velocity, true, fabrics_.data(), states_.data());
    carry_(states_.data(), sizeof(FlowState), sizeof(FlowState));
}

/// By the viscosities of the last flow.
void FlowForces::weigh() {
    weights_.assign(pairs_.size(), 1);
    const std::vector<FlowPairs::Row>& rows = pairs_.rows();
    for (std::size_t row = 0; row + 1 < rows.size(); ++row) {
        const std::int32_t i = rows[row].particle;
        for (std::uint32_t k = rows[row].begin; k < rows[row + 1].begin; ++k) {
            const std::int32_t j = pairs_.other()[k];
            if (type_[i] == type_[j]) continue;
            const float own = states_[i].viscosity(), theirs = states_[j].viscosity();
            weights_[k] = 2 * theirs / (own + theirs);
        }
    }
}

/// Of each particle, over its neighbours: half of sum sym(f r), f without the tractions.
/// Sums: moment[0] the diagonal, moment[1] xy, yz, zx; the fourths: the trace of the background's share, -.
TOMODEM_TWO_PROCESSORS void FlowForces::sum_virials(const Four* velocity) {
    const auto reach = static_cast<float>(C::crown * law_.diameter());
    const auto share = static_cast<float>(2 * C::pair_share * law_.diameter());
    const auto surface = static_cast<float>(C::surface);
    const auto per_strength = static_cast<float>(C::background * law_.diameter() * law_.diameter());
    const float flows = law_.law().at_rest ? 0 : 1;
    const std::vector<FlowPairs::Row>& rows = pairs_.rows();
    const std::int32_t* const other = pairs_.other();
    const Four* const apart = pairs_.apart();
    for (std::size_t row = 0; row + 1 < rows.size(); ++row) {
        const std::int32_t i = rows[row].particle;
        const FlowFabric& own = fabrics_[i];
        const float own_background = own.background(per_strength);
        Four diagonal{}, off{};
        for (std::uint32_t k = rows[row].begin; k < rows[row + 1].begin; ++k) {
            const std::int32_t j = other[k];
            const FlowFabric& theirs = fabrics_[j];
            const PairGeometry pair(apart[k], 1 / reach);
            const float their_background = theirs.background(per_strength);
            const Four pressed =
                pressure_force(pair, own.pressure() + theirs.pressure(),
                               surface * (own.pressure() * own.outward - theirs.pressure() * theirs.outward), reach);
            const Four backed =
                pressure_force(pair, own_background + their_background,
                               surface * (own_background * own.outward - their_background * theirs.outward), reach);
            const float one = states_[i].viscosity(), two = states_[j].viscosity();
            const Four force = pressed + pair_term(pair, velocity[i] - velocity[j], states_[i], states_[j],
                                                   flows * share * one / (one + two) * two);
            const Four squares = with_fourth(0.5F * force * pair.apart, 0.5F * sum_of_three(backed * pair.apart));
            const Four mixed = 0.25F * (force * turned(pair.apart) + turned(force) * pair.apart);
            FlowSums& neighbour = sums_[j];
            neighbour.moment[0] += squares;
            neighbour.moment[1] += mixed;
            diagonal += squares;
            off += mixed;
        }
        sums_[i].moment[0] += diagonal;
        sums_[i].moment[1] += off;
    }
}

void FlowForces::correct(const Four* velocity) {
    corrections_.assign(static_cast<std::size_t>(local_count_), Correction{});
    weights_.clear();
    find_flow(velocity);
    // The weights go by the viscosities, and these by a flow that is seen with the weights.
    for (int pass = 1; pass < passes_of_a_correction(); ++pass) {
        weigh();
        find_geometry();
        find_flow(velocity);
    }
    sum_virials(velocity);
    repulsions_.add_virials(pairs_, sums_.data());
    const auto d = static_cast<float>(law_.diameter());
    for (int i = 0; i < local_count_; ++i) {
        const Four diagonal = sums_[i].moment[0], off = sums_[i].moment[1];
        const FlowFabric& fabric = fabrics_[i];
        const Four deviator = diagonal - four((sum_of_three(diagonal) - diagonal[3]) / 3);
        const Four rows[3] = {
            {deviator[0], off[0], off[2], 0}, {off[0], deviator[1], off[1], 0}, {off[2], off[1], deviator[2], 0}};
        const Four shear = deviator - four(sum_of_three(deviator) / 3);
        const float stress = std::sqrt(1.5F * sum_of_three(shear * shear) + 3 * sum_of_three(off * off));
        const double flow_stress = law_.flow_stress(type_[i]);
        const float most = static_cast<float>(C::most_corrected * C::volume * flow_stress) * d * d * d;
        const float share = fabric.inside() * std::min(1.0F, most / stress);
        for (int b = 0; b < 3; ++b) corrections_[i].column[b] = share * times(rows, fabric.inverse[b]);
    }
    clear_sums();
}

double FlowForces::wall_force(const WallContact& contact) const {
    const double d = law_.diameter(), depth = contact.distance - d / 2;
    const FlowState& state = states_[static_cast<std::size_t>(contact.particle)];
    double stretch = 0;
    for (int c = 0; c < 3; ++c)
        stretch +=
            contact.normal[c] * (state.diagonal[c] * contact.normal[c] + state.off[c] * contact.normal[(c + 1) % 3]);
    return -law_.film_damping(contact.type - 1) * (contact.rate - depth * stretch) -
           law_.wall_stiffness(contact.type - 1, depth) * (depth + interval_ * contact.rate);
}

void FlowForces::add_pair_forces(const Four* velocity) {
    net_.assign(static_cast<std::size_t>(count_), Four{});
    add_forces(velocity);
    repulsions_.add(pairs_, velocity, interval_, true, net_.data());
}

void FlowForces::find(const Four* velocity) {
    find_flow(velocity);
    add_pair_forces(velocity);
    films_.add_forces(velocity, interval_, true, net_.data());
}

void FlowForces::find_corrected(const Four* velocity) {
    correct(velocity);
    for (int i = 0; i < local_count_; ++i)
        for (int b = 0; b < 3; ++b) states_[i].traction[b] += corrections_[i].column[b];
    carry_(states_.data(), sizeof(FlowState), sizeof(FlowState));
    add_pair_forces(velocity);
}

void FlowForces::product(Four* direction) {
    carry_(direction, sizeof(Four), 3 * sizeof(float));
    add_moments(direction);
    find_states(false);
    clear_sums();
    films_.add_to_states(direction, false, fabrics_.data(), states_.data());
    carry_(states_.data(), sizeof(FlowState), sizeof(FlowState));
    net_.assign(static_cast<std::size_t>(count_), Four{});
    add_changes(direction);
    repulsions_.add(pairs_, direction, interval_, false, net_.data());
    films_.add_forces(direction, interval_, false, net_.data());
}

void FlowForces::for_each_force(const Four* velocity, const PairKernel::UsePair& use) const {
    const auto reach = static_cast<float>(C::crown * law_.diameter());
    const auto report = [&](std::int32_t i, std::int32_t j, Four force, Four apart) {
        const double on_particle[3] = {force[0], force[1], force[2]}, arm[3] = {apart[0], apart[1], apart[2]};
        use(i, j, on_particle, arm);
    };
    auto core = repulsions_.cores().begin();
    for (std::size_t row = 0; row + 1 < pairs_.rows().size(); ++row) {
        const std::int32_t i = pairs_.rows()[row].particle;
        for (std::uint32_t k = pairs_.rows()[row].begin; k < pairs_.rows()[row + 1].begin; ++k) {
            const std::int32_t j = pairs_.other()[k];
            const PairGeometry pair(pairs_.apart()[k], 1 / reach);
            const Four speed = velocity[i] - velocity[j];
            Four force = viscous_force(pair, speed, states_[i], states_[j], damping_[k], weight(k)) +
                         pressure_force(pair, states_[i], states_[j], reach);
            if (core != repulsions_.cores().end() && core->pair == k) {
                force += core->force(sum_of_three(speed * pair.direction), interval_) * pair.direction;
                ++core;
            }
            report(i, j, force, pair.apart);
        }
    }
    for (std::size_t k = 0; k < pairs_.pushing().size(); ++k) {
        const FlowPairs::Pushing& one = pairs_.pushing()[k];
        const Four direction = one.apart / one.apart[3];
        report(one.particle, one.other, repulsions_.push(k, pairs_, velocity, interval_) * direction, one.apart);
    }
}

}  // namespace tomodem::plugin
