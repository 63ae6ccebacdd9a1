#include "tools/relax/carve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"

namespace tomodem::relax {
namespace {

/// How far from an image's pore its own pore in the sample may reach, and how far particles are looked at [diameters].
constexpr double belonging = 2, reach = 4;
/// Depth below a face in which particles are counted to find where the material ends [diameters].
constexpr double face_depth = 3;
/// Smallest share of what a pore lacks that is taken out in one iteration.
constexpr double least_share = 1.0 / 32;

std::string place(const Vec3& low, const Vec3& high) {
    return fmt::format("{:.4g} .. {:.4g}, {:.4g} .. {:.4g}, {:.4g} .. {:.4g} mm", low[0], high[0], low[1], high[1],
                       low[2], high[2]);
}

void check_place(const LabelVolume& volume, const Packing& sample) {
    const Vec3 low = volume.origin(), high = low + volume.extent();
    const Vec3 sample_low = sample.box.origin, sample_high = sample_low + sample.box.edges;
    // vol2pack gives the sample the box of the image.
    const double allowed = 2 * sample.seed_radius + 0.01 * sample.box.edges.maxCoeff();
    if ((low - sample_low).cwiseAbs().maxCoeff() <= allowed && (high - sample_high).cwiseAbs().maxCoeff() <= allowed)
        return;
    throw InvalidInput(
        fmt::format("the volume and the sample do not lie over each other: the volume is {}, the sample's box {}; give "
                    "--voxel-size, --origin and --roi as they were for the sample",
                    place(low, high), place(sample_low, sample_high)));
}

/// D of the material away from pores and faces.
double density_between(const ImagePores& image, const Packing& sample, const Vec3& low, const Vec3& high) {
    const double margin = 2 * sample.seed_radius;
    const Vec3 inner_low = low + Vec3::Constant(margin), inner_high = high - Vec3::Constant(margin);
    const auto solid = [&](const Vec3& point) {
        if ((point - inner_low).minCoeff() < 0 || (inner_high - point).minCoeff() < 0) return false;
        for (const ImagePore& pore : image.pores)
            if (pore.distance.at(point) < 2 * margin) return false;
        return true;
    };
    double inside = 0;
    for (const Vec3& point : sample.position) inside += solid(point);
    // By points about as dense as the particles, each in the middle of an equal share of the box.
    std::array<std::int32_t, 3> count;
    Vec3 step;
    for (int c = 0; c < 3; ++c) {
        count[c] = std::max(1, static_cast<std::int32_t>((inner_high - inner_low)[c] / (1.5 * sample.seed_radius)));
        step[c] = (inner_high - inner_low)[c] / count[c];
    }
    double points = 0;
    for (std::int32_t z = 0; z < count[2]; ++z)
        for (std::int32_t y = 0; y < count[1]; ++y)
            for (std::int32_t x = 0; x < count[0]; ++x)
                points += solid(inner_low + step.cwiseProduct(Vec3(x + 0.5, y + 0.5, z + 0.5)));
    const double particle = 4.0 / 3.0 * std::numbers::pi * std::pow(sample.seed_radius, 3);
    if (inside < 200 || points < 200) return sample.density();
    return inside * particle / (points * step.prod());
}

}  // namespace

Carver::Carver(const LabelVolume& volume, const Packing& sample, const CarveOptions& options)
    : options_(options), seed_radius_(sample.seed_radius) {
    if (sample.size() == 0) throw InvalidInput("the sample has no particle");
    check_place(volume, sample);
    const double diameter = 2 * seed_radius_;
    image_ = find_pores(volume, seed_radius_, options.min_across, reach * diameter, options.threads);
    image_low_ = volume.origin();
    image_high_ = volume.origin() + volume.extent();
    low_ = image_low_ + Vec3::Constant(diameter);
    high_ = image_high_ - Vec3::Constant(diameter);
    Vec3 sample_low = sample.position.front(), sample_high = sample_low;
    for (const Vec3& point : sample.position) {
        sample_low = sample_low.cwiseMin(point);
        sample_high = sample_high.cwiseMax(point);
    }
    bool any = false;
    for (const ImagePore& pore : image_.pores) {
        if (pore.kind == PoreKind::open) continue;
        any = true;
        const Vec3& centre = pore.part.centre;
        const Vec3 allowed = pore.kind == PoreKind::cut ? Vec3::Constant(2 * diameter) : Vec3::Zero();
        if ((centre - sample_low + allowed).minCoeff() < 0 || (sample_high + allowed - centre).minCoeff() < 0)
            throw InvalidInput(fmt::format(
                "pore {} of the volume is at {:.4g}, {:.4g}, {:.4g} mm, outside the particles of the sample "
                "({}); give --voxel-size, --origin and --roi as they were for the sample",
                pore.part.number, centre[0], centre[1], centre[2], place(sample_low, sample_high)));
    }
    if (!any)
        throw InvalidInput(
            "every pore of the volume meets, or nearly so, two opposite faces of it: there is no pore to carve; let "
            "vol2pack mask the void, and relax it");
    share_.assign(image_.pores.size(), 1.0);
    neighbours_.resize(image_.pores.size());
    for (std::size_t a = 0; a < image_.pores.size(); ++a)
        for (std::size_t b = 0; b < image_.pores.size(); ++b) {
            const DistanceField &one = image_.pores[a].distance, &other = image_.pores[b].distance;
            if (a != b && (one.low() - other.high()).maxCoeff() < 0 && (other.low() - one.high()).maxCoeff() < 0)
                neighbours_[a].push_back(b);
        }
    density_ = sample.density();
}

void Carver::measure_density(const Packing& sample) {
    Vec3 sample_low = sample.position.front(), sample_high = sample_low;
    for (const Vec3& point : sample.position) {
        sample_low = sample_low.cwiseMin(point);
        sample_high = sample_high.cwiseMax(point);
    }
    density_ = density_between(image_, sample, low_.cwiseMax(sample_low), high_.cwiseMin(sample_high));
}

bool Carver::belongs(std::size_t pore, const Vec3& point) const {
    const double distance = image_.pores[pore].distance.at(point);
    if (!(distance < belonging * 2 * seed_radius_)) return false;
    if (image_.pores[pore].kind == PoreKind::open && ((point - low_).minCoeff() < 0 || (high_ - point).minCoeff() < 0))
        return false;
    for (const std::size_t other : neighbours_[pore])
        if (image_.pores[other].distance.at(point) < distance) return false;
    return true;
}

std::vector<std::size_t> Carver::near(std::size_t pore, const Packing& sample) const {
    const DistanceField& field = image_.pores[pore].distance;
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < sample.size(); ++i) {
        const Vec3& point = sample.position[i];
        if ((point - field.low()).minCoeff() < 0 || (field.high() - point).minCoeff() < 0) continue;
        if (field.at(point) < reach * 2 * seed_radius_) found.push_back(i);
    }
    return found;
}

