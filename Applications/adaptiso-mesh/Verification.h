#pragma once

#include "MeshRun.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"

namespace adaptiso {

/// Checks what the method adaptive promises by code that it does not use: no two triangles cross,
/// components and Euler characteristic are those of the surface of marching cubes, and points
/// sampled on either surface lie within the proved bound of the other.
/// \param extraction  what the method made, whole
/// \throws InternalError  a promise is broken
Verification verify(const VolumeView& volume, const SpanSpaceIndex& index, double isovalue,
                    const Extraction& extraction);

}  // namespace adaptiso
