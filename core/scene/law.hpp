#pragma once
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

/// What a law of the particles is, in one place: everything that scenes, constants, runs and explanations need to know
/// of it. How the solver computes its forces is the other half (solver_plugin/liggghts/solver_law.hpp).
namespace tomodem {

class Reporter;
class TomlReader;
struct ExpectedFlow;
struct Model;
struct Packing;
struct Phase;
struct PhaseModel;
struct Scene;
struct CalibrationWindow;

/// What takes the energy out of a sample that comes to rest.
enum class Damping {
    drag,  ///< nothing of the law: all particles swing with one short period, under a drag
    law    ///< the law itself is viscous
};

/// What a law is in numbers. Those of BILIN stand where nothing is said.
struct LawTraits {
    std::string name = {};     ///< as in law = "bilin" of a scene
    std::string feature = {};  ///< of its forces, what others do not have; named by `solve --explain`. Empty: none

    double crown_over_seed = 1.5;      ///< r_c / r_s unless the scene gives it
    double strain_per_step = 5e-6;     ///< unless the scene gives it [-]
    double min_steps_per_period = 20;  ///< time steps in a natural period: with fewer particles are lost
    bool carries_tension = false;      ///< a step to a larger strain than the one reached is refused if not
    bool measures_by_volume = false;   ///< A0 H0 is the volume that was filled, and stress is taken from the pairs too
    bool planes_pull = false;  ///< faces are placed where planes find enough to hold, and the sample rests there
    bool starts_with_the_flow = false;  ///< particles are given the velocities of a flow that the planes begin
    bool quasi_static = false;          ///< the velocities at which its forces balance can be found (Scheme)
    bool self_contact = true;           ///< its pairs remember whether two surfaces met there
    Damping damping = Damping::drag;    ///< of a sample that comes to rest

    double max_energy_ratio = 1e-5;   ///< at rest: kinetic over elastic energy (docs/relaxation.md)
    double max_force_balance = 1e-3;  ///< at rest: net force over load
    double max_heat = std::numeric_limits<double>::infinity();  ///< kinetic energy over that of the uniform flow

    double neighbour_skin = 0.6;  ///< of LIGGGHTS' ghosts, over the seed radius: larger where particles are hot
    double list_skin = 0.05;      ///< of the vector loops' own lists, over the crown distance

    /// D of the packing that a sample is cut from: that at which the law is calibrated.
    double packing_density = 0.70;
    bool keeps_density = false;  ///< brings every packing to it, and so changes the size of a sample of another one

    std::string less_heat = "strain_per_step";  ///< advice: "take a smaller time_step or ..."
    std::string less_inertia = "a lower rate, a smaller strain_per_step";  ///< advice: "take ... or more particles"
};

/// One law. Objects live as long as the process and have no state.
class Law {
 public:
    virtual ~Law() = default;
    Law(const Law&) = delete;
    Law& operator=(const Law&) = delete;

    const LawTraits& traits() const { return traits_; }
    const std::string& name() const { return traits_.name; }

    /// Reads the keys of [phase.NAME] that are the law's own, and refuses those of other laws.
    virtual void read_phase(TomlReader& reader, Phase& phase) const = 0;
    /// Refuses what is missing or does not go together, once every key has been read.
    virtual void check_phase(const TomlReader& reader, const Phase& phase) const = 0;
    /// Reads the keys of [accuracy] that are the law's own, and refuses those of other laws.
    /// What every law knows (time_step, strain_per_step) has been read.
    virtual void read_accuracy(TomlReader& reader, Scene& scene) const = 0;
    /// Refuses what the law cannot hold in the root of a scene.
    virtual void check_scene(TomlReader& root, const Scene& scene) const;

    /// Reads the law's table of a calibration; null where the law has none.
    virtual std::shared_ptr<const CalibrationWindow> read_calibration(TomlReader& reader) const;

    /// Chooses time step and constants: fills time_step, the phases' pair, period, mass and chi, and what the law keeps
    /// in `constants`. The phases' labels and hardening are there, and everything else of the model.
    /// @throws InvalidInput: out of reach, unstable, a sample that the law cannot hold
    virtual void compile(const Scene& scene, const Packing& sample, Model& model) const = 0;

    /// What the law's calibration says of a phase given by norton: fills rate, packings, rates, time_step and outside.
    /// @return what was measured with which samples
    virtual const CalibrationWindow& expect(const Scene& scene, const Phase& phase, const PhaseModel& constants,
                                            const Model& model, ExpectedFlow& found) const;

    /// What set the time step, in words.
    virtual std::string time_step_reason(const Scene& scene, const Model& model) const;
    /// Warns of what a scene asks for and the law does badly.
    virtual void warn(const Scene& scene, const Model& model, Reporter& reporter) const;
    /// Of the steps while a sample comes to rest [s].
    virtual double relaxation_time_step(const Model& model) const;
    /// Computations of all pair forces that so many steps of a load take, from its start: one each, of explicit ones.
    virtual double evaluations(const Model& model, double steps) const;
    /// Of the same, a step while a sample comes to rest.
    virtual double evaluations_at_rest(const Model& model) const;
    /// Time steps of one period of a relaxation.
    virtual double steps_of_a_relaxation_period(const Model& model) const;

 protected:
    explicit Law(LawTraits traits) : traits_(std::move(traits)) {}

 private:
    LawTraits traits_;
};

/// Every law, those of tomodem first.
const std::vector<const Law*>& laws();

/// The law of that name; null if there is none.
const Law* find_law(std::string_view name);

/// Makes another law known: before main(), from a static object of the file that holds it.
struct LawRegistration {
    explicit LawRegistration(const Law& law);
};

/// The laws of tomodem, each in a file of its own in core/scene/laws/.
const Law& bilin_law();
const Law& trilin_law();
const Law& norton_law();

}  // namespace tomodem
