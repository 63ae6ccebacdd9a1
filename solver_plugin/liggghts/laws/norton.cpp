// NORTON inside LIGGGHTS.
#include <cmath>
#include <limits>
#include <memory>

#include "core/base/error.hpp"
#include "core/scene/laws/norton.hpp"
#include "solver_plugin/liggghts/liggghts.hpp"
// behind the headers of LIGGGHTS
#include "solver_plugin/liggghts/laws/script_properties.hpp"
#include "solver_plugin/liggghts/solver_law.hpp"
#include "solver_plugin/norton/norton_flow.hpp"
#include "solver_plugin/norton/norton_steps.hpp"

namespace tomodem::plugin {
namespace {

/// An input script gives consistency: peratomtype, K [stress time^M]; rateSensitivity: peratomtype, M; flowRate:
/// scalar, the strain rate of the load [1/time], which the elastic parts and the film at walls go by.
class NortonSolverLaw final : public SolverLaw {
 public:
    PairKernel& kernel() override { return flow_ ? static_cast<PairKernel&>(*flow_) : steps_; }

    void use(const PresentModel& present) override {
        law::Norton law = norton_of(present.model);
        law.at_rest = present.at_rest;
        for (std::size_t k = 0; k < law.materials.size(); ++k) {
            law.materials[k].consistency *= present.strength[k];
            law.materials[k].strength *= present.strength[k];
        }
        if (present.model.scheme == Scheme::quasi_static) {
            if (!flow_) flow_ = std::make_unique<NortonFlow>();
            flow_->set_law(law, present.model.imbalance);
        } else {
            steps_.set_law(law, norton_law().traits().list_skin);
        }
    }

    void connect(PropertyRegistry& registry, const char* caller) override {
        script::connect_types<consistency>(registry, consistency_, caller);
        script::connect_types<sensitivity>(registry, sensitivity_, caller);
        script::connect_scalar<flow_rate>(registry, flow_rate_, caller);
    }

    void read(const ScriptParticles& particles) override {
        law::Norton law;
        law.flow_rate = flow_rate_;
        law.min_rate = law::NortonConstants::rate_floor * flow_rate_;
        const double flow = shipped_calibration().find<NortonCalibration>()->flow;
        double crown = 0;
        for (std::size_t type = 1; type < particles.crown_radius.size(); ++type) {
            const double radius = particles.crown_radius[type];
            if (particles.dispersed || (radius > 0 && crown > 0 && radius != crown))
                throw InvalidInput("model norton is made for particles of one diameter");
            crown = std::max(crown, radius);
            const double own = consistency_[type] / flow;
            law.materials.push_back({own, sensitivity_[type], own * std::pow(flow_rate_, sensitivity_[type])});
        }
        law.seed_diameter = 2 * crown / law::NortonConstants::crown;
        steps_.set_law(law, norton_law().traits().list_skin);
    }

 private:
    static constexpr char consistency[] = "consistency", sensitivity[] = "rateSensitivity", flow_rate[] = "flowRate";

    NortonSteps steps_;
    std::unique_ptr<NortonFlow> flow_;  ///< of the quasi-static scheme, in its place
    double* consistency_ = nullptr;
    double* sensitivity_ = nullptr;
    double flow_rate_ = 0;
};

}  // namespace

std::unique_ptr<SolverLaw> make_norton() {
    return std::make_unique<NortonSolverLaw>();
}

}  // namespace tomodem::plugin
