#include "solver_plugin/quasi_static/flow_forces.hpp"

#include <algorithm>
#include <cmath>

namespace tomodem::plugin {
namespace {

using C = law::NortonConstants;

/// Of a pair, ready to be multiplied.
struct Geometry {
    Four apart, direction;  // the fourth of the direction is 1
    float distance, over_distance, closeness;

    TOMODEM_INLINE Geometry(Four row, float over_reach)
        : apart(row), distance(row[3]), over_distance(1 / row[3]), closeness(std::max(0.0F, 1 - row[3] * over_reach)) {
        direction = apart * over_distance;
    }
};

/// {x, y, z, -fourth} of the other particle of a pair: what is opposite, and what is the same.
constexpr Four opposite{-1, -1, -1, 1};

/// Of the corner of a push, over strength d^2: a pair that begins to push would have the solver step to and fro.
constexpr float push_rounding = 0.01F;

/// In the fourth place.
TOMODEM_INLINE Four with_fourth(Four vector, float fourth) {
    return Four{vector[0], vector[1], vector[2], fourth};
}

}  // namespace

float FlowForces::Push::at(float straight) {
    const float root = std::sqrt(straight * straight + rounding * rounding);
    share = 0.5F * (1 + straight / root);
    return 0.5F * (straight + root);
}

void FlowForces::clear_sums() {
    sums_.assign(static_cast<std::size_t>(count_), Sums{});
}

TOMODEM_TWO_PROCESSORS void FlowForces::sum_fabric() {
    const auto over_reach = static_cast<float>(1 / (C::crown * law_.seed_diameter));
    const std::vector<FlowPairs::Row>& rows = pairs_.rows();
    const std::int32_t* const other = pairs_.other();
    const Four* const apart = pairs_.apart();
    for (std::size_t row = 0; row + 1 < rows.size(); ++row) {
        Four diagonal{}, off{}, outward{};
        for (std::uint32_t k = rows[row].begin; k < rows[row + 1].begin; ++k) {
            const Geometry pair(apart[k], over_reach);
            const float weight = pair.closeness * pair.closeness;
            const Four squares = with_fourth(pair.apart * pair.apart, weight);
            const Four mixed = pair.apart * turned(pair.apart), away = pair.direction * weight;
            // Half of the weights: with none, a flow across an interface is seen as it is, with all, one along it.
            const float own_share = 0.5F * (1 + this->weight(k)), other_share = 2 - own_share;
            Sums& theirs = sums_[other[k]];
            theirs.moment[0] += with_fourth(other_share * squares, weight);
            theirs.moment[1] += other_share * mixed;
            theirs.outward -= away;
            diagonal += with_fourth(own_share * squares, weight);
            off += own_share * mixed;
            outward += away;
        }
        Sums& own = sums_[rows[row].particle];
        own.moment[0] += diagonal;
        own.moment[1] += off;
        own.outward += outward;
    }
    // Where two objects meet, their particles are still at a surface of their own.
    for (int i = 0; i < local_count_; ++i) fabrics_[i].outward[3] = sum_of_three(sums_[i].outward * sums_[i].outward);
    // But it is no free surface any more.
    for (const FlowPairs::Pushing& one : pairs_.pushing()) {
        const Geometry pair(one.apart, over_reach);
        const float weight = pair.closeness * pair.closeness;
        sums_[one.particle].outward += pair.direction * weight;
        sums_[one.other].outward -= pair.direction * weight;
        sums_[one.particle].moment[0][3] += weight;
        sums_[one.other].moment[0][3] += weight;
    }
}

void FlowForces::find_fabric() {
    const double d = law_.seed_diameter;
    for (int i = 0; i < local_count_; ++i) {
        const Sums& sums = sums_[i];
        const double strength = strengths_[type_[i]];
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
        Fabric& fabric = fabrics_[i];
        fabric.inverse[0] = Four{inverse[0], inverse[3], inverse[5], static_cast<float>(pressure)};
        fabric.inverse[1] = Four{inverse[3], inverse[1], inverse[4], 0};
        fabric.inverse[2] = Four{inverse[5], inverse[4], inverse[2], static_cast<float>(strength)};
        fabric.outward = with_fourth(sums.outward / static_cast<float>(length), static_cast<float>(inside));
    }
}

void FlowForces::find_cores() {
    const auto core = static_cast<float>(C::core * law_.seed_diameter);
    const auto half_stiffness = static_cast<float>(0.5 * C::core_stiffness * law_.seed_diameter);
    cores_.clear();
    const std::vector<FlowPairs::Row>& rows = pairs_.rows();
    for (std::size_t row = 0; row + 1 < rows.size(); ++row)
        for (std::uint32_t k = rows[row].begin; k < rows[row + 1].begin; ++k) {
            const float overlap = core - pairs_.apart()[k][3];
            if (overlap <= 0) continue;
            const float strengths =
                fabrics_[rows[row].particle].inverse[2][3] + fabrics_[pairs_.other()[k]].inverse[2][3];
            cores_.push_back({k, static_cast<std::uint32_t>(row), half_stiffness * strengths, overlap});
        }
}

TOMODEM_TWO_PROCESSORS void FlowForces::add_moments(const Four* velocity) {
    const auto over_reach = static_cast<float>(1 / (C::crown * law_.seed_diameter));
    const std::vector<FlowPairs::Row>& rows = pairs_.rows();
    const std::int32_t* const other = pairs_.other();
    const Four* const apart = pairs_.apart();
    Sums* const all = sums_.data();
    for (std::size_t row = 0; row + 1 < rows.size(); ++row) {
        const std::int32_t i = rows[row].particle;
        const Four own = velocity[i];
        Four x{}, y{}, z{}, outward{};
        for (std::uint32_t k = rows[row].begin; k < rows[row + 1].begin; ++k) {
            const std::int32_t j = other[k];
            const Geometry pair(apart[k], over_reach);
            const Four speed = own - velocity[j];
            const float own_weight = weight(k), other_weight = 2 - own_weight;
            const Four of_x = pair.apart * speed[0], of_y = pair.apart * speed[1], of_z = pair.apart * speed[2];
            const float separation = sum_of_three(speed * pair.direction);
            const float crowding = -2 * pair.closeness * over_reach * separation;
            const float turning = pair.closeness * pair.closeness * pair.over_distance;
            const Four tilt =
                with_fourth(pair.direction * (crowding - turning * separation) + speed * turning, crowding);
            Sums& theirs = all[j];
            theirs.moment[0] += other_weight * of_x;
            theirs.moment[1] += other_weight * of_y;
            theirs.moment[2] += other_weight * of_z;
            theirs.outward += opposite * tilt;
            x += own_weight * of_x;
            y += own_weight * of_y;
            z += own_weight * of_z;
            outward += tilt;
        }
        Sums& mine = all[i];
        mine.moment[0] += x;
        mine.moment[1] += y;
        mine.moment[2] += z;
        mine.outward += outward;
    }
}

/// With fresh viscosities the pressure is the whole of it, else its change alone.
TOMODEM_TWO_PROCESSORS void FlowForces::find_states(bool fresh_viscosity) {
    const double d = law_.seed_diameter;
    const auto volume = static_cast<float>(C::volume * d * d * d), surface = static_cast<float>(C::surface);
    const auto bulk = static_cast<float>(C::bulk_viscosity);
    const auto stiffness = static_cast<float>(C::pressure * d * d / C::rest_density) * interval_;
    // The square of a rate must stay in the range of single precision: rates are taken in units of the load's.
    const auto over_rate = static_cast<float>(1 / law_.flow_rate);
    const auto least = static_cast<float>(law_.min_rate / law_.flow_rate);
    for (int i = 0; i < local_count_; ++i) {
        const Sums& sums = sums_[i];
        Fabric& fabric = fabrics_[i];
        State& state = states_[i];
        Four gradient[3];
        for (int a = 0; a < 3; ++a)
            gradient[a] = sums.moment[a][0] * fabric.inverse[0] + sums.moment[a][1] * fabric.inverse[1] +
                          sums.moment[a][2] * fabric.inverse[2];
        const Four diagonal{gradient[0][0], gradient[1][1], gradient[2][2], 0};
        const Four off{gradient[0][1] + gradient[1][0], gradient[1][2] + gradient[2][1],
                       gradient[2][0] + gradient[0][2], 0};
        const float growth = sum_of_three(diagonal);
        if (fresh_viscosity) {
            const law::NortonMaterial& material = law_.materials[type_[i]];
            const Four deviator = (diagonal - four(growth / 3)) * over_rate, shear = off * over_rate;
            float square = 2.0F / 3 * (sum_of_three(deviator * deviator) + 0.5F * sum_of_three(shear * shear));
            square = law_.at_rest ? 1 : square + least * least;
            const auto exponent = static_cast<float>(0.5 * (material.rate_sensitivity - 1));
            const double at_flow_rate = material.consistency * std::pow(law_.flow_rate, material.rate_sensitivity - 1);
            fabric.inverse[1][3] = static_cast<float>(at_flow_rate) * std::pow(square, exponent);
        }
        const float viscosity = fabric.inverse[1][3];
        const float shear = 2.0F / 3 * viscosity, mean = (bulk * viscosity - shear / 3) * growth;
        const Four xyz = shear * diagonal + four(mean), mixed = 0.5F * shear * off;
        const Four stress[3] = {
            {xyz[0], mixed[0], mixed[2], 0}, {mixed[0], xyz[1], mixed[1], 0}, {mixed[2], mixed[1], xyz[2], 0}};
        const float pressed = stiffness * fabric.inverse[2][3] *
                              (sums.outward[3] + surface * sum_of_three(fabric.outward * sums.outward));
        const float pressure = fresh_viscosity ? fabric.inverse[0][3] + pressed : pressed;
        // The inverse is symmetric: its columns are its rows.
        for (int b = 0; b < 3; ++b)
            state.traction[b] = volume * (stress[0] * fabric.inverse[b][0] + stress[1] * fabric.inverse[b][1] +
                                          stress[2] * fabric.inverse[b][2]);
        if (fresh_viscosity)
            for (int b = 0; b < 3; ++b) state.traction[b] += corrections_[i].column[b];
        state.traction[0][3] = pressure;
        state.traction[1][3] = viscosity;
        state.diagonal = diagonal;
        state.off = off;
        state.lateral = surface * pressure * fabric.outward;
    }
}

namespace {

/// Of a pair, from the states of its particles.
/// @param damping  of what is not in the mean flow [uN.s/mm]
template <class State>
TOMODEM_INLINE Four pair_term(const Geometry& pair, Four speed, const State& own, const State& theirs, float damping) {
    const Four mean = (own.diagonal + theirs.diagonal) * pair.direction * pair.direction +
                      (own.off + theirs.off) * pair.direction * turned(pair.direction);
    const float strange = sum_of_three(speed * pair.direction - 0.5F * pair.distance * mean);
    return -damping * strange * pair.direction;
}

/// @param weight  of the particle's own traction
template <class State>
TOMODEM_INLINE Four viscous_force(const Geometry& pair, Four speed, const State& own, const State& theirs,
                                  float damping, float weight) {
    const float other = 2 - weight;
    return pair_term(pair, speed, own, theirs, damping) -
           (weight * own.traction[0] + other * theirs.traction[0]) * pair.apart[0] -
           (weight * own.traction[1] + other * theirs.traction[1]) * pair.apart[1] -
           (weight * own.traction[2] + other * theirs.traction[2]) * pair.apart[2];
}

/// @param pressures  of both
/// @param lateral    difference of what is along their outward vectors
TOMODEM_INLINE Four pressure_force(const Geometry& pair, float pressures, Four lateral, float reach) {
    const float along = sum_of_three(lateral * pair.direction);
    const float across = -reach * pair.closeness * pair.closeness * pair.over_distance;
    const float radial = 2 * pair.closeness * pressures + (2 * pair.closeness - across) * along;
    return radial * pair.direction + across * lateral;
}

template <class State>
TOMODEM_INLINE Four pressure_force(const Geometry& pair, const State& own, const State& theirs, float reach) {
    return pressure_force(pair, own.traction[0][3] + theirs.traction[0][3], own.lateral - theirs.lateral, reach);
}

}  // namespace

TOMODEM_TWO_PROCESSORS void FlowForces::add_forces(const Four* velocity) {
    const auto reach = static_cast<float>(C::crown * law_.seed_diameter);
    const auto share = static_cast<float>(2 * C::pair_share * law_.seed_diameter);
    const std::vector<FlowPairs::Row>& rows = pairs_.rows();
    const std::int32_t* const other = pairs_.other();
    const Four* const apart = pairs_.apart();
    const State* const states = states_.data();
    Four virial{}, virial_of_ghosts{};
    for (std::size_t row = 0; row + 1 < rows.size(); ++row) {
        const std::int32_t i = rows[row].particle;
        const State& own = states[i];
        Four sum{};
        for (std::uint32_t k = rows[row].begin; k < rows[row + 1].begin; ++k) {
            const std::int32_t j = other[k];
            const State& theirs = states[j];
            const Geometry pair(apart[k], 1 / reach);
            const float one = own.traction[1][3], two = theirs.traction[1][3];
            damping_[k] = share * one / (one + two) * two;
            Four force = viscous_force(pair, velocity[i] - velocity[j], own, theirs, damping_[k], weight(k));
            const float load = std::sqrt(sum_of_three(force * force));
            force = with_fourth(force + pressure_force(pair, own, theirs, reach), load);
            (j < local_count_ ? virial : virial_of_ghosts) += force * pair.apart;
            net_[j] += opposite * force;
            sum += force;
        }
        net_[i] += sum;
    }
    virial_ = virial + 0.5F * virial_of_ghosts;
}

TOMODEM_TWO_PROCESSORS void FlowForces::add_changes(const Four* direction) {
    const auto reach = static_cast<float>(C::crown * law_.seed_diameter);
    const std::vector<FlowPairs::Row>& rows = pairs_.rows();
    const std::int32_t* const other = pairs_.other();
    const Four* const apart = pairs_.apart();
    const float* const damping = damping_.data();
    const State* const states = states_.data();
    Four* const net = net_.data();
    for (std::size_t row = 0; row + 1 < rows.size(); ++row) {
        const std::int32_t i = rows[row].particle;
        const State& own = states[i];
        Four sum{};
        for (std::uint32_t k = rows[row].begin; k < rows[row + 1].begin; ++k) {
            const std::int32_t j = other[k];
            const Geometry pair(apart[k], 1 / reach);
            const Four force = viscous_force(pair, direction[i] - direction[j], own, states[j], damping[k], weight(k)) +
                               pressure_force(pair, own, states[j], reach);
            net[j] -= force;
            sum += force;
        }
        net[i] += sum;
    }
}

/// @param whole  force and its change; else the change alone
void FlowForces::add_cores(const Four* velocity, bool whole) {
    for (const Core& core : cores_) {
        const std::int32_t i = pairs_.rows()[core.row].particle, j = pairs_.other()[core.pair];
        const Four apart = pairs_.apart()[core.pair], direction = apart / apart[3];
        const float separation = sum_of_three((velocity[i] - velocity[j]) * direction);
        const float size = core.stiffness * ((whole ? core.overlap : 0) - interval_ * separation);
        const Four force = with_fourth(size * direction, 0);
        net_[i] += force;
        net_[j] -= force;
        if (whole) virial_ += (j < local_count_ ? 1.0F : 0.5F) * force * apart;
    }
}

/// Two objects push by core and pressure. How the force grows is taken from the pair alone: with what their neighbours
/// change, the forces would have no energy, and the system no symmetry.
void FlowForces::find_pushes() {
    const double d = law_.seed_diameter;
    const auto reach = static_cast<float>(C::crown * d), core = static_cast<float>(C::core * d);
    const auto half_core = static_cast<float>(0.5 * C::core_stiffness * d);
    const auto pressure = static_cast<float>(C::pressure * d * d / C::rest_density);
    for (std::size_t k = 0; k < pushes_.size(); ++k) {
        const FlowPairs::Pushing& one = pairs_.pushing()[k];
        const Geometry pair(one.apart, 1 / reach);
        const Fabric &own = fabrics_[one.particle], &theirs = fabrics_[one.other];
        const float strengths = own.inverse[2][3] + theirs.inverse[2][3], overlap = core - pair.distance;
        const float pressures = own.inverse[0][3] - background(own) + theirs.inverse[0][3] - background(theirs);
        pushes_[k] = {2 * pair.closeness * pressures,
                      4 * pair.closeness * pair.closeness / reach * pressure * strengths,
                      push_rounding * strengths * static_cast<float>(d * d), 0};
        if (overlap > 0) {
            pushes_[k].force += half_core * strengths * overlap;
            pushes_[k].stiffness += half_core * strengths;
        }
    }
}

/// @param whole  the force; else its change, with the shares of the last force
void FlowForces::add_pushes(const Four* velocity, bool whole) {
    for (std::size_t k = 0; k < pushes_.size(); ++k) {
        const FlowPairs::Pushing& one = pairs_.pushing()[k];
        Push& push = pushes_[k];
        const Four direction = one.apart / one.apart[3];
        const float separation = sum_of_three((velocity[one.particle] - velocity[one.other]) * direction);
        const float change = -interval_ * push.stiffness * separation;
        const Four force = with_fourth((whole ? push.at(push.force + change) : push.share * change) * direction, 0);
        net_[one.particle] += force;
        net_[one.other] -= force;
        if (whole) virial_ += (one.other < local_count_ ? 1.0F : 0.5F) * force * one.apart;
    }
}

void FlowForces::place(const ParticleView& particles, bool renumbered) {
    local_count_ = particles.local_count;
    count_ = particles.count;
    pairs_.find(particles, C::crown * law_.seed_diameter, renumbered);
    type_.resize(static_cast<std::size_t>(count_));
    for (int i = 0; i < count_; ++i) type_[i] = static_cast<std::uint8_t>(particles.type[i] - 1);
    const auto count = static_cast<std::size_t>(count_);
    fabrics_.resize(count);
    states_.resize(count);
    net_.resize(count);
    damping_.resize(pairs_.size());
    pushes_.resize(pairs_.pushing().size());
    weights_.clear();
    corrections_.assign(static_cast<std::size_t>(local_count_), Correction{});
    find_geometry();
    find_cores();
    find_pushes();
}

void FlowForces::find_geometry() {
    clear_sums();
    sum_fabric();
    find_fabric();
    carry_(fabrics_.data(), sizeof(Fabric), sizeof(Fabric));
    clear_sums();
}

/// States with these velocities, ghosts included.
void FlowForces::find_flow(const Four* velocity) {
    add_moments(velocity);
    find_states(true);
    clear_sums();
    add_films_to_states(velocity, true);
    carry_(states_.data(), sizeof(State), sizeof(State));
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
            const float own = states_[i].traction[1][3], theirs = states_[j].traction[1][3];
            weights_[k] = 2 * theirs / (own + theirs);
        }
    }
}

