#include "adaptiso/SurfacePipeline/SurfaceJson.h"

#include <algorithm>
#include <cmath>

#include "adaptiso/Json/OptionsJson.h"

namespace adaptiso {
namespace {

/// Components listed in full; a noisy image has thousands.
constexpr std::size_t kMaxComponents = 100;

Json boxesJson(const std::vector<BoxCount>& boxes) {
    Json list = Json::array();
    for (const BoxCount& count : boxes) {
        list.push_back(
            {{"size", count.size}, {"shared", count.shared}, {"unshared", count.unshared}});
    }
    return list;
}

/// The largest components: by what they enclose, those of an open surface by their area.
Json componentsJson(const TopologyReport& topology) {
    const bool isClosed = topology.isClosed();
    const auto size = [&](const SurfaceComponent& component) {
        return isClosed ? std::abs(component.signedVolumeMm3) : component.areaMm2;
    };
    std::vector<SurfaceComponent> components = topology.components;
    std::stable_sort(components.begin(), components.end(),
                     [&](const auto& a, const auto& b) { return size(a) > size(b); });
    components.resize(std::min(components.size(), kMaxComponents));
    Json list = Json::array();
    for (const SurfaceComponent& component : components) {
        list.push_back({{"vertices", component.vertices},
                        {"triangles", component.triangles},
                        {"genus", orNull(component.genus())},
                        {"areaMm2", number(component.areaMm2)},
                        {"volumeMm3", component.isClosed() ? number(component.signedVolumeMm3)
                                                           : Json(nullptr)}});
    }
    return list;
}

/// A count of defects of a kind.
template <TopologyDefect kind>
Json countOf(const MadeSurface& made) {
    return made.surface.topology.count(kind);
}

}  // namespace

Json imageJson(const std::string& format, const ImageGeometry& geometry, PixelType pixelType,
               const ValueRange& range, const std::vector<Warning>& warnings) {
    Json json{{"format", format}};
    json.update(geometryJson(geometry));
    json["pixelType"] = toString(pixelType);
    json["minimum"] = number(range.minimum);
    json["maximum"] = number(range.maximum);
    json["warnings"] = warnings;
    return json;
}

Json preprocessingJson(const PreprocessOptions& options, const Index3& size) {
    if (options.changesNothing()) return nullptr;
    Json crop = nullptr;
    if (options.crop) {
        crop = Json::array();
        for (std::size_t axis = 0; axis < size.size(); ++axis) {
            const auto& [first, end] = (*options.crop)[axis];
            crop.push_back(Json::array({first, end.value_or(size[axis])}));
        }
    }
    return {{"crop", crop},
            {"smoothSigmaMm", orNull(options.smoothSigmaMm)},
            {"resampleMm", orNull(options.resampleMm)},
            {"interpolation",
             options.resampleMm ? Json(toString(options.interpolation)) : Json(nullptr)}};
}

Json preprocessedJson(const PreprocessOptions& options, const Index3& size,
                      const std::optional<PreprocessedImage>& image) {
    if (!image) return nullptr;
    Json json = preprocessingJson(options, size);
    json.update(geometryJson(image->geometry));
    json["pixelType"] = toString(image->pixelType);
    json["minimum"] = number(image->range.minimum);
    json["maximum"] = number(image->range.maximum);
    return json;
}

Json surfaceOptionsJson(const ExtractionOptions& extraction, const IndexOptions& index,
                        const ComponentSelection& selection) {
    Json json = valuesJson(methodOptions(), extraction);
    json.update(valuesJson(discretizedOptions(), extraction.discretized));
    json.update(valuesJson(aimOptions(AimedSurface::OfScan), extraction.adaptive));
    json.update(valuesJson(indexOptions(), index));
    json.update(valuesJson(pieceOptions(), selection));
    return json;
}

const Figures<AdaptiveWork>& workFigures() {
    using Of = const AdaptiveWork&;
    static const Figures<AdaptiveWork> kRows{
        {"runs",
         "runs of the whole simplification by `adaptive`; 1 is the rule. This and the next three "
         "are `null` for other methods",
         [](Of work) { return Json(work.runs); }},
        {"placesMended", "places beyond the bound after a run, or where triangles crossed",
         [](Of work) { return Json(work.placesMended); }},
        {"verticesUndone", "vertices that came apart again where mending did not help",
         [](Of work) { return Json(work.verticesUndone); }},
        {"trianglesKept", "triangles at full resolution, for nothing could be simplified there",
         [](Of work) { return Json(work.trianglesKept); }}};
    return kRows;
}

Json workJson(const std::optional<AdaptiveWork>& work) {
    Json json = figuresJson(workFigures(), work.value_or(AdaptiveWork{}));
    if (!work) {
        for (Json& value : json) value = nullptr;
    }
    return json;
}

const Figures<MadeSurface>& surfaceFigures() {
    using Of = const MadeSurface&;
    using Defect = TopologyDefect;
    static const Figures<MadeSurface> kRows{
        {"isovalue", "the isovalue", [](Of of) { return Json(of.surface.isovalue); }, "Isovalue",
         Shown::Plain},
        {"isovalueChosenBy", "`\"user\"` or `\"otsu\"`",
         [](Of of) { return Json(of.surface.isAutomatic ? "otsu" : "user"); }},
        {"method", "`\"adaptive\"`, `\"boxes\"`, `\"dmc\"`, `\"asc\"` or `\"mc\"`",
         [](Of of) { return Json(toString(of.method)); }},
        {"blocks.size", "voxels a side of a block of the index",
         [](Of of) { return Json(of.blockSize); }},
        {"blocks.total", "blocks in the volume",
         [](Of of) { return Json(of.surface.statistics.blocksTotal); }},
        {"blocks.active", "blocks that the surface touches",
         [](Of of) { return Json(of.surface.statistics.blocksActive); }},
        {"blocks.nodesVisited", "nodes of the index (`linear`: blocks) looked at to find them",
         [](Of of) { return Json(of.surface.statistics.indexNodesVisited); }},
        {"boxes",
         "list of `{size, shared, unshared}`: boxes that the surface passes, by size (`asc`: "
         "longest side) and kind, largest first (unit boxes alone for `dmc`, empty for `adaptive` "
         "and `mc`)",
         [](Of of) { return boxesJson(of.surface.statistics.boxes); }},
        {"boxesChangingTopology",
         "boxes in which the surface was simplified in its topology (a tunnel closed): `boxes` "
         "and `asc` only, else 0",
         [](Of of) { return Json(of.surface.statistics.boxesChangingTopology); }},
        {"edgesSplit",
         "edges halved because two of them joined the same two vertices: `boxes`, `dmc` and `asc` "
         "only, else 0",
         [](Of of) { return Json(of.surface.statistics.edgesSplit); }},
        {"errorBoundMm",
         "`adaptive`: proved bound of the distance of the file's surface to that of `mc` (of the "
         "pieces kept), both ways, `roundingMm` included; else `null`",
         [](Of of) { return orNull(of.surface.errorBoundMm()); }, "Error at most, mm",
         Shown::Bound},
        {"roundingMm",
         "how far the format's digits move a point at most; 0 for `.vtp`, `.vtk` and `.ply`, null "
         "where it is not measured: other methods with `--no-check-crossings`",
         [](Of of) { return orNull(of.surface.roundingMm); }},
        {"verifiedSamples", "`--verify`: points that were measured, both ways; else `null`",
         [](Of of) {
             const auto& verified = of.surface.verification;
             return verified ? Json(verified->samples) : Json();
         }},
        {"verifiedMaxMm", "the farthest of them",
         [](Of of) {
             const auto& verified = of.surface.verification;
             return verified ? number(verified->maxMm) : Json();
         }},
        {"wantedTriangles", "the count that `--triangles` or `--reduction` asked for; else `null`",
         [](Of of) { return orNull(of.surface.statistics.wantedTriangles); }},
        {"countMet", "whether the file has no more; `null` without them",
         [](Of of) { return orNull(of.surface.countMet()); }},
        {"adaptive", "", [](Of of) { return workJson(of.surface.statistics.adaptiveWork); }},
        {"triangles", "of the mesh written",
         [](Of of) { return Json(of.surface.topology.triangles); }, "Triangles", Shown::Count},
        {"vertices", "of the mesh written",
         [](Of of) { return Json(of.surface.topology.vertices); }, "Vertices", Shown::Count},
        {"marchingCubesTriangles",
         "what marching cubes makes of the same surface by its table, before pieces are dropped "
         "(with a count: of the pieces kept; `mc` itself makes two more for each loop filled from "
         "its middle)",
         [](Of of) { return Json(of.surface.statistics.marchingCubesTriangles); },
         "Marching cubes has", Shown::Count},
        {"sizeMm", "of the mesh written along x, y and z of the patient, in every frame",
         [](Of of) { return vector(of.surface.sizeMm); }, "Size", Shown::Size},
        {"areaMm2", "of the mesh written", [](Of of) { return number(of.surface.areaMm2); },
         "Area, mm²", Shown::Measure},
        {"volumeMm3", "of the mesh written; `null` if it is open",
         [](Of of) { return orNull(of.surface.volumeMm3); }, "Volume, mm³", Shown::Measure},
        {"genus", "handles of all components together; `null` if it is open",
         [](Of of) { return orNull(of.surface.topology.genus()); }, "Genus", Shown::Count},
        {"componentCount", "number of components",
         [](Of of) { return Json(of.surface.topology.components.size()); }, "Pieces", Shown::Count},
        {"components",
         "the 100 largest: `{vertices, triangles, genus, areaMm2, volumeMm3}` (a cavity's volume "
         "is negative)",
         [](Of of) { return componentsJson(of.surface.topology); }},
        {"soundness.closed", "no open edge",
         [](Of of) { return Json(of.surface.topology.isClosed()); }},
        {"soundness.boundaryEdges", "edges in one triangle: 0 unless the border is open",
         countOf<Defect::BoundaryEdge>},
        {"soundness.nonManifoldEdges",
         "edges in more than two triangles: 0, as all that follow up to `unusedVertices`, or "
         "nothing is written",
         countOf<Defect::NonManifoldEdge>},
        {"soundness.inconsistentEdges", "edges whose triangles disagree about outside",
         countOf<Defect::InconsistentEdge>},
        {"soundness.nonManifoldVertices", "vertices whose triangles are not one fan",
         countOf<Defect::NonManifoldVertex>},
        {"soundness.degenerateTriangles", "triangles without area",
         countOf<Defect::DegenerateTriangle>},
        {"soundness.duplicateTriangles", "triangles with the vertices of another",
         countOf<Defect::DuplicateTriangle>},
        {"soundness.unusedVertices", "vertices in no triangle", countOf<Defect::UnusedVertex>},
        {"soundness.crossingPairs",
         "pairs of triangles that cross: 0 for `adaptive`, as proved; counted for the other "
         "methods, `null` with `--no-check-crossings`",
         [](Of of) { return orNull(of.surface.crossingPairs); }},
        {"soundness.insideOutPieces",
         "closed surfaces: pieces that face inward where they should face outward, or walls of "
         "cavities that face outward; 0 for `adaptive`, or nothing is written; a warning with "
         "other methods; `null` if it is open",
         [](Of of) { return orNull(of.surface.insideOutPieces); }}};
    return kRows;
}

}  // namespace adaptiso
