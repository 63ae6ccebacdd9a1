#pragma once
#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "solver_plugin/simulation/simulation.hpp"

namespace tomodem::plugin {

enum class ContactState : std::int64_t { internal, interface, between_objects };

/// A pair whose crowns meet.
struct Contact {
    std::int64_t a, b;  ///< places in the sample, from 1, a < b
    ContactState state;
    std::int64_t age;  ///< steps since an interface formed; 0 for the others, which are not remembered
    auto operator<=>(const Contact&) const = default;
};

/// What tests see of a simulation that no run asks for. Every call is collective over its communicator.
class SimulationProbe {
 public:
    explicit SimulationProbe(Simulation& simulation) : state_(simulation.state_.get()) {}

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
    /// process.
    std::vector<Vec3> forces_at(const std::vector<Vec3>& velocities);

 private:
    using State = Simulation::State;
    State* state_;
};

}  // namespace tomodem::plugin
