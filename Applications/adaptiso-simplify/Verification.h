#pragma once

#include "SimplifyRun.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::simplifier {

/// What a surface as written is checked against.
struct VerifiedSurface {
    const TriangleMesh& input;   ///< as read
    const TriangleMesh& result;  ///< as computed, in the input's frame
    TriangleMesh written;        ///< as read again, in the input's frame
    double roundingMm = 0;       ///< at most, between a point of `result` and of `written`
};

/// Checks what is promised of the result, as written, by code that it was not made by: a sound
/// surface has stayed sound, with its pieces and handles, no more triangles cross than before, and
/// points sampled on either surface lie within the proved bound of the other.
/// \param run  with the input's topology and findings, and the statistics; gets the output's
///             topology and the verification
/// \throws InvalidInput   the format has too few digits for the result
/// \throws InternalError  a promise is broken
void verify(const VerifiedSurface& surface, SimplifyRun& run);

}  // namespace adaptiso::simplifier
