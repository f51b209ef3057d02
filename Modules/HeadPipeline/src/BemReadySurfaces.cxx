#include <algorithm>
#include <cmath>
#include <map>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Extraction/Components.h"
#include "adaptiso/HeadPipeline/BemChecks.h"
#include "adaptiso/HeadPipeline/BemSurfaces.h"
#include "adaptiso/Mending/MendJson.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {
namespace {

enum class Need { Nothing, NewTriangles, NewSolid };

/// Drops triangles that can't be any (a corner that is not finite or not there, or named twice),
/// and vertices that no triangle uses. \return triangles dropped
std::int64_t dropUseless(TriangleMesh& mesh) {
    const auto count = std::ssize(mesh.points);
    const auto isUseless = [&](const Triangle& t) {
        return t[0] == t[1] || t[1] == t[2] || t[2] == t[0] ||
               std::any_of(t.begin(), t.end(), [&](VertexId v) {
                   return v < 0 || v >= count || !std::isfinite(squaredNorm(mesh.points[v]));
               });
    };
    const auto dropped = static_cast<std::int64_t>(std::erase_if(mesh.triangles, isUseless));
    std::vector<VertexId> number(mesh.points.size(), -1);
    for (const Triangle& t : mesh.triangles) {
        for (const VertexId v : t) number[v] = 0;
    }
    VertexId next = 0;
    for (VertexId v = 0; v < count; ++v) {
        if (number[v] < 0) continue;
        number[v] = next;
        mesh.points[next++] = mesh.points[v];
    }
    mesh.points.resize(next);
    for (Triangle& t : mesh.triangles) {
        for (VertexId& v : t) v = number[v];
    }
    return dropped;
}

/// Vertices at the same place made one: what a triangle soup lacks.
TriangleMesh merged(const TriangleMesh& mesh) {
    TriangleMesh result = mesh;
    joinVertices(result);
    dropUseless(result);
    return result;
}

/// Without islands: pieces of less than a tenth of the triangles of all, as segmentations leave
/// them.
TriangleMesh withoutIslands(const TriangleMesh& mesh) {
    constexpr std::size_t kIsland = 10;
    const std::vector<VertexId> root = findComponentRoots(mesh);
    std::map<VertexId, std::size_t> triangles;
    for (const Triangle& t : mesh.triangles) ++triangles[root[t[0]]];
    TriangleMesh result = mesh;
    std::erase_if(result.triangles, [&](const Triangle& t) {
        return kIsland * triangles[root[t[0]]] < mesh.triangles.size();
    });
    dropUseless(result);
    return result;
}

/// One closed manifold without handles, whatever the shape of its triangles.
bool isBall(const TriangleMesh& mesh) {
    const TopologyReport topology = checkTopology(mesh, {.maxExamplesPerDefect = 0});
    return topology.isWatertight() && topology.components.size() == 1 && topology.genus() == 0 &&
           topology.count(TopologyDefect::DuplicateTriangle) == 0;
}

void note(BemModel& model, std::size_t n, const std::string& text) {
    model.notes.push_back(bemSurfaceName(n, model.options.surfaceCount()) + ": " + text);
}

/// Mends a surface by itself: its largest piece, without cavities. One with a handle is not taken:
/// a disc that cuts or fills it leaves horns or pits, where BallTopology.h closes whole tunnels.
/// \return  false where it is no ball then
bool mendAlone(std::size_t n, TriangleMesh& mesh, BemModel& model, const BemHooks& hooks) {
    MendOptions options;
    options.maxHoleMm = norm(boundingBox(mesh).size());
    options.progress = hooks.progress;
    Mended mended;
    try {
        mended = mend(mesh, options);
    } catch (const InvalidInput&) {
        return false;
    }
    TriangleMesh piece = selectComponents(mended.mesh, {.largestOnly = true, .fillCavities = true});
    if (!isBall(piece)) return false;
    MendStatistics inRas = mended.statistics;
    for (auto* places : {&inRas.filled, &inRas.inner, &inRas.thin}) {
        for (MendedPlace& place : *places) {
            place.middleMm = {-place.middleMm.x, -place.middleMm.y, place.middleMm.z};
        }
    }
    std::vector<std::string> texts = mendFaultTexts(inRas);
    std::vector<std::string> done = mendPlaceTexts(inRas);
    const std::int64_t left = std::ssize(mended.mesh.triangles) - std::ssize(piece.triangles);
    if (left > 0) done.push_back(formatCount(left) + " triangles of other pieces left out");
    texts.insert(texts.end(), done.begin(), done.end());
    texts.push_back(mendDistanceText(inRas, 0));
    note(model, n, "mended (places in mm RAS): " + joined(texts, "; "));
    bool isWide = left > 0;
    for (const auto* const places : {&inRas.filled, &inRas.inner, &inRas.thin}) {
        for (const MendedPlace& place : *places) isWide = isWide || place.spanMm > kMostChangeMm;
    }
    if (isWide) {
        model.warnings.push_back({"surface-moved", bemSurfaceName(n, model.options.surfaceCount()) +
                                                       ": mended: " + joined(done, "; ")});
    }
    model.surfaces[n].mending = std::move(mended.statistics);
    mesh = std::move(piece);
    return true;
}

/// Returns the work that a surface needs. Does at once what leaves it in its place, but for what a
/// note lists: drops useless triangles, merges vertices, mends, turns it outward.
Need tidied(std::size_t n, TriangleMesh& mesh, BemModel& model, const BemHooks& hooks) {
    const std::size_t vertices = mesh.points.size();
    const std::int64_t dropped = dropUseless(mesh);
    if (dropped > 0) note(model, n, "dropped " + formatCount(dropped) + " invalid triangles");
    if (mesh.triangles.empty()) throw InvalidInput("a surface holds no triangle");
    if (!isBall(mesh)) {
        TriangleMesh whole = merged(mesh), main = withoutIslands(whole);
        const bool hasIslands = main.triangles.size() < whole.triangles.size();
        if (isBall(main) || hasIslands) {
            note(model, n,
                 hasIslands
                     ? formatCount(std::ssize(whole.triangles) - std::ssize(main.triangles)) +
                           " triangles of small pieces left out"
                     : "vertices at the same place merged");
            mesh = std::move(main);
        }
    } else if (mesh.points.size() < vertices) {
        note(model, n, "unused vertices left out");
    }
    const bool isSound = isBall(mesh) && findSelfIntersections(mesh, {.maxPairs = 0}).isClear();
    if (!isSound && !mendAlone(n, mesh, model, hooks)) return Need::NewSolid;
    if (enclosedVolume(mesh) < 0) {
        flipOrientation(mesh);
        note(model, n, "was inside out and has been turned");
    }
    for (const Check& check : checkHeadSurface(mesh)) {
        if (!check.breaksProfile() || check.key == "plausibleSize") continue;
        note(model, n, std::string(check.name) + ": " + check.finding + "; remeshed");
        return Need::NewTriangles;
    }
    return Need::Nothing;
}

/// In metres nothing else that can be said of a surface makes sense.
void findWrongSizes(const std::vector<TriangleMesh>& surfaces, BemModel& model) {
    for (std::size_t n = 0; n < surfaces.size(); ++n) {
        for (const Check& check : checkHeadSurface(surfaces[n])) {
            if (check.key != "plausibleSize" || !check.breaksProfile()) continue;
            model.findings.push_back({bemSurfaceName(n, surfaces.size()) + ": " +
                                          std::string(check.name) + ": " + check.finding,
                                      surfaces[n].points[surfaces[n].triangles[0][0]]});
        }
    }
}

}  // namespace

