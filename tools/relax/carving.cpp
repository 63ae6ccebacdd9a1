#include "tools/relax/carving.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/output_file.hpp"
#include "core/packing/packing_file.hpp"
#include "solver_plugin/simulation/checkpoint.hpp"

namespace tomodem::relax {
namespace {

std::filesystem::path with_suffix(std::filesystem::path file, const char* suffix) {
    return file += suffix;
}

/// Place, size and pores of a volume, to be compared.
std::vector<double> numbers_of(const LabelVolume& volume) {
    std::vector<double> numbers;
    for (int c = 0; c < 3; ++c) {
        numbers.push_back(volume.origin()[c]);
        numbers.push_back(volume.spacing()[c]);
        numbers.push_back(volume.size()[c]);
    }
    for (const auto& [label, voxels] : volume.histogram()) {
        numbers.push_back(label);
        numbers.push_back(static_cast<double>(voxels));
    }
    return numbers;
}

/// The loop; what looks at the image runs on the first process alone.
class Carving {
 public:
    Carving(const CarveRequest& request, const Provenance& provenance, int threads, MPI_Comm communicator,
            Reporter& reporter)
        : request_(request),
          communicator_(communicator),
          state_file_(with_suffix(request.carved, ".state")),
          table_file_(request.table.empty() ? std::filesystem::path(request.carved).replace_extension(".csv")
                                            : request.table),
          scene_(read_scene(request.scene)),
          sample_(read_sample(request.sample)),
          provenance_(provenance),
          threads_(threads),
          reporter_(reporter) {
        int rank = 0;
        MPI_Comm_rank(communicator, &rank);
        first_ = rank == 0;
        provenance_.scene = scene_.text;
        if (!scene_.calibration_file.empty())
            provenance_.inputs[scene_.calibration_file.string()] = content_digest(scene_.calibration_file);
        inputs_ = {provenance_.version, scene_.text, ""};
        for (const auto& [name, digest] : provenance_.inputs) inputs_.digests += digest + " ";
        inputs_.digests += fmt::format("{} {} {} {} {} {}", request.carve.min_across, request.carve.first_share,
                                       request.carve.judged_across, request.limits.energy_ratio,
                                       request.limits.force_balance, request.limits.max_periods);
        together(communicator, [&] {
            if (!first_) return;
            output_.emplace(request.carved);  // a folder that cannot be written to is found now, not at the end
            const OutputFile table(table_file_);
        });
    }

    void run() {
        begin();
        for (std::int64_t iteration = static_cast<std::int64_t>(rows_.size());; ++iteration) {
            std::vector<std::size_t> removal;
            int done = 0;
            together(communicator_, [&] {
                if (!first_) return;
                done = request_.max_iterations == 0 || carver_->is_done(assessment_);
                if (done) return;
                if (iteration > request_.max_iterations)
                    throw InvalidInput(
                        fmt::format("the pores are not as large as the image's after {} iterations: {}; "
                                    "--resume with more --max-iterations continues",
                                    request_.max_iterations, how_far(assessment_)));
                removal = carver_->next_removal(sample_, assessment_, iteration == 1);
            });
            MPI_Bcast(&done, 1, MPI_INT, 0, communicator_);
            if (done) break;
            const std::int64_t removed = share_count(static_cast<std::int64_t>(removal.size()));
            if (removed == 0 || share_count(since_nearest_) > most_in_vain) give_up(iteration);
            const Packing before = sample_;
            const Assessment assessed = assessment_;
            take_out(removal);
            come_to_rest();
            const bool too_much = assess(iteration, removed, carver_ && !carver_->has_overshot(assessed));
            if (!too_much) continue;
            sample_ = before;
            assessment_ = assessed;
            write_state();
        }
        finish();
    }

 private:
    /// Iterations that come no nearer, after which it ends.
    static constexpr std::int64_t most_in_vain = 5;
    /// Share of the pores' volume that has no particles, from which a sample has its pores already.
    static constexpr double masked_from = 0.5;

