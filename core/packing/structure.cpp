#include "core/packing/structure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "core/base/blocks.hpp"
#include "core/base/error.hpp"
#include "core/packing/cell_grid.hpp"

namespace tomodem {
NeighbourTable::NeighbourTable(std::span<const Vec3> points, const Box& box, double cutoff, int threads)
    : box_(box), cutoff_(cutoff), point_(points.begin(), points.end()), first_(points.size() + 1, 0) {
    const CellGrid cells(points, box, cutoff);
    std::vector<std::vector<std::int32_t>> found(blocks_of(points.size()));
    for_blocks(points.size(), threads, [&](std::size_t block, std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const std::size_t before = found[block].size();
            cells.near(points[i], [&](std::int32_t j, const Vec3&, double) {
                if (static_cast<std::size_t>(j) != i) found[block].push_back(j);
            });
            std::sort(found[block].begin() + static_cast<std::ptrdiff_t>(before), found[block].end());
            first_[i + 1] = found[block].size() - before;
        }
    });
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    neighbour_.reserve(first_.back());
    for (std::vector<std::int32_t>& of_block : found) {
        neighbour_.insert(neighbour_.end(), of_block.begin(), of_block.end());
        of_block = {};
    }
}

Vec3 NeighbourTable::separation(std::size_t i, std::size_t j) const {
    Vec3 apart = point_[j] - point_[i];
    for (int axis = 0; axis < 3; ++axis)
        if (box_.periodic[axis]) apart[axis] = nearest_image(apart[axis], box_.edges[axis]);
    return apart;
}

double longest_reach(const Box& box) {
    double reach = half_of_shortest_period(box);
    for (int axis = 0; axis < 3; ++axis)
        if (!box.periodic[axis]) reach = std::min(reach, box.edges[axis]);
    return reach;
}

RadialDistribution radial_distribution(std::span<const Vec3> points, const Box& box, double reach, std::size_t shells,
                                       int threads) {
    constexpr std::size_t enough_centres = 200'000;
    if (points.size() < 2 || shells == 0)
        throw InvalidInput("a radial distribution needs at least two points and one shell");
    if (!(reach > 0.0 && reach <= longest_reach(box)))
        throw InvalidInput(
            fmt::format("a radial distribution up to {:g} mm is not possible: expected more than 0 and at most {:g} "
                        "mm, half of the "
                        "shortest periodic edge of the box and its shortest other edge",
                        reach, longest_reach(box)));
    RadialDistribution result{reach / static_cast<double>(shells), std::vector<double>(shells, 0.0)};
    const CellGrid cells(points, box, reach);
    const std::size_t stride = (points.size() + enough_centres - 1) / enough_centres;
    const std::size_t centres = (points.size() + stride - 1) / stride;
    std::vector<std::vector<std::int64_t>> counted(blocks_of(centres));
    for_blocks(centres, threads, [&](std::size_t block, std::size_t first, std::size_t last) {
        counted[block].assign(shells, 0);
        for (std::size_t k = first; k < last; ++k) {
            const auto i = static_cast<std::int32_t>(k * stride);
            cells.near(points[i], [&](std::int32_t j, const Vec3&, double squared) {
                const auto shell = static_cast<std::size_t>(std::sqrt(squared) / result.shell);
                if (j != i && shell < shells) ++counted[block][shell];
            });
        }
    });

    // Mean over directions n of the share of the box whose point at distance r along n is in the box too:
    // product over the open axes of (1 - r |n_k| / L_k).
    double once = 0.0, twice = 0.0, thrice = 1.0;
    int open_axes = 0;
    for (int a = 0; a < 3; ++a) {
        if (box.periodic[a]) continue;
        ++open_axes;
        once += 1.0 / box.edges[a];
        thrice /= box.edges[a];
        for (int b = a + 1; b < 3; ++b)
            if (!box.periodic[b]) twice += 1.0 / (box.edges[a] * box.edges[b]);
    }
    if (open_axes < 3) thrice = 0.0;
    const auto volume_within = [&](double r) {  // integral of 4 pi r^2 times that share
        const double cube = r * r * r;
        return 4.0 * std::numbers::pi * cube *
               (1.0 / 3.0 - once / 2.0 * r / 4.0 + twice * 2.0 / (3.0 * std::numbers::pi) * r * r / 5.0 -
                thrice / (4.0 * std::numbers::pi) * cube / 6.0);
    };
    const double number_density = static_cast<double>(points.size() - 1) / box.volume();
    for (std::size_t shell = 0; shell < shells; ++shell) {
        std::int64_t count = 0;
        for (const auto& of_block : counted) count += of_block[shell];
        const double inner = static_cast<double>(shell) * result.shell;
        result.g[shell] = static_cast<double>(count) / (static_cast<double>(centres) * number_density *
                                                        (volume_within(inner + result.shell) - volume_within(inner)));
    }
    return result;
}

