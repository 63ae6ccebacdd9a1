#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/packing/packing.hpp"
#include "core/surface/alpha_surface.hpp"
#include "core/surface/selection.hpp"

/// The chosen surfaces of a frame, and the measures of each body.
namespace tomodem {

enum class Bodies {
    parts,   ///< the parts of the selection
    pores,   ///< its closed voids
    objects  ///< the parts of each object
};

enum class Envelope {
    centres,   ///< through the outermost centres
    corrected  ///< moved out to where the material ends
};

struct ReconstructionOptions {
    Bodies bodies = Bodies::parts;
    Selection selection = {};
    double probe_radius = 0.0;  ///< mm
    double lid_radius = 0.0;    ///< mm, of pores with a mouth (pore_search.hpp); 0: closed ones only
    Envelope envelope = Envelope::centres;
    std::function<void(double)> progress = {};  ///< as in AlphaSurfaceOptions
};

struct Reconstruction {
    struct Row {
        std::int32_t object;  ///< 0: of no object
        Body body;
    };
    TriangleMesh mesh;
    std::vector<std::int32_t> body_of_triangle;    ///< place in rows, from 1
    std::vector<std::int32_t> object_of_triangle;  ///< 0: of no object
    std::vector<Row> rows;                         ///< by object, then largest first
    std::int64_t particles = 0;                    ///< of the selection
    std::int64_t objects_left_out = 0;             ///< those that enclose no volume

    double volume() const;            ///< mm^3, sum over the rows
    double corrected_volume() const;  ///< mm^3; not a number if one of them is not
    double area() const;              ///< mm^2
    double largest() const;           ///< mm^3
    std::int64_t shells() const;
    std::int64_t genus() const;
};

/// @throws InvalidInput if the probe radius [mm] is larger than the box that holds all (four or more) centres
void require_smaller_probe(std::span<const Vec3> centres, double probe_radius);

/// @param packing  its position may be of another frame
/// @throws InvalidInput as selected_centres and alpha_surface; if the probe is larger than the selection, there are no
///                      objects, or none of them encloses a volume
Reconstruction reconstruct(const Packing& packing, const ReconstructionOptions& options);

}  // namespace tomodem
