#include "adaptiso/MeshIO/CoordinateFrame.h"

#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {

namespace {

constexpr std::array kFrames{CoordinateFrame::Ras, CoordinateFrame::Lps, CoordinateFrame::TkRas,
                             CoordinateFrame::Voxel};
constexpr std::string_view kMarker = "CoordinateFrame: ";

}  // namespace

std::string_view toString(CoordinateFrame frame) {
    constexpr const char* kWords[] = {"RAS mm", "LPS mm", "tkRAS mm", "voxel indices"};
    return kWords[static_cast<std::size_t>(frame)];
}

std::string frameMarker(CoordinateFrame frame) {
    return std::string(kMarker).append(toString(frame));
}

std::optional<CoordinateFrame> findFrameMarker(std::string_view text) {
    const std::size_t begin = text.find(kMarker);
    if (begin == std::string_view::npos) return std::nullopt;
    const std::string_view name = text.substr(begin + kMarker.size());
    for (const CoordinateFrame frame : kFrames) {
        if (name.starts_with(toString(frame))) return frame;
    }
    return std::nullopt;
}

std::optional<CoordinateFrame> parseCoordinateFrame(std::string_view name) {
    for (const CoordinateFrame frame : kFrames) {
        if (name == toString(frame)) return frame;
    }
    return std::nullopt;
}

std::string_view slicerName(CoordinateFrame frame) {
    return frame == CoordinateFrame::Ras ? "RAS" : frame == CoordinateFrame::Lps ? "LPS" : "";
}

std::string slicerMarker(CoordinateFrame frame) {
    const std::string_view name = slicerName(frame);
    return name.empty() ? std::string() : "SPACE=" + std::string(name);
}

namespace {

constexpr AffineTransform kLpsToRas{Mat3::diagonal(-1, -1, 1), {}};

// Cosine between two axes still taken for a right angle: directions written with six digits
// (DICOM) or as float (NIfTI) stay below 1e-5, gantry tilts start at 1e-2.
constexpr double kMaxAxisCosine = 1e-4;

const ImageGeometry& requireVolume(CoordinateFrame frame,
                                   const std::optional<ImageGeometry>& volume) {
    if (!volume) {
        throw InvalidInput("coordinates in the frame '" + std::string(toString(frame)) +
                           "' need the geometry of the volume they belong to");
    }
    if (!(volume->voxelVolumeMm3() > 0) || !std::isfinite(volume->voxelVolumeMm3()) ||
        !std::isfinite(squaredNorm(volume->originMm))) {
        throw InvalidInput("the volume's axes span no volume (voxel volume " +
                           formatShort(volume->voxelVolumeMm3()) + " mm3)");
    }
    return *volume;
}

}  // namespace

bool hasRightAngles(const ImageGeometry& volume) {
    const auto& axes = volume.indexToPhysical.column;
    for (int a = 0; a < 3; ++a) {
        const double cosine = dot(normalized(axes[a]), normalized(axes[(a + 1) % 3]));
        if (!(std::abs(cosine) <= kMaxAxisCosine)) return false;
    }
    return true;
}

AffineTransform indexToTkRas(const ImageGeometry& volume) {
    for (const std::int64_t extent : volume.size) {
        if (extent < 1) {
            throw InvalidInput("the volume has " + std::to_string(extent) +
                               " voxels along an axis, must have at least 1");
        }
    }
    if (!hasRightAngles(volume)) {
        throw InvalidInput(
            "the volume's axes are not at right angles, and tkRAS can't express "
            "shear; write RAS, or use the conformed volume's geometry");
    }
    const Vec3 d = volume.spacingMm();
    const auto half = [&](int axis) {
        return d[axis] * static_cast<double>(volume.size[axis]) / 2;
    };
    return {{{{{-d.x, 0, 0}, {0, 0, -d.y}, {0, d.z, 0}}}}, {half(0), -half(2), half(1)}};
}

ImageGeometry conformedGeometry(const ImageGeometry& volume) {
    const Vec3 centreIndex{static_cast<double>(volume.size[0]) / 2,
                           static_cast<double>(volume.size[1]) / 2,
                           static_cast<double>(volume.size[2]) / 2};
    ImageGeometry conformed{{256, 256, 256}, {}, {{{{1, 0, 0}, {0, 0, -1}, {0, -1, 0}}}}};
    conformed.originMm =
        volume.toPhysical(centreIndex) - conformed.indexToPhysical * Vec3{128, 128, 128};
    return conformed;
}

ImageGeometry standInVolume() {
    return conformedGeometry({});
}

ImageGeometry frameVolume(CoordinateFrame frame, const ImageGeometry& image) {
    return frame == CoordinateFrame::TkRas && !image.isMirrored() ? conformedGeometry(image)
                                                                  : image;
}

AffineTransform lpsToFrame(CoordinateFrame frame, const std::optional<ImageGeometry>& volume) {
    switch (frame) {
        case CoordinateFrame::Lps:
            return {};
        case CoordinateFrame::Ras:
            return kLpsToRas;
        case CoordinateFrame::Voxel:
        case CoordinateFrame::TkRas: {
            const ImageGeometry& geometry = requireVolume(frame, volume);
            const AffineTransform lpsToIndex =
                inverse(AffineTransform{geometry.indexToPhysical, geometry.originMm});
            return frame == CoordinateFrame::Voxel ? lpsToIndex
                                                   : indexToTkRas(geometry) * lpsToIndex;
        }
    }
    throw InternalError("lpsToFrame: unknown coordinate frame");
}

TriangleMesh transformed(const TriangleMesh& mesh, const AffineTransform& transform) {
    TriangleMesh moved = mesh;
    if (transform == AffineTransform{}) return moved;
    for (Vec3& point : moved.points) point = transform(point);
    // a normal is the gradient of a function that grows outward: it moves as gradients do
    const Mat3 gradientMove = transpose(inverse(transform.linear));
    for (Normal& normal : moved.normals) normal = toNormal(gradientMove * toVec3(normal));
    if (determinant(transform.linear) < 0) {
        for (Triangle& triangle : moved.triangles) std::swap(triangle[1], triangle[2]);
    }
    return moved;
}

TriangleMesh toFrame(const TriangleMesh& mesh, CoordinateFrame frame,
                     const std::optional<ImageGeometry>& volume) {
    return transformed(mesh, lpsToFrame(frame, volume));
}

TriangleMesh fromFrame(const TriangleMesh& mesh, CoordinateFrame frame,
                       const std::optional<ImageGeometry>& volume) {
    return transformed(mesh, inverse(lpsToFrame(frame, volume)));
}

}  // namespace adaptiso