Ends Carver::ends_of(const Packing& sample) const {
    const double diameter = 2 * seed_radius_, step = 0.75 * diameter;
    const double particle = 4.0 / 3.0 * std::numbers::pi * std::pow(seed_radius_, 3) / density_;
    const auto beside_pores = [&](const Vec3& point) {
        return std::all_of(image_.pores.begin(), image_.pores.end(),
                           [&](const ImagePore& pore) { return pore.distance.at(point) > diameter; });
    };
    Ends ends{image_low_, image_high_};
    std::vector<std::pair<double*, int>> unknown;
    double sum = 0;
    int known = 0;
    for (int c = 0; c < 3; ++c) {
        const int a = (c + 1) % 3, b = (c + 2) % 3;
        const double depth = std::min(face_depth * diameter, (image_high_ - image_low_)[c] / 3);
        const auto count = [&](int axis) { return std::max(0, static_cast<int>((high_ - low_)[axis] / step) - 2); };
        const int columns = count(a), rows = count(b);
        for (const int side : {-1, 1}) {
            double& end = side < 0 ? ends.low[c] : ends.high[c];
            std::vector<bool> taken(static_cast<std::size_t>(columns) * rows);
            double area = 0;
            for (int j = 0; j < rows; ++j)
                for (int i = 0; i < columns; ++i) {
                    Vec3 point;
                    point[a] = low_[a] + (i + 1.5) * step;
                    point[b] = low_[b] + (j + 1.5) * step;
                    bool dense = true;
                    for (double below = 0; dense && below < depth + diameter; below += diameter / 2) {
                        point[c] = end - side * below;
                        dense = beside_pores(point);
                    }
                    taken[static_cast<std::size_t>(j) * columns + i] = dense;
                    area += dense ? step * step : 0;
                }
            double particles = 0;
            for (const Vec3& point : sample.position) {
                if (side * (end - point[c]) > depth) continue;
                const double i = std::floor((point[a] - low_[a]) / step) - 1;
                const double j = std::floor((point[b] - low_[b]) / step) - 1;
                if (i >= 0 && j >= 0 && i < columns && j < rows)
                    particles += taken[static_cast<std::size_t>(j) * columns + static_cast<std::size_t>(i)];
            }
            constexpr double enough = 100;
            if (particles < enough) {
                unknown.emplace_back(&end, side);
                continue;
            }
            const double drawn_in = depth - particles * particle / area;
            end -= side * drawn_in;
            sum += drawn_in;
            ++known;
        }
    }
    // A face that pores take up draws in as the others do.
    for (const auto& [end, side] : unknown)
        if (known > 0) *end -= side * sum / known;
    return ends;
}

