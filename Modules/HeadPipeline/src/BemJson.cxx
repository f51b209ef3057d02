#include "adaptiso/HeadPipeline/BemJson.h"

#include "adaptiso/HeadModel/Plausibility.h"
#include "adaptiso/HeadModel/Tetrahedra.h"
#include "adaptiso/HeadPipeline/BemRules.h"
#include "adaptiso/HeadPipeline/TetrahedraJson.h"
#include "adaptiso/Json/OptionsJson.h"
#include "adaptiso/Mending/MendJson.h"

namespace adaptiso {
namespace {

Json imageJson(const std::optional<ImageGeometry>& image) {
    if (!image) return nullptr;
    return {{"sizeVoxels", image->size}, {"spacingMm", vector(image->spacingMm())}};
}

Json remeshJson(const BemSurface& surface) {
    if (!surface.remesh) return nullptr;
    return {{"meanVertexDistanceMm", number(surface.remesh->meanVertexDistanceMm)},
            {"maximumVertexDistanceMm", number(surface.remesh->maximumVertexDistanceMm)}};
}

Json mendingJson(const BemSurface& surface) {
    if (!surface.mending) return nullptr;
    Json json = mendFaultsJson(*surface.mending);
    json["resultToInputMm"] = number(surface.mending->resultToInputMm);
    json["inputToResultMm"] = number(surface.mending->inputToResultMm);
    json.update(mendPlacesJson(*surface.mending));
    return json;
}

Json surfaceJson(const std::string& name, const BemSurface& surface) {
    const ShapeReport& shape = surface.shape;
    return {
        {"name", name},
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
         {{"minimum", number(shape.angleDeg.minimum)},
          {"p5", number(shape.angleDeg.p5)},
          {"median", number(shape.angleDeg.median)}}},
        {"segmentedVolumeMm3", orNull(surface.segmentedMm3)},
        {"seenShare", surface.seen ? number(surface.seen->share) : Json(nullptr)},
        {"mending", mendingJson(surface)},
        {"remesh", remeshJson(surface)},
        {"nesting",
         {{"movedVertices", surface.move.movedVertices},
          {"maximumMm", number(surface.move.maximumMm)},
          {"maximumPointMm",
           surface.move.movedVertices > 0 ? vector(surface.move.maximumPointMm) : Json(nullptr)}}}};
}

/// As all points of this report.
std::vector<ReportedNote> inLps(std::vector<ReportedNote> notes) {
    for (ReportedNote& reported : notes) {
        reported.frame = CoordinateFrame::Lps;
        reported.placesMm = reported.note.pointsMm;
    }
    return notes;
}

/// What was judged of the head, and by what limits.
Json limitsJson(const BemModel& model) {
    Json list = Json::array();
    const auto add = [&](const HeadFigure& figure, const Json& of) {
        list.push_back({{"name", figure.key},
                        {"of", of},
                        {"value", number(figure.value)},
                        {"least", orNull(figure.least)},
                        {"most", orNull(figure.most)}});
    };
    for (const HeadFigure& figure : model.figures) add(figure, nullptr);
    for (const ReportedNote& reported : model.plausibility) {
        for (const HeadFigure& figure : reported.note.figures) add(figure, reported.subject);
    }
    return list;
}

Json gapJson(const NestedGap& gap) {
    return {{"mm", number(gap.mm)},
            {"innerPointMm", vector(gap.innerPointMm)},
            {"outerPointMm", vector(gap.outerPointMm)}};
}

Json pointJson(const std::string& name, const Vec3& p) {
    return {{"name", name}, {"pointMm", vector(p)}};
}

Json landmarksJson(const BemModel& model) {
    if (!model.electrodes || !model.electrodes->landmarks) return nullptr;
    const Landmarks& l = *model.electrodes->landmarks;
    return {{"origin", model.electrodes->landmarkOrigin},
            {"pointsIn", frameWord(CoordinateFrame::Lps)},
            {"nasionMm", vector(l.nasionMm)},
            {"leftEarMm", vector(l.leftEarMm)},
            {"rightEarMm", vector(l.rightEarMm)},
            {"nasionUncertaintyMm", number(l.nasionUncertaintyMm)},
            {"earUncertaintyMm", number(l.earUncertaintyMm)}};
}

Json electrodesJson(const BemModel& model) {
    if (!model.electrodes || model.electrodes->points.empty()) return nullptr;
    const BemElectrodes& e = *model.electrodes;
    Json points = Json::array();
    for (std::size_t n = 0; n < e.points.size(); ++n) {
        points.push_back(pointJson(e.points[n].name, e.points[n].point));
        points.back()["uncertaintyMm"] =
            e.uncertaintyMm.empty() ? number(0) : number(e.uncertaintyMm[n]);
    }
    return {{"computed", e.areComputed},
            {"meanMovedMm", number(e.meanMovedMm)},
            {"farthestMovedMm", number(e.farthestMovedMm)},
            {"farthest", e.areComputed ? Json(nullptr) : Json(e.farthestName)},
            {"pointsIn", frameWord(CoordinateFrame::Lps)},
            {"points", points}};
}

Json headPointsJson(const BemModel& model) {
    if (!model.electrodes || !model.electrodes->headPoints) return nullptr;
    const auto& [count, fit] = *model.electrodes->headPoints;
    return {{"count", count},
            {"meanMm", number(fit.meanMm)},
            {"p95Mm", number(fit.p95Mm)},
            {"largestMm", number(fit.largestMm)}};
}

Json sourcesJson(const BemModel& model) {
    if (!model.sources) return nullptr;
    const SourceMoves& moves = model.sources->moves;
    Json counts = Json::array();
    for (const SourceSpace& space : model.sources->spaces) counts.push_back(space.used.size());
    return {{"counts", counts},
            {"moved", moves.moved},
            {"meanMovedMm", number(moves.meanMm)},
            {"farthestMovedMm", number(moves.farthestMm)},
            {"outside", moves.outside},
            {"dropped", moves.dropped}};
}

/// The model's skull beside that of the segmentation.
Json skullJson(const BemModel& model) {
    if (!model.skull) return nullptr;
    const SkullComparison& skull = *model.skull;
    const auto place = [](const std::optional<Vec3>& p) { return p ? vector(*p) : Json(nullptr); };
    return {{"areaMm2", number(skull.areaMm2)},
            {"absentMm2", number(skull.absentMm2)},
            {"largestHoleMm2", number(skull.largestHoleMm2)},
            {"holePointMm", place(skull.holeMm)},
            {"segmentedMedianMm", number(skull.medianMm)},
            {"segmentedThinMm", number(skull.thinMm)},
            {"modelMedianMm", number(skull.modelMedianMm)},
            {"thickerMm", number(skull.thickerMm)},
            {"thickenedMm2", number(skull.thickenedMm2)},
            {"mostThickenedMm", number(skull.mostThickenedMm)},
            {"thickenedPointMm", place(skull.thickenedMm)}};
}

Json spongyJson(const BemModel& model) {
    if (!model.spongyBone) return nullptr;
    const BemSpongyBone& bone = *model.spongyBone;
    return {{"pieces", bone.pieces},
            {"vertices", std::ssize(bone.mesh.points)},
            {"triangles", std::ssize(bone.mesh.triangles)},
            {"volumeMm3", number(bone.volumeMm3)},
            {"segmentedVolumeMm3", number(bone.segmentedMm3)},
            {"innerSkullGapMm", number(bone.innerGapMm)},
            {"outerSkullGapMm", number(bone.outerGapMm)},
            {"conductivity", number(kSpongyBoneConductivity)}};
}

Json tetrahedraJson(const BemModel& model) {
    if (!model.tetrahedra) return nullptr;
    const TetrahedraReport& report = model.tetrahedra->report;
    Json layers = Json::array();
    for (std::size_t n = 0; n < report.counts.size(); ++n) {
        const HeadTissue& tissue =
            tissueWithin(headSurface(n, report.counts.size()), report.counts.size());
        layers.push_back({{"tissue", tissue.name},
                          {"number", tissue.number},
                          {"tetrahedra", report.counts[n]},
                          {"volumeMm3", number(report.volumesMm3[n])},
                          {"betweenSurfacesMm3", number(report.expectedMm3[n])}});
    }
    Json json{{"mesher", model.tetrahedra->mesher},
              {"points", std::ssize(model.tetrahedra->mesh.points)},
              {"layers", layers}};
    json.update(elementShapesJson(report));
    return json;
}

Json leadFieldJson(const BemModel& model) {
    if (!model.leadField) return nullptr;
    const std::size_t rows = model.electrodes->points.size();
    return {{"solver", model.leadField->solver},
            {"electrodes", rows},
            {"dipoles", model.leadField->gain.size() / rows},
            {"unit", "V/(A m)"},
            {"reference", nullptr}};
}

}  // namespace

