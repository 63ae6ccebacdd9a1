#include "core/surface/reconstruction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "core/base/error.hpp"
#include "core/surface/pore_search.hpp"

namespace tomodem {
namespace {

void append(SurfacePart part, const std::vector<Body>& bodies, std::int32_t object,
            const ReconstructionOptions& options, Reconstruction& result) {
    if (options.envelope == Envelope::corrected) correct_envelope(part, bodies);
    const auto first_vertex = std::int32_t(result.mesh.vertices.size());
    const auto first_row = std::int32_t(result.rows.size());
    for (const Body& body : bodies) result.rows.push_back({object, body});
    result.mesh.vertices.insert(result.mesh.vertices.end(), part.mesh.vertices.begin(), part.mesh.vertices.end());
    for (auto triangle : part.mesh.triangles) {
        for (std::int32_t& vertex : triangle) vertex += first_vertex;
        result.mesh.triangles.push_back(triangle);
    }
    for (const std::int32_t number : part.number) {
        result.body_of_triangle.push_back(first_row + number + 1);
        result.object_of_triangle.push_back(object);
    }
}

void append_objects(const Packing& packing, const ReconstructionOptions& options, Reconstruction& result) {
    if (packing.object.empty())
        throw InvalidInput("there are no objects in the sample: set 'objects = true' for a phase in the scene");
    std::map<std::int32_t, std::vector<Vec3>> centres_of;
    for (std::size_t i = 0; i < packing.size(); ++i)
        if (packing.object[i] > 0) centres_of[packing.object[i]].push_back(packing.position[i]);
    if (centres_of.empty()) throw InvalidInput("there are no objects in the sample: no particle belongs to one");
    std::size_t done = 0;
    for (const auto& [object, centres] : centres_of) {
        result.particles += std::int64_t(centres.size());
        try {
            const AlphaSurface surface = alpha_surface(
                centres, {.probe_radius = options.probe_radius, .progress = {}, .seed_radius = packing.seed_radius});
            append(body_surface(surface), surface.bodies, object, options, result);
        } catch (const InvalidInput&) {
            ++result.objects_left_out;  // fewer than four particles, in one plane, or far apart
        }
        if (options.progress) options.progress(double(++done) / double(centres_of.size()));
    }
    if (result.rows.empty())
        throw InvalidInput(fmt::format("none of the {} objects encloses a volume at a probe radius of {:g} mm",
                                       centres_of.size(), options.probe_radius));
}

}  // namespace

void require_smaller_probe(std::span<const Vec3> centres, double probe_radius) {
    Vec3 low = centres.front(), high = low;
    for (const Vec3& centre : centres) {
        low = low.cwiseMin(centre);
        high = high.cwiseMax(centre);
    }
    const double diagonal = (high - low).norm();
    if (centres.size() >= 4 && probe_radius > diagonal)
        throw InvalidInput(
            fmt::format("the probe radius {:g} mm is larger than the particles to wrap: the {} centres lie "
                        "in a box of diagonal {:.4g} mm; give a smaller one",
                        probe_radius, centres.size(), diagonal));
}

double Reconstruction::volume() const {
    double sum = 0.0;
    for (auto row = rows.rbegin(); row != rows.rend(); ++row) sum += row->body.volume;
    return sum;
}

double Reconstruction::corrected_volume() const {
    double sum = 0.0;
    for (auto row = rows.rbegin(); row != rows.rend(); ++row) sum += row->body.corrected_volume;
    return sum;
}

double Reconstruction::area() const {
    double sum = 0.0;
    for (auto row = rows.rbegin(); row != rows.rend(); ++row) sum += row->body.area;
    return sum;
}

double Reconstruction::largest() const {
    double largest = 0.0;
    for (const Row& row : rows) largest = std::max(largest, row.body.volume);
    return largest;
}

std::int64_t Reconstruction::shells() const {
    std::int64_t sum = 0;
    for (const Row& row : rows) sum += row.body.shells;
    return sum;
}

std::int64_t Reconstruction::genus() const {
    std::int64_t sum = 0;
    for (const Row& row : rows) sum += row.body.genus;
    return sum;
}

Reconstruction reconstruct(const Packing& packing, const ReconstructionOptions& options) {
    Reconstruction result;
    if (options.bodies == Bodies::objects) {
        append_objects(packing, options, result);
        return result;
    }
    const std::vector<Vec3> centres = selected_centres(packing, options.selection);
    require_smaller_probe(centres, options.probe_radius);
    result.particles = std::int64_t(centres.size());
    const auto object = std::int32_t(options.selection.object.value_or(0));
    if (options.bodies == Bodies::pores) {
        Pores pores = find_pores(centres, {.probe_radius = options.probe_radius,
                                           .seed_radius = packing.seed_radius,
                                           .lid_radius = options.lid_radius,
                                           .progress = options.progress});
        std::vector<Body> bodies;
        for (const Pore& pore : pores.pores) bodies.push_back(pore.body);
        append(std::move(pores.surface), bodies, object, options, result);
        return result;
    }
    const AlphaSurface surface = alpha_surface(
        centres,
        {.probe_radius = options.probe_radius, .progress = options.progress, .seed_radius = packing.seed_radius});
    append(body_surface(surface), surface.bodies, object, options, result);
    return result;
}

}  // namespace tomodem
