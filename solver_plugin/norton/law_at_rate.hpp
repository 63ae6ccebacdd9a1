#pragma once
#include <cmath>
#include <vector>

#include "core/law/norton_law.hpp"

namespace tomodem::plugin {

/// Law NORTON at the load's present rate, which films and elastic parts go by. Materials are counted from 0.
class LawAtRate {
 public:
    /// Its rate becomes that of the law.
    void set(const law::Norton& law) {
        law_ = law;
        set_rate(law.flow_rate);
    }
    /// @param rate  of the load [1/s], above 0
    void set_rate(double rate) {
        rate_ = rate;
        strengths_.clear();
        for (const law::NortonMaterial& material : law_.materials)
            strengths_.push_back(material.strength * (law_.strength_follows
                                                          ? std::pow(rate / law_.flow_rate, material.rate_sensitivity)
                                                          : 1));
    }

    const law::Norton& law() const { return law_; }
    double diameter() const { return law_.seed_diameter; }
    /// What the elastic parts are multiples of [Pa].
    double strength(int material) const { return strengths_[static_cast<std::size_t>(material)]; }
    /// K rate^M [Pa].
    double flow_stress(int material) const {
        const law::NortonMaterial& own = law_.materials[static_cast<std::size_t>(material)];
        return own.consistency * std::pow(rate_, own.rate_sensitivity);
    }
    /// Of the film at a wall's face [uN.s/mm].
    float film_damping(int material) const {
        const law::NortonMaterial& own = law_.materials[static_cast<std::size_t>(material)];
        return static_cast<float>(law::NortonConstants::film * law_.seed_diameter * own.consistency *
                                  std::pow(rate_, own.rate_sensitivity - 1));
    }
    /// Of the repulsion behind that face [uN/mm].
    /// @param depth  of the particle's centre within the sample [mm]; negative: behind the face
    float wall_stiffness(int material, double depth) const {
        if (depth >= 0) return 0;
        return static_cast<float>(law::NortonConstants::core_stiffness * law_.seed_diameter * strength(material));
    }

 private:
    law::Norton law_;
    double rate_ = 0;
    std::vector<double> strengths_;
};

}  // namespace tomodem::plugin
