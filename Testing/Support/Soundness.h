#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::testing {

/// What isSound forgives.
struct SoundnessOptions {
    /// Boundary edges are allowed, but only with both ends on one border face of this volume: at
    /// index 0 or size - 1 of the same axis, to within 1e-6 of an index.
    std::optional<ImageGeometry> openAtBorderOf = {};
    /// nestingOf() of the mesh is to be this.
    std::optional<std::string> nesting = {};
};

/// The pieces of a mesh as brackets around those that lie in them, alike for meshes whose pieces
/// lie in each other alike: "([][])" is an outward piece around two inward ones. "|" is an open
/// piece, "<>" one of no volume.
///
/// A piece lies in those that a line upwards (along z, a little aslant) from its first triangle
/// passes an odd number of times.
/// \param opensHold  as well, not closed ones alone: sheets from border to border
std::string nestingOf(const TriangleMesh& mesh, bool opensHold = false);

/// Open at the border of a volume with this geometry and nowhere else.
SoundnessOptions openOnlyAtBorder(const ImageGeometry& geometry);

/// The check that every test makes of every mesh it builds: a closed, oriented 2-manifold fit for
/// use. A failure says what is wrong and where, the first few of each kind.
///
/// Every edge lies in exactly two triangles that run along it in opposite directions; the
/// triangles of every vertex form one fan; indices lie in range, coordinates are finite; no
/// triangle comes twice or has no area (an altitude below 1e-9 of its longest edge); no vertex is
/// unused; normals, if any, are one a point and of length 1; pieces nest as asked for. An empty
/// mesh is sound.
/// Shares no code with MeshQuality's checkTopology, so that each can catch the other out.
::testing::AssertionResult isSound(const TriangleMesh& mesh, const SoundnessOptions& options = {});

/// EXPECT_TRUE(isSound(mesh, options)), reported at the caller's line.
void expectSound(const TriangleMesh& mesh, const SoundnessOptions& options = {},
                 const char* file = __builtin_FILE(), int line = __builtin_LINE());

}  // namespace adaptiso::testing
