#include "Common/SurfaceChange.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <variant>

#include "Common/CommonFrame.h"
#include "Common/Naming.h"
#include "Common/RunApp.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/SurfacePipeline/SurfaceJson.h"

namespace adaptiso {
namespace {

FrameChange changeOf(const MeshFile& input, std::optional<CoordinateFrame> wanted,
                     const MeshFormat& output) {
    FrameChange change;
    change.isSaid = input.frame || wanted;
    const CoordinateFrame from = input.frame.value_or(CoordinateFrame::Ras);
    change.frame = wanted.value_or(from);
    if (!input.frame && (wanted || output.defaultFrame == CoordinateFrame::TkRas)) {
        const char* const what = wanted ? "--coordinates" : "FreeSurfer's format";
        throw InvalidInput("does not say its coordinate frame, which " + std::string(what) +
                           " needs" + kStateIt);
    }
    if (change.frame == from) return change;
    for (const CoordinateFrame frame : {from, change.frame}) {
        if (!needsVolume(frame) || input.volume) continue;
        throw InvalidInput("is in " + std::string(toString(from)) +
                           ", and does not say the volume by which it would be in " +
                           std::string(toString(change.frame)));
    }
    change.move = lpsToFrame(change.frame, input.volume) * inverse(lpsToFrame(from, input.volume));
    return change;
}

}  // namespace

void summarize(const TriangleMesh& mesh, SurfaceSummary& summary) {
    summary.triangles = std::ssize(mesh.triangles);
    summary.vertices = std::ssize(mesh.points);
    summary.areaMm2 = surfaceArea(mesh);
}

Json surfaceJson(const SurfaceSummary& surface) {
    const TopologyReport& topology = surface.topology;
    return {{"file", baseName(surface.file)},
            {"format", surface.format->name},
            {"coordinates", frameJson(surface.frame)},
            {"triangles", surface.triangles},
            {"vertices", surface.vertices},
            {"components", std::ssize(topology.components)},
            {"genus", orNull(topology.genus())},
            {"closed", topology.isClosed()},
            {"areaMm2", number(surface.areaMm2)}};
}

std::string frameText(const std::optional<CoordinateFrame>& frame) {
    return frame ? std::string(toString(*frame)) : "frame not said";
}

double FrameChange::roundingMm(const TriangleMesh& mesh) const {
    double largest = 0;
    if (!move) return largest;
    const AffineTransform back = inverse(*move);
    for (const Vec3& p : mesh.points) largest = std::max(largest, norm(back((*move)(p)) - p));
    return largest;
}

FrameChange changeFrame(const MeshFile& input, const std::filesystem::path& file,
                        std::optional<CoordinateFrame> wanted,
                        const std::filesystem::path& output) {
    const MeshFormat& format = meshFormatOf(output);
    const FrameChange change =
        naming(baseName(file), [&] { return changeOf(input, wanted, format); });
    if (change.frame == CoordinateFrame::Voxel && !format.holdsVoxelFrame) {
        throw UsageError(output.string() + ": " + std::string(format.name) +
                         " holds points in mm only, not voxel indices");
    }
    return change;
}

std::vector<const PointArray*> heldArrays(const MeshFile& input, const MeshFormat& format,
                                          const std::string& from, const std::string& to,
                                          std::vector<Warning>& warnings) {
    std::vector<const PointArray*> held;
    std::string others;
    for (const PointArray& array : input.pointArrays) {
        const bool isFirstColor =
            std::holds_alternative<std::vector<Color>>(array.values) && held.empty();
        if (format.holdsPointArrays || (format.holdsColors && isFirstColor)) {
            held.push_back(&array);
        } else {
            addPart(others, array.name);
        }
    }
    if (!others.empty()) {
        warnings.push_back({"array-left-out",
                            std::string(format.name) + " holds no values at points" +
                                (format.holdsColors ? " but colours" : "") +
                                "; left out: " + others,
                            to});
    }
    if (!input.arraysLeftOut.empty()) {
        warnings.push_back({"array-left-out",
                            "values of triangles, text and arrays of more than nine "
                            "components are not carried over; left out: " +
                                joined(input.arraysLeftOut),
                            from});
    }
    return held;
}

PointArray transferred(const PointArray& array, const PointTransfer& transfer) {
    const auto columns = static_cast<std::size_t>(array.components);
    PointArray taken{array.name, {}, array.components};
    if (const auto* const colors = std::get_if<std::vector<Color>>(&array.values)) {
        const std::vector<std::uint8_t> shades = transfer.mixed(colors->front().data(), 3);
        std::vector<Color> mixed(transfer.size());
        for (std::size_t p = 0; p < mixed.size(); ++p) {
            std::copy_n(shades.data() + 3 * p, 3, mixed[p].data());
        }
        taken.values = std::move(mixed);
    } else if (const auto* const numbers = std::get_if<std::vector<double>>(&array.values)) {
        taken.values = transfer.mixed(numbers->data(), columns);
    } else {
        taken.values =
            transfer.nearest(std::get<std::vector<std::int64_t>>(array.values).data(), columns);
    }
    return taken;
}

}  // namespace adaptiso
