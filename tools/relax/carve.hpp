#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "core/packing/packing.hpp"
#include "core/volume/volume.hpp"
#include "tools/relax/pore_measure.hpp"
#include "tools/relax/pores.hpp"

/// Takes particles out of a sample until its pores, at rest, are as large as those of an image: docs/relaxation.md.
namespace tomodem::relax {

struct CarveOptions {
    double pore_error = 0.05;   ///< of the volume of each pore that is judged [-]
    double total_error = 0.02;  ///< of the volume of all pores that are measured [-]
    double min_across = 4;      ///< particles across a pore; smaller ones are left solid
    double judged_across = 12;  ///< particles across a pore from which its own error counts
    double first_share = 0.8;   ///< of a pore's volume that is taken out at first
    int threads = 1;
};

/// One pore of the image and what has become of it.
struct PoreState {
    std::int32_t number = 0;
    bool open =
        false;  ///< it meets a face of the image or nearly so: measured within the image, one diameter from its faces
    bool judged = false;  ///< its own error counts
    double across = 0;    ///< particles [-]
    Vec3 centre = Vec3::Zero();
    double target = 0;  ///< [mm^3]
    PoreMeasure measure;
    PoreOverlap overlap;
    double error() const { return measure.volume / target - 1; }
    double iou() const { return overlap.united > 0 ? overlap.intersection / overlap.united : 0; }
};

/// The pores of a sample beside those of the image. Sums are over the closed pores.
struct Assessment {
    std::vector<PoreState> pores;
    double target = 0, volume = 0, grid_volume = 0;  ///< [mm^3]
    double intersection = 0, united = 0;             ///< [mm^3]
    std::size_t worst = 0;                           ///< of the judged pores, the one with the largest error
    std::int64_t judged = 0, wrong = 0;              ///< pores; those with too large an error
    double total_error() const { return volume / target - 1; }
    double iou() const { return united > 0 ? intersection / united : 0; }
};

class Carver {
 public:
    /// @param sample  dense, or with particles missing already; at rest, or still to be relaxed
    /// @throws InvalidInput if the image and the sample do not lie over each other, or the image has no pore that these
    ///         particles can show
    Carver(const LabelVolume& volume, const Packing& sample, const CarveOptions& options);

    /// Takes D of the material between the pores from the sample, which is at rest; or from an earlier process.
    void measure_density(const Packing& sample);
    void set_density(double density) { density_ = density; }

    Assessment assess(const Packing& sample) const;
    bool is_done(const Assessment& assessment) const;

    /// Places in the sample, increasing, of the particles to take out next: in each pore as many as the volume that it
    /// lacks would hold, at first only `first_share` of it, those farthest inside the image's pore first. From open
    /// pores those within the image's.
    std::vector<std::size_t> next_removal(const Packing& sample, const Assessment& assessment, bool first) const;

    std::int64_t too_small() const { return image_.too_small; }
    double too_small_volume() const { return image_.too_small_volume; }
    /// Part of the closed pores' volume that has no particles.
    double empty_share(const Assessment& assessment) const { return assessment.volume / assessment.target; }
    double density() const { return density_; }

 private:
    bool belongs(std::size_t pore, const Vec3& point) const;
    std::vector<std::size_t> near(std::size_t pore, const Packing& sample) const;

    CarveOptions options_;
    double seed_radius_, density_ = 0;
    Vec3 low_, high_;  ///< of the image, one diameter from its faces
    ImagePores image_;
    std::vector<std::vector<std::size_t>> neighbours_;  ///< pores whose boxes meet
};

/// Header and rows of the table of iterations.
struct CarveRow {
    std::int64_t iteration = 0, particles = 0, removed = 0;
    double target = 0, volume = 0, total_error = 0, grid_error = 0;
    std::int64_t judged = 0, wrong = 0, worst = 0;
    double worst_error = 0, iou = 0, surface_distance = 0, surface_spread = 0;
    double periods = 0, energy_ratio = 0, force_balance = 0;
};
CarveRow row_of(const Assessment& assessment, std::int64_t iteration, std::int64_t particles, std::int64_t removed);
std::string table_of(const std::vector<CarveRow>& rows);
/// One line a pore: number, across, place, target, volume, error, IoU, distance of the surfaces.
std::string pore_table(const Assessment& assessment);

/// For a state that is kept between processes: rows as plain numbers and back.
std::vector<double> numbers_of(const std::vector<CarveRow>& rows);
std::vector<CarveRow> rows_of(const std::vector<double>& numbers);

}  // namespace tomodem::relax