Json bemInputJson(const BemModel& model) {
    Json files = Json::array();
    for (const BemInput& input : model.inputs) {
        files.push_back({{"file", input.file.empty() ? Json(nullptr) : Json(input.file)},
                         {"role", input.role},
                         {"format", input.format}});
    }
    return {{"source", toString(model.source)},
            {"files", files},
            {"image", imageJson(model.image)},
            {"warnings", model.warnings}};
}

Json bemOptionsJson(const BemModelOptions& options) {
    const BoundaryOptions& b = options.boundaries;
    Json edges = nullptr;
    if (options.edgeLengthMm) {
        edges = {options.edgeLengthMm->minimumMm, options.edgeLengthMm->maximumMm};
    }
    Json json{{"layers", options.surfaceCount()},
              {"vertices", options.vertices.empty() ? Json(nullptr) : Json(options.vertices)},
              {"edgeLengthMm", edges},
              {"minGapMm", {b.minSkullMm, b.minScalpMm}},
              {"minCsfMm", b.minCsfMm},
              {"minGreyMm", b.minGreyMm}};
    json.update(valuesJson(boundaryOptions(), b));
    if (b.stepMm == 0) json["voxelMm"] = nullptr;
    if (b.skullMm == 0) json["skullMm"] = UsualHead(b.ageYears).skullMm;
    const ConductivityModel& sigma = options.conductivities;
    json["conductivity"] = {{"white", b.innerSurfaces > 1 ? Json(sigma.white) : Json(nullptr)},
                            {"brain", sigma.brain},
                            {"csf", b.innerSurfaces > 0 ? Json(sigma.csf) : Json(nullptr)},
                            {"skull", sigma.skull},
                            {"scalp", sigma.scalp}};
    json["inputCoordinates"] = options.inputCoordinates;
    json.update(valuesJson(sourceOptions(), options.sources));
    json["leadField"] = options.leadField.empty() ? Json(nullptr) : Json(options.leadField);
    return json;
}

