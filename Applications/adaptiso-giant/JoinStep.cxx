#include <algorithm>
#include <ostream>

#include "Common/Json.h"
#include "Common/ProgramRun.h"
#include "Common/RunApp.h"
#include "Common/Verdict.h"
#include "PieceJoiner.h"
#include "Steps.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Files/AtomicOutput.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/Report/Page.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso::giant {
namespace fs = std::filesystem;

namespace {

constexpr std::int64_t kPreviewTriangles = 200'000;

Json componentJson(const GiantComponent& component) {
    return {{"volumeMm3", number(component.volumeMm3)}, {"areaMm2", number(component.areaMm2)},
            {"triangles", component.triangles},         {"vertices", component.vertices},
            {"eulerNumber", component.eulerNumber()},   {"cavity", component.isCavity()}};
}

Json reportOf(const GiantPlan& plan, const GiantSurface& surface, const GiantOptions& options) {
    const GiantTotals& totals = surface.totals;
    Json image{{"file", baseName(plan.input)}, {"format", plan.format}};
    image.update(geometryJson(plan.geometry));
    image["pixelType"] = toString(plan.pixelType);
    Json components = Json::array();
    for (const GiantComponent& component : surface.components) {
        components.push_back(componentJson(component));
    }
    return {{"schema", "adaptiso-giant/1"},
            {"version", plan.version},
            {"input", image},
            {"isovalue", plan.isovalue},
            {"method", toString(plan.method)},
            {"maxErrorMm", plan.isAdaptive() ? Json(plan.maxErrorMm) : Json(nullptr)},
            {"errorBoundMm", plan.isAdaptive() ? Json(surface.errorBoundMm) : Json(nullptr)},
            {"tileSide", plan.side},
            {"pieces", surface.pieces},
            {"emptyPieces", surface.emptyPieces},
            {"unchangedPieces", surface.unchangedPieces},
            {"vertices", surface.vertices},
            {"triangles", surface.triangles},
            {"closed", surface.openEdges == 0},
            {"areaMm2", number(totals.areaMm2)},
            {"volumeMm3", number(totals.volumeMm3)},
            {"genus", totals.genus},
            {"componentCount", totals.count},
            {"cavities", totals.cavities},
            {"components", components},
            {"output", options.output.empty() ? Json(nullptr) : Json(baseName(options.output))},
            {"coordinates", frameWord(options.frame)}};
}

MeshWriteOptions writeOptions(const GiantPlan& plan, const GiantOptions& options) {
    MeshWriteOptions write;
    write.frame = options.frame;
    write.volume = frameVolume(options.frame, plan.geometry);
    return write;
}

/// A piece as the file has it.
TriangleMesh inFrame(const Piece& piece, const GiantPlan& plan, const MeshWriteOptions& write) {
    return toFrame(physicalMesh(piece.mesh, plan.geometry), write.frame, write.volume);
}

void writePly(const PieceJoiner& joiner, const GiantPlan& plan, const MeshWriteOptions& write,
              const fs::path& path) {
    const GiantSurface& surface = joiner.surface();
    PlyStream stream(path, write, surface.vertices, surface.triangles, true);
    joiner.forEachPiece([&](const Piece& piece, const auto&, const auto& isNew) {
        const TriangleMesh mesh = inFrame(piece, plan, write);
        for (std::size_t v = 0; v < isNew.size(); ++v) {
            if (isNew[v] != 0) stream.addPoint(mesh.points[v], mesh.normals[v]);
        }
    });
    joiner.forEachPiece([&](const Piece& piece, const auto& number, const auto&) {
        for (const auto& [a, b, c] : inFrame(piece, plan, write).triangles) {
            stream.addTriangle({number[a], number[b], number[c]});
        }
    });
    stream.finish();
}

/// ParaView's list of pieces: what is in them, and where they lie.
std::string pvtpOf(const std::string& folder, const std::vector<std::string>& pieces) {
    std::string text =
        "<?xml version=\"1.0\"?>\n"
        "<VTKFile type=\"PPolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\">\n"
        "  <PPolyData GhostLevel=\"0\">\n"
        "    <PPointData Normals=\"Normals\">\n"
        "      <PDataArray type=\"Float32\" Name=\"Normals\" NumberOfComponents=\"3\"/>\n"
        "    </PPointData>\n"
        "    <PPoints>\n"
        "      <PDataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"/>\n"
        "    </PPoints>\n";
    for (const std::string& piece : pieces) {
        text += "    <Piece Source=\"" + folder + "/" + piece + "\"/>\n";
    }
    return text + "  </PPolyData>\n</VTKFile>\n";
}

/// The folder beside a .pvtp that its pieces are in.
fs::path piecesFolder(const fs::path& pvtp) {
    fs::path folder = pvtp;
    return folder.replace_extension();
}

bool isPieceName(std::string_view name) {
    constexpr std::string_view kEnding = ".vtp";
    return name.ends_with(kEnding) && placeOf(name.substr(0, name.size() - kEnding.size()));
}

void writePieces(const PieceJoiner& joiner, const GiantPlan& plan, const MeshWriteOptions& write,
                 const fs::path& target, AtomicOutput& list) {
    AtomicFolder folder(piecesFolder(target), OwnNames(isPieceName));
    std::vector<std::string> names;
    folder.fill([&] {
        joiner.forEachPiece([&](const Piece& piece, const auto&, const auto&) {
            names.push_back(piece.summary.id + ".vtp");
            writeMesh(physicalMesh(piece.mesh, plan.geometry), folder.place(names.back()), write);
        });
    });
    list.writeText(pvtpOf(piecesFolder(target).filename().string(), names));
    folder.commit({&list, 1});
}

/// A coarse copy to be looked at, made of coarse pieces.
TriangleMesh previewOf(const PieceJoiner& joiner, const GiantPlan& plan) {
    constexpr double kBefore = 4;  // what is kept before the last pass
    TriangleMesh all;
    const auto total = static_cast<double>(joiner.surface().triangles);
    joiner.forEachPiece([&](const Piece& piece, const auto&, const auto&) {
        const double share = static_cast<double>(piece.summary.triangles) / total;
        const auto most = static_cast<std::int64_t>(kBefore * kPreviewTriangles * share) + 16;
        const TriangleMesh coarse = coarserMesh(physicalMesh(piece.mesh, plan.geometry), most);
        const VertexId first = std::ssize(all.points);
        all.points.insert(all.points.end(), coarse.points.begin(), coarse.points.end());
        for (const auto& [a, b, c] : coarse.triangles) {
            all.triangles.push_back({first + a, first + b, first + c});
        }
    });
    return coarserMesh(all, kPreviewTriangles);
}

void printText(const Json& report, std::ostream& out) {
    out << formatCount(report["triangles"].get<long long>()) << " triangles, "
        << formatCount(report["componentCount"].get<long long>()) << " components, "
        << formatCount(report["cavities"].get<long long>()) << " of them cavities, genus "
        << report["genus"] << ", area " << formatShort(report["areaMm2"].get<double>())
        << " mm2, volume " << formatShort(report["volumeMm3"].get<double>()) << " mm3\n";
}

void requireClosed(const GiantSurface& surface) {
    if (surface.openEdges == 0) return;
    throw InvalidInput("the pieces do not fit together at " + formatCount(surface.openEdges) +
                       " edges; the image was changed between the steps: run all of them again");
}

constexpr std::size_t kMostRows = 50;  // components in the page's table

std::vector<ReportFact> inputsOf(const GiantPlan& plan, const Json& json) {
    const Index3& size = plan.geometry.size;
    const Vec3 spacing = plan.geometry.spacingMm();
    return {
        {"image", json.at("input").at("file").get<std::string>() + ", " + plan.format},
        {"size", formatCount(size[0]) + " x " + formatCount(size[1]) + " x " +
                     formatCount(size[2]) + " voxels, " + std::string(toString(plan.pixelType))},
        {"spacing", formatShort(spacing.x) + " x " + formatShort(spacing.y) + " x " +
                        formatShort(spacing.z) + " mm"}};
}

std::vector<ReportFact> optionsOf(const GiantPlan& plan) {
    std::vector<ReportFact> facts{{"isovalue", formatNumber(plan.isovalue)},
                                  {"method", std::string(toString(plan.method))},
                                  {"tiles", std::to_string(plan.side) + " cells a side"}};
    if (plan.isAdaptive()) facts.emplace_back("bound", formatShort(plan.maxErrorMm) + " mm");
    return facts;
}

std::vector<ReportCheck> checksOf(const GiantPlan& plan, const GiantSurface& surface) {
    std::vector<ReportCheck> checks{{"the surface", "closed over all pieces", ReportOutcome::Passed,
                                     "every edge on a border has found its partner"}};
    if (plan.isAdaptive()) {
        checks.push_back({"the surface", "within the bound", ReportOutcome::Passed,
                          formatShort(surface.errorBoundMm) + " mm proved, both ways"});
    }
    return checks;
}

ReportTable totalsOf(const GiantSurface& surface, const Json& json) {
    const auto measure = [&](const char* key) { return formatShort(json.at(key).get<double>()); };
    return {"The whole surface",
            {"", ""},
            {{"triangles", formatCount(surface.triangles)},
             {"vertices", formatCount(surface.vertices)},
             {"components", formatCount(surface.totals.count)},
             {"of them cavities", formatCount(json.at("cavities").get<long long>())},
             {"genus", formatCount(json.at("genus").get<long long>())},
             {"area, mm2", measure("areaMm2")},
             {"volume, mm3", measure("volumeMm3")},
             {"pieces", formatCount(surface.pieces)},
             {"pieces left as they were", formatCount(surface.unchangedPieces)}}};
}

ReportTable componentsOf(const GiantSurface& surface) {
    ReportTable table{
        "The largest components", {"", "volume, mm3", "area, mm2", "triangles", "genus"}, {}};
    for (const GiantComponent& component : surface.components) {
        if (table.rows.size() == kMostRows) break;
        table.rows.push_back({std::to_string(table.rows.size() + 1),
                              formatShort(component.volumeMm3), formatShort(component.areaMm2),
                              formatCount(component.triangles), formatCount(component.genus())});
    }
    return table;
}

/// The report that the page shows.
/// \param json    the report of the join
/// \param coarse  a copy of the surface that a browser can show, LPS mm
Report giantReport(const GiantPlan& plan, const GiantSurface& surface, const Json& json,
                   TriangleMesh coarse) {
    Report report;
    report.title = "Surface of a large volume";
    report.verdict = ReportVerdict::Passed;
    report.headline = formatCount(surface.triangles) + " triangles in " +
                      formatCount(surface.totals.count) + " components, closed";
    report.inputs = inputsOf(plan, json);
    report.options = optionsOf(plan);
    report.checks = checksOf(plan, surface);
    report.tables = {totalsOf(surface, json), componentsOf(surface)};
    report.warnings = linesOf(plan.warnings);
    report.notes.push_back("shown is a coarse copy of " +
                           formatCount(std::ssize(coarse.triangles)) +
                           " triangles, which may cross; all numbers are those of the surface");
    report.surfaces.push_back({"a coarse copy", std::move(coarse)});
    return report;
}

bool hasPieces(const GiantOptions& options) {
    return options.output.extension() == ".pvtp";
}

}  // namespace

