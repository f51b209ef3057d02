#include "TextReport.h"

#include <iomanip>
#include <ostream>
#include <string>
#include <string_view>

#include "Common/Numbers.h"

namespace adaptiso::compare {
namespace {

std::string signedPercent(double value, double of) {
    const double percent = (value - of) / of * 100;
    return (percent > 0 ? "+" : "") + formatFixed(percent, 3) + " %";
}

void printSurface(std::ostream& out, std::string_view name, const SurfaceSummary& surface) {
    out << name << "  " << surface.file.string() << ": " << formatCount(surface.triangles)
        << " triangles, area " << formatMeasure(surface.areaMm2) << " mm2, ";
    if (surface.volumeMm3) {
        out << "volume " << formatMeasure(*surface.volumeMm3) << " mm3\n";
    } else {
        out << "not closed\n";
    }
}

using Length = double DistanceStatistics::*;

/// One row of the table: the same figure of every direction.
void printRow(std::ostream& out, std::string_view name, Length length, double unit,
              const DistanceReport& distances) {
    out << "  " << std::left << std::setw(22) << name << std::right;
    for (const DistanceStatistics* direction :
         {&distances.aToB, &distances.bToA, &distances.combined}) {
        if (direction->samples == 0) continue;
        out << std::setw(12) << formatLength(direction->*length / unit, 4);
        if (distances.bToA.samples == 0) break;  // the combined figures are those of A to B
    }
    out << '\n';
}

void printLengths(std::ostream& out, const std::string& unitName, double unit,
                  const DistanceReport& distances) {
    printRow(out, "mean, " + unitName, &DistanceStatistics::meanMm, unit, distances);
    printRow(out, "RMS, " + unitName, &DistanceStatistics::rmsMm, unit, distances);
    printRow(out, "95 % within, " + unitName, &DistanceStatistics::p95Mm, unit, distances);
    printRow(out, "99 % within, " + unitName, &DistanceStatistics::p99Mm, unit, distances);
    printRow(out, "maximum, " + unitName, &DistanceStatistics::maxMm, unit, distances);
}

void printDistances(std::ostream& out, const CompareRun& run) {
    const DistanceReport& distances = run.distances;
    out << "  distance" << std::setw(26) << "A to B";
    if (run.options.isSymmetric) out << std::setw(12) << "B to A" << std::setw(12) << "both";
    out << '\n';
    printLengths(out, "mm", 1, distances);
    if (run.voxelMm) printLengths(out, "voxels", *run.voxelMm, distances);
    const double percentMm = run.b.diagonalMm / 100;
    printRow(out, "mean, % of diagonal", &DistanceStatistics::meanMm, percentMm, distances);
    printRow(out, "maximum, % of diagonal", &DistanceStatistics::maxMm, percentMm, distances);
    printRow(out, "normals, mean degrees", &DistanceStatistics::meanNormalDeviationDeg, 1,
             distances);
    printRow(out, "normals, 95 % within", &DistanceStatistics::p95NormalDeviationDeg, 1, distances);
    const Vec3 farthest = run.toFrame(distances.combined.maxPointMm);
    out << "  farthest at " << formatFixed(farthest.x, 2) << ", " << formatFixed(farthest.y, 2)
        << ", " << formatFixed(farthest.z, 2) << " ("
        << (run.frame ? toString(*run.frame) : "frame not said") << ")\n";
}

void printDifferences(std::ostream& out, const CompareRun& run) {
    out << "  area of A " << signedPercent(run.a.areaMm2, run.b.areaMm2);
    if (run.a.volumeMm3 && run.b.volumeMm3) {
        out << ", volume of A " << signedPercent(*run.a.volumeMm3, *run.b.volumeMm3);
    }
    out << " against B\n";
    if (run.overlap) {
        out << "  Dice " << formatFixed(run.overlap->voxels.dice(), 5) << ", mean boundary offset "
            << formatLength(run.overlap->meanBoundaryOffsetMm, 4) << " mm\n";
    }
}

}  // namespace

void printReport(std::ostream& out, const CompareRun& run) {
    printSurface(out, "A", run.a);
    printSurface(out, "B", run.b);
    printDistances(out, run);
    printDifferences(out, run);
    if (run.colored) {
        out << run.options.colored.string() << ": A with its distances, viridis from 0 to "
            << formatLength(run.colored->maximumMm, 4) << " mm\n";
    }
    printTimes(out, run.timer);
}

}  // namespace adaptiso::compare