float FlowForces::background(const Fabric& fabric) const {
    const double d = law_.seed_diameter;
    return static_cast<float>(C::background * d * d) * fabric.inverse[2][3] * fabric.outward[3];
}

/// Of each particle, over its neighbours: half of sum sym(f r), f without the tractions.
/// Sums: moment[0] the diagonal, moment[1] xy, yz, zx; the fourths: the trace of the background's share, -.
TOMODEM_TWO_PROCESSORS void FlowForces::sum_virials(const Four* velocity) {
    const auto reach = static_cast<float>(C::crown * law_.seed_diameter);
    const auto share = static_cast<float>(2 * C::pair_share * law_.seed_diameter);
    const auto surface = static_cast<float>(C::surface);
    const auto per_strength = static_cast<float>(C::background * law_.seed_diameter * law_.seed_diameter);
    const float flows = law_.at_rest ? 0 : 1;
    const std::vector<FlowPairs::Row>& rows = pairs_.rows();
    const std::int32_t* const other = pairs_.other();
    const Four* const apart = pairs_.apart();
    for (std::size_t row = 0; row + 1 < rows.size(); ++row) {
        const std::int32_t i = rows[row].particle;
        const Fabric& own = fabrics_[i];
        const float own_background = per_strength * own.inverse[2][3] * own.outward[3];
        Four diagonal{}, off{};
        for (std::uint32_t k = rows[row].begin; k < rows[row + 1].begin; ++k) {
            const std::int32_t j = other[k];
            const Fabric& theirs = fabrics_[j];
            const Geometry pair(apart[k], 1 / reach);
            const float their_background = per_strength * theirs.inverse[2][3] * theirs.outward[3];
            const Four pressed = pressure_force(
                pair, own.inverse[0][3] + theirs.inverse[0][3],
                surface * (own.inverse[0][3] * own.outward - theirs.inverse[0][3] * theirs.outward), reach);
            const Four backed =
                pressure_force(pair, own_background + their_background,
                               surface * (own_background * own.outward - their_background * theirs.outward), reach);
            const float one = states_[i].traction[1][3], two = states_[j].traction[1][3];
            const Four force = pressed + pair_term(pair, velocity[i] - velocity[j], states_[i], states_[j],
                                                   flows * share * one / (one + two) * two);
            const Four squares = with_fourth(0.5F * force * pair.apart, 0.5F * sum_of_three(backed * pair.apart));
            const Four mixed = 0.25F * (force * turned(pair.apart) + turned(force) * pair.apart);
            Sums& neighbour = sums_[j];
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
    for (const Core& core : cores_) {
        const std::int32_t ends[2] = {pairs_.rows()[core.row].particle, pairs_.other()[core.pair]};
        const Four apart = pairs_.apart()[core.pair];
        const Four force = core.stiffness * core.overlap / apart[3] * apart;
        for (const std::int32_t end : ends) {
            sums_[end].moment[0] += with_fourth(0.5F * force * apart, 0);
            sums_[end].moment[1] += 0.5F * force * turned(apart);
        }
    }
    const auto d = static_cast<float>(law_.seed_diameter);
    for (int i = 0; i < local_count_; ++i) {
        const Four diagonal = sums_[i].moment[0], off = sums_[i].moment[1];
        const Fabric& fabric = fabrics_[i];
        const Four deviator = diagonal - four((sum_of_three(diagonal) - diagonal[3]) / 3);
        const Four rows[3] = {
            {deviator[0], off[0], off[2], 0}, {off[0], deviator[1], off[1], 0}, {off[2], off[1], deviator[2], 0}};
        const Four shear = deviator - four(sum_of_three(deviator) / 3);
        const float stress = std::sqrt(1.5F * sum_of_three(shear * shear) + 3 * sum_of_three(off * off));
        const law::NortonMaterial& material = law_.materials[type_[i]];
        const double flow_stress = material.consistency * std::pow(rate_, material.rate_sensitivity);
        const float most = static_cast<float>(C::most_corrected * C::volume * flow_stress) * d * d * d;
        const float share = fabric.outward[3] * std::min(1.0F, most / stress);
        for (int b = 0; b < 3; ++b)
            corrections_[i].column[b] = share * (rows[0] * fabric.inverse[b][0] + rows[1] * fabric.inverse[b][1] +
                                                 rows[2] * fabric.inverse[b][2]);
    }
    clear_sums();
}

float FlowForces::film_damping(int type) const {
    const law::NortonMaterial& material = law_.materials[type];
    return static_cast<float>(C::film * law_.seed_diameter * material.consistency *
                              std::pow(rate_, material.rate_sensitivity - 1));
}

void FlowForces::set_rate(double rate) {
    rate_ = rate;
    strengths_.clear();
    for (const law::NortonMaterial& material : law_.materials)
        strengths_.push_back(material.strength *
                             (law_.strength_follows ? std::pow(rate / law_.flow_rate, material.rate_sensitivity) : 1));
}

void FlowForces::set_walls(const std::vector<NearWall>& walls) {
    const double d = law_.seed_diameter;
    films_.clear();
    film_of_.assign(static_cast<std::size_t>(count_), -1);
    for (const NearWall& wall : walls) {
        const int type = type_[wall.particle];
        const double depth = wall.distance - d / 2;
        film_of_[wall.particle] = static_cast<std::int32_t>(films_.size());
        Film film{};
        film.particle = wall.particle;
        for (int c = 0; c < 3; ++c) film.normal[c] = static_cast<float>(wall.normal[c]);
        film.velocity = static_cast<float>(wall.velocity);
        film.depth = static_cast<float>(depth);
        film.damping = film_damping(type);
        film.stiffness = film_stiffness(type, depth);
        films_.push_back(film);
    }
}

/// The film acts where the sample meets the face: on the velocity of the centre, extrapolated by the particle's own
/// flow.
/// @param whole  with the walls' own velocities; else the change alone
void FlowForces::add_films_to_states(const Four* velocity, bool whole) {
    for (Film& film : films_) {
        State& state = states_[film.particle];
        const Fabric& fabric = fabrics_[film.particle];
        const Four n = film.normal;
        const float stretch = sum_of_three(state.diagonal * n * n + state.off * n * turned(n));
        film.slip = sum_of_three(velocity[film.particle] * n) - (whole ? film.velocity : 0) - film.depth * stretch;
        const Four arm = n[0] * fabric.inverse[0] + n[1] * fabric.inverse[1] + n[2] * fabric.inverse[2];
        for (int b = 0; b < 3; ++b)
            state.traction[b] -= with_fourth(film.damping * film.slip * film.depth * arm[b] * n, 0);
    }
}

void FlowForces::add_films(const Four* velocity, bool whole) {
    for (const Film& film : films_) {
        const float approach = sum_of_three(velocity[film.particle] * film.normal) - (whole ? film.velocity : 0);
        const float size =
            -film.damping * film.slip - film.stiffness * (interval_ * approach + (whole ? film.depth : 0));
        net_[film.particle] += with_fourth(size * film.normal, 0);
    }
}

double FlowForces::wall_force(const WallContact& contact) const {
    const double d = law_.seed_diameter, depth = contact.distance - d / 2;
    const State& state = states_[static_cast<std::size_t>(contact.particle)];
    double stretch = 0;
    for (int c = 0; c < 3; ++c)
        stretch +=
            contact.normal[c] * (state.diagonal[c] * contact.normal[c] + state.off[c] * contact.normal[(c + 1) % 3]);
    return -film_damping(contact.type - 1) * (contact.rate - depth * stretch) -
           film_stiffness(contact.type - 1, depth) * (depth + interval_ * contact.rate);
}

/// A neighbour's velocity along the normal counts in the slip with w_ij r . lever (r from the neighbour to the
/// particle), the particle's own with 1 less their sum.
void FlowForces::lay_films(const std::vector<NearWall>& planes, FilmBalance& films) {
    films.clear();
    levers_.clear();
    film_of_.assign(static_cast<std::size_t>(count_), -1);
    for (const NearWall& plane : planes) {
        const int type = type_[plane.particle];
        const double depth = plane.distance - law_.seed_diameter / 2;
        if (film_of_[plane.particle] < 0) film_of_[plane.particle] = static_cast<std::int32_t>(levers_.size());
        FilmBalance::Film film{plane.particle, plane.wall, {}, plane.velocity, film_damping(type), 0};
        for (int c = 0; c < 3; ++c) film.normal[c] = static_cast<float>(plane.normal[c]);
        film.repulsion = -film_stiffness(type, depth) * static_cast<float>(depth);
        const Four* const inverse = fabrics_[plane.particle].inverse;
        const Four arm = film.normal[0] * inverse[0] + film.normal[1] * inverse[1] + film.normal[2] * inverse[2];
        levers_.push_back(with_fourth(static_cast<float>(depth) * arm, 0));
        films.add(film);
    }
    const std::vector<FlowPairs::Row>& rows = pairs_.rows();
    for (std::size_t row = 0; row + 1 < rows.size(); ++row)
        for (std::uint32_t k = rows[row].begin; k < rows[row + 1].begin; ++k) {
            const std::int32_t ends[2] = {rows[row].particle, pairs_.other()[k]};
            for (int side = 0; side < 2; ++side) {
                const std::int32_t first = film_of_[ends[side]];
                if (first < 0) continue;
                const float own_weight = side == 0 ? weight(k) : weight(k) - 2;
                for (auto f = static_cast<std::size_t>(first);
                     f < levers_.size() && films.films()[f].particle == ends[side]; ++f) {
                    const float share = own_weight * sum_of_three(pairs_.apart()[k] * levers_[f]);
                    films.add_share(static_cast<std::uint32_t>(f), ends[1 - side], share);
                    levers_[f][3] += share;
                }
            }
        }
    for (std::size_t f = 0; f < levers_.size(); ++f)
        films.add_share(static_cast<std::uint32_t>(f), films.films()[f].particle, -levers_[f][3]);
}

void FlowForces::add_to_tractions(const FilmBalance& films) {
    for (std::size_t f = 0; f < levers_.size(); ++f) {
        const FilmBalance::Film& film = films.films()[f];
        for (int b = 0; b < 3; ++b)
            states_[film.particle].traction[b] +=
                with_fourth(static_cast<float>(films.film_force(f)) * levers_[f][b] * film.normal, 0);
    }
}

/// Of the repulsion behind the face.
float FlowForces::film_stiffness(int type, double depth) const {
    return depth < 0 ? static_cast<float>(C::core_stiffness * law_.seed_diameter * strengths_[type]) : 0;
}

void FlowForces::add_pair_forces(const Four* velocity) {
    net_.assign(static_cast<std::size_t>(count_), Four{});
    add_forces(velocity);
    add_cores(velocity, true);
    add_pushes(velocity, true);
}

void FlowForces::find(const Four* velocity) {
    find_flow(velocity);
    add_pair_forces(velocity);
    add_films(velocity, true);
}

void FlowForces::find_corrected(const Four* velocity) {
    correct(velocity);
    for (int i = 0; i < local_count_; ++i)
        for (int b = 0; b < 3; ++b) states_[i].traction[b] += corrections_[i].column[b];
    carry_(states_.data(), sizeof(State), sizeof(State));
    add_pair_forces(velocity);
}

void FlowForces::product(Four* direction) {
    carry_(direction, sizeof(Four), 3 * sizeof(float));
    add_moments(direction);
    find_states(false);
    clear_sums();
    add_films_to_states(direction, false);
    carry_(states_.data(), sizeof(State), sizeof(State));
    net_.assign(static_cast<std::size_t>(count_), Four{});
    add_changes(direction);
    add_cores(direction, false);
    add_pushes(direction, false);
    add_films(direction, false);
}

TOMODEM_TWO_PROCESSORS void FlowForces::add_block_parts(std::vector<Block>& blocks) const {
    const double d = law_.seed_diameter;
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
    const auto through_flow = [&](const Fabric& fabric, Four arm, Block& block) __attribute__((always_inline)) {
        const Four reached = arm[0] * fabric.inverse[0] + arm[1] * fabric.inverse[1] + arm[2] * fabric.inverse[2];
        const float size = volume * fabric.inverse[1][3];
        block.diagonal += size * (four(sum_of_three(reached * reached) / 3) + bulk * reached * reached);
        block.off += size * bulk * reached * turned(reached);
    };
    const auto through_pressure = [&](const Fabric& fabric, Four crowding, Block& block)
        __attribute__((always_inline)) {
        const float size = stiffness * fabric.inverse[2][3];
        block.diagonal += size * crowding * crowding;
        block.off += size * crowding * turned(crowding);
    };
    const auto reached_along = [&](const Film& film, Four arm) __attribute__((always_inline)) {
        const Fabric& fabric = fabrics_[film.particle];
        return sum_of_three(film.normal *
                            (arm[0] * fabric.inverse[0] + arm[1] * fabric.inverse[1] + arm[2] * fabric.inverse[2]));
    };
    /// @param share  of the slip in a particle's velocity along the normal
    const auto through_film = [](const Film& film, float share, Block& block) __attribute__((always_inline)) {
        const float size = film.damping * share * share;
        block.diagonal += size * film.normal * film.normal;
        block.off += size * film.normal * turned(film.normal);
    };
    for (std::size_t row = 0; row + 1 < rows.size(); ++row)
        for (std::uint32_t k = rows[row].begin; k < rows[row + 1].begin; ++k) {
            const std::int32_t ends[2] = {rows[row].particle, pairs_.other()[k]};
            const Geometry pair(pairs_.apart()[k], 1 / reach);
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
                Block& block = blocks[ends[side]];
                through_flow(fabrics_[ends[1 - side]], pair.apart, block);
                through_pressure(fabrics_[ends[1 - side]], sign * slope * pair.direction - tilt[1 - side], block);
                if (const std::int32_t film = film_of_[ends[1 - side]]; film >= 0)
                    through_film(films_[film], films_[film].depth * reached_along(films_[film], pair.apart), block);
                block.diagonal += damping_[k] * pair.direction * pair.direction;
                block.off += damping_[k] * pair.direction * turned(pair.direction);
                own[ends[side]].arm += sign * pair.apart;
                own[ends[side]].crowding += sign * slope * pair.direction + tilt[side];
            }
        }
    for (int i = 0; i < local_count_; ++i) {
        through_flow(fabrics_[i], own[i].arm, blocks[i]);
        through_pressure(fabrics_[i], own[i].crowding, blocks[i]);
        // A particle that nothing touches keeps its velocity.
        blocks[i].diagonal += four(1e-6F * static_cast<float>(d) * fabrics_[i].inverse[1][3]);
    }
    for (const Film& film : films_)
        through_film(film, 1 - film.depth * reached_along(film, own[film.particle].arm), blocks[film.particle]);
}

/// Where a particle has two walls, one counts in the blocks of its neighbours, which are an approximation anyway.
void FlowForces::prepare_blocks(std::vector<Block>& blocks) {
    carry_(fabrics_.data(), sizeof(Fabric), sizeof(Fabric));
    blocks.assign(static_cast<std::size_t>(count_), Block{});
    add_block_parts(blocks);
    for (const Core& core : cores_) {
        const Four apart = pairs_.apart()[core.pair], direction = apart / apart[3];
        const float stiffness = interval_ * core.stiffness;
        for (const std::int32_t i : {pairs_.rows()[core.row].particle, pairs_.other()[core.pair]}) {
            blocks[i].diagonal += stiffness * direction * direction;
            blocks[i].off += stiffness * direction * turned(direction);
        }
    }
    for (const Film& film : films_) {
        Block& block = blocks[film.particle];
        block.diagonal += interval_ * film.stiffness * film.normal * film.normal;
        block.off += interval_ * film.stiffness * film.normal * turned(film.normal);
    }
    for (std::size_t k = 0; k < pushes_.size(); ++k) {
        const FlowPairs::Pushing& one = pairs_.pushing()[k];
        const Four direction = one.apart / one.apart[3];
        const float stiffness = interval_ * pushes_[k].share * pushes_[k].stiffness;
        for (const std::int32_t i : {one.particle, one.other}) {
            blocks[i].diagonal += stiffness * direction * direction;
            blocks[i].off += stiffness * direction * turned(direction);
        }
    }
}

void FlowForces::for_each_force(const Four* velocity, const PairKernel::UsePair& use) const {
    const auto reach = static_cast<float>(C::crown * law_.seed_diameter);
    const auto report = [&](std::int32_t i, std::int32_t j, Four force, Four apart) {
        const double on_particle[3] = {force[0], force[1], force[2]}, arm[3] = {apart[0], apart[1], apart[2]};
        use(i, j, on_particle, arm);
    };
    auto core = cores_.begin();
    for (std::size_t row = 0; row + 1 < pairs_.rows().size(); ++row) {
        const std::int32_t i = pairs_.rows()[row].particle;
        for (std::uint32_t k = pairs_.rows()[row].begin; k < pairs_.rows()[row + 1].begin; ++k) {
            const std::int32_t j = pairs_.other()[k];
            const Geometry pair(pairs_.apart()[k], 1 / reach);
            const Four speed = velocity[i] - velocity[j];
            Four force = viscous_force(pair, speed, states_[i], states_[j], damping_[k], weight(k)) +
                         pressure_force(pair, states_[i], states_[j], reach);
            if (core != cores_.end() && core->pair == k) {
                const float separation = sum_of_three(speed * pair.direction);
                force += core->stiffness * (core->overlap - interval_ * separation) * pair.direction;
                ++core;
            }
            report(i, j, force, pair.apart);
        }
    }
    for (std::size_t k = 0; k < pushes_.size(); ++k) {
        const FlowPairs::Pushing& one = pairs_.pushing()[k];
        const Four direction = one.apart / one.apart[3];
        const float separation = sum_of_three((velocity[one.particle] - velocity[one.other]) * direction);
        Push push = pushes_[k];
        report(one.particle, one.other, push.at(push.force - interval_ * push.stiffness * separation) * direction,
               one.apart);
    }
}

double FlowForces::core_energy() const {
    double energy = 0;
    for (const Core& core : cores_)
        energy +=
            (pairs_.other()[core.pair] < local_count_ ? 0.5 : 0.25) * core.stiffness * core.overlap * core.overlap;
    return energy;
}

}  // namespace tomodem::plugin
