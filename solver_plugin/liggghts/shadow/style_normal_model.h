// See README.md in this folder.
#include "solver_plugin/liggghts/wall_model.h"