double first_minimum(const RadialDistribution& distribution, double from, double to) {
    const auto& g = distribution.g;
    std::vector<std::size_t> inside;
    std::vector<double> mean;
    for (std::size_t k = 1; k + 1 < g.size(); ++k)
        if (distribution.radius(k) >= from && distribution.radius(k) <= to) {
            inside.push_back(k);
            mean.push_back((g[k - 1] + g[k] + g[k + 1]) / 3.0);
        }
    if (inside.empty())
        throw InvalidInput(
            fmt::format("the radial distribution ends at {:g} mm, before its first minimum", distribution.reach()));
    const double lowest = *std::min_element(mean.begin(), mean.end());
    std::size_t best = 0, longest = 0, length = 0;
    for (std::size_t k = 0; k < mean.size(); ++k) {
        length = mean[k] == lowest ? length + 1 : 0;
        if (length > longest) {
            longest = length;
            best = k;
        }
    }
    return 0.5 * (distribution.radius(inside[best]) + distribution.radius(inside[best + 1 - longest]));
}

namespace {

/// Bonds among the nearest neighbours of a point, a bit each.
using Bonds = std::array<std::uint16_t, 14>;

Bonds bonds_among(std::span<const Vec3> neighbours, double length) {
    Bonds bonds{};
    for (std::size_t a = 0; a < neighbours.size(); ++a)
        for (std::size_t b = a + 1; b < neighbours.size(); ++b)
            if ((neighbours[a] - neighbours[b]).squaredNorm() < length * length) {
                bonds[a] |= static_cast<std::uint16_t>(1U << b);
                bonds[b] |= static_cast<std::uint16_t>(1U << a);
            }
    return bonds;
}

struct Signature {
    int common, bonds, longest_chain;
    bool operator==(const Signature&) const = default;
};

/// What neighbour k and the point between the neighbours share.
Signature signature(const Bonds& bonds, std::size_t k) {
    std::uint16_t common = bonds[k];
    Signature found{std::popcount(common), 0, 0};
    while (common != 0) {  // one connected piece after the other
        std::uint16_t piece = 0, edge = common & static_cast<std::uint16_t>(-common);
        int ends = 0;
        while (edge != 0) {
            const int at = std::countr_zero(edge);
            piece |= static_cast<std::uint16_t>(1U << at);
            const std::uint16_t bonded = bonds[static_cast<std::size_t>(at)] & bonds[k];
            ends += std::popcount(bonded);
            edge = (edge | bonded) & static_cast<std::uint16_t>(~piece);
        }
        found.bonds += ends / 2;
        found.longest_chain = std::max(found.longest_chain, ends / 2);
        common &= static_cast<std::uint16_t>(~piece);
    }
    return found;
}

constexpr double to_the_middle = (1.0 + std::numbers::sqrt2) / 2.0;  // between the first and the second shell of fcc

double mean_length(std::span<const Vec3> vectors) {
    double sum = 0.0;
    for (const Vec3& v : vectors) sum += v.norm();
    return sum / static_cast<double>(vectors.size());
}

/// @param nearest  sorted by distance
Order order_of(std::span<const Vec3> nearest) {
    if (nearest.size() < 12) return Order::none;
    const std::span<const Vec3> twelve = nearest.first(12);
    const Bonds close = bonds_among(twelve, to_the_middle * mean_length(twelve));
    int fcc = 0, hcp = 0, five = 0;
    for (std::size_t k = 0; k < 12; ++k) {
        const Signature s = signature(close, k);
        fcc += s == Signature{4, 2, 1};
        hcp += s == Signature{4, 2, 2};
        five += s == Signature{5, 5, 5};
    }
    if (fcc == 12) return Order::fcc;
    if (fcc == 6 && hcp == 6) return Order::hcp;
    if (five == 12) return Order::icosahedral;
    if (nearest.size() < 14) return Order::none;
    const std::span<const Vec3> fourteen = nearest.first(14);
    // Both shells say what the edge of the bcc cell is.
    const double edge = 0.5 * (2.0 / std::sqrt(3.0) * mean_length(fourteen.first(8)) + mean_length(fourteen.last(6)));
    const Bonds wide = bonds_among(fourteen, to_the_middle * edge);
    int six = 0, four = 0;
    for (std::size_t k = 0; k < 14; ++k) {
        const Signature s = signature(wide, k);
        six += s == Signature{6, 6, 6};
        four += s == Signature{4, 4, 4};
    }
    return six == 8 && four == 6 ? Order::bcc : Order::none;
}

/// The q6m of m = 0 ... 6 (those of -m follow), summed over bonds.
using Harmonics = std::array<std::complex<double>, 7>;

/// Adds sqrt(4 pi / 13) Y6m of a unit vector.
void add_harmonics(const Vec3& e, Harmonics& sum) {
    const double z = e.z(), z2 = z * z;
    const std::complex<double> xy(e.x(), e.y());
    const std::complex<double> xy2 = xy * xy, xy3 = xy2 * xy;
    static const double f1 = std::sqrt(42.0) / 16.0, f2 = std::sqrt(105.0 / 1024.0), f3 = std::sqrt(105.0) / 16.0,
                        f4 = 3.0 * std::sqrt(14.0) / 32.0, f5 = 3.0 * std::sqrt(77.0) / 16.0,
                        f6 = std::sqrt(231.0) / 32.0;
    sum[0] += ((231.0 * z2 - 315.0) * z2 + 105.0) * z2 / 16.0 - 5.0 / 16.0;
    sum[1] -= f1 * ((33.0 * z2 - 30.0) * z2 + 5.0) * z * xy;
    sum[2] += f2 * ((33.0 * z2 - 18.0) * z2 + 1.0) * xy2;
    sum[3] -= f3 * (11.0 * z2 - 3.0) * z * xy3;
    sum[4] += f4 * (11.0 * z2 - 1.0) * xy2 * xy2;
    sum[5] -= f5 * z * xy2 * xy3;
    sum[6] += f6 * xy3 * xy3;
}

/// Over all m of q6m(a) times the conjugate of q6m(b); its real part, as the rest cancels.
double product(const Harmonics& a, const Harmonics& b) {
    double sum = a[0].real() * b[0].real();
    for (std::size_t m = 1; m < 7; ++m) sum += 2.0 * (a[m].real() * b[m].real() + a[m].imag() * b[m].imag());
    return sum;
}

}  // namespace

