#include "solver_plugin/norton/wall_films.hpp"

namespace tomodem::plugin {

void WallFilms::set(const LawAtRate& law, const std::vector<NearWall>& walls,
                    const std::vector<std::uint8_t>& material) {
    films_.clear();
    of_particle_.assign(material.size(), -1);
    for (const NearWall& wall : walls) {
        const double depth = wall.distance - law.diameter() / 2;
        of_particle_[wall.particle] = static_cast<std::int32_t>(films_.size());
        Film film{};
        film.particle = wall.particle;
        for (int c = 0; c < 3; ++c) film.normal[c] = static_cast<float>(wall.normal[c]);
        film.velocity = static_cast<float>(wall.velocity);
        film.depth = static_cast<float>(depth);
        film.damping = law.film_damping(material[wall.particle]);
        film.stiffness = law.wall_stiffness(material[wall.particle], depth);
        films_.push_back(film);
    }
}

void WallFilms::add_to_states(const Four* velocity, bool whole, const FlowFabric* fabrics, FlowState* states) {
    for (Film& film : films_) {
        FlowState& state = states[film.particle];
        const Four n = film.normal;
        const float stretch = sum_of_three(state.diagonal * n * n + state.off * n * turned(n));
        film.slip = sum_of_three(velocity[film.particle] * n) - (whole ? film.velocity : 0) - film.depth * stretch;
        const Four arm = times(fabrics[film.particle].inverse, n);
        for (int b = 0; b < 3; ++b)
            state.traction[b] -= with_fourth(film.damping * film.slip * film.depth * arm[b] * n, 0);
    }
}

void WallFilms::add_forces(const Four* velocity, float interval, bool whole, Four* net) const {
    for (const Film& film : films_) {
        const float approach = sum_of_three(velocity[film.particle] * film.normal) - (whole ? film.velocity : 0);
        const float size =
            -film.damping * film.slip - film.stiffness * (interval * approach + (whole ? film.depth : 0));
        net[film.particle] += with_fourth(size * film.normal, 0);
    }
}

void WallFilms::add_blocks(float interval, FlowBlock* blocks) const {
    for (const Film& film : films_) blocks[film.particle].add(interval * film.stiffness, film.normal);
}

/// Levers are depth A*^-1 n. Those of a particle follow one another.
void WallFilms::lay_levers(const LawAtRate& law, const std::vector<NearWall>& planes,
                           const std::vector<std::uint8_t>& material, const FlowFabric* fabrics, FilmBalance& balance) {
    balance.clear();
    levers_.clear();
    of_particle_.assign(material.size(), -1);
    for (const NearWall& plane : planes) {
        const double depth = plane.distance - law.diameter() / 2;
        std::int32_t& first = of_particle_[plane.particle];
        if (first < 0) first = static_cast<std::int32_t>(levers_.size());
        FilmBalance::Film film{
            plane.particle, plane.wall, {}, plane.velocity, law.film_damping(material[plane.particle]), 0};
        for (int c = 0; c < 3; ++c) film.normal[c] = static_cast<float>(plane.normal[c]);
        film.repulsion = -law.wall_stiffness(material[plane.particle], depth) * static_cast<float>(depth);
        levers_.push_back(
            with_fourth(static_cast<float>(depth) * times(fabrics[plane.particle].inverse, film.normal), 0));
        balance.add(film);
    }
}

/// Of a neighbour in the films of a particle.
void WallFilms::add_shares(std::int32_t particle, std::int32_t neighbour, float weight, Four apart,
                           FilmBalance& balance) {
    const std::int32_t first = of_particle_[particle];
    if (first < 0) return;
    for (auto f = static_cast<std::size_t>(first); f < levers_.size() && balance.films()[f].particle == particle; ++f) {
        const float share = weight * sum_of_three(apart * levers_[f]);
        balance.add_share(static_cast<std::uint32_t>(f), neighbour, share);
        levers_[f][3] += share;
    }
}

void WallFilms::add_to_states(const FilmBalance& balance, FlowState* states) const {
    for (std::size_t f = 0; f < levers_.size(); ++f) {
        const FilmBalance::Film& film = balance.films()[f];
        for (int b = 0; b < 3; ++b)
            states[film.particle].traction[b] +=
                with_fourth(static_cast<float>(balance.film_force(f)) * levers_[f][b] * film.normal, 0);
    }
}

}  // namespace tomodem::plugin
