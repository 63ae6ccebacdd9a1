#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/law/self_contact.hpp"

namespace tomodem::plugin {

/// What one process remembers for self-contact: outward vectors, and the pairs that are interfaces.
///
/// Internal pairs are not stored: a pair in the crown that is not an interface is internal, and whether it was in the
/// crown one step ago follows from positions and velocities. Both particles of a pair carry an interface, each on its
/// own process, so that it survives every change of owner.
class ContactMemory {
 public:
    struct Interface {
        std::int64_t partner;  ///< id
        std::int64_t since;    ///< step in which the pair formed
    };
    using Outward = std::array<double, 4>;  // the fourth stays 0: rows are added four at a time

    void set_law(const law::SelfContact& law) { law_ = law; }

    /// Room for `local` particles of this process and `ghosts` behind them.
    void resize(int local, int ghosts);

    /// Outward vectors at the end of the last step, ghosts included once they were exchanged.
    std::vector<Outward>& outward() { return outward_; }
    const std::vector<Outward>& outward() const { return outward_; }
    /// Sums of the present step; finish_step() makes them the outward vectors of the local particles.
    std::vector<Outward>& next_outward() { return next_; }
    void finish_step();

    std::vector<Interface>& interfaces(int i) { return interfaces_[i]; }
    const std::vector<Interface>& interfaces(int i) const { return interfaces_[i]; }
    bool is_interface(int i, std::int64_t partner) const;

    /// Decides what the new pair of particle `i` of this process and `j` is, and remembers an interface.
    /// @param line  from i to j, 3 numbers
    bool classify(int i, int j, const double* line, const std::int32_t* id, std::int64_t step);
    /// The pair has left the crown.
    void forget(int i, int j, const std::int32_t* id);
    /// Turns interfaces that are at least `age` steps old into internal pairs. @return how many entries went
    std::int64_t heal(std::int64_t step, std::int64_t age);

 private:
    law::SelfContact law_{};
    int local_ = 0;
    std::vector<Outward> outward_, next_;
    std::vector<std::vector<Interface>> interfaces_;
};

}  // namespace tomodem::plugin
