#pragma once
#include <limits>
#include <utility>

#include "core/scene/law.hpp"
#include "core/scene/model.hpp"
#include "core/scene/scene.hpp"

namespace tomodem {

/// What BILIN and TRILIN share: a repulsive seed in an attractive crown, with constants that follow from norton = { K,
/// M } or are given as repulsive_stiffness and natural_period (docs/method.md).
class CrownLaw : public Law {
 public:
    void read_phase(TomlReader& reader, Phase& phase) const override;
    void check_phase(const TomlReader& reader, const Phase& phase) const override;
    void read_accuracy(TomlReader& reader, Scene& scene) const override;
    void compile(const Scene& scene, const Packing& sample, Model& model) const override;
    void warn(const Scene& scene, const Model& model, Reporter& reporter) const override;

 protected:
    struct Constants {
        double stiffness, period;  ///< k_rep [uN/mm], t0 [s]
    };

    /// @param usual_stiffness_ratio  k_rep / k_att unless the scene gives it
    CrownLaw(LawTraits traits, double usual_stiffness_ratio)
        : Law(std::move(traits)), usual_stiffness_ratio_(usual_stiffness_ratio) {}

    /// Of a phase given by norton, at the highest rate of the scene.
    virtual Constants constants_for(const Scene& scene, const Norton& flow, double time_step) const = 0;
    /// What "auto" aims at.
    virtual double strain_per_step(const Scene& scene) const;
    /// @throws InvalidInput if the packing could not follow the load
    virtual void check_rate(const Scene& scene, const Phase& phase, double period, double time_step) const = 0;
    /// f_att [uN]
    virtual double max_attraction(const Scene& scene, const Phase& phase, double stiffness) const;

 private:
    PhaseModel compile_phase(const Scene& scene, const Phase& phase, double time_step) const;

    double usual_stiffness_ratio_;
};

}  // namespace tomodem
