#pragma once
#include <string>
#include <vector>

#include "core/packing/packing_file.hpp"

namespace tomodem::render {

/// A number of each particle that a run or sample holds, known by a name as a user gives it.
///
/// "temperature": a property of the sample, or a field of one component; "stress_zz", "velocity_x": a component of a
/// field; "outward": the length of a vector.
class Quantity {
 public:
    /// @throws InvalidInput naming what there is, if there is no such quantity, or the name leaves open which component
    Quantity(const RunReader& run, const std::string& name);

    std::vector<double> values(std::size_t frame) const;
    const std::string& title() const { return title_; }
    const std::string& unit() const { return unit_; }

 private:
    const RunReader* run_;
    std::string field_, title_, unit_;
    int components_ = 0;  ///< 0: a property, the same in all frames
    int component_ = -1;  ///< -1: the length of the vector
};

/// A vector of each particle in one frame.
/// @throws InvalidInput naming what there is, if the run has no such field of three components
std::vector<Vec3> vectors(const RunReader& run, const std::string& field, std::size_t frame);

}  // namespace tomodem::render
