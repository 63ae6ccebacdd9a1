#pragma once
// The headers of LIGGGHTS that the plugin uses, in an order that compiles, without their warnings.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#include <mpi.h>

#include "lammps.h"
// lammps.h first
#include "atom.h"
#include "atom_vec.h"
#include "comm.h"
#include "compute.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "input.h"
#include "irregular.h"
#include "modify.h"
#include "neigh_list.h"
#include "neigh_request.h"
#include "neighbor.h"
#include "update.h"
// contact models need all of the above
#include "contact_models.h"
#include "fix_wall_gran_base.h"
#include "global_properties.h"
#include "granular_pair_style.h"
#include "granular_wall.h"
#include "pair_gran.h"
#include "settings.h"
#pragma GCC diagnostic pop