std::vector<Order> common_neighbour_analysis(const NeighbourTable& neighbours, int threads) {
    std::vector<Order> order(neighbours.size(), Order::none);
    for_blocks(neighbours.size(), threads, [&](std::size_t, std::size_t first, std::size_t last) {
        std::vector<std::pair<double, std::int32_t>> by_distance;
        std::vector<Vec3> nearest;
        for (std::size_t i = first; i < last; ++i) {
            by_distance.clear();
            nearest.clear();
            for (const std::int32_t j : neighbours.of(i))
                by_distance.emplace_back(neighbours.separation(i, static_cast<std::size_t>(j)).squaredNorm(), j);
            const std::size_t kept = std::min<std::size_t>(by_distance.size(), 14);
            std::partial_sort(by_distance.begin(), by_distance.begin() + static_cast<std::ptrdiff_t>(kept),
                              by_distance.end());
            for (std::size_t k = 0; k < kept; ++k)
                nearest.push_back(neighbours.separation(i, static_cast<std::size_t>(by_distance[k].second)));
            order[i] = order_of(nearest);
        }
    });
    return order;
}

BondOrder bond_order(const NeighbourTable& neighbours, double cutoff, double solid_like, int threads) {
    if (!(cutoff > 0.0 && cutoff <= neighbours.cutoff()))
        throw InvalidInput(fmt::format("bonds up to {:g} mm are not in a table of neighbours up to {:g} mm", cutoff,
                                       neighbours.cutoff()));
    const std::size_t count = neighbours.size();
    std::vector<Harmonics> of_point(count);
    std::vector<std::int64_t> bonds(count, 0);
    BondOrder result{std::vector<double>(count, 0.0), std::vector<std::int32_t>(count, 0), 0.0};
    for_blocks(count, threads, [&](std::size_t, std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            Harmonics& sum = of_point[i];
            for (const std::int32_t j : neighbours.of(i)) {
                const Vec3 apart = neighbours.separation(i, static_cast<std::size_t>(j));
                const double distance = apart.norm();
                if (!(distance < cutoff && distance > 0.0)) continue;
                add_harmonics(apart / distance, sum);
                ++bonds[i];
            }
            if (bonds[i] > 0) result.q6[i] = std::sqrt(product(sum, sum)) / static_cast<double>(bonds[i]);
        }
    });
    for_blocks(count, threads, [&](std::size_t, std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            for (const std::int32_t neighbour : neighbours.of(i)) {
                const auto j = static_cast<std::size_t>(neighbour);
                const double distance = neighbours.separation(i, j).norm();
                if (!(distance < cutoff && distance > 0.0)) continue;
                const double both = std::sqrt(product(of_point[i], of_point[i]) * product(of_point[j], of_point[j]));
                result.connections[i] += product(of_point[i], of_point[j]) > solid_like * both;
            }
    });
    Harmonics all{};
    std::int64_t all_bonds = 0;
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t m = 0; m < 7; ++m) all[m] += of_point[i][m];
        all_bonds += bonds[i];
    }
    if (all_bonds > 0) result.global_q6 = std::sqrt(product(all, all)) / static_cast<double>(all_bonds);
    return result;
}

