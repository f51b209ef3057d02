#include <algorithm>
#include <ostream>
#include <string>

#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "Common/PreprocessingOptions.h"
#include "Common/ReportOutput.h"
#include "Common/RunApp.h"
#include "Run.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Json/OptionsJson.h"

namespace adaptiso::mesher {
namespace {

Json inputJson(const MeshRun& run) {
    const InputSummary& input = run.input;
    Json json{{"file", baseName(run.options.input)}};
    json.update(
        imageJson(input.format, input.geometry, input.pixelType, input.range, input.warnings));
    return json;
}

Json optionsJson(const MeshOptions& options) {
    Json json = surfaceOptionsJson(options.extraction, options.index, options.selection);
    json.update(valuesJson(scaleOptions(), options.scale));
    json["threads"] = orNull(options.common.threads);
    json["strict"] = options.common.isStrict;
    return json;
}

Json indexJson(const IndexSummary& index) {
    return {{"search", toString(index.search)}, {"memoryBytes", index.memoryBytes}};
}

MadeSurface madeSurface(const MeshRun& run, const SurfaceSummary& surface) {
    return {surface, run.options.extraction.method, run.options.index.blockSize};
}

Json surfaceJson(const MeshRun& run, const SurfaceSummary& surface) {
    Json json = figuresJson(surfaceFigures(), madeSurface(run, surface));
    json["output"] = {
        {"file", surface.file.filename().string()},
        {"format", surface.format->name},
        {"coordinates", surface.scale == 1 ? Json(frameWord(surface.frame)) : Json(nullptr)},
        {"scale", number(surface.scale)},
        {"bytes", surface.bytes},
        {"written", !run.failsStrict()}};
    return json;
}

/// "1 piece", "3 pieces, 12,718 cavities".
std::string piecesText(const TopologyReport& topology) {
    const std::int64_t cavities = std::ranges::count_if(
        topology.components,
        [](const SurfaceComponent& c) { return c.isClosed() && !c.isOutward(); });
    const std::string pieces = counted(std::ssize(topology.components) - cavities, "piece");
    if (cavities == 0) return pieces;
    return pieces + ", " + counted(cavities, "cavity", "cavities");
}

/// "STL, RAS mm"
std::string formatAndFrame(const SurfaceSummary& surface) {
    return std::string(surface.format->name) + ", " +
           (surface.scale == 1 ? std::string(toString(surface.frame))
                               : "scaled by " + formatNumber(surface.scale));
}

void printSurface(std::ostream& out, const MeshRun& run, const SurfaceSummary& surface) {
    const bool isWritten = !run.failsStrict();
    const TopologyReport& topology = surface.topology;
    out << oneLine(surface.file.string()) << (isWritten ? "" : " (not written)") << ": isovalue "
        << (surface.isAutomatic ? formatShort(surface.isovalue) : formatNumber(surface.isovalue))
        << (surface.isAutomatic ? " (chosen by Otsu's method)" : "") << ", "
        << formatAndFrame(surface) << '\n';
    out << "  " << counted(topology.triangles, "triangle") << ", " << formatCount(topology.vertices)
        << " vertices, " << piecesText(topology) << "; marching cubes makes "
        << formatCount(surface.statistics.marchingCubesTriangles) << '\n';
    if (surface.volumeMm3) {
        out << "  closed, " << formatSizeMm(surface.sizeMm) << ", area "
            << formatMeasure(surface.areaMm2) << " mm2, volume "
            << formatMeasure(*surface.volumeMm3) << " mm3\n";
    } else {
        out << "  open at the border of the image ("
            << counted(topology.count(TopologyDefect::BoundaryEdge), "edge") << "), "
            << formatSizeMm(surface.sizeMm) << ", area " << formatMeasure(surface.areaMm2)
            << " mm2\n";
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
            << (run.options.extraction.adaptive.maxErrorMm
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

std::string nameOf(const SurfaceSummary& surface) {
    return surface.file.filename().string();
}

void addVerdict(const MeshRun& run, Report& report) {
    const std::size_t count = run.surfaces.size();
    report.title = count == 1
                       ? "Surface of " + baseName(run.options.input)
                       : std::to_string(count) + " surfaces of " + baseName(run.options.input);
    std::int64_t crossings = 0, insideOut = 0;
    bool isKnown = true, areClosed = true, areJudged = true;
    for (const SurfaceSummary& surface : run.surfaces) {
        crossings += surface.crossingPairs.value_or(0);
        isKnown = isKnown && surface.crossingPairs.has_value();
        areClosed = areClosed && surface.topology.isClosed();
        areJudged = areJudged && surface.insideOutPieces.has_value();
        insideOut += surface.insideOutPieces.value_or(0);
    }
    report.headline =
        std::string(count == 1 ? "Written: manifold" : "All written: manifold") +
        (!areClosed       ? " and oriented, open at the image's border"
         : !areJudged     ? " and closed"
         : insideOut == 0 ? ", closed and facing outward"
                          : ", closed, " + formatCount(insideOut) +
                                (insideOut == 1 ? " piece" : " pieces") + " inside out");
    report.headline += !isKnown         ? "; crossings were not looked for."
                       : crossings == 0 ? "; no triangle crosses another."
                                        : "; " + counted(crossings, "pair") +
                                              " of triangles cross each other, see below.";
}

void addInputs(const MeshRun& run, Report& report) {
    const InputSummary& input = run.input;
    report.inputs = imageFacts(baseName(run.options.input), input.format, input.geometry);
    report.inputs.push_back({"Samples", std::string(toString(input.pixelType)) + ", " +
                                            formatNumber(input.range.minimum) + " to " +
                                            formatNumber(input.range.maximum)});
}

void addOptions(const MeshRun& run, Report& report) {
    const MeshOptions& options = run.options;
    for (const SurfaceSummary& surface : run.surfaces) {
        report.options.push_back(
            {"Isovalue", formatNumber(surface.isovalue) +
                             (surface.isAutomatic ? " (chosen by Otsu's method)" : "")});
    }
    addOptions(methodOptions(), options.extraction, report.options);
    addOptions(aimOptions(AimedSurface::OfScan), options.extraction.adaptive, report.options);
    addOptions(indexOptions(), options.index, report.options);
    addOptions(pieceOptions(), options.selection, report.options);
    addOptions(scaleOptions(), options.scale, report.options);
}

void addFindings(const SurfaceSummary& surface, Report& report) {
    const TopologyReport& topology = surface.topology;
    const auto add = [&](const std::string& name, bool holds, const std::string& finding) {
        report.checks.push_back(
            {nameOf(surface), name, holds ? ReportOutcome::Passed : ReportOutcome::Noted, finding});
    };
    // no surface is written that is not manifold, oriented and without degenerate triangles
    add("manifold and oriented", topology.isManifold() && topology.isOriented(), "");
    add("closed", topology.isClosed(),
        topology.isClosed() ? ""
                            : formatCount(topology.count(TopologyDefect::BoundaryEdge)) +
                                  " edges at the image's border");
    if (const auto count = surface.insideOutPieces) {
        add("facing outward", *count == 0,
            *count == 0 ? "" : counted(*count, "piece is", "pieces are") + " inside out");
    }
    if (!surface.crossingPairs) return;
    add("no self-intersection", *surface.crossingPairs == 0,
        *surface.crossingPairs == 0
            ? ""
            : formatCount(*surface.crossingPairs) +
                  (*surface.crossingPairs == 1 ? " pair" : " pairs") + " of triangles cross");
}

ReportTable surfaceTable(const MeshRun& run) {
    const auto& rows = surfaceFigures();
    ReportTable table{"Surfaces", figureColumns({"File", "Format, frame"}, rows), {}};
    for (const SurfaceSummary& surface : run.surfaces) {
        table.rows.push_back(figureCells({nameOf(surface), formatAndFrame(surface)}, rows,
                                         madeSurface(run, surface)));
    }
    return table;
}

/// "ball.vtp, 1,234 triangles at 100; ..."
Json resultJson(const MeshRun& run) {
    std::vector<std::string> files;
    const std::string says = joined(
        run.surfaces,
        [&](const SurfaceSummary& surface) {
            if (!run.failsStrict()) files.push_back(surface.file.filename().string());
            return surface.file.filename().string() + ", " +
                   formatCount(surface.topology.triangles) + " triangles at " +
                   formatShort(surface.isovalue);
        },
        "; ");
    return adaptiso::resultJson(says, files);
}

}  // namespace

std::string jsonReport(const MeshRun& run) {
    Json surfaces = Json::array();
    for (const SurfaceSummary& surface : run.surfaces) {
        surfaces.push_back(surfaceJson(run, surface));
    }
    return run.json("adaptiso-mesh/1",
                    {{"input", inputJson(run)},
                     {"preprocessing", preprocessedJson(run.options.preprocessing,
                                                        run.input.geometry.size, run.preprocessed)},
                     {"options", optionsJson(run.options)},
                     {"index", indexJson(run.index)},
                     {"surfaces", surfaces},
                     {"result", resultJson(run)}});
}

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

Report makeReport(MeshRun& run, const VolumeView& volume) {
    Report report;
    addVerdict(run, report);
    addInputs(run, report);
    addOptions(run, report);
    for (std::size_t n = 0; n < run.surfaces.size(); ++n) {
        const SurfaceSummary& surface = run.surfaces[n];
        ShownSurface& shown = run.shown[n];
        addFindings(surface, report);
        SpotClusters clusters(shown.mesh);
        for (const TrianglePair& pair : shown.crossings) {
            clusters.add(middleOf(shown.mesh, pair[0]));
        }
        clusters.tell("crossing triangles in " + nameOf(surface), false, report.spots);
        report.surfaces.push_back({nameOf(surface), std::move(shown.mesh)});
    }
    report.tables.push_back(surfaceTable(run));
    report.volume = ReportVolume{baseName(run.options.input), volume};
    return report;
}

}  // namespace adaptiso::mesher