    std::string how_far(const Assessment& assessment) const {
        std::string text = fmt::format("total volume {:+.2f} %", 100 * assessment.all.error());
        if (assessment.judged > 0)
            text += fmt::format(", {} of {} judged pores beyond {:g} %, pore {} by {:+.2f} %", assessment.wrong,
                                assessment.judged, request_.pore_error, assessment.pores[assessment.worst].number,
                                100 * assessment.worst_error());
        return text;
    }

    /// The sample that has come nearest to the image.
    void keep_nearest() {
        if (!first_) return;
        ++since_nearest_;
        const double distance = carver_->distance_from_done(assessment_);
        if (nearest_ && distance >= carver_->distance_from_done(nearest_->assessment)) return;
        nearest_ = {sample_, assessment_};
        since_nearest_ = 0;
    }

    /// Ends with an error; the state holds the nearest sample, which --resume takes with errors as large as its own.
    void give_up(std::int64_t iteration) {
        if (first_) {
            sample_ = nearest_->sample;
            assessment_ = nearest_->assessment;
            rows_.push_back(row_of(assessment_, iteration, static_cast<std::int64_t>(sample_.size()), 0));
        } else {
            rows_.emplace_back();
        }
        write_state();
        together(communicator_, [&] {
            if (!first_) return;
            write_text(table_file_, table_of(rows_));
            throw InvalidInput(
                fmt::format("taking particles out brings the pores no nearer to the image's than this: {}{}",
                            how_far(assessment_), advice()));
        });
    }

    /// What can be done about the nearest sample.
    std::string advice() const {
        std::string text;
        const auto torn = std::count_if(assessment_.pores.begin(), assessment_.pores.end(), [](const PoreState& pore) {
            return pore.kind == PoreKind::closed && pore.measure.leaks;
        });
        if (rows_.front().volume > masked_from * rows_.front().target)
            text += "; the sample had pores already: start from a dense one (vol2pack --relabel 0=1)";
        else if (torn > 0)
            text += fmt::format(
                "; {} pores have torn their walls: finer particles (vol2pack --pixels-per-seed) make "
                "thicker ones",
                torn);
        const double total = std::abs(assessment_.all.error()), worst = std::abs(assessment_.worst_error());
        if (std::max(total, worst) > 0.99) return text;
        const auto option = [](const char* flag, double error, double allowed) {
            return 100 * error <= allowed ? std::string{}
                                          : fmt::format(" {} {:.1f}%", flag, std::ceil(1000 * error + 1e-6) / 10);
        };
        return text + fmt::format("; the same command with --resume{}{} takes the sample as it is",
                                  option("--total-error", total, request_.total_error),
                                  option("--pore-error", worst, request_.pore_error));
    }

    std::int64_t share_count(std::int64_t count) const {
        MPI_Bcast(&count, 1, MPI_INT64_T, 0, communicator_);
        return count;
    }

    void begin() {
        std::error_code ignored;
        const bool go_on = request_.resume && std::filesystem::exists(state_file_, ignored);
        MPI_Barrier(communicator_);
        if (go_on) {
            restore();
        } else if (request_.resume && first_) {
            reporter_.note(fmt::format("there is no state '{}': starting from the beginning", state_file_.string()));
        }
        together(communicator_, [&] {
            if (!first_) return;
            CarveOptions options = request_.carve;
            options.pore_error = request_.pore_error / 100;
            options.total_error = request_.total_error / 100;
            options.threads = threads_;
            const LabelVolume volume = read_image(request_.image, request_.volume, threads_, reporter_).volume;
            carver_.emplace(volume, sample_, options);
            const std::vector<double> before = std::exchange(image_, numbers_of(volume));
            if (!go_on) return;
            if (before != image_)
                throw InvalidInput(
                    fmt::format("cannot resume from '{}': it was made with other options of the volume; use "
                                "the same again, or start again without --resume",
                                state_file_.string()));
            carver_->set_density(density_);
            carver_->set_shares(shares_);
            assessment_ = carver_->assess(sample_);
            keep_nearest();
        });
        if (!go_on) {
            // With its pores filled its faces draw in without moving the pores.
            if (!sample_.relaxed) come_to_rest();
            if (first_) carver_->measure_density(sample_);
            assess(0, 0, false);
        }
        if (!first_) return;
        if (assessment_.judged == 0)
            reporter_.warn(
                fmt::format("no pore is {:g} particles across or more: none is judged by itself, only their total is",
                            request_.carve.judged_across));
        const double empty = carver_->empty_share(assessment_);
        if (!go_on && empty > masked_from && request_.max_iterations > 0)
            reporter_.warn(
                fmt::format("the sample is masked already: {:.0f} % of the pores' volume has no particles; they can "
                            "only grow from there, a dense sample (vol2pack --relabel 0=1) is the better start",
                            100 * empty));
    }