Json bemModelJson(const BemModel& model) {
    Json surfaces = Json::array(), gaps = Json::array(), checks = Json::array();
    Json findings = Json::array();
    for (std::size_t n = 0; n < model.surfaces.size(); ++n) {
        surfaces.push_back(
            surfaceJson(bemSurfaceName(n, model.surfaces.size()), model.surfaces[n]));
    }
    for (const NestedGap& gap : model.gaps) gaps.push_back(gapJson(gap));
    for (const BemCheck& check : model.checks) {
        checks.push_back({{"name", check.fullName()},
                          {"passed", check.isPassed},
                          {"detail", check.detail},
                          {"pointMm", check.pointMm ? vector(*check.pointMm) : Json(nullptr)}});
    }
    for (const Finding& finding : model.findings) {
        findings.push_back({{"what", finding.what}, {"pointMm", vector(finding.pointMm)}});
    }
    return {{"notes", model.notes},
            {"surfaces", surfaces},
            {"gaps", gaps},
            {"skull", skullJson(model)},
            {"spongyBone", spongyJson(model)},
            {"checks", checks},
            {"tetrahedra", tetrahedraJson(model)},
            {"landmarks", landmarksJson(model)},
            {"electrodes", electrodesJson(model)},
            {"headPoints", headPointsJson(model)},
            {"sources", sourcesJson(model)},
            {"leadField", leadFieldJson(model)},
            {"plausibility", notesJson(inLps(model.plausibility))},
            {"limits", limitsJson(model)},
            {"findings", findings}};
}

Json bemOutputJson(const BemModel& model, const BemFileOptions& options,
                   const std::vector<std::pair<std::string, std::uintmax_t>>& files,
                   const std::vector<std::string>& subjectFiles) {
    Json list = Json::array();
    for (const auto& [name, bytes] : files) list.push_back({{"file", name}, {"bytes", bytes}});
    return {{"files", list},
            {"subjectFiles", subjectFiles},
            {"freesurferFrame", model.tkRasVolume ? "tkras" : "ras"},
            {"coordinates", frameWord(options.frame)},
            {"openmeegUnit", options.unit == OpenMeegUnit::Metres ? "m" : "mm"}};
}

}  // namespace adaptiso