std::vector<TriangleMesh> mendSurfaces(std::vector<TriangleMesh> surfaces, BemModel& model,
                                       const BemHooks& hooks) {
    std::vector<Need> needs;
    std::vector<std::size_t> vertices;
    std::vector<TriangleMesh> given = surfaces;
    for (TriangleMesh& surface : given) dropUseless(surface);
    model.surfaces.resize(surfaces.size());
    for (const TriangleMesh& surface : surfaces) vertices.push_back(surface.points.size());
    hooks.stage("check", [&] {
        for (std::size_t n = 0; n < surfaces.size(); ++n) {
            needs.push_back(tidied(n, surfaces[n], model, hooks));
        }
        findWrongSizes(surfaces, model);
    });
    if (!model.hasModel()) return surfaces;
    if (std::find(needs.begin(), needs.end(), Need::NewSolid) == needs.end()) {
        for (std::size_t n = 0; n < surfaces.size(); ++n) {
            if (needs[n] != Need::NewTriangles) continue;
            model.surfaces[n].denseTriangles = std::ssize(surfaces[n].triangles);
            constexpr std::int64_t kLeast = 42, kMost = 10'000;  // what MNE can work with
            model.surfaces[n].ownVertices = std::clamp<std::int64_t>(
                std::min(surfaces[n].points.size(), vertices[n]), kLeast, kMost);
        }
        return surfaces;
    }
    for (std::size_t n = 0; n < surfaces.size(); ++n) {
        if (needs[n] != Need::NewSolid) continue;
        note(model, n,
             "can't be mended to one closed surface of genus 0 that does not cross itself: all "
             "are made anew from the solids that they bound");
    }
    model.surfaces.clear();
    BoundaryOptions boundaries = model.options.boundaries;
    boundaries.progress = hooks.progress;
    HeadBoundaries mended;
    hooks.stage("boundaries", [&] { mended = boundariesFromSurfaces(surfaces, boundaries); });
    model.given = std::move(given);
    return extractSurfaces(mended, model, hooks);
}

}  // namespace adaptiso
