#include "solver_plugin/norton/coarse_grid.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace tomodem::plugin {
namespace {

/// Nodes over the square root of the number of particles, at most: the work of the factorisation goes as their square,
/// and stays the same share of the particles' (bench/norton/trials.md). 2000 are the most that memory is given for.
constexpr double nodes_per_root = 2.3, most_nodes = 2000;

/// Of a node: itself and the neighbours that come behind it, in the order of z, y and x.
constexpr int ahead = 14;

/// From one corner of a cell to another, in that order; negative: the other comes before.
int way_between(int one, int two) {
    int way = 0;
    for (int c = 0, stride = 1; c < 3; ++c, stride *= 3) way += stride * ((two >> c & 1) - (one >> c & 1));
    return way;
}

/// On the diagonal, over its mean: of a node with hardly a particle near it.
constexpr double least_diagonal = 1e-3;

}  // namespace

struct CoarseGrid::Matrix {
    Eigen::SparseMatrix<double> values;  // lower triangle
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factors;
    int analysed[3] = {0, 0, 0};
};

CoarseGrid::CoarseGrid() : matrix_(std::make_unique<Matrix>()) {}
CoarseGrid::~CoarseGrid() = default;

int CoarseGrid::size() const {
    return 3 * nodes_[0] * nodes_[1] * nodes_[2];
}

std::array<int, 8> CoarseGrid::offsets() const {
    std::array<int, 8> result{};
    for (int corner = 0; corner < 8; ++corner)
        result[corner] = (corner & 1) + nodes_[0] * ((corner >> 1 & 1) + nodes_[1] * (corner >> 2));
    return result;
}

/// Of the weights [1/mm].
std::array<Eigen::Vector3d, 8> CoarseGrid::slopes(const Place& place) const {
    std::array<Eigen::Vector3d, 8> slope;
    for (int corner = 0; corner < 8; ++corner)
        for (int c = 0; c < 3; ++c) {
            slope[corner][c] = ((corner >> c & 1) != 0 ? 1 : -1) / width_[c];
            for (int other = 1; other < 3; ++other) {
                const int axis = (c + other) % 3;
                slope[corner][c] *= (corner >> axis & 1) != 0 ? place.share[axis] : 1 - place.share[axis];
            }
        }
    return slope;
}

std::array<Four, 2> CoarseGrid::weights(const Place& place) {
    const auto [x, y, z] = place.share;
    const Four in_layer = Four{1 - x, x, 1 - x, x} * Four{1 - y, 1 - y, y, y};
    return {in_layer * four(1 - z), in_layer * four(z)};
}

void CoarseGrid::lay(const double* position, int count, double width, const FlowSurroundings& surroundings) {
    double reach[6];  // the negative of the lowest, and the highest
    for (int c = 0; c < 3; ++c) {
        reach[c] = reach[3 + c] = -1e300;
        for (int i = 0; i < count; ++i) {
            reach[c] = std::max(reach[c], -position[3 * i + c]);
            reach[3 + c] = std::max(reach[3 + c], position[3 * i + c]);
        }
    }
    surroundings.take_largest(reach, 6);
    const double low[3] = {-reach[0], -reach[1], -reach[2]}, *const high = reach + 3;
    double cells = 1;
    for (int c = 0; c < 3; ++c) cells *= (high[c] - low[c]) / width + 1;
    double particles = count;
    surroundings.add_up(&particles, 1);
    const double most = std::clamp(nodes_per_root * std::sqrt(particles), 8.0, most_nodes);
    const double cell = width * std::max(1.0, std::cbrt(cells / most));
    for (int c = 0; c < 3; ++c) {
        const int along = std::max(1, static_cast<int>(std::lround((high[c] - low[c]) / cell)));
        nodes_[c] = along + 1;
        width_[c] = std::max((high[c] - low[c]) / along * (1 + 1e-9), 1e-9 * width);
    }
    places_.resize(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        int at[3];
        for (int c = 0; c < 3; ++c) {
            const double cells_in = (position[3 * i + c] - low[c]) / width_[c];
            at[c] = std::clamp(static_cast<int>(cells_in), 0, nodes_[c] - 2);
            places_[i].share[c] = static_cast<float>(cells_in - at[c]);
        }
        places_[i].node = at[0] + nodes_[0] * (at[1] + nodes_[1] * at[2]);
    }
}

