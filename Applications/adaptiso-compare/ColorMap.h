#pragma once

#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso {

/// The colour map viridis, dark violet at 0 to yellow at 1: ten samples of matplotlib's table,
/// linear in between. Values beyond 0 and 1 get the end's colour.
Color viridis(double part);

}  // namespace adaptiso
