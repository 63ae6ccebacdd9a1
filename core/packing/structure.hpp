#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "core/packing/packing.hpp"

/// Arrangement of the particles: neighbours, contacts, radial distribution, local crystalline order.
///
/// All results are the same on any number of threads. A box repeats along its periodic axes; along the others points
/// may lie anywhere, and those at the edge of a sample have fewer neighbours.
namespace tomodem {

/// Neighbours of each point within a cutoff.
class NeighbourTable {
 public:
    /// @param cutoff  more than 0, at most half of the shortest periodic edge
    /// @throws InvalidInput if it is not, or a point is not finite
    /// @note   time and memory O(N): 28 bytes a point and 4 a neighbour
    NeighbourTable(std::span<const Vec3> points, const Box& box, double cutoff, int threads = 1);

    std::size_t size() const { return point_.size(); }
    double cutoff() const { return cutoff_; }
    /// Neighbours of a point, in the order of their indices.
    std::span<const std::int32_t> of(std::size_t i) const {
        return std::span(neighbour_).subspan(first_[i], first_[i + 1] - first_[i]);
    }
    /// From point i to the nearest image of point j.
    Vec3 separation(std::size_t i, std::size_t j) const;

 private:
    Box box_;
    double cutoff_;
    std::vector<Vec3> point_;
    std::vector<std::size_t> first_;
    std::vector<std::int32_t> neighbour_;
};

/// g(r) in equal shells from 0 on.
struct RadialDistribution {
    double shell = 0.0;     ///< width [mm]
    std::vector<double> g;  ///< [-]
    double radius(std::size_t k) const { return (static_cast<double>(k) + 0.5) * shell; }
    double reach() const { return shell * static_cast<double>(g.size()); }
};

/// Longest distance that radial_distribution() accepts: half of the shortest periodic edge, the shortest other edge.
double longest_reach(const Box& box);

/// Radial distribution function of points, normalised by (N - 1) / V and the share of each shell that lies within the
/// box seen from a point anywhere in it; so independent uniform points average exactly 1, whether the box is periodic
/// or not.
///
/// @param points  at least 2, all in the box
/// @param reach   at most longest_reach()
/// @note  seen from at most 2e5 points, evenly chosen; time O(N reach^3)
/// @throws InvalidInput if a condition does not hold
/// @see   Allen & Tildesley, Computer Simulation of Liquids, 2nd ed. (2017), section 2.6
RadialDistribution radial_distribution(std::span<const Vec3> points, const Box& box, double reach, std::size_t shells,
                                       int threads = 1);

/// Where g is lowest between two distances: the middle of the longest row of lowest shells (means over three).
double first_minimum(const RadialDistribution& distribution, double from, double to);

enum class Order : std::uint8_t { none, fcc, hcp, bcc, icosahedral };

/// Adaptive common-neighbour analysis: the lattice that each point and its nearest neighbours form.
///
/// The 12 nearest neighbours, bonded where closer than (1 + sqrt 2) / 2 of their mean distance: twelve 421 are fcc, six
/// 421 and six 422 hcp, twelve 555 an icosahedron. Else the 14 nearest, with their own bond length: eight 666 and six
/// 444 are bcc. The three digits of a neighbour are the common neighbours of it and the point, the bonds among them
/// and the longest chain of these.
///
/// @param neighbours  cutoff of 1.5 nearest distances or more; points with fewer than 12 neighbours have no order
/// @see Honeycutt & Andersen, J. Phys. Chem. 91 (1987) 4950; Stukowski, Modelling Simul. Mater. Sci. Eng. 20 (2012)
///      045021, section 2.3
std::vector<Order> common_neighbour_analysis(const NeighbourTable& neighbours, int threads = 1);

/// Which points lie at a free surface, 1 or 0 each: those with fewer than 12 neighbours, and those with none within 60
/// degrees of their outward vector, which is minus the sum of the unit vectors to the neighbours.
///
/// In a flat face that cone is empty up to 90 degrees; in a lattice or a random dense packing the widest empty one is
/// of about 55, and no point has fewer than 12.
///
/// @param neighbours  cutoff of about 1.7 nearest distances
std::vector<std::uint8_t> surface_points(const NeighbourTable& neighbours, int threads = 1);

/// Bond-orientational order of the sixth degree.
struct BondOrder {
    std::vector<double> q6;  ///< of each point; fcc 0.575, hcp 0.485, bcc 0.511 (14 bonds), icosahedron 0.663
    std::vector<std::int32_t> connections;  ///< solid-like ones of each point
    double global_q6 = 0.0;                 ///< of all bonds; about 1 / sqrt(bonds) without long-range order
};

/// @param cutoff      bonds are shorter; at most that of the table
/// @param solid_like  a bond is solid-like when the normalised product of the q6m of its ends exceeds this
/// @see Steinhardt, Nelson & Ronchetti, Phys. Rev. B 28 (1983) 784; ten Wolde, Ruiz-Montero & Frenkel, J. Chem. Phys.
/// 104
///      (1996) 9932
BondOrder bond_order(const NeighbourTable& neighbours, double cutoff, double solid_like = 0.5, int threads = 1);

/// What stands at the faces of a box along the axes that are not periodic.
enum class OpenFaces { free, walls };

/// Contacts of a packing: pairs with h < r_i + r_j, or within another reach.
struct ContactStatistics {
    std::int64_t contacts = 0;       ///< between particles
    std::int64_t wall_contacts = 0;  ///< those count for coordination and rattlers too
    double mean_coordination = 0.0;  ///< contacts of a particle
    double max_overlap = 0.0;        ///< 1 - h / (r_i + r_j); 0 where nothing overlaps
    double mean_overlap = 0.0;       ///< over the pairs of particles that overlap; 0 without any
    /// Particles that no force can hold: those with fewer than 4 contacts with others that are not rattlers.
    std::int64_t rattlers = 0;
    double backbone_coordination = 0.0;  ///< contacts of a particle among those that are not rattlers; 0 without any
};

/// @param packing  a periodic edge is at least two diameters of the largest sphere
ContactStatistics contact_statistics(const Packing& packing, OpenFaces faces = OpenFaces::free, int threads = 1);

/// Contacts between the particles of two labels, or of one.
struct PairContacts {
    std::int64_t contacts = 0;
    double max_overlap = 0.0, mean_overlap = 0.0;  ///< as in ContactStatistics
};

/// The same of each particle and of each pair of labels.
struct ContactDetail {
    ContactStatistics all;
    std::vector<std::int32_t> contacts;           ///< of each particle
    std::vector<std::int32_t> backbone_contacts;  ///< of each particle with those that are not rattlers; of a rattler 0
    std::vector<std::uint8_t> rattler;            ///< 1 or 0
    std::map<std::array<std::int32_t, 2>, PairContacts> between;  ///< the lower label first; every pair that there is
};

/// @param packing  a periodic edge is at least 2 reach diameters of the largest sphere
/// @param reach    a pair is in contact where h < reach (r_i + r_j): 1 for the seeds, r_c / r_s for the crowns
ContactDetail contact_detail(const Packing& packing, double reach = 1.0, OpenFaces faces = OpenFaces::free,
                             int threads = 1);

}  // namespace tomodem