void CoarseGrid::fill(const std::vector<Material>& materials, const std::vector<NearWall>& walls, double face,
                      const std::vector<double>& wall_stiffness, const FlowSurroundings& surroundings) {
    const int nodes = size() / 3;
    const std::array<int, 8> offset = offsets();
    // The 3 x 3 blocks of each node with itself and with the neighbours behind it, in an array that the processes can
    // add up.
    std::vector<double> blocks(static_cast<std::size_t>(nodes) * ahead * 9, 0.0);
    const auto block = [&](int node, int way) {
        return blocks.data() + (static_cast<std::size_t>(node) * ahead + way) * 9;
    };
    for (std::size_t i = 0; i < places_.size(); ++i) {
        const Place& place = places_[i];
        const std::array<Eigen::Vector3d, 8> slope = slopes(place);
        const auto [viscosity, bulk] = materials[i];
        for (int one = 0; one < 8; ++one)
            for (int two = 0; two < 8; ++two) {
                const int way = way_between(one, two);
                if (way < 0) continue;
                double* const sum = block(place.node + offset[one], way);
                const double both =
                    slope[one][0] * slope[two][0] + slope[one][1] * slope[two][1] + slope[one][2] * slope[two][2];
                for (int c = 0; c < 3; ++c)
                    for (int e = 0; e < 3; ++e)
                        sum[3 * c + e] += viscosity * ((c == e ? both : 0) + slope[one][e] * slope[two][c]) +
                                          bulk * slope[one][c] * slope[two][e];
            }
    }
    // Walls are far stiffer: they must not count in what is little for a node.
    double diagonal = 0;
    for (int node = 0; node < nodes; ++node)
        for (int c = 0; c < 3; ++c) diagonal += block(node, 0)[4 * c];
    for (std::size_t k = 0; k < walls.size(); ++k) {
        const Place& place = places_[static_cast<std::size_t>(walls[k].particle)];
        const std::array<Four, 2> weight = weights(place);
        const std::array<Eigen::Vector3d, 8> slope = slopes(place);
        double at_face[8];
        for (int corner = 0; corner < 8; ++corner)
            at_face[corner] = weight[corner / 4][corner % 4] -
                              (walls[k].distance - face) * slope[corner].dot(Eigen::Vector3d(walls[k].normal));
        for (int one = 0; one < 8; ++one)
            for (int two = 0; two < 8; ++two) {
                const int way = way_between(one, two);
                if (way < 0) continue;
                double* const sum = block(place.node + offset[one], way);
                const double both = at_face[one] * at_face[two];
                for (int c = 0; c < 3; ++c)
                    for (int e = 0; e < 3; ++e)
                        sum[3 * c + e] += wall_stiffness[k] * both * walls[k].normal[c] * walls[k].normal[e];
            }
    }
    blocks.push_back(diagonal);
    surroundings.add_up(blocks.data(), blocks.size());
    const double mean = blocks.back() / size();
    Matrix& matrix = *matrix_;
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(blocks.size());
    for (int node = 0; node < nodes; ++node) {
        const int at[3] = {node % nodes_[0], node / nodes_[0] % nodes_[1], node / nodes_[0] / nodes_[1]};
        for (int way = 0; way < ahead; ++way) {
            const int step[3] = {(way + 13) % 3 - 1, (way + 13) / 3 % 3 - 1, (way + 13) / 9 - 1};
            bool in_grid = true;
            for (int c = 0; c < 3; ++c) in_grid = in_grid && at[c] + step[c] >= 0 && at[c] + step[c] < nodes_[c];
            if (!in_grid) continue;
            const int other = node + step[0] + nodes_[0] * (step[1] + nodes_[1] * step[2]);
            for (int c = 0; c < 3; ++c)
                for (int e = 0; e < 3; ++e) {
                    if (way == 0 && e < c) continue;
                    double value = block(node, way)[3 * c + e];
                    if (way == 0 && c == e) {
                        if (value < least_diagonal * mean) value += least_diagonal * mean;
                        value += 1e-6 * mean;
                    }
                    entries.emplace_back(3 * other + e, 3 * node + c, value);
                }
        }
    }
    matrix.values.resize(size(), size());
    matrix.values.setFromTriplets(entries.begin(), entries.end());
    if (!std::equal(nodes_, nodes_ + 3, matrix.analysed)) {
        matrix.factors.analyzePattern(matrix.values);
        std::copy_n(nodes_, 3, matrix.analysed);
    }
    matrix.factors.factorize(matrix.values);
}

void CoarseGrid::gather(const Four* force, double* nodes) const {
    const std::array<int, 8> offset = offsets();
    std::vector<Four> sums(static_cast<std::size_t>(size() / 3), Four{});
    for (std::size_t i = 0; i < places_.size(); ++i) {
        const std::array<Four, 2> weight = weights(places_[i]);
        for (int corner = 0; corner < 8; ++corner)
            sums[places_[i].node + offset[corner]] += four(weight[corner / 4][corner % 4]) * force[i];
    }
    for (std::size_t node = 0; node < sums.size(); ++node)
        for (int c = 0; c < 3; ++c) nodes[3 * node + c] += sums[node][c];
}

void CoarseGrid::solve(double* nodes) const {
    Eigen::Map<Eigen::VectorXd> vector(nodes, size());
    vector = matrix_->factors.solve(vector).eval();
}

void CoarseGrid::spread(const double* nodes, Four* motion) const {
    const std::array<int, 8> offset = offsets();
    std::vector<Four> motions(static_cast<std::size_t>(size() / 3), Four{});
    for (std::size_t node = 0; node < motions.size(); ++node)
        for (int c = 0; c < 3; ++c) motions[node][c] = static_cast<float>(nodes[3 * node + c]);
    for (std::size_t i = 0; i < places_.size(); ++i) {
        const std::array<Four, 2> weight = weights(places_[i]);
        Four sum{};
        for (int corner = 0; corner < 8; ++corner)
            sum += four(weight[corner / 4][corner % 4]) * motions[places_[i].node + offset[corner]];
        motion[i] += sum;
    }
}

}  // namespace tomodem::plugin