Assessment Carver::assess(const Packing& sample) const {
    Assessment result;
    result.pores.resize(image_.pores.size());
    const Ends ends = ends_of(sample);
    parallel_for(static_cast<std::int64_t>(image_.pores.size()), options_.threads, [&](std::int64_t k) {
        const ImagePore& pore = image_.pores[k];
        std::vector<Vec3> centres;
        for (const std::size_t i : near(k, sample)) centres.push_back(sample.position[i]);
        const Belongs mine = [&](const Vec3& point) { return belongs(k, point); };
        Mirrors mirrors{pore.face, Vec3::Zero()};
        for (int c = 0; c < 3; ++c) mirrors.plane[c] = pore.face[c] < 0 ? ends.low[c] : ends.high[c];
        PoreState& state = result.pores[k];
        state.number = pore.part.number;
        state.kind = pore.kind;
        state.judged = pore.kind != PoreKind::open && pore.across >= options_.judged_across;
        state.across = pore.across;
        state.centre = pore.part.centre;
        state.measure = measure_pore(centres, pore.distance, mine, {seed_radius_, density_}, mirrors);
        state.overlap = overlap_pore(centres, pore.distance, mine, {seed_radius_, density_}, pore.across, mirrors);
        state.target = pore.kind == PoreKind::open     ? state.overlap.image
                       : pore.kind == PoreKind::closed ? pore.part.volume
                                                       : pore.distance.volume_up_to(pore.face, mirrors.plane);
    });
    double largest = -1;
    for (std::size_t k = 0; k < result.pores.size(); ++k) {
        const PoreState& state = result.pores[k];
        if (state.kind == PoreKind::open) continue;
        for (PoreSum* const sum : {&result.all, state.kind == PoreKind::closed ? &result.closed : &result.cut}) {
            ++sum->count;
            sum->target += state.target;
            sum->volume += state.measure.volume;
        }
        result.grid_volume += state.overlap.volume;
        result.intersection += state.overlap.intersection;
        result.united += state.overlap.united;
        if (!state.judged) continue;
        ++result.judged;
        result.wrong += std::abs(state.error()) > options_.pore_error;
        if (std::abs(state.error()) > largest) {
            largest = std::abs(state.error());
            result.worst = k;
        }
    }
    return result;
}

