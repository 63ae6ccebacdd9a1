#include "solver_plugin/norton/film_balance.hpp"

#include <algorithm>
#include <stdexcept>

namespace tomodem::plugin {
namespace {

/// Of the forces: norm of what is left over that at the beginning.
constexpr double tolerance = 1e-4;
/// Four to six are usual.
constexpr int most_iterations = 1000;

double along(Four vector, Four normal) {
    return sum_of_three(vector * normal);
}

}  // namespace

void FilmBalance::clear() {
    films_.clear();
    shares_.clear();
    forces_.clear();
}

/// Of films of ghosts: what they have where their particles belong.
void FilmBalance::bring(std::vector<double>& of_films, const Carry& carry) {
    const auto place = [&](std::size_t k) -> double& {
        const bool second = k > 0 && films_[k - 1].particle == films_[k].particle;
        return carried_[static_cast<std::size_t>(films_[k].particle)][second ? 1 : 0];
    };
    for (std::size_t k = 0; k < own_films_; ++k) place(k) = of_films[k];
    carry(carried_.data(), sizeof(OfParticle), sizeof(OfParticle));
    for (std::size_t k = own_films_; k < films_.size(); ++k) of_films[k] = place(k);
}

/// Of the velocities of the particles of this process with those forces of the films.
void FilmBalance::find_changes(const std::vector<double>& film_forces) {
    std::fill_n(changes_.begin(), local_count_, Four{});
    for (std::size_t k = 0; k < own_films_; ++k)
        changes_[films_[k].particle] += static_cast<float>(film_forces[k]) * films_[k].normal;
    for (const Share& one : shares_)
        if (one.particle < local_count_)
            changes_[one.particle] += static_cast<float>(film_forces[one.film]) * one.share * films_[one.film].normal;
    for (int i = 0; i < local_count_; ++i) changes_[i] *= static_cast<float>(mobility_[i]);
}

void FilmBalance::solve(const ParticleView& particles, const Four* forces, double time_step, const Carry& carry,
                        const FlowSurroundings& surroundings) {
    local_count_ = particles.local_count;
    iterations_ = 0;
    // One more than there are: a process without particles takes part in every exchange.
    const auto room = static_cast<std::size_t>(particles.count) + 1;
    changes_.assign(room, Four{});
    carried_.assign(room, OfParticle{});
    mobility_.resize(static_cast<std::size_t>(local_count_));
    for (int i = 0; i < local_count_; ++i) mobility_[i] = time_step / particles.mass[i];
    own_films_ = static_cast<std::size_t>(
        std::find_if(films_.begin(), films_.end(), [&](const Film& film) { return film.particle >= local_count_; }) -
        films_.begin());
    for (std::vector<double>* vector : {&forces_, &rest_, &step_, &direction_, &product_, &diagonal_})
        vector->assign(films_.size(), 0.0);

    // The slips that there would be without films.
    for (int i = 0; i < local_count_; ++i) changes_[i] = forces[i];
    for (std::size_t k = 0; k < own_films_; ++k) changes_[films_[k].particle] += films_[k].repulsion * films_[k].normal;
    for (int i = 0; i < local_count_; ++i) changes_[i] *= static_cast<float>(mobility_[i]);
    carry(changes_.data(), sizeof(Four), 3 * sizeof(float));
    const auto speed = [&](std::int32_t i, Four normal) {
        double sum = along(changes_[i], normal);
        for (int c = 0; c < 3; ++c) sum += particles.velocity[3 * i + c] * normal[c];
        return sum;
    };
    std::vector<double>& own_share = step_;
    for (std::size_t k = 0; k < own_films_; ++k) {
        rest_[k] = films_[k].velocity - speed(films_[k].particle, films_[k].normal);
        own_share[k] = 1;
    }
    for (const Share& one : shares_) {
        if (one.film >= own_films_) continue;
        rest_[one.film] -= one.share * speed(one.particle, films_[one.film].normal);
        if (one.particle == films_[one.film].particle)
            own_share[one.film] += one.share;
        else
            diagonal_[one.film] += static_cast<double>(one.share) * one.share;
    }
    for (std::size_t k = 0; k < own_films_; ++k)
        diagonal_[k] =
            1 / films_[k].damping + mobility_[films_[k].particle] * (diagonal_[k] + own_share[k] * own_share[k]);

    const auto precondition = [&] {
        double sum = 0;
        for (std::size_t k = 0; k < own_films_; ++k) {
            step_[k] = rest_[k] / diagonal_[k];
            sum += rest_[k] * step_[k];
        }
        surroundings.add_up(&sum, 1);
        return sum;
    };
    double square = precondition();
    const double enough = tolerance * tolerance * square;
    for (double share = 0; square > enough; ++iterations_) {
        if (iterations_ == most_iterations)
            throw std::runtime_error("the forces of the films at the planes were not found");
        for (std::size_t k = 0; k < own_films_; ++k) direction_[k] = step_[k] + share * direction_[k];
        bring(direction_, carry);
        find_changes(direction_);
        carry(changes_.data(), sizeof(Four), 3 * sizeof(float));
        for (std::size_t k = 0; k < own_films_; ++k)
            product_[k] = direction_[k] / films_[k].damping + along(changes_[films_[k].particle], films_[k].normal);
        for (const Share& one : shares_)
            if (one.film < own_films_)
                product_[one.film] += one.share * along(changes_[one.particle], films_[one.film].normal);
        double against = 0;
        for (std::size_t k = 0; k < own_films_; ++k) against += direction_[k] * product_[k];
        surroundings.add_up(&against, 1);
        const double length = square / against;
        for (std::size_t k = 0; k < own_films_; ++k) {
            forces_[k] += length * direction_[k];
            rest_[k] -= length * product_[k];
        }
        const double before = square;
        square = precondition();
        share = square / before;
    }
    bring(forces_, carry);
}

double FilmBalance::plane_force(std::int32_t particle, int plane) const {
    const auto first = std::lower_bound(films_.begin(), films_.end(), particle,
                                        [](const Film& film, std::int32_t wanted) { return film.particle < wanted; });
    for (auto film = first; film != films_.end() && film->particle == particle; ++film)
        if (film->plane == plane) return forces_[static_cast<std::size_t>(film - films_.begin())] + film->repulsion;
    return 0;
}

void FilmBalance::add_forces(double* forces) const {
    for (const Share& one : shares_) {
        if (one.particle >= local_count_) continue;
        const double force = forces_[one.film] * one.share;
        for (int c = 0; c < 3; ++c) forces[3 * one.particle + c] += force * films_[one.film].normal[c];
    }
}

}  // namespace tomodem::plugin
