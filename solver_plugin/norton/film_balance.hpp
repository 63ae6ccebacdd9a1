#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "solver_plugin/norton/four.hpp"
#include "solver_plugin/pairs/pair_kernel.hpp"

namespace tomodem::plugin {

/// The viscous films between sample and planes in an explicit step. They are too stiff for one, so their forces are
/// those of the end of the step: found by conjugate gradients over the films alone, all other forces given.
///
/// A film's slip is s = B v - V: its particle's velocity along the normal, and shares of the velocities of the
/// neighbours, which make the flow at the face. Its force phi = -c s acts by B^T. With the velocities v* that the
/// particles would have without films, (1/c + B (dt/m) B^T) phi = V - B v*.
class FilmBalance {
 public:
    /// Brings each ghost `size` bytes from its owner; particle i has them at first + i * stride bytes. Collective.
    using Carry = std::function<void(void* first, std::size_t stride, std::size_t size)>;

    struct Film {
        std::int32_t particle;  ///< may be a ghost: its force acts on neighbours of this process
        int plane;              ///< WallContact::plane
        Four normal;            ///< from the plane to the particle
        double velocity;        ///< V, of the plane along the normal
        float damping;          ///< c [uN.s/mm]
        float repulsion;        ///< of what is behind the face, besides the film [uN]
    };

    void clear();
    /// Those of a particle one after the other, in the same order on every process; those of ghosts last.
    void add(const Film& film) { films_.push_back(film); }
    /// Of the slip of the film that was added `film`-th: what a particle's velocity along its normal has in it, besides
    /// the whole that the film's own particle has.
    void add_share(std::uint32_t film, std::int32_t particle, float share) {
        shares_.push_back({film, particle, share});
    }

    /// Finds the forces. Collective, and does nothing where there are no films on any process.
    /// @param particles  with mass and velocity, ghosts' velocities included
    /// @param forces     of everything but the films and the repulsion, of the particles of this process [uN]
    void solve(const ParticleView& particles, const Four* forces, double time_step, const Carry& carry,
               const FlowSurroundings& surroundings);

    /// Of a film, by the order in which they were added, in the last solve(); ghosts' included [uN].
    double film_force(std::size_t film) const { return forces_[film]; }
    const std::vector<Film>& films() const { return films_; }
    /// Film and repulsion of a plane on a particle, along the normal; 0 where it has none [uN].
    double plane_force(std::int32_t particle, int plane) const;
    /// Adds what acts on the particles of this process through the flow: all but plane_force().
    /// @param forces  3 per particle
    void add_forces(double* forces) const;
    /// Of conjugate gradients in the last solve().
    int iterations() const { return iterations_; }

 private:
    struct Share {
        std::uint32_t film;
        std::int32_t particle;
        float share;
    };
    /// A particle is between two planes at most.
    using OfParticle = std::array<double, 2>;

    void bring(std::vector<double>& of_films, const Carry& carry);
    void find_changes(const std::vector<double>& film_forces);

    std::vector<Film> films_;
    std::vector<Share> shares_;
    std::size_t own_films_ = 0;  ///< of particles of this process
    int local_count_ = 0, iterations_ = 0;
    std::vector<double> forces_, rest_, step_, direction_, product_, diagonal_;  ///< of the films
    std::vector<Four> changes_;     ///< of the velocities of the particles, ghosts included
    std::vector<double> mobility_;  ///< dt/m of the particles of this process
    std::vector<OfParticle> carried_;
};

}  // namespace tomodem::plugin
