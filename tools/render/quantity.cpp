#include "tools/render/quantity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>

#include "core/base/error.hpp"

namespace tomodem::render {
namespace {

std::vector<std::string> component_names(int components) {
    if (components == 3) return {"x", "y", "z"};
    if (components == 6) return {"xx", "yy", "zz", "xy", "xz", "yz"};
    std::vector<std::string> names;
    for (int k = 0; k < components; ++k) names.push_back(std::to_string(k));
    return names;
}

/// Everything that may be asked for.
std::vector<std::string> all_names(const RunReader& run) {
    std::vector<std::string> names;
    for (const auto& [name, values] : run.packing().property) names.push_back(name);
    for (const ParticleField& field : run.fields()) {
        if (field.components == 1 || field.components == 3) names.push_back(field.name);
        if (field.components > 1)
            for (const std::string& component : component_names(field.components))
                names.push_back(field.name + "_" + component);
    }
    return names;
}

}  // namespace

Quantity::Quantity(const RunReader& run, const std::string& name) : run_(&run), title_(name) {
    std::string wanted = name;
    std::replace(wanted.begin(), wanted.end(), ' ', '_');
    std::replace(wanted.begin(), wanted.end(), ':', '_');
    if (run.packing().property.contains(wanted)) {
        field_ = wanted;
        return;
    }
    for (const ParticleField& field : run.fields()) {
        const auto components = component_names(field.components);
        for (int k = -1; k < field.components; ++k) {
            if (k < 0 && field.components != 1 && field.components != 3) continue;
            if (wanted != (k < 0 ? field.name : field.name + "_" + components[static_cast<std::size_t>(k)])) continue;
            field_ = field.name;
            unit_ = field.unit;
            components_ = field.components;
            component_ = field.components == 1 ? 0 : k;
            std::replace(title_.begin(), title_.end(), '_', ' ');
            return;
        }
    }
    const auto names = all_names(run);
    throw InvalidInput(fmt::format("there is no '{}' to colour by; besides phase, object and none the file has {}",
                                   name, names.empty() ? "nothing" : fmt::format("{}", fmt::join(names, ", "))));
}

std::vector<double> Quantity::values(std::size_t frame) const {
    if (components_ == 0) return run_->packing().property.at(field_);
    const std::vector<double> rows = run_->field_values(field_, frame);
    const auto components = static_cast<std::size_t>(components_);
    std::vector<double> values(rows.size() / components);
    for (std::size_t k = 0; k < values.size(); ++k) {
        const std::span row(rows.data() + k * components, components);
        values[k] = component_ < 0 ? Vec3(row[0], row[1], row[2]).norm() : row[static_cast<std::size_t>(component_)];
    }
    return values;
}

std::vector<Vec3> vectors(const RunReader& run, const std::string& field, std::size_t frame) {
    std::vector<std::string> names;
    bool found = false;
    for (const ParticleField& one : run.fields())
        if (one.components == 3) {
            names.push_back(one.name);
            found |= one.name == field;
        }
    if (!found)
        throw InvalidInput(fmt::format(
            "the run has no vector '{}' to draw as arrows; it has {}{}", field,
            names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", ")),
            field == "outward" ? " (the solver writes outward with 'self_contact = true' in the scene)" : ""));
    const std::vector<double> rows = run.field_values(field, frame);
    std::vector<Vec3> result(rows.size() / 3);
    for (std::size_t k = 0; k < result.size(); ++k) result[k] = {rows[3 * k], rows[3 * k + 1], rows[3 * k + 2]};
    return result;
}

}  // namespace tomodem::render
