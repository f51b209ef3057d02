#include "TextReport.h"

#include <ostream>
#include <string>
#include <string_view>

#include "Common/Numbers.h"
#include "Common/PreprocessingOptions.h"
#include "Common/RunApp.h"

namespace adaptiso {
namespace {

/// "1 piece", "3 pieces".
std::string counted(std::int64_t count, const std::string& what) {
    return formatCount(count) + " " + what + (count == 1 ? "" : "s");
}

void printSurface(std::ostream& out, const MeshRun& run, const SurfaceSummary& surface) {
    const bool isWritten = !run.failsStrict();
    const TopologyReport& topology = surface.topology;
    out << oneLine(surface.file.string()) << (isWritten ? "" : " (not written)") << ": isovalue "
        << (surface.isAutomatic ? formatShort(surface.isovalue) : formatNumber(surface.isovalue))
        << (surface.isAutomatic ? " (chosen by Otsu's method)" : "") << ", " << surface.format->name
        << ", " << toString(surface.frame) << '\n';
    out << "  " << counted(topology.triangles, "triangle") << ", " << formatCount(topology.vertices)
        << " vertices, " << counted(std::ssize(topology.components), "component")
        << "; marching cubes makes " << formatCount(surface.statistics.marchingCubesTriangles)
        << '\n';
    if (surface.volumeMm3) {
        out << "  closed, area " << formatMeasure(surface.areaMm2) << " mm2, volume "
            << formatMeasure(*surface.volumeMm3) << " mm3\n";
    } else {
        out << "  open at the border of the image ("
            << counted(topology.count(TopologyDefect::BoundaryEdge), "edge") << "), area "
            << formatMeasure(surface.areaMm2) << " mm2\n";
    }
    if (const auto boundMm = surface.errorBoundMm()) {
        out << "  no point farther than " << formatBound(*boundMm)
            << " mm from the surface of marching cubes, nor "
            << (surface.isPart ? "the pieces kept of it" : "it") << " from this one (proved";
        if (surface.verification) {
            out << "; farthest of " << formatCount(surface.verification->samples)
                << " points measured: " << formatLength(surface.verification->maxMm, 4) << " mm";
        }
        out << ")\n";
    }
    if (!surface.countMet().value_or(true)) {
        out << "  " << formatCount(*surface.statistics.wantedTriangles)
            << " triangles were asked for; "
            << (run.options.adaptive.maxErrorMm
                    ? "the bound of --max-error does not allow as few\n"
                    : "keeping all its pieces and holes left little to gain\n");
    }
    if (surface.insideOutPieces.value_or(0) > 0) {
        out << "  " << counted(*surface.insideOutPieces, "piece") << " inside out\n";
    }
    if (surface.crossingPairs) {
        out << "  " << counted(*surface.crossingPairs, "pair") << " of triangles cross\n";
    }
}

}  // namespace

void printReport(std::ostream& out, const MeshRun& run) {
    if (run.preprocessed) {
        const Index3& size = run.preprocessed->geometry.size;
        out << "from " << preprocessingText(run.options.preprocessing, run.input.geometry.size)
            << ": " << size[0] << " x " << size[1] << " x " << size[2] << " voxels, "
            << toString(run.preprocessed->pixelType) << '\n';
    }
    for (const SurfaceSummary& surface : run.surfaces) printSurface(out, run, surface);
    printTimes(out, run.timer);
}

}  // namespace adaptiso
