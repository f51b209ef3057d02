#include "TextReport.h"

#include <ostream>
#include <string>
#include <string_view>

#include "Common/Numbers.h"
#include "Common/RunApp.h"

namespace adaptiso {
namespace {

/// "1 region", "3 regions"
std::string counted(std::int64_t count, const std::string& what) {
    return formatCount(count) + " " + what + (count == 1 ? "" : "s");
}

void printWalls(std::ostream& out, const LabelsRun& run) {
    const LabelStatistics& statistics = run.statistics;
    out << "  " << counted(run.triangles, "triangle") << ", " << formatCount(run.points)
        << " vertices in walls that are stored once; "
        << (run.isPart() ? "the whole map has " + formatCount(statistics.mapTriangles) +
                               ", at full resolution "
                         : "the full resolution has ")
        << formatCount(statistics.fullTriangles) << '\n';
    if (run.errorBoundMm() > 0) {
        out << "  no wall farther than " << formatBound(run.errorBoundMm())
            << " mm from that of the full resolution, nor that from it (proved)\n";
    }
    if (statistics.wantedTriangles && statistics.mapTriangles > *statistics.wantedTriangles) {
        out << "  " << formatCount(*statistics.wantedTriangles) << " triangles were asked for"
            << (run.isPart() ? " in the whole map" : "")
            << "; keeping all regions, pieces and junctions left little to gain\n";
    }
}

}  // namespace

void printReport(std::ostream& out, const LabelsRun& run) {
    out << oneLine(run.folder.string()) << (run.writesFolder() ? "" : " (not written)") << ": "
        << counted(std::ssize(run.regions), "region") << " of "
        << oneLine(run.options.input.filename().string()) << ", " << run.format->name << ", "
        << toString(run.frame) << '\n';
    printWalls(out, run);
    if (run.tetrahedra) {
        out << "  "
            << describeTetrahedra(run.tetrahedra->mesh, run.tetrahedra->report,
                                  run.options.tetrahedra.mesher)
            << '\n';
    }
    for (const LabelsCheck& check : run.checks) {
        out << "  " << (check.isPassed ? "holds:  " : "FAILED: ") << check.name
            << (check.isPassed ? "" : ": " + check.finding) << '\n';
    }
    if (!run.names.files.empty()) {
        out << "  names and colours of " << oneLine(run.names.files.front());
        for (std::size_t n = 1; n < run.names.files.size(); ++n) {
            out << " and " << oneLine(run.names.files[n]);
        }
        out << " (" << run.names.format << ")\n";
    }
    printTimes(out, run.timer);
}

}  // namespace adaptiso
