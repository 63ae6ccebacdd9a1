#include "core/scene/law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "core/base/toml_reader.hpp"
#include "core/scene/model.hpp"

namespace tomodem {
namespace {

std::vector<const Law*>& registry() {
    static std::vector<const Law*> all{&bilin_law(), &trilin_law(), &norton_law()};
    return all;
}

}  // namespace

const std::vector<const Law*>& laws() {
    return registry();
}

const Law* find_law(std::string_view name) {
    const auto found = std::find_if(laws().begin(), laws().end(), [&](const Law* law) { return law->name() == name; });
    return found == laws().end() ? nullptr : *found;
}

LawRegistration::LawRegistration(const Law& law) {
    if (find_law(law.name()) != nullptr) throw std::logic_error("two laws are called " + law.name());
    registry().push_back(&law);
}

void Law::check_scene(TomlReader&, const Scene&) const {}

std::shared_ptr<const CalibrationWindow> Law::read_calibration(TomlReader&) const {
    return nullptr;
}

const CalibrationWindow& Law::expect(const Scene&, const Phase&, const PhaseModel&, const Model&, ExpectedFlow&) const {
    throw std::logic_error("law " + name() + " has no calibration");
}

std::string Law::time_step_reason(const Scene& scene, const Model& model) const {
    if (scene.time_step) return "given in [accuracy]";
    const double wanted = scene.step_strain() / scene.highest_rate();
    if (model.time_step >= wanted * (1 - 1e-9))
        return fmt::format("strain_per_step {:g} at the highest rate {:g} /s", scene.step_strain(),
                           scene.highest_rate());
    const auto shortest =
        std::min_element(model.phases.begin(), model.phases.end(),
                         [](const PhaseModel& a, const PhaseModel& b) { return a.natural_period < b.natural_period; });
    return fmt::format("the natural period {:g} s of label {}, which needs so many steps", shortest->natural_period,
                       shortest->label);
}

void Law::warn(const Scene&, const Model&, Reporter&) const {}

double Law::relaxation_time_step(const Model& model) const {
    return model.time_step;
}

double Law::evaluations(const Model&, double steps) const {
    return steps;
}

double Law::evaluations_at_rest(const Model&) const {
    return 1;
}

double Law::steps_of_a_relaxation_period(const Model&) const {
    return relaxation_steps_per_period;
}

}  // namespace tomodem
