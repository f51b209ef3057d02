#include "TextReport.h"

#include <cmath>
#include <iomanip>
#include <ostream>
#include <sstream>
#include <string>
#include <string_view>

#include "Common/Numbers.h"

namespace adaptiso {
namespace {

std::string fixedText(double value, int digits) {
    std::ostringstream text;
    text << std::fixed << std::setprecision(digits) << value;
    return text.str();
}

std::string rounded(double value) {
    return formatCount(std::llround(value));
}

/// "1 piece", "3 pieces".
std::string counted(std::int64_t count, const std::string& what) {
    return formatCount(count) + " " + what + (count == 1 ? "" : "s");
}

void printSurface(std::ostream& out, const SurfaceSummary& surface) {
    const TopologyReport& topology = surface.topology;
    out << surface.file.string() << ": isovalue " << formatNumber(surface.isovalue)
        << (surface.isAutomatic ? " (chosen by Otsu's method)" : "") << ", " << surface.format->name
        << ", " << toString(surface.frame) << '\n';
    out << "  " << counted(topology.triangles, "triangle") << ", " << formatCount(topology.vertices)
        << " vertices, " << counted(std::ssize(topology.components), "component")
        << "; marching cubes makes " << formatCount(surface.statistics.marchingCubesTriangles)
        << '\n';
    if (surface.volumeMm3) {
        out << "  closed, area " << rounded(surface.areaMm2) << " mm2, volume "
            << rounded(*surface.volumeMm3) << " mm3\n";
    } else {
        out << "  open at the border of the image ("
            << counted(topology.count(TopologyDefect::BoundaryEdge), "edge") << "), area "
            << rounded(surface.areaMm2) << " mm2\n";
    }
    if (surface.crossingPairs) {
        out << "  " << counted(*surface.crossingPairs, "pair") << " of triangles cross\n";
    }
}

}  // namespace

void printReport(std::ostream& out, const MeshRun& run) {
    for (const SurfaceSummary& surface : run.surfaces) printSurface(out, surface);
    out << fixedText(run.timer.total(), 2) << " s (";
    std::string_view separator;
    for (const auto& [stage, seconds] : run.timer.stages()) {
        out << separator << stage << ' ' << fixedText(seconds, 2);
        separator = ", ";
    }
    out << "), peak memory " << rounded(peakMemoryMb()) << " MB\n";
}

}  // namespace adaptiso
