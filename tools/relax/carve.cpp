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
    low_ = volume.origin() + Vec3::Constant(diameter);
    high_ = volume.origin() + volume.extent() - Vec3::Constant(diameter);
    Vec3 sample_low = sample.position.front(), sample_high = sample_low;
    for (const Vec3& point : sample.position) {
        sample_low = sample_low.cwiseMin(point);
        sample_high = sample_high.cwiseMax(point);
    }
    std::int64_t closed = 0;
    for (const ImagePore& pore : image_.pores) {
        closed += !pore.open;
        if ((pore.centre - sample_low).minCoeff() < 0 || (sample_high - pore.centre).minCoeff() < 0)
            if (!pore.open)
                throw InvalidInput(fmt::format(
                    "pore {} of the volume is at {:.4g}, {:.4g}, {:.4g} mm, outside the particles of the sample ({}); "
                    "give "
                    "--voxel-size, --origin and --roi as they were for the sample",
                    pore.number, pore.centre[0], pore.centre[1], pore.centre[2], place(sample_low, sample_high)));
    }
    if (closed == 0)
        throw InvalidInput(
            "every pore of the volume meets one of its faces, or comes within two particles of one: there is no closed "
            "pore to carve; let vol2pack mask what is open, and relax it");
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
    if (image_.pores[pore].open && ((point - low_).minCoeff() < 0 || (high_ - point).minCoeff() < 0)) return false;
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

Assessment Carver::assess(const Packing& sample) const {
    Assessment result;
    result.pores.resize(image_.pores.size());
    parallel_for(static_cast<std::int64_t>(image_.pores.size()), options_.threads, [&](std::int64_t k) {
        const ImagePore& pore = image_.pores[k];
        std::vector<Vec3> centres;
        for (const std::size_t i : near(k, sample)) centres.push_back(sample.position[i]);
        const Belongs mine = [&](const Vec3& point) { return belongs(k, point); };
        PoreState& state = result.pores[k];
        state.number = pore.number;
        state.open = pore.open;
        state.judged = !pore.open && pore.across >= options_.judged_across;
        state.across = pore.across;
        state.centre = pore.centre;
        state.measure = measure_pore(centres, pore.distance, mine, {seed_radius_, density_});
        state.overlap = overlap_pore(centres, pore.distance, mine, {seed_radius_, density_}, pore.across);
        state.target = pore.open ? state.overlap.image : pore.volume;
    });
    double largest = -1;
    for (std::size_t k = 0; k < result.pores.size(); ++k) {
        const PoreState& state = result.pores[k];
        if (state.open) continue;
        result.target += state.target;
        result.volume += state.measure.volume;
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
    return assessment.wrong == 0 && std::abs(assessment.total_error()) <= options_.total_error;
}

std::vector<std::size_t> Carver::next_removal(const Packing& sample, const Assessment& assessment, bool first) const {
    const double particle = 4.0 / 3.0 * std::numbers::pi * std::pow(seed_radius_, 3) / density_;
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
        if (pore.open) {
            // Once, and as it is in the image: the sample's own faces move, and its edge there is no measure.
            if (first)
                while (wanted < candidates.size() && candidates[wanted].first < 0) ++wanted;
        } else {
            const double share = options_.first_share * state.target;
            const double aim = first && state.measure.volume < share ? share : state.target;
            const double lacking = std::max(0.0, aim - state.measure.volume);
            wanted = std::min(candidates.size(), static_cast<std::size_t>(std::llround(lacking / particle)));
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
    row.target = assessment.target;
    row.volume = assessment.volume;
    row.total_error = assessment.total_error();
    row.grid_error = assessment.grid_volume / assessment.target - 1;
    row.judged = assessment.judged;
    row.wrong = assessment.wrong;
    if (assessment.judged > 0) {
        row.worst = assessment.pores[assessment.worst].number;
        row.worst_error = assessment.pores[assessment.worst].error();
    }
    row.iou = assessment.iou();
    double area = 0, first = 0, second = 0;
    for (const PoreState& pore : assessment.pores) {
        if (pore.open) continue;
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
        "[-]\n";
    for (const CarveRow& r : rows)
        text += fmt::format(
            "{},{},{},{:.6g},{:.6g},{:.5f},{:.5f},{},{},{},{:.5f},{:.5f},{:.4g},{:.4g},{:.0f},{:.3g},{:.3g}\n",
            r.iteration, r.particles, r.removed, r.target, r.volume, r.total_error, r.grid_error, r.judged, r.wrong,
            r.worst, r.worst_error, r.iou, r.surface_distance, r.surface_spread, r.periods, r.energy_ratio,
            r.force_balance);
    return text;
}

std::string pore_table(const Assessment& assessment) {
    std::string text =
        "pore,open,judged,across [particles],x [mm],y [mm],z [mm],target [mm^3],volume [mm^3],error [-],grid_error [-],"
        "iou [-],surface_distance [mm],surface_spread [mm],leaks\n";
    for (const PoreState& p : assessment.pores)
        text +=
            fmt::format("{},{},{},{:.2f},{:.5g},{:.5g},{:.5g},{:.6g},{:.6g},{:.5f},{:.5f},{:.5f},{:.4g},{:.4g},{}\n",
                        p.number, int(p.open), int(p.judged), p.across, p.centre[0], p.centre[1], p.centre[2], p.target,
                        p.measure.volume, p.error(), p.overlap.volume / p.target - 1, p.iou(), p.measure.distance,
                        p.measure.spread, int(p.measure.leaks));
    return text;
}

std::vector<double> numbers_of(const std::vector<CarveRow>& rows) {
    std::vector<double> numbers;
    for (const CarveRow& r : rows)
        numbers.insert(numbers.end(),
                       {double(r.iteration), double(r.particles), double(r.removed), r.target, r.volume, r.total_error,
                        r.grid_error, double(r.judged), double(r.wrong), double(r.worst), r.worst_error, r.iou,
                        r.surface_distance, r.surface_spread, r.periods, r.energy_ratio, r.force_balance});
    return numbers;
}

std::vector<CarveRow> rows_of(const std::vector<double>& numbers) {
    std::vector<CarveRow> rows;
    for (std::size_t at = 0; at + 17 <= numbers.size(); at += 17) {
        const double* const n = numbers.data() + at;
        const auto whole = [&](int k) { return static_cast<std::int64_t>(n[k]); };
        rows.push_back({whole(0), whole(1), whole(2), n[3], n[4], n[5], n[6], whole(7), whole(8), whole(9), n[10],
                        n[11], n[12], n[13], n[14], n[15], n[16]});
    }
    return rows;
}

}  // namespace tomodem::relax
