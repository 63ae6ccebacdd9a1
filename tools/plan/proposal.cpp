#include "tools/plan/proposal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "core/base/error.hpp"
#include "core/scene/load_path.hpp"
#include "core/scene/model.hpp"

namespace tomodem::plan {
namespace {

/// Settings between two points of the table that are tried, and the ratio of two seed radii tried.
constexpr int steps_between = 4;
constexpr double radius_ratio = 1.03;

double volume_of_particle(double radius, double density) {
    return 4 * std::numbers::pi / 3 * std::pow(radius, 3) / density;
}

/// Diameter of the feature that decides a quantity [mm]; nothing: the image has none. The smallest over the phases.
std::optional<double> feature_of(Quantity quantity, const ImageFeatures& image, bool smallest) {
    const Feature::Kind kind = quantity == Quantity::pore_volume   ? Feature::Kind::pores
                               : quantity == Quantity::foam_stress ? Feature::Kind::struts
                                                                   : Feature::Kind::objects;
    std::optional<double> found;
    for (const Feature& feature : image.features)
        if (feature.kind == kind) found = std::min(found.value_or(1e300), smallest ? feature.smallest : feature.median);
    return found;
}

/// A sample as far as compiling a scene looks at it: its labels, objects and height.
Packing outline(const ImageFeatures& image, double seed_radius) {
    Packing sample;
    sample.box = {image.origin, image.extent, {false, false, false}};
    sample.seed_radius = seed_radius;
    for (const std::int32_t label : image.labels)
        for (const double side : {0.0, 1.0}) {
            sample.position.push_back(image.origin + Vec3::Constant(seed_radius) +
                                      side * (image.extent - Vec3::Constant(2 * seed_radius)));
            sample.species.push_back(label);
            sample.id.push_back(static_cast<std::int64_t>(sample.id.size()) + 1);
            sample.object.push_back(0);
        }
    return sample;
}

std::vector<double> steps_to_try(const std::vector<double>& measured) {
    std::vector<double> steps{measured.front()};
    for (std::size_t k = 1; k < measured.size(); ++k)
        for (int part = 1; part <= steps_between; ++part)
            steps.push_back(measured[k - 1] *
                            std::pow(measured[k] / measured[k - 1], static_cast<double>(part) / steps_between));
    return steps;
}

/// Everything that is looked through.
class Search {
 public:
    Search(const ImageFeatures& image, const PlanRequest& request, const TradeTable& table, std::vector<Quantity> of)
        : image_(image), request_(request), table_(table), of_(std::move(of)) {}

    /// The cheapest within the error under one law; `closest` becomes the setting of the smallest error seen.
    /// @throws InvalidInput if the law cannot hold the scene
    std::optional<Proposal> best(const std::string& law, std::optional<Proposal>& closest) const {
        const LawTrade& trade = table_.law.at(law);
        for (const Quantity quantity : of_)
            if (!trade.curve.contains(quantity))
                throw InvalidInput(fmt::format("the table has no {} of it", name_of(quantity)));
        std::optional<Proposal> found;
        std::string refused;
        for (const double step : steps_to_try(trade.curve.at(of_.front()).step)) {
            Proposal tried;
            tried.choice = {law, step};
            tried.density = trade.density;
            tried.scene = with_choice(request_.scene_text, tried.choice, request_.scene_name);
            const Scene scene = parse_scene(tried.scene, request_.scene_name);
            if (law == "norton" && scene.self_contact)
                throw InvalidInput("self_contact does not work under it (docs/norton.md)");
            const auto [coarsest, finest] = radii(trade);
            for (double radius = coarsest;; radius /= radius_ratio) {
                tried.seed_radius = std::max(radius, finest);
                try {
                    fill(tried, scene, trade);
                } catch (const InvalidInput& error) {
                    refused = error.what();
                    break;
                }
                if (!closest || tried.error() < closest->error()) closest = tried;
                if (tried.error() <= request_.error) {
                    if (!found || cost(tried) < cost(*found)) found = tried;
                    break;
                }
                if (radius <= finest) break;
            }
        }
        if (!closest && !refused.empty()) throw InvalidInput(refused);
        return found;
    }

    static double cost(const Proposal& one) { return one.cpu_seconds + one.prepare_seconds; }

 private:
    double resolution(Quantity quantity, double radius, double density) const {
        if (quantity == Quantity::flow_stress) return image_.solid_volume / volume_of_particle(radius, density);
        return *feature_of(quantity, image_, request_.smallest) / (2 * radius);
    }
    double radius(Quantity quantity, double resolution, double density) const {
        if (quantity == Quantity::flow_stress)
            return std::cbrt(image_.solid_volume / resolution * density * 3 / (4 * std::numbers::pi));
        return *feature_of(quantity, image_, request_.smallest) / (2 * resolution);
    }
    /// Coarsest radius at which something is known of every quantity, and the one finer than which nothing improves.
    std::pair<double, double> radii(const LawTrade& trade) const {
        double coarsest = 1e300, finest = 1e300;
        for (const Quantity quantity : of_) {
            const TradeCurve& curve = trade.curve.at(quantity);
            coarsest = std::min(coarsest, radius(quantity, curve.resolution.front(), trade.density));
            finest = std::min(finest, radius(quantity, curve.resolution.back(), trade.density));
        }
        return {coarsest, std::min(coarsest, finest)};
    }

