#include "solver_plugin/norton/norton_flow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"

namespace tomodem::plugin {
namespace {

using C = law::NortonConstants;

/// Viscosities that are taken anew, at most: then the interval is halved.
constexpr int most_outer = 60;
/// Of one linear system.
constexpr int most_inner = 300;
/// How far a linear system is solved, relative to its right side: no farther than the viscosities are worth.
constexpr double loosest = 0.5, tightest = 0.1;
/// A balance that the viscosities of a motion leave above that share of the one before was solved for too loosely.
constexpr double slow = 0.7, most_care = 0.05;
/// Motions after which no balance is in sight, if none of them got below that share of the best before.
constexpr int most_tried = 10;
constexpr double stalled = 0.9;
/// A motion at frozen viscosities lowers the dissipated power, of which the forces are the gradient, but not always the
/// norm of the forces at once: how much more there may be of it, and how often the motion is halved if there is.
constexpr double most_growth = 2;
constexpr int most_halvings = 4;
/// Shortest part of a step: below it the run stops.
constexpr double shortest_part = 1e-6;
/// Way of a particle in a step while the sample comes to rest, over its diameter.
constexpr double way_at_rest = 0.05;
/// Cell of the coarse grid, in diameters.
constexpr double cell = 4;

double dot(const std::vector<Four>& a, const std::vector<Four>& b, int count) {
    double sum = 0;
    for (int i = 0; i < count; ++i) {
        const Four product = a[i] * b[i];
        sum += static_cast<double>(product[0]) + product[1] + product[2];
    }
    return sum;
}

/// In place; symmetric and positive.
void invert(FlowBlock& block) {
    const double xx = block.diagonal[0], yy = block.diagonal[1], zz = block.diagonal[2];
    const double xy = block.off[0], yz = block.off[1], zx = block.off[2];
    const double cofactor[6] = {yy * zz - yz * yz, xx * zz - zx * zx, xx * yy - xy * xy,
                                yz * zx - xy * zz, xy * zx - xx * yz, xy * yz - yy * zx};
    const double over = 1 / (xx * cofactor[0] + xy * cofactor[3] + zx * cofactor[5]);
    for (int c = 0; c < 3; ++c) block.diagonal[c] = static_cast<float>(cofactor[c] * over);
    for (int c = 0; c < 3; ++c) block.off[c] = static_cast<float>(cofactor[3 + c] * over);
}

Four times(const FlowBlock& block, Four v) {
    return block.diagonal * v + Four{block.off[0] * v[1] + block.off[2] * v[2],
                                     block.off[0] * v[0] + block.off[1] * v[2],
                                     block.off[2] * v[0] + block.off[1] * v[1], 0};
}

}  // namespace

void NortonFlow::set_law(const law::Norton& law, double imbalance) {
    forces_.set_law(law);
    imbalance_ = imbalance;
}

/// The velocities that the particles have brought along, or a share of them.
void NortonFlow::take(const ParticleView& particles, double share) {
    for (int i = 0; i < local_count_; ++i)
        for (int c = 0; c < 3; ++c) found_[i][c] = share * particles.velocity[3 * i + c];
}

/// velocity_, ghosts included, from found_.
void NortonFlow::find_velocities() {
    for (int i = 0; i < local_count_; ++i)
        velocity_[i] = Four{static_cast<float>(found_[i][0]), static_cast<float>(found_[i][1]),
                            static_cast<float>(found_[i][2]), 0};
    carry(velocity_.data(), sizeof(Four), 3 * sizeof(float));
    for (int i = local_count_; i < count_; ++i) velocity_[i] += jump_[i - local_count_];
}

void NortonFlow::find_forces() {
    find_velocities();
    forces_.find(velocity_.data());
    ++work_.forces;
    std::copy_n(forces_.net(), local_count_, net_.begin());
    // The law keeps a sample's angular momentum in the mean only: what would turn it as a whole, nothing can balance.
    rigid_.remove(net_, surroundings());
    double norms[2] = {dot(net_, net_, local_count_), 0};
    for (int i = 0; i < local_count_; ++i) norms[1] += static_cast<double>(net_[i][3]) * net_[i][3];
    surroundings().add_up(norms, 2);
    net_norm_ = std::sqrt(norms[0]);
    load_norm_ = std::sqrt(norms[1]);
}

void NortonFlow::prepare() {
    ++work_.blocks;
    forces_.prepare_blocks(blocks_);
    for (int i = 0; i < local_count_; ++i) invert(blocks_[i]);

    const double d = law().seed_diameter, volume = C::volume * d * d * d;
    std::vector<CoarseGrid::Material> materials(static_cast<std::size_t>(local_count_));
    for (int i = 0; i < local_count_; ++i) {
        const double viscosity = forces_.viscosity(i);
        materials[i] = {volume * viscosity / 3, volume * (viscosity * (C::bulk_viscosity - 2.0 / 9) +
                                                          4 * interval_ * C::pressure * forces_.strength(i))};
    }
    std::vector<double> walls(walls_.size());
    for (std::size_t k = 0; k < walls.size(); ++k) walls[k] = forces_.wall_stiffness(k);
    grid_.fill(materials, walls_, d / 2, walls, surroundings());
}

/// step_ = an approximate solution for rest_.
/// @param along  becomes rest_ . step_
/// @return the square of the norm of rest_
double NortonFlow::precondition(double& along) {
    const auto size = static_cast<std::size_t>(grid_.size());
    nodes_.assign(size + 2, 0.0);
    for (int i = 0; i < local_count_; ++i) step_[i] = times(blocks_[i], rest_[i]);
    grid_.gather(rest_.data(), nodes_.data());
    nodes_[size] = dot(rest_, step_, local_count_);
    nodes_[size + 1] = dot(rest_, rest_, local_count_);
    surroundings().add_up(nodes_.data(), nodes_.size());
    const double squares = nodes_[size + 1];
    along = nodes_[size];
    const std::vector<double> forces(nodes_.begin(), nodes_.begin() + grid_.size());
    grid_.solve(nodes_.data());
    for (std::size_t k = 0; k < size; ++k) along += forces[k] * nodes_[k];
    grid_.spread(nodes_.data(), step_.data());
    rigid_.remove(step_, surroundings());
    return squares;
}

/// motion_ = the change of the velocities that balances net_ at frozen viscosities, by conjugate gradients.
void NortonFlow::find_motion(double tolerance) {
    ++work_.solutions;
    std::fill(motion_.begin(), motion_.end(), Four{});
    std::copy(net_.begin(), net_.end(), rest_.begin());
    for (Four& force : rest_) force[3] = 0;
    double before = 1, first = 0;
    for (int iteration = 0; iteration < most_inner; ++iteration) {
        double along = 0;
        const double squares = precondition(along);
        if (iteration == 0) first = squares;
        if (!(squares > tolerance * tolerance * first)) return;
        const auto share = static_cast<float>(iteration == 0 ? 0 : along / before);
        before = along;
        for (int i = 0; i < local_count_; ++i) direction_[i] = step_[i] + share * direction_[i];
        forces_.product(direction_.data());
        ++work_.products;
        std::copy_n(forces_.change(), local_count_, step_.begin());
        rigid_.remove(step_, surroundings());
        double against = -dot(direction_, step_, local_count_);
        surroundings().add_up(&against, 1);
        if (!(against > 0)) {
            if (iteration == 0) std::copy_n(direction_.begin(), local_count_, motion_.begin());
            return;
        }
        const auto length = static_cast<float>(along / against);
        for (int i = 0; i < local_count_; ++i) {
            motion_[i] += length * direction_[i];
            rest_[i] += length * step_[i];
        }
    }
}

/// @return whether the forces are in balance
bool NortonFlow::balance() {
    find_forces();
    bool prepared = false;
    double care = 1, best = net_norm_;
    int tried = 0;
    std::vector<std::array<double, 3>> from;
    for (int outer = 0; !is_balanced(); ++outer) {
        if (outer == most_outer || !std::isfinite(net_norm_) || !std::isfinite(load_norm_)) return false;
        if (!prepared) prepare();
        prepared = true;
        const double wanted = load_norm_ > 0 ? 0.5 * imbalance_ * load_norm_ / net_norm_ : 0;
        find_motion(care * std::clamp(wanted, tightest, loosest));
        from.assign(found_.begin(), found_.begin() + local_count_);
        const double before = net_norm_;
        double length = 1;
        for (int halvings = 0;; ++halvings) {
            for (int i = 0; i < local_count_; ++i)
                for (int c = 0; c < 3; ++c) found_[i][c] = from[i][c] + length * motion_[i][c];
            find_forces();
            if (net_norm_ < most_growth * before || halvings == most_halvings) break;
            length /= 2;
        }
        if (net_norm_ > slow * before) care = std::max(care / 2, most_care);
        if (net_norm_ < stalled * best) {
            best = net_norm_;
            tried = 0;
        } else if (++tried == most_tried) {
            return false;
        }
    }
    return true;
}

void NortonFlow::add_forces(const ParticleView& particles, const NeighbourView&, const PairStep& step, double* forces,
                            ContactMemory*, const UsePair* use) {
    local_count_ = particles.local_count;
    count_ = particles.count;
    const auto local = static_cast<std::size_t>(local_count_), count = static_cast<std::size_t>(count_);
    // One more than there are: a process without particles takes part in every exchange.
    found_.resize(local + 1);
    for (std::vector<Four>* vector : {&net_, &rest_, &step_, &motion_}) vector->resize(local);
    velocity_.assign(count + 1, Four{});
    direction_.assign(count + 1, Four{});
    jump_.assign(count - local, Four{});
    ++work_.steps;
    ++work_.geometries;
    forces_.set_rate(load_rate(step.start));
    forces_.place(particles);
    take(particles, 1);
    for (int i = 0; i < local_count_; ++i)
        for (int c = 0; c < 3; ++c) velocity_[i][c] = static_cast<float>(found_[i][c]);
    carry(velocity_.data(), sizeof(Four), 3 * sizeof(float));
    for (int i = local_count_; i < count_; ++i)
        for (int c = 0; c < 3; ++c)
            jump_[i - local_count_][c] = static_cast<float>(particles.velocity[3 * i + c]) - velocity_[i][c];
    grid_.lay(particles.position, local_count_, cell * law().seed_diameter, surroundings());

    bool corrected = false;
    interval_ = step.start < 0 ? -step.start : step.time_step;
    for (;; interval_ /= 2) {
        if (interval_ < shortest_part * step.time_step)
            throw InvalidInput(fmt::format(
                "the forces find no balance, however short the step: net force over viscous force stays {:.2g}, wanted "
                "{:g}; take a larger max_imbalance, or look whether the sample tears or a part of it is held by "
                "nothing",
                net_norm_ / load_norm_, imbalance_));
        forces_.set_interval(interval_);
        walls_ = surroundings().walls(step.start, interval_);
        forces_.set_walls(walls_);
        // While a sample comes to rest, the search begins at half of them: no force stops a part that is torn off, and
        // it would drift for ever.
        take(particles, law().at_rest ? 0.5 : 1);
        if (!corrected) {
            find_velocities();
            forces_.correct(velocity_.data());
            work_.corrections += forces_.passes_of_a_correction();
            corrected = true;
        }
        rigid_.find(particles.position, local_count_, walls_, surroundings());
        if (balance()) break;
    }
    good_for_ = interval_;
    if (law().at_rest) {
        double fastest = 0;
        for (int i = 0; i < local_count_; ++i)
            for (int c = 0; c < 3; ++c) fastest = std::max(fastest, std::abs(found_[i][c]));
        surroundings().take_largest(&fastest, 1);
        if (fastest * interval_ > way_at_rest * law().seed_diameter)
            good_for_ = way_at_rest * law().seed_diameter / fastest;
    }
    for (int i = 0; i < local_count_; ++i)
        for (int c = 0; c < 3; ++c) {
            step.velocity[3 * i + c] = found_[i][c];
            forces[3 * i + c] += forces_.net()[i][c];
        }
    for (int i = local_count_; i < count_; ++i)
        for (int c = 0; c < 3; ++c) step.velocity[3 * i + c] = velocity_[i][c];
    if (use != nullptr) forces_.for_each_force(velocity_.data(), *use);
}

void NortonFlow::pair_forces(const ParticleView&, const NeighbourView&, const ContactMemory*,
                             const UsePair& use) const {
    forces_.for_each_force(velocity_.data(), use);
}

}  // namespace tomodem::plugin
