#pragma once

#include "MeshRun.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"

namespace adaptiso {

/// Checks what the method adaptive promises by code that it does not use: no two triangles cross,
/// no piece is inside out, components and Euler characteristic are those of the surface of marching
/// cubes, and points sampled on either surface, with the file's digits, lie within the bound of the
/// other.
/// \param mesh    extractPieces()'s \param record  what that knows of it
/// \throws InternalError  a promise is broken
Verification verify(const VolumeView& volume, const SpanSpaceIndex& index, const TriangleMesh& mesh,
                    const FileDigits& digits, const MeshOptions& options,
                    const SurfaceRecord& record);

}  // namespace adaptiso
