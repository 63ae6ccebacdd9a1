#pragma once
#include "core/packing/packing.hpp"

/// Where a sample is cut open.
namespace tomodem::render {

enum class Cut { none, x, y };

/// The half of the sample towards the camera is removed: above the place along x, below it along y.
struct CutPlane {
    Cut cut = Cut::none;
    double place = 0.0;  ///< mm, along the axis, in the first frame

    int axis() const { return cut == Cut::x ? 0 : 1; }
};

/// Where most of what a sample is made for lies in the plane: particles of objects, or else of all phases but the
/// largest, and pores, open ones too as far as a lid closes them (pore_search.hpp). Of a structure that is more void
/// than solid, the solid counts instead of the void. A plane that has nearly as much and is nearer to the middle is
/// preferred; so is the middle, across y, where there is nothing of all that.
/// @param packing  its first frame
/// @note  the pores cost two alpha shapes; of more than 200,000 particles one, and none where there are objects or
/// several phases
CutPlane best_cut(const Packing& packing);

}  // namespace tomodem::render
