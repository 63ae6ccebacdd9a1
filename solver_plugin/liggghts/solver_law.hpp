#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/scene/model.hpp"
#include "solver_plugin/pairs/pair_kernel.hpp"

class PropertyRegistry;  // of LIGGGHTS

namespace tomodem::plugin {

/// What a model is at one moment of a run.
struct PresentModel {
    const Model& model;
    const std::vector<double>& strength;  ///< factor of each phase (hardening)
    bool at_rest;                         ///< the sample comes to rest
    bool dispersed;                       ///< particles of a phase differ in their radii
};

/// What the particles of an input script are.
struct ScriptParticles {
    std::vector<double> crown_radius;  ///< by type, from 1; 0 where there is no particle
    bool dispersed;                    ///< particles of a type differ
};

/// One law inside one LIGGGHTS: its kernel, and how its constants get there. The other half of what a law is, Law, is
/// in core/scene/law.hpp.
class SolverLaw {
 public:
    virtual ~SolverLaw() = default;
    virtual PairKernel& kernel() = 0;

    /// Constants of a scene. Called again whenever they change.
    virtual void use(const PresentModel& present) = 0;

    /// Asks for the constants of an input script, `fix property/global` (docs/plain-liggghts.md). Here: refuses.
    /// @param caller  named in LIGGGHTS' error when a property is missing
    virtual void connect(PropertyRegistry& registry, const char* caller);
    /// Takes them, for the particles that there are now.
    virtual void read(const ScriptParticles& /*particles*/) {}
};

/// Makes the solver's half of a law known: before main(), from a static object of the file that holds it.
struct SolverLawRegistration {
    using Make = std::unique_ptr<SolverLaw> (*)();
    SolverLawRegistration(const Law& law, Make make);
};

/// The laws that the solver knows, those of tomodem first; the same at every call.
std::vector<const Law*> solver_laws();
/// @throws InvalidInput if the solver does not know the law
std::unique_ptr<SolverLaw> make_solver_law(const Law& law);

/// The laws of tomodem, each in a file of its own in solver_plugin/liggghts/laws/.
std::unique_ptr<SolverLaw> make_bilin();
std::unique_ptr<SolverLaw> make_trilin();
std::unique_ptr<SolverLaw> make_norton();

}  // namespace tomodem::plugin
