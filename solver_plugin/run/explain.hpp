#pragma once
#include <mpi.h>

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/reporter.hpp"
#include "core/packing/packing.hpp"
#include "core/scene/expected_flow.hpp"
#include "core/scene/scene.hpp"

namespace tomodem {

struct Continuation;

/// Something that a scene makes the solver do, or spares it.
struct Ingredient {
    std::string name;
    bool on;
    std::string why;
};

/// What a run of a scene would be.
struct Explanation {
    std::vector<Ingredient> ingredients;
    std::vector<ExpectedFlow> flows;
    std::int64_t particles = 0;
    double time_step = 0;  ///< s
    std::string time_step_reason;
    std::int64_t steps = 0;  ///< of relaxation and loading
    std::int64_t evaluations =
        0;  ///< of all pair forces in the steps of the load, where one takes several; 0: it takes one
    int processes = 1;
    double seconds_per_particle_step = 0;  ///< of one process, measured on this machine
    double wall_seconds = 0;
    std::int64_t peak_bytes = 0;  ///< all processes
};

/// Checks sample and scene as a run would, and presses the sample for about two seconds to see what a step costs.
/// Nothing is written. Collective.
/// @param before  the run whose end is the beginning; null: there is none
/// @throws InvalidInput as solve()
Explanation explain(const Packing& sample, const Scene& scene, const Continuation* before, MPI_Comm communicator,
                    Reporter& reporter);

}  // namespace tomodem
