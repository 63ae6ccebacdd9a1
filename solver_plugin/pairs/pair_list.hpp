#pragma once
#include <cstddef>
#include <cstdint>
#include <unordered_set>
#include <vector>

#include "solver_plugin/pairs/contact_memory.hpp"
#include "solver_plugin/pairs/pair_search.hpp"
#include "solver_plugin/pairs/particle_view.hpp"

namespace tomodem::plugin {

/// One particle with four neighbours of one class, filled up with the particle itself, at distance zero.
struct PairBlock {
    static constexpr int lanes = 4;
    static constexpr unsigned all_lanes = 0b1111;

    std::int32_t particle;
    std::int16_t law;
    std::uint8_t inside;     ///< one bit a neighbour: in the crown one step ago
    std::uint8_t interface;  ///< one bit a neighbour
    std::int32_t neighbour[lanes];
};

/// The pairs that the vector loop computes: those nearer than a reach where their particles were listed.
///
/// A class of pairs is a pair of types, in the same or in different objects. As long as no particle is farther than
/// half of (reach - crown) from where it was listed, every pair in the crown is in the list. A few that stray farther,
/// mostly at free surfaces, are listed once more by themselves; when they are many, everything is listed anew.
class PairList {
 public:
    /// Blocks that may be read behind the last one, so that prefetching needs no test.
    static constexpr std::size_t tail = 24;

    /// One where the law does not look at types.
    void set_types(int count) { type_count_ = count; }
    /// Room for the places of so many particles.
    void make_room(int count) { listed_at_.resize(3 * static_cast<std::size_t>(count)); }

    /// Lists every pair of two local particles once, and those of a local one with a ghost.
    /// @param memory  whose interfaces are marked; null: none is
    void make(const ParticleView& particles, double reach, const ContactMemory* memory);
    /// Lists the pairs of these particles once more from where they are. A pair that was not listed before has been
    /// outside the crown until now.
    /// @return false if there are too many: then nothing is done
    bool mend(const ParticleView& particles, const std::vector<std::int32_t>& strayed, const ContactMemory* memory);

    /// Where a particle was listed, 3 each; single precision is allowed for in the reach.
    const float* listed_at() const { return listed_at_.data(); }
    /// Whether objects are distinguished.
    bool by_object() const { return by_object_; }
    PairBlock* begin() { return blocks_.data(); }
    PairBlock* end() { return blocks_.data() + count_; }
    const PairBlock* begin() const { return blocks_.data(); }
    const PairBlock* end() const { return blocks_.data() + count_; }
    /// Calls use(i, j) for every listed pair.
    template <class Use>
    void for_each_pair(Use use) const {
        for (const PairBlock& block : *this)
            for (const std::int32_t j : block.neighbour)
                if (j != block.particle) use(block.particle, j);
    }
    /// How often make() was called.
    std::int64_t listings() const { return listings_; }

 private:
    void add(std::int32_t i, std::int32_t* found, int count, const ParticleView& particles,
             const ContactMemory* memory);
    void add_blocks(std::int32_t i, int law, std::int32_t* found, int count, const ParticleView& particles,
                    const ContactMemory* memory);
    void close();
    bool is_listed(std::int32_t i, std::int32_t j) const;
    int hand_on(std::int32_t i, std::int32_t* found, int count);

    int type_count_ = 1;
    bool by_object_ = false;
    std::vector<float> listed_at_;
    std::vector<PairBlock> blocks_;  // with the tail behind count_
    std::size_t count_ = 0;
    /// Block of each local particle when the list was made; while it is made, of those still to come: `waiting` and the
    /// last link of the chain of neighbours that they take over.
    std::vector<std::uint32_t> first_;
    struct Link {
        std::int32_t neighbour;
        std::uint32_t before;
    };
    std::vector<Link> links_;
    std::uint32_t free_link_ = 0;  // links that were taken over are used again
    bool making_ = false;
    std::size_t made_ = 0;                     // blocks when the list was made
    std::unordered_set<std::uint64_t> added_;  // pairs since
    int strayed_ = 0;
    PairSearch search_;
    std::vector<std::int32_t> found_, sorted_;
    std::vector<int> kept_;
    std::int64_t listings_ = 0;
};

}  // namespace tomodem::plugin
