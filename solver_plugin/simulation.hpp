#pragma once
#include <mpi.h>

#include <array>
#include <compare>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/model.hpp"
#include "core/packing.hpp"

/// A sample inside LIGGGHTS. No LIGGGHTS header is needed to use it.
namespace tomodem::plugin {

/// Forces of the planes on the sample [uN], tension positive, summed over all processes.
struct PlaneForces {
    double top = 0.0, bottom = 0.0;  ///< means over `steps`
    long steps = 0;
};

struct Energies {
    double kinetic = 0.0;  ///< nJ
    double seeds = 0.0;    ///< elastic, of the overlapping seeds [nJ]
};

enum class ContactState : std::int64_t { internal, interface, between_objects };

/// A pair whose crowns meet.
struct Contact {
    std::int64_t a, b;  ///< places in the sample, from 1, a < b
    ContactState state;
    std::int64_t age;  ///< steps since an interface formed; 0 for the others, which are not remembered
    auto operator<=>(const Contact&) const = default;
};

/// Every call is collective over the communicator; results are the same on every process unless said otherwise.
///
/// The sample is scaled to the model's seed radius, centred, and turned so that the loading axis is z; what comes out
/// is scaled back to the sample's own lengths (stresses, strains and times are the same in both).
class Simulation {
 public:
    Simulation(const Packing& sample, const Model& model, int axis, MPI_Comm communicator);
    ~Simulation();
    Simulation(const Simulation&) = delete;
    Simulation& operator=(const Simulation&) = delete;

    /// Every particle swings with the same short period while `steps` are made: rest is reached soonest.
    void begin_relaxation();
    /// Ends it: true masses, velocities zero.
    void end_relaxation();

    /// Puts the planes one seed radius outside the sample's faces; their distance less two seeds is H0.
    ///
    /// A face is at the outermost centre. Planes that pull (TRILIN's) must find more to hold: there a face is where the
    /// layer in their reach, r_c - r_s thick, has as many centres as the sample has on average.
    void place_planes();
    /// Constant true strain rate (signed) from `strain` on, from the next step.
    void set_loading(double strain, double rate);

    void run(std::int64_t steps);
    std::int64_t step() const;
    double strain() const;
    PlaneForces take_forces();
    Energies energies() const;
    /// Greatest over the phases of kinetic energy over N k_rep r_s^2, each with its own particles and stiffness.
    double hottest_phase() const;
    double largest_speed() const;
    double initial_height() const;  ///< H0 [mm] of the sample's own lengths
    std::int64_t particles() const;
    std::int64_t neighbour_builds() const;

    /// Positions in the order of the sample's particles, on the first process; empty elsewhere.
    std::vector<Vec3> positions() const;

    /// Every pair in the crown, sorted, on the first process; empty elsewhere.
    std::vector<Contact> contacts() const;
    /// Outward vectors of self-contact [mm], in the order of the sample, on the first process; zero without
    /// self-contact.
    std::vector<Vec3> outward_vectors() const;
    /// Process that owns each particle, in the order of the sample, on the first process.
    std::vector<int> owners() const;
    /// Processes along the two directions across the load and along it.
    std::array<int, 3> process_grid() const;

    /// Sets velocities [mm/s] (in the order of the sample) and returns the forces [uN] at this moment, on the first
    /// process: what tests of the law look at.
    std::vector<Vec3> forces_at(const std::vector<Vec3>& velocities);

 private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace tomodem::plugin
