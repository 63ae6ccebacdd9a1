#pragma once
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "solver_plugin/liggghts/fix_contact.hpp"
#include "solver_plugin/liggghts/fix_watch.hpp"
#include "solver_plugin/liggghts/lateral_box.hpp"
#include "solver_plugin/liggghts/law_pair.hpp"
#include "solver_plugin/liggghts/planes.hpp"
#include "solver_plugin/liggghts/surfaces.hpp"
#include "solver_plugin/simulation/session.hpp"
#include "solver_plugin/simulation/simulation.hpp"

namespace tomodem::plugin {

/// A sample inside LIGGGHTS, and what the parts of Simulation share: building and loading (simulation.cpp), what is
/// read off (simulation_reports.cpp), saving and resuming (simulation_restart.cpp).
struct Simulation::State {
    MPI_Comm communicator;
    int rank = 0;
    Model model;
    int axis;
    double scale = 1;  ///< solver's length over the sample's
    Vec3 centre;       ///< of the sample, in its own lengths
    std::int64_t count = 0;
    Session session;
    FixPlanes* planes = nullptr;
    FixLateralBox* sides = nullptr;  ///< when they are periodic
    std::vector<FixSurface*> surfaces;
    LoadSegment segment;             ///< the present one
    std::int64_t segment_start = 0;  ///< its first step
    LawPair* pair = nullptr;
    FixWatch* watch = nullptr;
    FixContact* contact = nullptr;
    std::vector<std::int32_t> object;  ///< by id - 1, where the law looks at it
    std::vector<double> hardening;     ///< factor of each phase at present
    bool relaxing = false;
    bool loading = false;
    LoadClock material_clock;            ///< all time under load: hardening goes by it
    LoadClock run_clock;                 ///< of the present load: the motion of the walls goes by it
    bool ready = false;                  ///< LIGGGHTS is set up for the present masses, planes and walls
    double sample_volume = 0;            ///< of the sample's box, in its own lengths
    std::int64_t builds_before = 0;      ///< neighbour builds before the last set-up
    bool counting = false;               ///< there was a set-up
    std::vector<double> radius_factors;  ///< by row; empty: all 1

    State(const Packing& sample, const Model& model, int axis, MPI_Comm communicator);

    LAMMPS_NS::Atom& atom() { return *session.lmp().atom; }

    /// Component of the sample's coordinates that the solver calls `component`: the loading axis becomes z.
    int turned(int component) const { return (component + axis + 1) % 3; }

    Vec3 to_solver(const Vec3& point) const {
        const Vec3 local = scale * (point - centre);
        return {local[turned(0)], local[turned(1)], local[turned(2)]};
    }

    /// Turns a vector of the solver back to the sample's axes, without scaling.
    Vec3 turned_back(const Vec3& vector) const {
        Vec3 result;
        for (int component = 0; component < 3; ++component) result[turned(component)] = vector[component];
        return result;
    }

    double total(double mine) const {
        double sum = 0;
        MPI_Allreduce(&mine, &sum, 1, MPI_DOUBLE, MPI_SUM, communicator);
        return sum;
    }

    double largest(double mine) const {
        double highest = 0;
        MPI_Allreduce(&mine, &highest, 1, MPI_DOUBLE, MPI_MAX, communicator);
        return highest;
    }

    /// LIGGGHTS' type of a label of the image.
    int type_of(std::int32_t label) const;

    void add_sides();

    /// Once.
    void add_planes();

    /// Gives the pair style the constants of the present strength of each phase.
    void use_laws();

    /// A phase that hardens keeps its natural period: stiffness and mass grow together, so that no trajectory changes.
    void harden(double time);

    void remember_contacts();

    /// Widens the periodic sides while the sample presses on them, and narrows them while it pulls.
    void steer_sides();

    bool quasi_static() const { return model.scheme == Scheme::quasi_static; }

    /// From now on the steps have that length [s].
    void step_by(double time_step);

    double time_in_segment() {
        return segment.time_step * static_cast<double>(session.lmp().update->ntimestep - segment_start);
    }

    /// Adds the velocities of a uniaxial flow about the planes' centre that keeps the volume.
    void carry_along(double rate);

    void scale_velocities(double factor);

    /// Adds a random velocity of that standard deviation to every component; it depends on the particle alone.
    void shake(double deviation);

    /// Those of this process.
    void create_particles(const Packing& sample);
    void create_particle(int type, int tag, double* point);
    /// @throws InvalidInput if some found no place
    void count_particles();

    /// The height that `wanted` centres lie beyond: below it for inward = 1, above it for -1.
    double face(double low, double high, double wanted, double inward);

    template <class PeriodOf>
    void set_masses(PeriodOf period_of) {
        LAMMPS_NS::Atom& atoms = atom();
        const double crown_volume = 4.0 / 3.0 * std::numbers::pi * std::pow(model.crown_radius, 3);
        for (int i = 0; i < atoms.nlocal; ++i) {
            const PhaseModel& phase = model.phases[atoms.type[i] - 1];
            const double stiffness = phase.pair.repulsive_stiffness * hardening[atoms.type[i] - 1];
            atoms.rmass[i] = law::mass_for_period(stiffness, period_of(phase));
            atoms.density[i] = atoms.rmass[i] / crown_volume;
        }
        ready = false;
    }

    /// LIGGGHTS counts from its last set-up on; before the first its number means nothing.
    std::int64_t builds() { return builds_before + (counting ? session.lmp().neighbor->ncalls : 0); }

    void set_up_if_needed();

    /// Deals `components` values of each local particle out to the processes that hold their rows.
    /// @param value  (local particle, component)
    RowBlock rows(int components, const std::function<double(int, int)>& value);

    /// Vectors of the local particles, in the order of the sample, on the first process.
    std::vector<Vec3> gather(double* const* local);
};

}  // namespace tomodem::plugin
