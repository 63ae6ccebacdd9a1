#include "tools/plan/proposal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
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
/// Particles finer than voxels show no more of the image [voxels].
constexpr double finest_seed = 0.5;
/// What vol2pack makes unless told otherwise.
constexpr double most_particles = 5e7;
/// Pores whose share of an open structure's void is smaller come with it, they are not what it is about.
constexpr double minor_pores = 0.1;
/// A strut of fewer particles across does not carry its stress, whatever the law.
constexpr double thinnest_strut = 3;

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

/// Of all quantities, and between them; none coarser than each of them was measured with.
std::vector<double> steps_to_try(const LawTrade& trade, const std::vector<Quantity>& of) {
    std::set<double> measured;
    double coarsest = std::numeric_limits<double>::infinity();
    for (const Quantity quantity : of) {
        const std::vector<double>& step = trade.curve.at(quantity).step;
        measured.insert(step.begin(), step.end());
        coarsest = std::min(coarsest, step.back());
    }
    measured.erase(measured.upper_bound(coarsest), measured.end());
    std::vector<double> steps;
    for (const double step : measured) {
        if (steps.empty()) {
            steps.push_back(step);
            continue;
        }
        const double before = steps.back();
        for (int part = 1; part <= steps_between; ++part)
            steps.push_back(before * std::pow(step / before, static_cast<double>(part) / steps_between));
    }
    return steps;
}

double particles_of(const ImageFeatures& image, double radius, double density) {
    return image.solid_volume / volume_of_particle(radius, density);
}

double radius_for(Quantity quantity, const ImageFeatures& image, bool smallest, double resolution, double density) {
    if (quantity == Quantity::flow_stress)
        return std::cbrt(image.solid_volume / resolution * density * 3 / (4 * std::numbers::pi));
    return *feature_of(quantity, image, smallest) / (2 * resolution);
}

double resolution_of(Quantity quantity, const ImageFeatures& image, bool smallest, double radius, double density) {
    if (quantity == Quantity::flow_stress) return particles_of(image, radius, density);
    return *feature_of(quantity, image, smallest) / (2 * radius);
}

/// Of a run, from the rest between its planes on.
struct Work {
    std::int64_t steps = 0;       ///< with the rest between the planes
    double evaluations = 0;       ///< of these steps
    double load_evaluations = 0;  ///< of the load alone, as solve counts them
};

Work work_of(const Scene& scene, const Model& model) {
    Work work;
    for (const LoadSegment& segment : load_path(scene, model)) work.steps += segment.steps;
    work.load_evaluations = work.evaluations = model.law->evaluations(model, static_cast<double>(work.steps));
    if (!model.law->traits().planes_pull) return work;
    const std::int64_t seating = relaxation_steps(model, seating_periods);
    work.steps += seating;
    work.evaluations += model.law->evaluations_at_rest(model) * static_cast<double>(seating);
    return work;
}

