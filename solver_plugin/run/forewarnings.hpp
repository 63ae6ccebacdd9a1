#pragma once
#include "core/base/reporter.hpp"
#include "core/packing/packing.hpp"
#include "core/scene/model.hpp"
#include "core/scene/scene.hpp"

namespace tomodem {

struct Continuation;

/// Everything that scene and sample alone give reason to say before the first step: names that differ, what lies
/// outside the calibration, inertia, contrast, hardening. `solve` and `solve --explain` say what stands here, and only
/// that.
/// @param before  the run whose end is the beginning; null: there is none
/// @throws InvalidInput where the planes would jump over particles
void forewarn(const Scene& scene, const Packing& sample, const Model& model, const Continuation* before,
              Reporter& reporter);

/// Warns where a sample was cut from a packing of another density than that to which its law brings every packing:
/// it will change its size as it comes to rest.
void warn_of_density(const Scene& scene, const Packing& sample, Reporter& reporter);

}  // namespace tomodem
