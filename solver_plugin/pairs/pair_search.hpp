#pragma once
#include <cstdint>
#include <vector>

namespace tomodem::plugin {

/// Finds pairs of particles within reach: cells as wide as the reach, eight candidates at once. A pair that is
/// farther than the reach by a rounding error of single precision may be found too, none within is missed.
///
/// sort(); then for every cell enter(cell), and for every slot of it find(slot).
class PairSearch {
 public:
    /// @param position  3 per particle; ghosts follow the `local_count` particles of this process
    void sort(const double* position, int local_count, int count, double reach);

    int cell_count() const { return cells_[0] * cells_[1] * cells_[2]; }
    /// Local particles of a cell are in the slots [first_slot(cell), first_slot(cell + 1)).
    int first_slot(int cell) const { return local_.start[cell]; }
    std::int32_t particle(int slot) const { return local_.index[slot]; }

    void enter(int cell);
    /// Particles within reach of the one in `slot` of the entered cell: each pair of local particles is found from one
    /// of the two, each pair with a ghost from the local one.
    /// @param found  room for most_found() entries
    /// @return how many
    int find(int slot, std::int32_t* found) const;
    /// For the entered cell.
    int most_found() const { return most_found_; }

    /// Everything within reach of a point, ghosts included, where it was sorted or has moved to since; some twice.
    void find_around(const double* point, std::vector<std::int32_t>& found) const;
    /// A particle that is to be found at a new place, too.
    void move(std::int32_t particle, const double* point);

 private:
    /// Particles sorted by cell, coordinate by coordinate, relative to the lowest corner, with far away ones at the
    /// end.
    struct Sorted {
        std::vector<int> start;
        std::vector<std::int32_t> index;
        std::vector<float> coordinate[3];
    };
    struct Run {
        const Sorted* particles;
        int begin, end;
    };

    void place(const double* position, int begin, int end, Sorted& sorted);
    int cell_of(const double* point) const;
    int search(const Run& run, const float* at, std::int32_t* found, int count) const;

    double low_[3] = {}, cells_per_length_[3] = {};
    float reach_squared_ = 0;
    int cells_[3] = {};
    Sorted local_, ghosts_, moved_;  // moved_ in the order of the moves
    std::vector<std::int32_t> cell_;
    Run runs_[16] = {};
    int run_count_ = 0, most_found_ = 0, own_end_ = 0;
};

}  // namespace tomodem::plugin
