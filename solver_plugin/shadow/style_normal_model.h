// See README.md in this folder.
#include "solver_plugin/normal_models.h"