    void restore() {
        const Checkpoint found = read_checkpoint(state_file_, inputs_, communicator_).checkpoint;
        const std::vector<double>&ids = found.numbers.at("id"), &position = found.numbers.at("position");
        std::vector<std::size_t> gone;
        std::size_t at = 0;
        for (std::size_t i = 0; i < sample_.size(); ++i)
            if (at < ids.size() && static_cast<std::int64_t>(ids[at]) == sample_.id[i])
                ++at;
            else
                gone.push_back(i);
        erase(gone);
        for (std::size_t i = 0; i < sample_.size(); ++i) sample_.position[i] = Vec3(position.data() + 3 * i);
        sample_.relaxed = true;
        rows_ = rows_of(found.numbers.at("rows"));
        steps_ = static_cast<std::int64_t>(found.number("steps"));
        density_ = found.number("density");
        image_ = found.numbers.at("image");
        shares_ = found.numbers.at("shares");
        reporter_.note(fmt::format("resuming after iteration {}", rows_.back().iteration));
    }

    void erase(const std::vector<std::size_t>& places) {
        const auto filter = [&](auto& values) {
            if (values.empty()) return;
            std::size_t to = 0, next = 0;
            for (std::size_t i = 0; i < values.size(); ++i) {
                if (next < places.size() && places[next] == i) {
                    ++next;
                    continue;
                }
                values[to++] = values[i];
            }
            values.resize(to);
        };
        filter(sample_.position);
        filter(sample_.species);
        filter(sample_.id);
        filter(sample_.object);
        filter(sample_.radius);
        for (auto& [name, values] : sample_.property) filter(values);
    }

    void take_out(std::vector<std::size_t>& places) {
        std::int64_t count = share_count(static_cast<std::int64_t>(places.size()));
        places.resize(static_cast<std::size_t>(count));
        MPI_Bcast(places.data(), static_cast<int>(count * sizeof(std::size_t)), MPI_BYTE, 0, communicator_);
        erase(places);
    }

    void come_to_rest() {
        Relaxation result = tomodem::come_to_rest(sample_, scene_, request_.limits, communicator_, reporter_);
        steps_ += result.cost.steps;
        if (first_) sample_ = std::move(result.sample);
        sample_.relaxed = true;
        MPI_Bcast(sample_.position.data(), static_cast<int>(3 * sample_.size()), MPI_DOUBLE, 0, communicator_);
        last_.periods = result.periods;
        last_.energy_ratio = result.energy_ratio;
        last_.force_balance = result.force_balance;
    }

    /// @param may_go_back  to the sample before, if too much has come out. @return whether it should
    bool assess(std::int64_t iteration, std::int64_t removed, bool may_go_back) {
        int too_much = 0;
        together(communicator_, [&] {
            if (!first_) return;
            assessment_ = carver_->assess(sample_);
            CarveRow row = row_of(assessment_, iteration, static_cast<std::int64_t>(sample_.size()), removed);
            row.periods = last_.periods;
            row.energy_ratio = last_.energy_ratio;
            row.force_balance = last_.force_balance;
            keep_nearest();
            row.taken_back = may_go_back && !carver_->is_done(assessment_) && carver_->has_overshot(assessment_) &&
                             carver_->hold_back(assessment_);
            too_much = row.taken_back;
            rows_.push_back(row);
            reporter_.note(fmt::format("iteration {}: {} particles out, {}, IoU {:.3f}{}", iteration, removed,
                                       how_far(assessment_), row.iou,
                                       row.taken_back ? "; too much, taken back to take out less" : ""));
            write_text(table_file_, table_of(rows_));
        });
        if (!first_) rows_.emplace_back();
        MPI_Bcast(&too_much, 1, MPI_INT, 0, communicator_);
        if (too_much == 0) write_state();
        return too_much != 0;
    }