std::vector<std::uint8_t> surface_points(const NeighbourTable& neighbours, int threads) {
    constexpr double cosine = 0.5;  // of 60 degrees
    std::vector<std::uint8_t> surface(neighbours.size(), 0);
    for_blocks(neighbours.size(), threads, [&](std::size_t, std::size_t first, std::size_t last) {
        std::vector<Vec3> directions;
        for (std::size_t i = first; i < last; ++i) {
            directions.clear();
            Vec3 outward = Vec3::Zero();
            for (const std::int32_t j : neighbours.of(i)) {
                const Vec3 apart = neighbours.separation(i, static_cast<std::size_t>(j));
                directions.push_back(apart.normalized());
                outward -= directions.back();
            }
            const double length = outward.norm();
            const bool even = length < 1e-9;  // a lattice: it points nowhere
            surface[i] = directions.size() < 12 ||
                         (!even && std::none_of(directions.begin(), directions.end(),
                                                [&](const Vec3& e) { return e.dot(outward) > cosine * length; }));
        }
    });
    return surface;
}

namespace {

/// Sums over contacts between two labels, each contact seen from both ends.
struct PairSum {
    std::int64_t ends = 0, overlapping = 0;
    double overlap = 0.0, max = 0.0;
    void add(const PairSum& other) {
        ends += other.ends;
        overlapping += other.overlapping;
        overlap += other.overlap;
        max = std::max(max, other.max);
    }
    void add(double depth) {
        ++ends;
        if (depth <= 0.0) return;
        ++overlapping;
        overlap += depth;
        max = std::max(max, depth);
    }
    double mean() const { return overlapping > 0 ? overlap / static_cast<double>(overlapping) : 0.0; }
};

/// Labels in their order, and the place of each particle's one among them.
struct Labels {
    explicit Labels(const Packing& packing) : label(packing.species), of_particle(packing.size(), 0) {
        std::sort(label.begin(), label.end());
        label.erase(std::unique(label.begin(), label.end()), label.end());
        if (label.empty()) label = {0};  // a packing without labels
        for (std::size_t i = 0; i < packing.species.size(); ++i)
            of_particle[i] = static_cast<std::uint32_t>(
                std::lower_bound(label.begin(), label.end(), packing.species[i]) - label.begin());
    }
    std::vector<std::int32_t> label;
    std::vector<std::uint32_t> of_particle;
};

}  // namespace

