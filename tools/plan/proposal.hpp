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
    double time_step = 0;  ///< s
    std::int64_t steps = 0;
    double cpu_seconds = 0, prepare_seconds = 0;  ///< of solve; of filling and relaxing
    double bytes = 0;
    std::vector<PredictedError> errors;
    std::vector<ExpectedFlow> flows;  ///< what the calibration says of each phase
    double error() const;             ///< the largest
};

struct Plan {
    std::vector<Quantity> of;
    Proposal proposal;                                           ///< the cheapest that keeps within the error
    std::vector<std::pair<std::string, std::string>> not_taken;  ///< laws that cannot hold the scene, and why
    std::vector<Proposal> other_laws;                            ///< the cheapest of each other law within the error
};

/// What `of` is when the user says nothing: the stress, S_f, pores or struts, by what the image has.
std::vector<Quantity> quantities_of(const ImageFeatures& image, const Scene& scene);

/// Looks through laws, time steps and resolutions of the table, and what lies between them, for the smallest CPU time.
///
/// A law is tried if the scene, with it, parses and compiles: BILIN refuses tension, each law has its M, NORTON does
/// not go with self-contact.
/// @throws InvalidInput if no setting keeps within the error: says the smallest that is in reach and what limits it
Plan make_plan(const ImageFeatures& image, const PlanRequest& request, const TradeTable& table);

}  // namespace tomodem::plan
