#pragma once
#include <cstdint>

/// Windows on LIGGGHTS' arrays; nothing is owned. Ghosts follow the particles of this process.
namespace tomodem::plugin {

/// What the pair loops read of a process' particles.
struct ParticleView {
    const double* position;  ///< 3 per particle
    const double* velocity;  ///< 3 per particle, half a step old: x - time_step v is the position one step ago
    const double* radius;    ///< of the crown
    const int* type;         ///< from 1
    const std::int32_t* id;
    int local_count;
    int count;                             ///< with ghosts
    const std::int32_t* object = nullptr;  ///< by id - 1; null: attraction does not look at objects
    const double* mass = nullptr;          ///< of those of this process

    bool same_object(int i, int j) const { return object == nullptr || object[id[i] - 1] == object[id[j] - 1]; }
};

/// LIGGGHTS' half neighbour list: pairs within crown and skin.
struct NeighbourView {
    int row_count;
    const int* rows;
    const int* lengths;  ///< by particle
    const int* const* neighbours;
    int index_mask;
};

/// What integration moves: the particles of this process.
struct MovingView {
    double* position;     ///< 3 per particle
    double* velocity;     ///< 3 per particle
    const double* force;  ///< 3 per particle
    const double* mass;
    int count;
};

}  // namespace tomodem::plugin