ContactDetail contact_detail(const Packing& packing, double reach, OpenFaces faces, int threads) {
    const std::size_t count = packing.size();
    ContactDetail detail;
    ContactStatistics& statistics = detail.all;
    if (count == 0) return detail;
    double largest = packing.seed_radius;
    if (!packing.radius.empty()) largest = *std::max_element(packing.radius.begin(), packing.radius.end());
    const NeighbourTable near(packing.position, packing.box, reach * 2.0 * largest, threads);
    const Labels labels(packing);
    const std::size_t kinds = labels.label.size();

    const auto overlap = [&](std::size_t i, std::size_t j) {
        return 1.0 - near.separation(i, j).norm() / (packing.radius_of(i) + packing.radius_of(j));
    };
    const double farthest = 1.0 - reach;  // a contact's overlap is more
    detail.contacts.assign(count, 0);
    std::vector<std::vector<PairSum>> sums(blocks_of(count));
    std::vector<std::int64_t> wall_contacts(sums.size(), 0);
    std::vector<double> deepest_at_wall(sums.size(), 0.0);
    for_blocks(count, threads, [&](std::size_t block, std::size_t first, std::size_t last) {
        sums[block].resize(kinds * kinds);
        for (std::size_t i = first; i < last; ++i) {
            for (const std::int32_t neighbour : near.of(i)) {
                const auto j = static_cast<std::size_t>(neighbour);
                const double depth = overlap(i, j);
                if (depth <= farthest) continue;
                ++detail.contacts[i];
                const auto [low, high] = std::minmax(labels.of_particle[i], labels.of_particle[j]);
                sums[block][low * kinds + high].add(depth);
            }
            if (faces == OpenFaces::free) continue;
            for (int axis = 0; axis < 3; ++axis) {
                if (packing.box.periodic[axis]) continue;
                const double from_low = packing.position[i][axis] - packing.box.origin[axis];
                for (const double distance : {from_low, packing.box.edges[axis] - from_low}) {
                    const double depth = 1.0 - distance / packing.radius_of(i);
                    if (depth <= farthest) continue;
                    ++detail.contacts[i];
                    ++wall_contacts[block];
                    deepest_at_wall[block] = std::max(deepest_at_wall[block], depth);
                }
            }
        }
    });

    PairSum all;
    for (std::size_t a = 0; a < kinds; ++a)
        for (std::size_t b = a; b < kinds; ++b) {
            PairSum sum;
            for (const auto& of_block : sums) sum.add(of_block[a * kinds + b]);
            if (sum.ends > 0) detail.between[{labels.label[a], labels.label[b]}] = {sum.ends / 2, sum.max, sum.mean()};
            all.add(sum);
        }
    statistics.max_overlap = all.max;
    for (std::size_t block = 0; block < sums.size(); ++block) {
        statistics.wall_contacts += wall_contacts[block];
        statistics.max_overlap = std::max(statistics.max_overlap, deepest_at_wall[block]);
    }
    statistics.contacts = all.ends / 2;
    statistics.mean_coordination =
        static_cast<double>(all.ends + statistics.wall_contacts) / static_cast<double>(count);
    statistics.mean_overlap = all.mean();

    // A rattler holds nobody, so its neighbours may be rattlers too.
    std::vector<std::int32_t>& holding = detail.backbone_contacts;
    holding = detail.contacts;
    detail.rattler.assign(count, 0);
    std::vector<std::size_t> loose;
    for (std::size_t i = 0; i < count; ++i)
        if (holding[i] < 4) {
            detail.rattler[i] = 1;
            loose.push_back(i);
        }
    while (!loose.empty()) {
        const std::size_t i = loose.back();
        loose.pop_back();
        ++statistics.rattlers;
        for (const std::int32_t neighbour : near.of(i)) {
            const auto j = static_cast<std::size_t>(neighbour);
            if (detail.rattler[j] != 0 || overlap(i, j) <= farthest) continue;
            if (--holding[j] < 4) {
                detail.rattler[j] = 1;
                loose.push_back(j);
            }
        }
    }
    std::int64_t held = 0;
    for (std::size_t i = 0; i < count; ++i) {
        if (detail.rattler[i] != 0) holding[i] = 0;
        held += holding[i];
    }
    const auto backbone = static_cast<std::int64_t>(count) - statistics.rattlers;
    if (backbone > 0) statistics.backbone_coordination = static_cast<double>(held) / static_cast<double>(backbone);
    return detail;
}

ContactStatistics contact_statistics(const Packing& packing, OpenFaces faces, int threads) {
    return contact_detail(packing, 1.0, faces, threads).all;
}

}  // namespace tomodem
