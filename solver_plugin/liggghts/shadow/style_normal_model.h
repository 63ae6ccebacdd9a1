// See README.md in this folder.
#include "solver_plugin/liggghts/normal_models.h"