    void write_state() {
        Checkpoint state;
        // Places of particles are kept as numbers, by row; the file's own list of particles must not be empty.
        state.particles = {{1}, {1}, {0}, {0, 0, 0}, {0, 0, 0}, {0}, {}};
        if (first_) {
            for (const std::int64_t id : sample_.id) state.numbers["id"].push_back(static_cast<double>(id));
            for (const Vec3& point : sample_.position)
                state.numbers["position"].insert(state.numbers["position"].end(), point.data(), point.data() + 3);
            state.numbers["rows"] = numbers_of(rows_);
            state.numbers["steps"] = {static_cast<double>(steps_)};
            state.numbers["density"] = {carver_->density()};
            state.numbers["shares"] = carver_->shares();
            state.numbers["image"] = image_;
        }
        write_checkpoint(state, inputs_, state_file_, communicator_);
    }

    void finish() {
        together(communicator_, [&] {
            if (!first_) return;
            if (!request_.pores.empty()) write_text(request_.pores, pore_table(assessment_));
            output_.reset();
            write_packing(sample_, request_.carved, provenance_);
            std::error_code ignored;
            std::filesystem::remove(state_file_, ignored);
        });
        if (!first_) return;
        for (const PoreState& pore : assessment_.pores)
            if (pore.kind == PoreKind::closed && pore.measure.leaks)
                reporter_.warn(
                    fmt::format("pore {} opens into another one or to the outside; its volume is counted as "
                                "far as the image's pore is the nearest",
                                pore.number));
        const CarveRow& row = rows_.back();
        reporter_.report("particles", static_cast<std::int64_t>(sample_.size()));
        reporter_.report("iterations", row.iteration);
        reporter_.report("density", carver_->density());
        reporter_.report("closed_pores", assessment_.closed.count);
        reporter_.report("cut_pores", assessment_.cut.count);
        reporter_.report("open_pores", static_cast<std::int64_t>(assessment_.pores.size()) - assessment_.all.count);
        reporter_.report("judged_pores", assessment_.judged);
        reporter_.report("too_small_pores", carver_->too_small());
        reporter_.report("too_small_volume", carver_->too_small_volume(), "mm^3");
        reporter_.report("image_volume", assessment_.all.target, "mm^3");
        reporter_.report("pore_volume", assessment_.all.volume, "mm^3");
        reporter_.report("total_error", row.total_error);
        if (assessment_.closed.count > 0) reporter_.report("closed_pores_error", assessment_.closed.error());
        if (assessment_.cut.count > 0) reporter_.report("cut_pores_error", assessment_.cut.error());
        reporter_.report("total_error_by_grid", row.grid_error);
        reporter_.report("worst_pore_error", row.worst_error);
        reporter_.report("intersection_over_union", row.iou);
        reporter_.report("surface_distance", row.surface_distance, "mm");
        reporter_.report("steps", steps_);
    }

    const CarveRequest& request_;
    MPI_Comm communicator_;
    bool first_ = false;
    std::filesystem::path state_file_, table_file_;
    Scene scene_;
    Packing sample_;
    Provenance provenance_;
    int threads_;
    Reporter& reporter_;
    Inputs inputs_;
    std::optional<OutputFile> output_;
    std::optional<Carver> carver_;  // on the first process
    Assessment assessment_;         // likewise
    std::vector<CarveRow> rows_;
    CarveRow last_;
    std::int64_t steps_ = 0;
    double density_ = 0;          ///< from the state
    std::vector<double> shares_;  ///< likewise
    struct Reached {
        Packing sample;
        Assessment assessment;
    };
    std::optional<Reached> nearest_;  // on the first process
    std::int64_t since_nearest_ = 0;  ///< assessments
    std::vector<double> image_;       ///< what its options make of the volume
};

}  // namespace

void carve(const CarveRequest& request, const Provenance& provenance, int threads, MPI_Comm communicator,
           Reporter& reporter) {
    Carving(request, provenance, threads, communicator, reporter).run();
}

}  // namespace tomodem::relax
