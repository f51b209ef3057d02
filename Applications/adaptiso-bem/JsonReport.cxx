#include "JsonReport.h"

#include "Common/CommonOptions.h"
#include "Common/Json.h"

namespace adaptiso {
namespace {

Json imageJson(const std::optional<ImageGeometry>& image) {
    if (!image) return nullptr;
    return {{"sizeVoxels", image->size}, {"spacingMm", vector(image->spacingMm())}};
}

Json inputJson(const BemRun& run) {
    Json files = Json::array();
    for (const BemInput& input : run.inputs) {
        files.push_back(
            {{"file", baseName(input.path)}, {"role", input.role}, {"format", input.format}});
    }
    return {{"source", run.source},
            {"files", files},
            {"image", imageJson(run.image)},
            {"warnings", run.warnings}};
}

Json optionsJson(const BemOptions& options) {
    const BoundaryOptions& b = options.boundaries;
    Json edges = nullptr;
    if (options.edgeLengthMm) {
        edges = {options.edgeLengthMm->minimumMm, options.edgeLengthMm->maximumMm};
    }
    return {{"layers", options.surfaceCount()},
            {"vertices", options.vertices.empty() ? Json(nullptr) : Json(options.vertices)},
            {"edgeLengthMm", edges},
            {"minGapMm", {b.minSkullMm, b.minScalpMm}},
            {"smoothingMm", b.smoothingMm},
            {"closingMm", b.closingMm},
            {"cutNecksMm", b.cutNecksMm},
            {"voxelMm", b.stepMm > 0 ? Json(b.stepMm) : Json(nullptr)},
            {"csfMm", b.csfMm},
            {"skullMm", b.skullMm},
            {"maxSkullMm", b.maxSkullMm},
            {"skullHu", b.skullHu},
            {"skinHu", b.skinHu},
            {"conductivity",
             {{"brain", options.conductivities.brain},
              {"skull", options.conductivities.skull},
              {"scalp", options.conductivities.scalp}}},
            {"threads", orNull(options.common.threads)},
            {"strict", options.common.isStrict}};
}

Json remeshJson(const BemSurface& surface) {
    if (!surface.remesh) return nullptr;
    return {{"meanVertexDistanceMm", number(surface.remesh->meanVertexDistanceMm)},
            {"maximumVertexDistanceMm", number(surface.remesh->maximumVertexDistanceMm)}};
}

Json surfaceJson(std::size_t n, const BemSurface& surface) {
    const ShapeReport& shape = surface.shape;
    return {{"name", toString(static_cast<HeadSurface>(n))},
            {"denseTriangles", surface.denseTriangles},
            {"vertices", surface.topology.vertices},
            {"triangles", surface.topology.triangles},
            {"genus", orNull(surface.topology.genus())},
            {"crossingPairs", surface.crossingPairs},
            {"areaMm2", number(surface.areaMm2)},
            {"volumeMm3", number(surface.volumeMm3)},
            {"extentMm", vector(surface.extentMm)},
            {"solidAngleShare", number(surface.solidAngleShare)},
            {"edgeMm",
             {{"minimum", number(shape.edgeMm.minimum)},
              {"mean", number(shape.edgeMm.mean)},
              {"maximum", number(shape.edgeMm.maximum)}}},
            {"minAngleDeg",
             {{"minimum", number(shape.minAngleDeg.minimum)},
              {"p5", number(shape.minAngleDeg.p5)},
              {"median", number(shape.minAngleDeg.median)}}},
            {"remesh", remeshJson(surface)},
            {"nesting",
             {{"movedVertices", surface.move.movedVertices},
              {"maximumMm", number(surface.move.maximumMm)}}}};
}

/// As all points of this report.
std::vector<ToldNote> inLps(std::vector<ToldNote> notes) {
    for (ToldNote& told : notes) {
        told.frame = CoordinateFrame::Lps;
        told.placesMm = told.note.pointsMm;
    }
    return notes;
}

Json gapJson(const NestedGap& gap) {
    return {{"mm", number(gap.mm)},
            {"innerPointMm", vector(gap.innerPointMm)},
            {"outerPointMm", vector(gap.outerPointMm)}};
}

}  // namespace

std::string jsonReport(const BemRun& run) {
    Json surfaces = Json::array(), gaps = Json::array(), checks = Json::array();
    Json findings = Json::array(), files = Json::array(), subject = Json::array();
    for (std::size_t n = 0; n < run.surfaces.size(); ++n) {
        surfaces.push_back(surfaceJson(n, run.surfaces[n]));
    }
    for (const NestedGap& gap : run.gaps) gaps.push_back(gapJson(gap));
    for (const BemCheck& check : run.checks) {
        checks.push_back({{"name", check.name},
                          {"passed", check.isPassed},
                          {"detail", check.detail},
                          {"pointMm", check.pointMm ? vector(*check.pointMm) : Json(nullptr)}});
    }
    for (const Finding& finding : run.findings) {
        findings.push_back({{"what", finding.what}, {"pointMm", vector(finding.pointMm)}});
    }
    for (const auto& [name, bytes] : run.files) {
        files.push_back({{"file", name}, {"bytes", bytes}});
    }
    for (const auto& path : run.subjectFiles) subject.push_back(baseName(path));
    const BemOptions& options = run.options;
    const Json report{{"schema", "adaptiso-bem/1"},
                      {"program", {{"name", "adaptiso-bem"}, {"version", programVersion()}}},
                      {"model", run.hasModel() && !run.failsStrict() && !options.isDryRun},
                      {"failedByWarnings", run.failsStrict()},
                      {"input", inputJson(run)},
                      {"options", optionsJson(options)},
                      {"notes", run.notes},
                      {"surfaces", surfaces},
                      {"gaps", gaps},
                      {"checks", checks},
                      {"plausibility", notesJson(inLps(run.plausibility))},
                      {"findings", findings},
                      {"output",
                       {{"files", files},
                        {"subjectFiles", subject},
                        {"freesurferFrame", run.tkRasVolume ? "tkras" : "ras"},
                        {"coordinates", frameWord(options.frame)},
                        {"openmeegUnit", options.unit == OpenMeegUnit::Metres ? "m" : "mm"}}},
                      {"reportFailure", reportFailureJson(run.reportFailure)},
                      {"seconds", secondsJson(run.timer)},
                      {"peakMemoryMb", peakMemoryMb()}};
    // a file's name need not be UTF-8: what is not becomes U+FFFD
    return report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace adaptiso
