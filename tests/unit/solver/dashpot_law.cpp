// A law that tomodem does not have, to show what one takes: this file, linked into `solve`, is all of it.
//
// DASHPOT: seeds repel as springs; in the crown a viscous force resists the change of the distance, F = -c dh/dt.
#include <algorithm>
#include <cmath>

#include "core/base/toml_reader.hpp"
#include "core/law/pair.hpp"
#include "core/scene/law.hpp"
#include "core/scene/model.hpp"
#include "solver_plugin/liggghts/solver_law.hpp"

namespace tomodem {
namespace {

/// Its constants: repulsive_stiffness [uN/mm], natural_period [s] and viscosity, c [uN s/mm], of each [phase.NAME].
struct DashpotModel : LawConstants {
    std::vector<double> viscosity;  ///< by phase
};

class DashpotLaw final : public Law {
 public:
    DashpotLaw() : Law({.name = "dashpot", .feature = "dashpots", .self_contact = false}) {}

    void read_phase(TomlReader& reader, Phase& phase) const override {
        for (const char* key : {"repulsive_stiffness", "natural_period", "viscosity"}) {
            reader.get(key);
            phase.law_numbers[key] = *reader.optional_positive(key);
        }
    }
    void check_phase(const TomlReader& reader, const Phase& phase) const override {
        if (phase.norton) reader.fail("law \"dashpot\" has no flow stress K rate^M");
    }
    void read_accuracy(TomlReader&, Scene&) const override {}

    void compile(const Scene& scene, const Packing&, Model& model) const override {
        const auto constants = std::make_shared<DashpotModel>();
        model.time_step = scene.time_step.value_or(scene.step_strain() / scene.highest_rate());
        for (PhaseModel& phase : model.phases) {
            const LawNumbers& given = scene.phase(phase.label).law_numbers;
            const double stiffness = given.at("repulsive_stiffness"), period = given.at("natural_period");
            phase.pair = {2 * scene.seed_radius, 2 * scene.crown_radius, stiffness, 0};
            phase.natural_period = period;
            phase.mass = law::mass_for_period(stiffness, period);
            constants->viscosity.push_back(given.at("viscosity"));
        }
        model.constants = constants;
    }
};

const DashpotLaw dashpot;
const LawRegistration known_to_scenes(dashpot);

}  // namespace

namespace plugin {
namespace {

class DashpotPairs final : public PairKernel {
 public:
    std::vector<law::Pair> pair;  // by type, from 0
    std::vector<double> viscosity;

    void pair_forces(const ParticleView& particles, const NeighbourView& list, const ContactMemory*,
                     const UsePair& use) const override {
        for_each_pair(list, [&](int i, int j) {
            const law::Pair law = mixed(particles, i, j);
            const double c = (viscosity[particles.type[i] - 1] + viscosity[particles.type[j] - 1]) / 2;
            double apart[3], squared = 0, rate = 0;
            for (int axis = 0; axis < 3; ++axis) {
                apart[axis] = particles.position[3 * i + axis] - particles.position[3 * j + axis];
                squared += apart[axis] * apart[axis];
                rate += apart[axis] * (particles.velocity[3 * i + axis] - particles.velocity[3 * j + axis]);
            }
            const double distance = std::sqrt(squared);
            if (distance > law.crown_distance) return;
            const double spring = law.repulsive_stiffness * std::max(0.0, law.seed_distance - distance);
            const double over_distance = (spring - c * rate / distance) / distance;
            const double force[3] = {over_distance * apart[0], over_distance * apart[1], over_distance * apart[2]};
            use(i, j, force, apart);
        });
    }
    double wall_force(const WallContact& contact) const override {
        const law::Pair& law = pair[contact.type - 1];
        return law.repulsive_stiffness * std::max(0.0, law.seed_distance / 2 - contact.distance);
    }
    double seed_energy(const ParticleView& particles, const NeighbourView& list) const override {
        return spring_energy(particles, list, [&](int i, int j) {
            const law::Pair law = mixed(particles, i, j);
            return std::pair(law.seed_distance, law.repulsive_stiffness);
        });
    }

 private:
    law::Pair mixed(const ParticleView& particles, int i, int j) const {
        return law::mixed(pair[particles.type[i] - 1], pair[particles.type[j] - 1]);
    }
};

class DashpotInLiggghts final : public SolverLaw {
 public:
    PairKernel& kernel() override { return pairs_; }
    void use(const PresentModel& present) override {
        pairs_.pair.clear();
        pairs_.viscosity = static_cast<const DashpotModel&>(*present.model.constants).viscosity;
        for (std::size_t k = 0; k < present.model.phases.size(); ++k) {
            pairs_.pair.push_back(law::scaled(present.model.phases[k].pair, present.strength[k]));
            pairs_.viscosity[k] *= present.strength[k];
        }
    }

 private:
    DashpotPairs pairs_;
};

const SolverLawRegistration known_to_the_solver(dashpot, []() -> std::unique_ptr<SolverLaw> {
    return std::make_unique<DashpotInLiggghts>();
});

}  // namespace
}  // namespace plugin
}  // namespace tomodem
