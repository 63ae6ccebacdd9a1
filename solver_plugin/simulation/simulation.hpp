#pragma once
#include <mpi.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh/mesh.hpp"
#include "core/packing/packing.hpp"
#include "core/scene/load_path.hpp"
#include "core/scene/model.hpp"
#include "solver_plugin/simulation/checkpoint.hpp"

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

/// How far the sample is from equilibrium: forces are means over two steps, as at rest an attraction that switches with
/// the direction of motion pulls in every other one.
struct ForceBalance {
    double net = 0.0;   ///< force on a particle, root mean square [uN]
    double load = 0.0;  ///< sum of the magnitudes of a particle's pair forces, mean over the particles [uN]
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
    /// Adds a rigid surface that begins its motion (mm/s, in the sample's axes) with the next step.
    /// @param mesh  in the sample's own lengths and coordinates
    /// @return particles nearer to it than half a seed radius: it stands inside the sample if there are any
    std::int64_t place_wall(const TriangleMesh& mesh, const Wall& wall);
    /// Begins a segment of the loading with the next step; gives the particles its random velocities.
    void set_loading(const LoadSegment& segment);

    /// Called between steps: returns after how many it wants to be called again, or throws, which ends the run in
    /// disorder: the simulation is not to be used any more.
    using Watch = std::function<std::int64_t()>;
    void run(std::int64_t steps, const Watch& watch = {});
    /// As run(), with the stress of every particle in the last step ready for stress_rows().
    void run_to_stress_sample(std::int64_t steps, const Watch& watch = {});
    std::int64_t step() const;
    double strain() const;
    PlaneForces take_forces();
    /// Mean force of each wall on the sample since the last call [uN], in the sample's axes, summed over all processes;
    /// in the order in which the walls were placed.
    std::vector<Vec3> take_wall_forces();
    Energies energies() const;
    /// Of the pair laws alone; planes, walls and drag do not count. Makes two steps (seldom more).
    ForceBalance force_balance();
    /// Kinetic energy [nJ] that the particles would have in a uniform flow between the planes; 0 without planes.
    double flow_energy() const;
    /// Present area between periodic sides [mm^2], in the sample's own lengths; nothing when the sides are free.
    std::optional<double> periodic_section() const;
    /// Greatest over the phases of kinetic energy over N k_rep r_s^2, each with its own particles and stiffness.
    double max_kinetic_energy_of_a_phase() const;
    double initial_height() const;  ///< H0 [mm] of the sample's own lengths
    /// Sum of force times lever along the load, over pairs and walls, in the last step of a run: the mean stress times
    /// the volume [uN mm]. Collective.
    double axial_virial() const;
    std::int64_t particles() const;
    std::int64_t initial_particles() const;  ///< of the sample
    double seed_radius() const;              ///< [mm] of the sample's own lengths
    /// Particles whose centre a plane has passed.
    std::int64_t particles_behind_planes() const;
    std::int64_t neighbour_builds() const;
    /// Passes over all pairs so far, in quasi-static steps; 0 in explicit ones, which make one each.
    std::int64_t evaluations() const;

    /// What the line ends with that the user sees when LIGGGHTS fails on one process alone.
    void advise(const std::string& text);

    /// Saves what restore() needs, under the names that begin with "solver".
    void save(Checkpoint& checkpoint) const;
    /// Takes the particles, the planes and the step of a checkpoint instead of its own. The next run sets LIGGGHTS up
    /// anew, as it does after rest(): from there on both give the same numbers, on the same number of processes.
    void restore(const FoundCheckpoint& found);
    /// The next run sets LIGGGHTS up anew from the particles as they are.
    void rest();
    /// The segment that began at an earlier step, after restore().
    void continue_loading(const LoadSegment& segment, std::int64_t first_step);

    /// Values by row, that is in the order of the sample's particles: each process gets its block of rows, in the
    /// sample's axes.
    RowBlock position_rows() const;  ///< mm, not cut by periodic sides
    RowBlock velocity_rows() const;  ///< mm/s
    RowBlock outward_rows() const;   ///< outward vectors of self-contact [mm]; zero before the first step under load
    /// Stress at the last step, which must be a sample: xx yy zz xy xz yz [Pa], tension positive, as the laws saw it
    /// there. The volume is volume_per_particle().
    /// sigma_ab = 1/V sum f_a l_b over the contacts of a particle, planes and walls included (thesis eq. 8.12).
    RowBlock stress_rows() const;
    /// Volume of the sample's box over the number of its particles [mm^3].
    double volume_per_particle() const;

    /// Positions in the order of the sample's particles, on the first process; empty elsewhere. Periodic sides do not
    /// cut them: a particle that leaves goes on outside.
    std::vector<Vec3> positions() const;

 private:
    friend class SimulationProbe;  // of the tests
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace tomodem::plugin