    /// Errors and cost of a setting whose choice and radius are given.
    void fill(Proposal& tried, const Scene& scene, const LawTrade& trade) const {
        const Model model = compile_model(scene, outline(image_, tried.seed_radius));
        tried.particles = image_.solid_volume / volume_of_particle(tried.seed_radius, trade.density);
        tried.time_step = model.time_step;
        tried.steps = 0;
        for (const LoadSegment& segment : load_path(scene, model.time_step)) tried.steps += segment.steps;
        if (model.law->traits().planes_pull) tried.steps += relaxation_steps(model, seating_periods);
        tried.flows = expected_flows(scene, std::llround(tried.particles), model);
        const double decades = std::max(0.0, std::log10(scene.highest_rate() / scene.lowest_rate()));
        double misfit = 0;
        if (decades > 1e-6)
            for (const ExpectedFlow& flow : tried.flows) misfit = std::max(misfit, flow.rates);

        tried.errors.clear();
        tried.bytes = 0;
        double particle_step = 0, prepare = 0;
        for (const Quantity quantity : of_) {
            const TradeCurve& curve = trade.curve.at(quantity);
            PredictedError error;
            error.quantity = quantity;
            error.resolution = resolution(quantity, tried.seed_radius, trade.density);
            error.parts = curve.error(error.resolution, tried.choice.step);
            error.parts.rates = std::max(decades * curve.rate_error.value_or(0), is_stress(quantity) ? misfit : 0.0);
            tried.errors.push_back(error);
            tried.bytes = std::max(tried.bytes, curve.bytes[0] + curve.bytes[1] * tried.particles);
            particle_step = std::max(particle_step, curve.particle_step);
            prepare = std::max(
                prepare, curve.prepare[0] + curve.prepare[1] * tried.particles * std::cbrt(tried.particles / 1000));
        }
        tried.cpu_seconds = particle_step * tried.particles * static_cast<double>(tried.steps);
        tried.prepare_seconds = prepare;
    }

    const ImageFeatures& image_;
    const PlanRequest& request_;
    const TradeTable& table_;
    std::vector<Quantity> of_;
};

void check_asked(const std::vector<Quantity>& of, const ImageFeatures& image) {
    for (const Quantity quantity : of)
        if (quantity != Quantity::flow_stress && !feature_of(quantity, image, false))
            throw InvalidInput(fmt::format("{}: the image has no {}", name_of(quantity),
                                           quantity == Quantity::pore_volume   ? "closed pore of 27 voxels or more"
                                           : quantity == Quantity::foam_stress ? "struts: void that reaches its faces "
                                                                                 "fills less than 30 % of it"
                                                                               : "object of 27 voxels or more"));
}

}  // namespace

double Proposal::error() const {
    double largest = 0;
    for (const PredictedError& one : errors) largest = std::max(largest, one.parts.total());
    return largest;
}

std::vector<Quantity> quantities_of(const ImageFeatures& image, const Scene& scene) {
    std::set<Quantity> of;
    for (const Feature& feature : image.features) {
        if (feature.kind == Feature::Kind::pores) of.insert(Quantity::pore_volume);
        if (feature.kind == Feature::Kind::struts) of.insert(Quantity::foam_stress);
        if (feature.kind != Feature::Kind::objects) continue;
        of.insert(Quantity::composite_stress);
        if (scene.phase(image.labels.front()).objects ||
            std::any_of(scene.phases.begin(), scene.phases.end(), [](const Phase& phase) { return phase.objects; }))
            of.insert(Quantity::shape_factor);
    }
    if (of.empty()) of.insert(Quantity::flow_stress);
    return {of.begin(), of.end()};
}

Plan make_plan(const ImageFeatures& image, const PlanRequest& request, const TradeTable& table) {
    Plan plan;
    const Scene scene = readable_scene(request.scene_text, request.scene_name);
    plan.of = request.of.empty() ? quantities_of(image, scene) : request.of;
    check_asked(plan.of, image);
    const Search search(image, request, table, plan.of);
    std::optional<Proposal> closest;
    std::vector<Proposal> found;
    for (const Law* known : laws()) {
        const std::string& law = known->name();
        if (!table.law.contains(law)) continue;
        if (request.law && law != *request.law) continue;
        try {
            std::optional<Proposal> closest_of_law;
            if (auto one = search.best(law, closest_of_law)) found.push_back(*one);
            if (closest_of_law && (!closest || closest_of_law->error() < closest->error())) closest = closest_of_law;
        } catch (const InvalidInput& error) {
            plan.not_taken.emplace_back(law, error.what());
        }
    }
    if (!closest) {
        std::string why;
        for (const auto& [law, reason] : plan.not_taken)
            why += fmt::format("{}{}: {}", why.empty() ? "" : "; ", law, reason);
        throw InvalidInput(fmt::format("no law can hold scene '{}': {}", request.scene_name, why));
    }
    if (found.empty()) {
        const auto worst = std::max_element(
            closest->errors.begin(), closest->errors.end(),
            [](const PredictedError& a, const PredictedError& b) { return a.parts.total() < b.parts.total(); });
        throw InvalidInput(fmt::format(
            "an error of {:g} % is out of reach: the smallest is {:.2g} % of {}, with law \"{}\", {} = {:.4g} and "
            "{:.0f} "
            "particles; {} limits it",
            100 * request.error, 100 * worst->parts.total(), name_of(worst->quantity), closest->choice.law,
            closest->choice.key(), closest->choice.step, closest->particles, worst->parts.largest()));
    }
    std::sort(found.begin(), found.end(),
              [](const Proposal& a, const Proposal& b) { return Search::cost(a) < Search::cost(b); });
    plan.proposal = found.front();
    plan.other_laws.assign(found.begin() + 1, found.end());
    return plan;
}

}  // namespace tomodem::plan
