#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/expected_flow.hpp"
#include "tools/plan/features.hpp"
#include "tools/plan/scene_text.hpp"
#include "tools/plan/trade_table.hpp"

namespace tomodem::plan {

/// What is wanted of a simulation.
struct PlanRequest {
    std::string scene_text, scene_name;
    double error = 0;                ///< share
    std::vector<Quantity> of;        ///< each within the error; empty: all that the image and the scene have
    bool smallest = false;           ///< the smallest feature is resolved, not the median one
    std::optional<std::string> law;  ///< no other
};

struct PredictedError {
    Quantity quantity = Quantity::flow_stress;
    double resolution = 0;  ///< particles across the feature, of flow_stress particles
    ErrorParts parts;
};

/// A setting with what it costs.
struct Proposal {
    SceneChoice choice;
    std::string scene;                    ///< the user's text with that choice
    double density = 0, seed_radius = 0;  ///< of the brick; [mm]
    double particles = 0;
    double time_step = 0;                         ///< s
    std::int64_t steps = 0, evaluations = 0;      ///< evaluations of the pair forces, of quasi-static steps
    double cpu_seconds = 0, prepare_seconds = 0;  ///< of solve; of filling and relaxing
    double bytes = 0;
    std::vector<PredictedError> errors;
    std::vector<ExpectedFlow> flows;  ///< what the calibration says of each phase
    double error() const;             ///< the largest
};

struct Plan {
    std::vector<Quantity> of;
    std::vector<std::string> left_out;  ///< what the image has and no error is known of, and why; a sentence each
    Proposal proposal;                  ///< the cheapest that keeps within the error
    std::vector<std::pair<std::string, std::string>> not_taken;  ///< laws that cannot hold the scene, and why
    std::vector<Proposal> other_laws;                            ///< the cheapest of each other law within the error
};

/// Why the image's pores cannot be filled and carved out again (docs/relaxation.md); nothing: they can.
std::optional<std::string> not_carved(const ImageFeatures& image, const Scene& scene);

/// What `of` is when the user says nothing: the stress, S_f, pores or struts, by what the image has and the table can
/// judge.
/// @param left_out  gets a sentence for each quantity that cannot be judged
std::vector<Quantity> quantities_of(const ImageFeatures& image, const Scene& scene, const TradeTable& table,
                                    bool smallest, std::vector<std::string>& left_out);

/// A stress that particles of this size cannot carry, and the coarsest ones that were measured to.
struct CoarseStress {
    Quantity quantity = Quantity::flow_stress;
    double resolution = 0, needed = 0;      ///< particles across the feature, of flow_stress particles
    double seed_radius = 0, particles = 0;  ///< of those that would do [mm]
    double cpu_seconds = 0;                 ///< 0: not known
};

/// @param density  of the brick
std::vector<CoarseStress> coarse_stresses(const ImageFeatures& image, const Scene& scene, double seed_radius,
                                          double density, const TradeTable& table);

/// Looks through laws, time steps and resolutions of the table, and what lies between them, for the smallest CPU time.
///
/// If the user did not say what the error is about, and no law has all that the image has, quantities are left out
/// until one has. A law is tried if the scene, with it, parses and compiles: BILIN refuses tension, each law has its M,
/// NORTON does not go with self-contact.
/// @throws InvalidInput if no setting keeps within the error: says what limits it, and an error that can be kept
Plan make_plan(const ImageFeatures& image, const PlanRequest& request, const TradeTable& table);

}  // namespace tomodem::plan
