#pragma once

#include "Pipeline.h"

namespace adaptiso {

/// Runs adaptiso-mesh for each of many inputs. \return, \throws as runBatch()
int runMeshBatch(const MeshOptions& options);

}  // namespace adaptiso
