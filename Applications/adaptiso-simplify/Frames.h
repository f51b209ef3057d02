#pragma once

#include <optional>
#include <string>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshIO/FrameTransform.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso::simplifier {

/// How the points of a file go to those of another.
struct FrameChange {
    CoordinateFrame frame{};              ///< of the output
    bool isSaid = true;                   ///< the output may say so
    std::optional<AffineTransform> move;  ///< none: the points stay as they are, to the bit

    TriangleMesh apply(const TriangleMesh& mesh) const {
        return move ? transformed(mesh, *move) : mesh;
    }
    TriangleMesh undo(TriangleMesh mesh) const {
        return move ? transformed(mesh, inverse(*move)) : std::move(mesh);
    }
};

/// \param input   a file as read
/// \param wanted  none: the input's frame
/// \throws InvalidInput  the file does not say its frame, which the output has to know, or the
/// volume
///                       that a frame belongs to
FrameChange changeFrame(const MeshFile& input, std::optional<CoordinateFrame> wanted,
                        const MeshFormat& output);

/// A frame that a page can show: LPS mm, or what is like it but for where it lies.
struct PageFrame {
    AffineTransform toLps;
    std::string name;  ///< of what points are told in
};

PageFrame pageFrame(const MeshFile& input);

}  // namespace adaptiso::simplifier
