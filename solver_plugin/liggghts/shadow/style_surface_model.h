// See README.md in this folder.
#include "surface_model_default.h"
