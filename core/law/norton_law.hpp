#pragma once
#include <vector>

/// NORTON: a law whose flow stress is K rate^M at any M up to 1 and does not look at the time step (docs/norton.md).
///
/// Lengths are in seeds' diameters d where no unit is given; the crown's diameter is 1.5 d.
namespace tomodem::law {

/// Constants of the law, for packings of density D = 0.64. They are the same for every material.
struct NortonConstants {
    static constexpr double crown = 1.5;           ///< 2 r_c
    static constexpr double core = 0.7;            ///< diameter of the elastic core: seeds that touch would jam
    static constexpr double core_stiffness = 100;  ///< over strength d
    static constexpr double pressure = 25;         ///< B, over strength d^2
    static constexpr double rest_density = 1.08;   ///< rho_0 [-]: a packing of D = 0.64 keeps its volume at rest
    static constexpr double surface = 1.5;         ///< a_n: what a free surface lacks of rho
    static constexpr double smoothing = 0.1;       ///< n_0: |n| is smooth below it
    static constexpr double fabric_floor =
        0.131;                                   ///< [d^2] of a particle with few neighbours: 0.02 of the mean tr A / 3
    static constexpr double background = 0.4;    ///< p_b, over strength d^2: keeps clusters from forming where p < 0
    static constexpr double inside = 0.4;        ///< |n| up to which a particle is not at a surface
    static constexpr double volume = 0.818;      ///< of a particle [d^3]
    static constexpr double pair_share = 0.4;    ///< chi: viscosity of what is not in the mean flow, over eta d
    static constexpr double bulk_viscosity = 2;  ///< over eta
    static constexpr double rate_floor = 0.1;    ///< of the load's lowest rate: below, the viscosity does not grow
    static constexpr double most_corrected = 2;  ///< of a stress, over K rate^M: more, and a particle runs away
    static constexpr double film = 30;           ///< between sample and wall, over strength d / flow_rate
    static constexpr double film_range = 0.75;   ///< of centres, from the face [d]
    static constexpr double wall_viscosity =
        1000;  ///< of the film between particle and wall, over strength d / flow_rate
};

/// One material.
struct NortonMaterial {
    double consistency;       ///< K over the measured flow stress of K = 1 (docs/calibration.md) [Pa.s^M]
    double rate_sensitivity;  ///< M [-]
    double strength;          ///< K rate^M at the reference rate [Pa]: what the elastic parts are multiples of
};

struct Norton {
    double seed_diameter = 1;  ///< d [mm]
    double min_rate = 0;       ///< [1/s]: the viscosity does not grow below it
    double flow_rate = 0;      ///< [1/s] of the load
    /// The elastic parts are those of the load's present rate, K rate^M, not of one rate: a jump of it leaves the
    /// sample in balance.
    bool strength_follows = false;
    bool at_rest = false;  ///< while a sample comes to rest the viscosity is that of flow_rate everywhere
    std::vector<NortonMaterial> materials;  ///< by type, from 0
};

/// Sums over the neighbours j in the crown of a particle i: r = x_i - x_j, v = v_i - v_j, u = 1 - |r| / 2 r_c.
struct NortonSums {
    double moment[3][4];  ///< rows of sum v r [mm^2/s]
    double diagonal[4];   ///< of the fabric A = sum r r [mm^2]; the fourth is rho = sum u^2
    double off[4];        ///< A_xy, A_yz, A_zx
    double outward[4];    ///< n = sum u^2 r / |r|
    double of_own[4];     ///< the part of n of the neighbours in the same body
};

/// What the force of a pair needs of its particles.
struct NortonState {
    double traction[3][4];  ///< columns of T = V sigma A^-1 [uN/mm]; the fourths are p [uN], eta [Pa.s], strength [Pa]
    double diagonal[4];     ///< of the rate of deformation D [1/s]; the fourth is 0
    double off[4];          ///< 2 D_xy, 2 D_yz, 2 D_zx; 0
    double lateral[4];      ///< a_n p n / sqrt(n^2 + n_0^2) [uN]; 0
    double inverse[3][3];   ///< of the fabric A [1/mm^2]
    double background;      ///< share of p [uN]
    double inside;          ///< w: from 0 at a surface to 1

    double pressure() const { return traction[0][3]; }
    double viscosity() const { return traction[1][3]; }
    double strength() const { return traction[2][3]; }
};

/// What is added to A [mm^2]: 0.131 d^2 / (1 + a^4), a = 3 det A / (sum of the principal 2 x 2 minors) [d^2]: nothing
/// where a particle has its neighbours, and in flat or lone places as much as keeps A's inverse finite.
/// @param diagonal  of A; xx, yy, zz
/// @param off       xy, yz, zx
double norton_fabric_floor(double diameter, const double* diagonal, const double* off);

/// From the sums of a particle: velocity gradient (sum v r) A^-1, its symmetric part D, the equivalent rate
/// gamma = sqrt(2/3 D':D' + min_rate^2), eta = K gamma^(M-1), sigma = 2/3 eta D' + bulk, and the pressure of the
/// density with the background.
NortonState norton_state(const Norton& law, const NortonMaterial& material, const NortonSums& sums);

/// Force on i of a pair within the crown [uN].
/// @param apart   x_i - x_j [mm]
/// @param speed   v_i - v_j [mm/s]
/// @param bonded  false for two objects or an interface: repulsion alone
/// @param weight  w_ij of T_i; that of T_j is 2 - w_ij
void norton_force(const Norton& law, const NortonState& i, const NortonState& j, const double* apart,
                  const double* speed, bool bonded, double* force, double weight = 1);

/// w_ij = 2 eta_j / (eta_i + eta_j) of two phases: with it the traction is the same on both sides of their interface.
inline double norton_weight(double own_viscosity, double other_viscosity) {
    return 2 * other_viscosity / (own_viscosity + other_viscosity);
}

/// Takes from the traction what the elastic forces and the pair term carry of the stress: what the packing's anisotropy
/// makes of them would otherwise add to the flow stress, more and more with the strain.
/// @param virial      W = 1/2 sum sym(f r) over the neighbours, f without T [uN.mm]
/// @param background   trace of the background's share of W
/// @param flow_stress  K rate^M at the load's rate [Pa]: a particle cannot carry much more
void norton_correct(const Norton& law, NortonState& state, const double (&virial)[3][3], double background,
                    double flow_stress);

/// Force of a wall along its normal, repulsion positive [uN]: seeds are held off, and a viscous film makes the crown
/// follow the wall's normal motion. The film is so stiff that its force is that of the end of the time step.
/// @param distance   of the centre [mm], below the crown's radius
/// @param approach   velocity of the particle along the normal, relative to the wall [mm/s]
/// @param other      force of everything else along the normal [uN]
double norton_wall_force(const Norton& law, double strength, double distance, double approach, double other,
                         double time_step_over_mass);

}  // namespace tomodem::law
