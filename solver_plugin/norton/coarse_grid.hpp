#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "solver_plugin/norton/four.hpp"
#include "solver_plugin/pairs/pair_kernel.hpp"

namespace tomodem::plugin {

/// A viscous body on a grid of a few seeds' width over the sample, with the particles as its quadrature points: it
/// finds the smooth part of a motion, which pairs of neighbours would pass on too slowly. The same on every process.
class CoarseGrid {
 public:
    CoarseGrid();
    ~CoarseGrid();

    /// What a particle brings into the body.
    struct Material {
        double viscosity;  ///< 1/3 of viscosity times volume: of the rate's deviator [mm^3 Pa.s]
        double bulk;       ///< of the change of volume
    };

    /// Lays the grid over the particles of all processes. Collective.
    /// @param position  3 per particle of this process
    /// @param count     of them
    /// @param width     of a cell, at least [mm]
    void lay(const double* position, int count, double width, const FlowSurroundings& surroundings);
    /// Fills and factorises the matrix. Collective.
    /// @param face            distance from a wall where it acts on the body [mm]
    /// @param wall_stiffness  of each wall along its normal [uN.s/mm]
    void fill(const std::vector<Material>& materials, const std::vector<NearWall>& walls, double face,
              const std::vector<double>& wall_stiffness, const FlowSurroundings& surroundings);

    /// Unknowns: three for each node of the grid.
    int size() const;
    /// Adds this process' share of the forces on the nodes to the first size() of `nodes`.
    void gather(const Four* force, double* nodes) const;
    /// The motion of the nodes under their forces, in place.
    void solve(double* nodes) const;
    /// Adds the nodes' motion to the particles'.
    void spread(const double* nodes, Four* motion) const;

 private:
    struct Place {
        std::int32_t node;  ///< the lowest of its cell
        float share[3];     ///< of the way through the cell
    };
    struct Matrix;

    std::array<int, 8> offsets() const;
    /// Of a cell's corners, in the order of z, y and x.
    static std::array<Four, 2> weights(const Place& place);
    std::array<Eigen::Vector3d, 8> slopes(const Place& place) const;

    int nodes_[3] = {0, 0, 0};
    double width_[3] = {1, 1, 1};
    std::vector<Place> places_;
    std::unique_ptr<Matrix> matrix_;
};

}  // namespace tomodem::plugin
