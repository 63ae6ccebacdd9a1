#pragma once
#include <algorithm>
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

/// Where the material of a sample ends along each axis [mm].
struct Ends {
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
};

/// One pore of the image and what has become of it.
struct PoreState {
    std::int32_t number = 0;
    PoreKind kind = PoreKind::closed;
    bool judged = false;  ///< its own error counts
    double across = 0;    ///< particles [-]
    Vec3 centre = Vec3::Zero();
    /// Volume of the image's pore; of one that a face cuts, up to where the material ends; of an open one, one diameter
    /// from the faces [mm^3].
    double target = 0;
    PoreMeasure measure;
    PoreOverlap overlap;
    double lacking() const { return std::max(0.0, target - measure.volume); }
    double error() const { return measure.volume / target - 1; }
    double iou() const { return overlap.united > 0 ? overlap.intersection / overlap.united : 0; }
};

/// Volumes of several pores in the image and in the sample [mm^3].
struct PoreSum {
    std::int64_t count = 0;
    double target = 0, volume = 0;
    double error() const { return target > 0 ? volume / target - 1 : 0; }
};

/// The pores of a sample beside those of the image. Open ones count nowhere.
struct Assessment {
    std::vector<PoreState> pores;
    PoreSum all, closed, cut;
    double grid_volume = 0, intersection = 0, united = 0;  ///< of all [mm^3]
    std::size_t worst = 0;                                 ///< of the judged pores, the one with the largest error
    std::int64_t judged = 0, wrong = 0;                    ///< pores; those with too large an error
    double worst_error() const { return judged > 0 ? pores[worst].error() : 0; }
    double iou() const { return united > 0 ? intersection / united : 0; }
};

class Carver {
 public:
    /// @param sample  dense, or with particles missing already; at rest, or still to be relaxed
    /// @throws InvalidInput if the image and the sample do not lie over each other, or the image has no pore that these
    ///         particles can show and that does not pass through it
    Carver(const LabelVolume& volume, const Packing& sample, const CarveOptions& options);

    /// Takes D of the material between the pores from the sample, which is at rest; or from an earlier process.
    void measure_density(const Packing& sample);
    void set_density(double density) { density_ = density; }

    Assessment assess(const Packing& sample) const;
    bool is_done(const Assessment& assessment) const;
    /// More has come out than should: the total, or a judged pore, is too large.
    bool has_overshot(const Assessment& assessment) const;
    /// The larger of the errors over what is allowed; at most 1 is done.
    double distance_from_done(const Assessment& assessment) const;

    /// Places in the sample, increasing, of the particles to take out next: in each pore as many as the volume that it
    /// lacks would hold, at first only `first_share` of it, those farthest inside the image's pore first. Pores that
    /// are not judged by themselves give no more than the total lacks. From open pores those within the image's.
    std::vector<std::size_t> next_removal(const Packing& sample, const Assessment& assessment, bool first) const;

    /// The last removal was too much: from pores that are now too large (or from all, if none is) half as much comes
    /// out in future. @return false if that has been done too often to help
    bool hold_back(const Assessment& overshot);
    /// Of each pore, to be kept between processes.
    const std::vector<double>& shares() const { return share_; }
    void set_shares(const std::vector<double>& shares) { share_ = shares; }

    std::int64_t too_small() const { return image_.too_small; }
    double too_small_volume() const { return image_.too_small_volume; }
    /// Part of the pores' volume that has no particles.
    double empty_share(const Assessment& assessment) const { return assessment.all.volume / assessment.all.target; }
    double density() const { return density_; }
    /// By its mass, away from the pores.
    Ends ends_of(const Packing& sample) const;

 private:
    bool belongs(std::size_t pore, const Vec3& point) const;
    std::vector<std::size_t> near(std::size_t pore, const Packing& sample) const;

    CarveOptions options_;
    double seed_radius_, density_ = 0;
    Vec3 image_low_, image_high_;
    Vec3 low_, high_;  ///< of the image, one diameter from its faces
    ImagePores image_;
    std::vector<std::vector<std::size_t>> neighbours_;  ///< pores whose boxes meet
    std::vector<double> share_;                         ///< of what a pore lacks, that comes out in one iteration
};

/// Header and rows of the table of iterations.
struct CarveRow {
    std::int64_t iteration = 0, particles = 0, removed = 0;
    double target = 0, volume = 0, total_error = 0, grid_error = 0;
    std::int64_t judged = 0, wrong = 0, worst = 0;
    double worst_error = 0, iou = 0, surface_distance = 0, surface_spread = 0;
    double periods = 0, energy_ratio = 0, force_balance = 0;
    bool taken_back = false;  ///< too much had come out: the next iteration starts from the sample before
};
CarveRow row_of(const Assessment& assessment, std::int64_t iteration, std::int64_t particles, std::int64_t removed);
std::string table_of(const std::vector<CarveRow>& rows);
/// One line a pore: number, across, place, target, volume, error, IoU, distance of the surfaces.
std::string pore_table(const Assessment& assessment);

/// For a state that is kept between processes: rows as plain numbers and back.
std::vector<double> numbers_of(const std::vector<CarveRow>& rows);
std::vector<CarveRow> rows_of(const std::vector<double>& numbers);

}  // namespace tomodem::relax