double prepare_seconds_of(const TradeCurve& curve, double particles) {
    return curve.prepare[0] + curve.prepare[1] * particles * std::cbrt(particles / 1000);
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
        for (const double step : steps_to_try(trade, of_)) {
            Proposal tried;
            tried.choice = {law, step};
            tried.density = trade.density;
            tried.scene = with_choice(request_.scene_text, tried.choice, request_.scene_name);
            const Scene scene = parse_scene(tried.scene, request_.scene_name);
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
                if (tried.error() <= request_.error * (1 + 1e-6)) {  // a request may have been rounded
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
    /// Coarsest radius at which something is known of every quantity, and the one finer than which nothing improves.
    std::pair<double, double> radii(const LawTrade& trade) const {
        double coarsest = 1e300, finest = 1e300;
        for (const Quantity quantity : of_) {
            const std::vector<double>& resolution = trade.curve.at(quantity).resolution;
            const auto radius = [&](double across) {
                return radius_for(quantity, image_, request_.smallest, across, trade.density);
            };
            coarsest = std::min(coarsest, radius(resolution.front()));
            finest = std::min(finest, radius(resolution.back()));
        }
        const double of_most = radius_for(Quantity::flow_stress, image_, false, most_particles, trade.density);
        if (coarsest < of_most)
            throw InvalidInput(fmt::format("it would take {:.2g} particles; take a part of the image (--roi)",
                                           particles_of(image_, coarsest, trade.density)));
        finest = std::max({finest, of_most, finest_seed * image_.voxel});
        return {coarsest, std::min(coarsest, finest)};
    }

    /// Errors and cost of a setting whose choice and radius are given.
    void fill(Proposal& tried, const Scene& scene, const LawTrade& trade) const {
        const Model model = compile_model(scene, outline(image_, tried.seed_radius));
        tried.particles = particles_of(image_, tried.seed_radius, trade.density);
        tried.time_step = model.time_step;
        const Work work = work_of(scene, model);
        tried.steps = work.steps;
        if (scene.scheme == Scheme::quasi_static) tried.evaluations = std::llround(work.load_evaluations);
        tried.flows = expected_flows(scene, std::llround(tried.particles), model);
        const double decades = std::max(0.0, std::log10(scene.highest_rate() / scene.lowest_rate()));
        double misfit = 0;
        if (decades > 1e-6)
            for (const ExpectedFlow& flow : tried.flows) misfit = std::max(misfit, flow.rates);

        tried.errors.clear();
        tried.bytes = 0;
        double particle_evaluation = 0, prepare = 0;
        for (const Quantity quantity : of_) {
            const TradeCurve& curve = trade.curve.at(quantity);
            PredictedError error;
            error.quantity = quantity;
            error.resolution = resolution_of(quantity, image_, request_.smallest, tried.seed_radius, trade.density);
            error.parts = curve.error(error.resolution, tried.choice.step);
            error.parts.rates = std::max(decades * curve.rate_error.value_or(0), is_stress(quantity) ? misfit : 0.0);
            tried.errors.push_back(error);
            tried.bytes = std::max(tried.bytes, curve.bytes[0] + curve.bytes[1] * tried.particles);
            particle_evaluation = std::max(particle_evaluation, curve.particle_step);
            prepare = std::max(prepare, prepare_seconds_of(curve, tried.particles));
        }
        tried.cpu_seconds = particle_evaluation * tried.particles * work.evaluations;
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

const Feature* first_of(Feature::Kind kind, const ImageFeatures& image) {
    const auto found = std::find_if(image.features.begin(), image.features.end(),
                                    [&](const Feature& feature) { return feature.kind == kind; });
    return found == image.features.end() ? nullptr : &*found;
}

bool marks_objects(const Scene& scene) {
    return std::any_of(scene.phases.begin(), scene.phases.end(), [](const Phase& phase) { return phase.objects; });
}

/// Objects of the image that only touch, if at all.
bool are_separate(const Feature& objects) {
    return objects.count != 1;
}

double closed_volume(const ImageFeatures& image) {
    double volume = 0;
    for (const VoidPart& part : image.voids)
        if (part.wall() > 0) volume += part.volume;
    return volume;
}

/// Rounded up to two digits, so that who asks for it gets it.
double reachable(double error) {
    const double digit = std::pow(10, std::floor(std::log10(error)) - 1);
    return std::ceil(error / digit - 1e-6) * digit;
}

/// What a search over the laws comes to.
struct Found {
    std::vector<Proposal> within;
    std::optional<Proposal> closest;
    std::vector<std::pair<std::string, std::string>> not_taken;
};

Found search_laws(const ImageFeatures& image, const PlanRequest& request, const TradeTable& table,
                  const std::vector<Quantity>& of) {
    const Search search(image, request, table, of);
    Found found;
    for (const Law* known : laws()) {
        const std::string& law = known->name();
        if (!table.law.contains(law)) continue;
        if (request.law && law != *request.law) continue;
        try {
            std::optional<Proposal> closest_of_law;
            if (auto one = search.best(law, closest_of_law)) found.within.push_back(*one);
            if (closest_of_law && (!found.closest || closest_of_law->error() < found.closest->error()))
                found.closest = closest_of_law;
        } catch (const InvalidInput& error) {
            found.not_taken.emplace_back(law, error.what());
        }
    }
    return found;
}

/// Sets of fewer and fewer of the quantities, each next to the last.
std::vector<std::vector<Quantity>> fewer(const std::vector<Quantity>& of) {
    std::vector<std::vector<Quantity>> sets;
    for (unsigned chosen = 1; chosen + 1 < 1U << of.size(); ++chosen) {
        std::vector<Quantity>& set = sets.emplace_back();
        for (std::size_t k = 0; k < of.size(); ++k)
            if ((chosen >> k & 1U) != 0) set.push_back(of[k]);
    }
    std::stable_sort(sets.begin(), sets.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
    return sets;
}

bool is_readable(const PlanRequest& request) {
    try {
        parse_scene(request.scene_text, request.scene_name);
        return true;
    } catch (const InvalidInput&) {
        return false;
    }
}

[[noreturn]] void refuse(const ImageFeatures& image, const PlanRequest& request, const TradeTable& table,
                         const std::vector<Quantity>& of, const Found& found) {
    std::string why;
    for (const auto& [law, reason] : found.not_taken)
        why += fmt::format("{}{}: {}", why.empty() ? "" : "; ", law, reason);
    std::string advice;
    if (request.law) {
        PlanRequest any = request;
        any.law.reset();
        if (const Found others = search_laws(image, any, table, of); others.closest)
            advice = fmt::format("; without --law, \"{}\" can", others.closest->choice.law);
    }
    if (advice.empty() && is_readable(request))
        advice = "; --particles instead of --error makes the chain for the scene as it is, its error unknown";
    throw InvalidInput(fmt::format("no law can hold scene '{}': {}{}", request.scene_name, why, advice));
}

}  // namespace

double Proposal::error() const {
    double largest = 0;
    for (const PredictedError& one : errors) largest = std::max(largest, one.parts.total());
    return largest;
}

std::optional<std::string> not_carved(const ImageFeatures& image, const Scene& scene) {
    if (image.labels.size() > 1) return "void between several phases has no phase that it could be filled with";
    const Feature* const objects = first_of(Feature::Kind::objects, image);
    if (marks_objects(scene) && objects != nullptr && are_separate(*objects))
        return "filled with their phase, void would join the objects";
    return std::nullopt;
}

std::vector<Quantity> quantities_of(const ImageFeatures& image, const Scene& scene, const TradeTable& table,
                                    bool smallest, std::vector<std::string>& left_out) {
    const Feature* const objects = first_of(Feature::Kind::objects, image);
    const Feature* const struts = first_of(Feature::Kind::struts, image);
    std::set<Quantity> of;
    const auto leave_out = [&](Quantity quantity, const std::string& why) {
        of.erase(quantity);
        left_out.push_back(fmt::format("{} is left out, its error is unknown: {}", name_of(quantity), why));
    };
    if (objects != nullptr && marks_objects(scene)) of.insert(Quantity::shape_factor);
    if (objects != nullptr && image.labels.size() > 1) {
        of.insert(Quantity::composite_stress);
        if (struts != nullptr)
            leave_out(Quantity::composite_stress, "it was measured without void, which fills over 30 % of this image");
    }
    if (struts != nullptr) {
        of.insert(Quantity::foam_stress);
        if (objects != nullptr && are_separate(*objects))
            leave_out(Quantity::foam_stress, "the stress of separate objects in void was not measured");
    }
    if (first_of(Feature::Kind::pores, image) != nullptr) {
        of.insert(Quantity::pore_volume);
        const double share = closed_volume(image) / image.void_volume;
        if (const auto why = not_carved(image, scene))
            leave_out(Quantity::pore_volume, *why);
        else if (struts != nullptr && share < minor_pores)
            leave_out(Quantity::pore_volume,
                      fmt::format("closed pores are {:.2g} % of the void, the others reach its faces", 100 * share));
    }
    for (const Quantity quantity : std::set<Quantity>(of)) {
        double coarsest = std::numeric_limits<double>::infinity();
        for (const auto& [law, trade] : table.law)
            if (trade.curve.contains(quantity))
                coarsest = std::min(coarsest, trade.curve.at(quantity).resolution.front());
        const double size = *feature_of(quantity, image, smallest);
        if (std::isfinite(coarsest) && size < 2 * finest_seed * image.voxel * coarsest)
            leave_out(quantity, fmt::format("{:g} particles across {:.3g} voxels would be finer than the image",
                                            coarsest, size / image.voxel));
    }
    if (of.empty()) of.insert(Quantity::flow_stress);
    return {of.begin(), of.end()};
}

std::vector<CoarseStress> coarse_stresses(const ImageFeatures& image, const Scene& scene, double seed_radius,
                                          double density, const TradeTable& table) {
    const auto trade = table.law.find(scene.law().name());
    if (trade == table.law.end()) return {};
    const bool struts = first_of(Feature::Kind::struts, image) != nullptr;
    const bool composite = first_of(Feature::Kind::objects, image) != nullptr && image.labels.size() > 1;
    const Quantity quantity = struts      ? Quantity::foam_stress
                              : composite ? Quantity::composite_stress
                                          : Quantity::flow_stress;
    const auto curve = trade->second.curve.find(quantity);
    CoarseStress coarse;
    coarse.quantity = quantity;
    coarse.resolution = resolution_of(quantity, image, false, seed_radius, density);
    coarse.needed = std::max(struts ? thinnest_strut : 0.0,
                             curve == trade->second.curve.end() ? 0.0 : curve->second.resolution.front());
    if (coarse.resolution >= coarse.needed) return {};
    coarse.seed_radius = radius_for(quantity, image, false, coarse.needed, density);
    coarse.particles = particles_of(image, coarse.seed_radius, density);
    if (curve != trade->second.curve.end()) try {
            const Model model = compile_model(scene, outline(image, coarse.seed_radius));
            coarse.cpu_seconds = curve->second.particle_step * coarse.particles * work_of(scene, model).evaluations +
                                 prepare_seconds_of(curve->second, coarse.particles);
        } catch (const InvalidInput&) {
            // solve says what the scene cannot do; what it would cost is not known then.
        }
    return {coarse};
}

Plan make_plan(const ImageFeatures& image, const PlanRequest& request, const TradeTable& table) {
    Plan plan;
    const Scene scene = readable_scene(request.scene_text, request.scene_name);
    check_asked(request.of, image);
    plan.of = request.of.empty() ? quantities_of(image, scene, table, request.smallest, plan.left_out) : request.of;
    Found found = search_laws(image, request, table, plan.of);
    if (!found.closest && request.of.empty())
        for (const std::vector<Quantity>& some : fewer(plan.of)) {
            Found other = search_laws(image, request, table, some);
            if (!other.closest) continue;
            for (const Quantity quantity : plan.of)
                if (std::find(some.begin(), some.end(), quantity) == some.end())
                    plan.left_out.push_back(fmt::format(
                        "{} is left out, its error is unknown: no law that holds the scene was measured for it "
                        "together with the others",
                        name_of(quantity)));
            plan.of = some;
            found = std::move(other);
            break;
        }
    plan.not_taken = found.not_taken;
    if (!found.closest) refuse(image, request, table, plan.of, found);
    if (found.within.empty()) {
        const Proposal& closest = *found.closest;
        const auto worst = std::max_element(
            closest.errors.begin(), closest.errors.end(),
            [](const PredictedError& a, const PredictedError& b) { return a.parts.total() < b.parts.total(); });
        throw InvalidInput(fmt::format(
            "an error of {:g} % is out of reach: the smallest is {:.2g} % of {}, with law \"{}\", strain_per_step = "
            "{:.4g} and "
            "{:.0f} particles; {} limits it; give --error {:g}%",
            100 * request.error, 100 * worst->parts.total(), name_of(worst->quantity), closest.choice.law,
            closest.choice.step, closest.particles, worst->parts.largest(), reachable(100 * worst->parts.total())));
    }
    std::sort(found.within.begin(), found.within.end(),
              [](const Proposal& a, const Proposal& b) { return Search::cost(a) < Search::cost(b); });
    plan.proposal = found.within.front();
    plan.other_laws.assign(found.within.begin() + 1, found.within.end());
    return plan;
}

}  // namespace tomodem::plan
