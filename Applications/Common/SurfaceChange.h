#pragma once

// What programs share that read a surface and write it changed.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "Common/Json.h"
#include "Common/PrintScale.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/Extraction/PointTransfer.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/Formats.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {

/// A surface as a file has it.
struct SurfaceSummary {
    std::filesystem::path file;
    const MeshFormat* format = nullptr;
    std::optional<CoordinateFrame> frame;  ///< empty: the file does not say
    std::int64_t triangles = 0, vertices = 0;
    TopologyReport topology;
    double areaMm2 = 0;
    double scale = 1;  ///< of an output: of its coordinates
};

/// Sets the numbers and the area.
void summarize(const TriangleMesh& mesh, SurfaceSummary& summary);

/// `input` and `output` of a report.
Json surfaceJson(const SurfaceSummary& surface);

/// "RAS mm", "frame not said"
std::string frameText(const std::optional<CoordinateFrame>& frame);

/// How the points of a file go to those of another.
struct FrameChange {
    CoordinateFrame frame{};              ///< of the output
    bool isSaid = true;                   ///< the output may say so
    std::optional<AffineTransform> move;  ///< empty: the points stay as they are, to the bit

    TriangleMesh apply(const TriangleMesh& mesh) const {
        return move ? transformed(mesh, *move) : mesh;
    }
    TriangleMesh undo(TriangleMesh mesh) const {
        return move ? transformed(mesh, inverse(*move)) : std::move(mesh);
    }
    /// Scales the output; its file then says no frame. Distances stay those of the input.
    void scale(double factor) {
        if (factor == 1) return;
        move = scaled(move.value_or(AffineTransform{}), factor);
        isSaid = false;
    }
    /// Upper bound on the rounding of doubles on the way there and back.
    double roundingMm(const TriangleMesh& mesh) const;
};

/// \param input   a file as read, from `file`
/// \param wanted  empty: the input's frame
/// \throws InvalidInput  the file does not say its frame, which the output has to know, or the
///                       volume that a frame belongs to
/// \throws UsageError    the output's format holds no voxel indices
FrameChange changeFrame(const MeshFile& input, const std::filesystem::path& file,
                        std::optional<CoordinateFrame> wanted, const std::filesystem::path& output);

/// The input's arrays that the output's format holds; warnings name the others.
/// \param from, to  names of the files
std::vector<const PointArray*> heldArrays(const MeshFile& input, const MeshFormat& format,
                                          const std::string& from, const std::string& to,
                                          std::vector<Warning>& warnings);

/// Values at the points of the input as the result has them. Numbers and colours are mixed; whole
/// numbers, which may be labels, are those of the nearest corner.
PointArray transferred(const PointArray& array, const PointTransfer& transfer);

}  // namespace adaptiso