void checkJoinOutputs(const GiantOptions& options, const fs::path& input) {
    OutputPlan planned({&input, 1});
    if (!options.output.empty()) planned.add("--output", options.output);
    if (!options.preview.empty()) planned.add("--preview", options.preview);
    planned.check(options.common, options.report);
    if (hasPieces(options)) {
        AtomicFolder::check(piecesFolder(options.output), OwnNames(isPieceName));
    }
}

int runJoinStep(const GiantOptions& options, const std::string& key) {
    const ThreadLimit threads(options.common);
    const GiantPlan plan = readPlan(options.work);
    if (!key.empty() && keyOf(plan) != key) {
        throw InvalidInput(options.work.string() +
                           ": another plan was made there meanwhile; give each surface a folder of "
                           "its own");
    }
    const bool isPieces = hasPieces(options);
    checkJoinOutputs(options, plan.input);
    ProgressLine progress(options.common.isQuiet);
    progress.show("join");
    const PieceJoiner joiner(options.work, plan);
    requireClosed(joiner.surface());
    const bool isEmpty = joiner.surface().triangles == 0;
    if (isEmpty &&
        !(options.output.empty() && options.preview.empty() && !options.report.isWanted())) {
        throw InvalidInput("no surface: no sample reaches the isovalue " +
                           formatNumber(plan.isovalue) + ", so no file is written");
    }
    const MeshWriteOptions write = writeOptions(plan, options);
    const Json report = reportOf(plan, joiner.surface(), options);
    ReportResult page;
    std::vector<AtomicOutput> outputs;
    if (!options.preview.empty() || options.report.isWanted()) {
        TriangleMesh coarse = previewOf(joiner, plan);
        if (!options.preview.empty()) {
            outputs.emplace_back(options.preview).write([&](const fs::path& path) {
                writeMesh(coarse, path, write);
            });
        }
        if (options.report.isWanted()) {
            page = writeReport(
                [&] { return giantReport(plan, joiner.surface(), report, std::move(coarse)); },
                kGiantProgram, options.report, outputs);
        }
    }
    if (!options.output.empty() && !isPieces) {
        outputs.emplace_back(options.output).write([&](const fs::path& path) {
            writePly(joiner, plan, write, path);
        });
    }
    if (isPieces) {
        AtomicOutput list(options.output);
        writePieces(joiner, plan, write, options.output, list);
    }
    progress.clear();
    AtomicOutput::commit(outputs);
    Verdict verdict;
    verdict.failReport(page.failure);
    std::vector<Warning> warnings;
    addWarnings(warnings, plan.warnings, baseName(plan.input));
    Json whole = reportHead("adaptiso-giant/1", kGiantProgram, verdict, warnings);
    whole.update(report);
    deliverReport(options.common, plan.input, jsonText(whole) + "\n",
                  [&](std::ostream& out) { printText(report, out); });
    return printVerdict(kGiantProgram, verdict, "the surface is joined");
}

}  // namespace adaptiso::giant
