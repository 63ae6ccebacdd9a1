#pragma once
#include <algorithm>
#include <vector>

#include "solver_plugin/liggghts/liggghts.hpp"
// behind the headers of LIGGGHTS
#include "solver_plugin/liggghts/laws/script_properties.hpp"
#include "solver_plugin/liggghts/solver_law.hpp"
#include "solver_plugin/pairs/crown_pairs.hpp"

namespace tomodem::plugin {

/// What BILIN and TRILIN share inside LIGGGHTS.
///
/// An input script gives repulsiveStiffness, attractiveStiffness: peratomtypepair [force/length]; greatestAttraction
/// (TRILIN only): peratomtypepair [force]; seedToCrown: scalar, r_s / r_c.
class CrownSolverLaw final : public SolverLaw {
 public:
    enum class Attraction { unbounded, bounded };

    CrownSolverLaw(const Law& law, Attraction attraction) : law_(law), attraction_(attraction) {}

    PairKernel& kernel() override { return pairs_; }

    void use(const PresentModel& present) override {
        const Model& model = present.model;
        PairLaws laws;
        laws.type_count = static_cast<int>(model.phases.size());
        laws.dispersed = present.dispersed;
        laws.seed_to_crown = model.seed_radius / model.crown_radius;
        std::vector<law::Pair> own;
        for (std::size_t k = 0; k < model.phases.size(); ++k)
            own.push_back(law::scaled(model.phases[k].pair, present.strength[k]));
        for (const law::Pair& a : own)
            for (const law::Pair& b : own) laws.of_types.push_back(law::mixed(a, b));
        pairs_.set_laws(laws, law_.traits().list_skin);
    }

    void connect(PropertyRegistry& registry, const char* caller) override {
        script::connect_pairs<repulsive>(registry, repulsive_stiffness_, caller);
        script::connect_pairs<attractive>(registry, attractive_stiffness_, caller);
        if (attraction_ == Attraction::bounded) script::connect_pairs<greatest>(registry, max_attraction_, caller);
        script::connect_scalar<seed_share>(registry, seed_to_crown_, caller);
    }

    void read(const ScriptParticles& particles) override {
        PairLaws laws;
        laws.type_count = static_cast<int>(particles.crown_radius.size()) - 1;
        laws.dispersed = particles.dispersed;
        laws.seed_to_crown = seed_to_crown_;
        for (int a = 1; a <= laws.type_count; ++a)
            for (int b = 1; b <= laws.type_count; ++b)
                laws.of_types.push_back(pair(a, b, particles.crown_radius[a] + particles.crown_radius[b]));
        pairs_.set_laws(laws, law_.traits().list_skin);
    }

 private:
    static constexpr char repulsive[] = "repulsiveStiffness", attractive[] = "attractiveStiffness",
                          greatest[] = "greatestAttraction", seed_share[] = "seedToCrown";

    /// Law of a pair of types whose crown radii add up to `crown`.
    law::Pair pair(int a, int b, double crown) const {
        law::Pair law{crown * seed_to_crown_, crown, repulsive_stiffness_[a][b], attractive_stiffness_[a][b]};
        if (max_attraction_ != nullptr) law.max_attraction = max_attraction_[a][b];
        return law;
    }

    const Law& law_;
    Attraction attraction_;
    CrownPairs pairs_;
    double** repulsive_stiffness_ = nullptr;
    double** attractive_stiffness_ = nullptr;
    double** max_attraction_ = nullptr;
    double seed_to_crown_ = 0.0;
};

}  // namespace tomodem::plugin
