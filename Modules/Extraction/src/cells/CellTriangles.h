#pragma once

#include "adaptiso/Extraction/detail/CellFans.h"
#include "lattice/LatticeSampler.h"

namespace adaptiso::detail {

CellCrossings crossingsOfCell(const LatticeSampler& sampler, const Index3& lowSample,
                              const BoxCase& boxCase);

}  // namespace adaptiso::detail
