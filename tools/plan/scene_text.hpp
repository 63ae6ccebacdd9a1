#pragma once
#include <string>

#include "core/scene/scene.hpp"

namespace tomodem::plan {

/// The setting that a plan chooses in a scene.
struct SceneChoice {
    std::string law = "bilin";
    double step = 0;  ///< strain_per_step
};

/// The user's text with the law of every phase, and what chooses the time step, replaced; everything else, comments
/// too, stays byte by byte. What chose the time step before (a number for time_step too) is taken out, and where the
/// steps become quasi-static the window of averaging.
///
/// @param name  stands for the scene in errors
/// @throws InvalidInput as parse_scene, of the text or of what it would become; or if the keys stand where they cannot
///         be replaced
std::string with_choice(const std::string& text, const SceneChoice& choice, const std::string& name);

/// The scene as it is or, if its law cannot carry it, as another law would: phases and load are what counts.
/// @throws InvalidInput what is wrong with the text as it is, if no law can
Scene readable_scene(const std::string& text, const std::string& name);

}  // namespace tomodem::plan
