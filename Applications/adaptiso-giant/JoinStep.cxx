#include <algorithm>
#include <ostream>

#include "Common/AtomicOutput.h"
#include "Common/Json.h"
#include "Common/ProgramRun.h"
#include "Common/RunApp.h"
#include "Common/Verdict.h"
#include "PieceJoiner.h"
#include "Steps.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/Report/Page.h"

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

}  // namespace

int runJoinStep(const GiantOptions& options, const std::string& key) {
    const ThreadLimit threads(options.common);
    const GiantPlan plan = readPlan(options.work);
    if (!key.empty() && keyOf(plan) != key) {
        throw InvalidInput(options.work.string() +
                           ": another plan was made there meanwhile; give each surface a folder of "
                           "its own");
    }
    const bool isPieces = options.output.extension() == ".pvtp";
    OutputPlan planned({&plan.input, 1});
    if (!options.output.empty()) planned.add("--output", options.output);
    if (!options.preview.empty()) planned.add("--preview", options.preview);
    planned.check(options.common, options.report);
    if (isPieces) AtomicFolder::check(piecesFolder(options.output), OwnNames(isPieceName));
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