bool Carver::is_done(const Assessment& assessment) const {
    return assessment.wrong == 0 && std::abs(assessment.all.error()) <= options_.total_error;
}

bool Carver::has_overshot(const Assessment& assessment) const {
    return assessment.all.error() > options_.total_error ||
           std::any_of(assessment.pores.begin(), assessment.pores.end(),
                       [&](const PoreState& pore) { return pore.judged && pore.error() > options_.pore_error; });
}

double Carver::distance_from_done(const Assessment& assessment) const {
    return std::max(std::abs(assessment.all.error()) / options_.total_error,
                    std::abs(assessment.worst_error()) / options_.pore_error);
}

bool Carver::hold_back(const Assessment& overshot) {
    const auto too_large = [&](const PoreState& pore) {
        return pore.kind != PoreKind::open && pore.measure.volume > pore.target;
    };
    const bool any = std::any_of(overshot.pores.begin(), overshot.pores.end(), too_large);
    bool helps = false;
    for (std::size_t k = 0; k < share_.size(); ++k) {
        if ((any && !too_large(overshot.pores[k])) || share_[k] < least_share) continue;
        share_[k] /= 2;
        helps = true;
    }
    return helps;
}

std::vector<std::size_t> Carver::next_removal(const Packing& sample, const Assessment& assessment, bool first) const {
    const double particle = 4.0 / 3.0 * std::numbers::pi * std::pow(seed_radius_, 3) / density_;
    // What the total will still lack when the judged pores have their volume, over what the others lack.
    double left = assessment.all.target - assessment.all.volume, others = 0;
    for (const PoreState& state : assessment.pores) {
        if (state.kind == PoreKind::open) continue;
        (state.judged ? left : others) += state.judged ? -state.lacking() : state.lacking();
    }
    const double of_others = others > 0 ? std::clamp(left / others, 0.0, 1.0) : 0;
    std::vector<std::vector<std::size_t>> chosen(image_.pores.size());
    parallel_for(static_cast<std::int64_t>(image_.pores.size()), options_.threads, [&](std::int64_t k) {
        const ImagePore& pore = image_.pores[k];
        const PoreState& state = assessment.pores[k];
        std::vector<std::pair<double, std::size_t>> candidates;
        for (const std::size_t i : near(k, sample)) {
            const Vec3& point = sample.position[i];
            const double distance = pore.distance.at(point);
            const bool own = std::none_of(neighbours_[k].begin(), neighbours_[k].end(), [&](std::size_t other) {
                return image_.pores[other].distance.at(point) <= distance;
            });
            if (own && distance < belonging * 2 * seed_radius_) candidates.emplace_back(distance, i);
        }
        std::sort(candidates.begin(), candidates.end());
        std::size_t wanted = 0;
        if (pore.kind == PoreKind::open) {
            // Once, and as it is in the image: the sample's own faces move, and its edge there is no measure.
            if (first)
                while (wanted < candidates.size() && candidates[wanted].first < 0) ++wanted;
        } else {
            const double share = options_.first_share * state.target;
            const double lacking =
                first && state.measure.volume < share ? share - state.measure.volume : state.lacking() * share_[k];
            const double number = lacking * (state.judged || first ? 1 : of_others) / particle;
            wanted = std::min(candidates.size(), static_cast<std::size_t>(std::llround(number)));
        }
        for (std::size_t n = 0; n < wanted; ++n) chosen[k].push_back(candidates[n].second);
    });
    std::vector<std::size_t> all;
    for (const auto& some : chosen) all.insert(all.end(), some.begin(), some.end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

CarveRow row_of(const Assessment& assessment, std::int64_t iteration, std::int64_t particles, std::int64_t removed) {
    CarveRow row;
    row.iteration = iteration;
    row.particles = particles;
    row.removed = removed;
    row.target = assessment.all.target;
    row.volume = assessment.all.volume;
    row.total_error = assessment.all.error();
    row.grid_error = assessment.grid_volume / assessment.all.target - 1;
    row.judged = assessment.judged;
    row.wrong = assessment.wrong;
    if (assessment.judged > 0) {
        row.worst = assessment.pores[assessment.worst].number;
        row.worst_error = assessment.worst_error();
    }
    row.iou = assessment.iou();
    double area = 0, first = 0, second = 0;
    for (const PoreState& pore : assessment.pores) {
        if (pore.kind == PoreKind::open) continue;
        const PoreMeasure& m = pore.measure;
        area += m.area;
        first += m.area * m.distance;
        second += m.area * (m.spread * m.spread + m.distance * m.distance);
    }
    if (area > 0) {
        row.surface_distance = first / area;
        row.surface_spread = std::sqrt(std::max(0.0, second / area - std::pow(first / area, 2)));
    }
    return row;
}

std::string table_of(const std::vector<CarveRow>& rows) {
    std::string text =
        "iteration,particles,removed,target [mm^3],volume [mm^3],total_error [-],grid_error "
        "[-],judged,wrong,worst_pore,"
        "worst_error [-],iou [-],surface_distance [mm],surface_spread [mm],periods,energy_ratio [-],force_balance "
        "[-],taken_back\n";
    for (const CarveRow& r : rows)
        text += fmt::format(
            "{},{},{},{:.6g},{:.6g},{:.5f},{:.5f},{},{},{},{:.5f},{:.5f},{:.4g},{:.4g},{:.0f},{:.3g},{:.3g},{}\n",
            r.iteration, r.particles, r.removed, r.target, r.volume, r.total_error, r.grid_error, r.judged, r.wrong,
            r.worst, r.worst_error, r.iou, r.surface_distance, r.surface_spread, r.periods, r.energy_ratio,
            r.force_balance, int(r.taken_back));
    return text;
}

std::string pore_table(const Assessment& assessment) {
    std::string text =
        "pore,open,cut,judged,across [particles],x [mm],y [mm],z [mm],target [mm^3],volume [mm^3],error [-],grid_error "
        "[-],"
        "iou [-],surface_distance [mm],surface_spread [mm],leaks\n";
    for (const PoreState& p : assessment.pores)
        text += fmt::format(
            "{},{},{},{},{:.2f},{:.5g},{:.5g},{:.5g},{:.6g},{:.6g},{:.5f},{:.5f},{:.5f},{:.4g},{:.4g},{}\n", p.number,
            int(p.kind == PoreKind::open), int(p.kind == PoreKind::cut), int(p.judged), p.across, p.centre[0],
            p.centre[1], p.centre[2], p.target, p.measure.volume, p.error(), p.overlap.volume / p.target - 1, p.iou(),
            p.measure.distance, p.measure.spread, int(p.measure.leaks));
    return text;
}

std::vector<double> numbers_of(const std::vector<CarveRow>& rows) {
    std::vector<double> numbers;
    for (const CarveRow& r : rows)
        numbers.insert(numbers.end(), {double(r.iteration), double(r.particles), double(r.removed), r.target, r.volume,
                                       r.total_error, r.grid_error, double(r.judged), double(r.wrong), double(r.worst),
                                       r.worst_error, r.iou, r.surface_distance, r.surface_spread, r.periods,
                                       r.energy_ratio, r.force_balance, double(r.taken_back)});
    return numbers;
}

std::vector<CarveRow> rows_of(const std::vector<double>& numbers) {
    std::vector<CarveRow> rows;
    for (std::size_t at = 0; at + 18 <= numbers.size(); at += 18) {
        const double* const n = numbers.data() + at;
        const auto whole = [&](int k) { return static_cast<std::int64_t>(n[k]); };
        rows.push_back({whole(0), whole(1), whole(2), n[3], n[4], n[5], n[6], whole(7), whole(8), whole(9), n[10],
                        n[11], n[12], n[13], n[14], n[15], n[16], n[17] != 0});
    }
    return rows;
}

}  // namespace tomodem::relax
