#include "adaptiso/HeadPipeline/BemSpongyBone.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Extraction/Components.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/HeadModel/SpongyBone.h"
#include "adaptiso/MeshQuality/InsideTest.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/SurfaceChecks/Checks.h"

namespace adaptiso {
namespace {

constexpr const char* kName = "spongy_bone";
constexpr double kLeastPieceMm3 = 50;
/// Voxels' stairs are about as deep as the first; elements want no needles.
constexpr double kErrorVoxels = 0.4, kAngleDeg = 15;

TriangleMesh surfaceOf(const FractionField& solid) {
    const SpanSpaceIndex index = SpanSpaceIndex::build(solid.view(), {});
    ExtractionOptions extract;
    extract.isovalue = kFractionIsovalue;
    extract.computeNormals = false;
    extract.adaptive.maxErrorMm = kErrorVoxels * solid.grid.spacingMm().x;
    extract.adaptive.minAngleDeg = kAngleDeg;
    return extractSurface(solid.view(), index, extract).mesh;
}

/// A check that a surface of the skull lies far enough away, on its side.
BemCheck checkAgainst(const TriangleMesh& spongy, const TriangleMesh& skull, bool isOuter,
                      double& gapMm) {
    const AabbTree spongyTree(spongy), skullTree(skull);
    const SurfaceGap gap = surfaceGap(spongy, spongyTree, skull, skullTree);
    gapMm = gap.nearest.distanceMm;
    BemCheck check{isOuter ? "spongy_bone in outer_skull" : "spongy_bone outside of inner_skull",
                   "at least " + formatNumber(kSpongyGapMm) + " mm apart",
                   gapMm >= kSpongyGapMm,
                   formatLength(gapMm, 2) + " mm",
                   {}};
    if (!check.isPassed) check.pointMm = gap.nearest.pointA;
    const InsideTest inside(skull, skullTree);
    const Side right = isOuter ? Side::Inside : Side::Outside;
    for (const Vec3& p : spongy.points) {
        if (inside.sideOf(p) == right) continue;
        check.isPassed = false;
        check.detail = "a vertex lies on the other side";
        check.pointMm = p;
        break;
    }
    return check;
}

double leastGapMm(const TriangleMesh& a, const TriangleMesh& b) {
    return surfaceGap(a, AabbTree(a), b, AabbTree(b)).nearest.distanceMm;
}

}  // namespace

void addSpongyBone(BemModel& model, const BemHooks& hooks) {
    if (!model.segmented || model.segmented->isSpongy.empty()) return;
    const SegmentedHead& head = *model.segmented;
    const std::size_t inner = model.meshes.size() - 3;
    const TriangleMesh &innerSkull = model.meshes[inner], &outerSkull = model.meshes[inner + 1];
    BemSpongyBone bone;
    bone.segmentedMm3 = std::accumulate(head.isSpongy.begin(), head.isSpongy.end(), 0.0) *
                        head.grid.voxelVolumeMm3();
    std::int64_t allPieces = 0;
    hooks.stage("extract", [&] {
        // the solid ends there at samples: between them its surface may lie nearer
        for (const double roomVoxels : {0.25, 0.75, 1.5}) {
            const auto solid = spongySolid(head, innerSkull, outerSkull, kSpongyGapMm, roomVoxels,
                                           model.options.boundaries.stepMm);
            const TriangleMesh all = solid ? surfaceOf(*solid) : TriangleMesh{};
            allPieces = labelComponents(all).count;
            bone.mesh = selectComponents(all, {.minVolumeMm3 = kLeastPieceMm3});
            if (bone.mesh.triangles.empty() ||
                std::min(leastGapMm(bone.mesh, innerSkull), leastGapMm(bone.mesh, outerSkull)) >=
                    kSpongyGapMm) {
                break;
            }
        }
    });
    if (bone.mesh.triangles.empty()) {
        model.warnings.push_back(
            {"spongy-bone-missing", "the labels' spongy bone has no piece of " +
                                        formatNumber(kLeastPieceMm3) + " mm3 that lies " +
                                        formatNumber(kSpongyGapMm) +
                                        " mm within the model's skull; there is no surface of it"});
        return;
    }
    hooks.stage("check", [&] {
        CheckRules rules;
        rules.maxPairs = 1;
        const SurfaceFacts facts = measureSurface(bone.mesh, sizeLimitsOf(Profile::Print), 1);
        bone.volumeMm3 = facts.volumeMm3.value_or(0);
        bone.pieces = labelComponents(bone.mesh).count;
        for (Check& check : judgeSurface(facts, rules)) {
            const bool isPassed = !check.breaksProfile();
            model.addCheck(
                {kName, std::string(check.name), isPassed, check.finding,
                 isPassed ? std::nullopt : std::optional(placeOfFinding(check, facts, bone.mesh))});
        }
        model.addCheck(checkAgainst(bone.mesh, innerSkull, false, bone.innerGapMm));
        model.addCheck(checkAgainst(bone.mesh, outerSkull, true, bone.outerGapMm));
    });
    std::string note = "spongy_bone: " + formatCount(std::ssize(bone.mesh.triangles)) +
                       " triangles, pieces: " + formatCount(bone.pieces) + ", " +
                       formatMeasure(bone.volumeMm3 / 1000) + " cm3, " +
                       formatMeasure(bone.segmentedMm3 / 1000) + " cm3 in the segmentation";
    if (allPieces > bone.pieces) {
        note += "; left out, of less than " + formatNumber(kLeastPieceMm3) +
                " mm3: " + formatCount(allPieces - bone.pieces);
    }
    model.notes.push_back(std::move(note));
    model.spongyBone = std::move(bone);
}

}  // namespace adaptiso
