#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "adaptiso/SurfaceProof/Parameters.h"  // IWYU pragma: export

/// Every constant of the adaptive method that was chosen, with its unit and its reason; those of
/// walks and cuts are in SurfaceProof. Numbers that follow from the data's layout stand where they
/// are used.
///
/// A voxel is the least distance between planes of samples (MetricFrame::narrowestMm). Costs are
/// the quadrics' squared distances weighted by areas, in voxels to the fourth. "Chosen by" names
/// the measurement: the scans are those of Documentation/Benchmarks.md.
namespace adaptiso::detail {

// ---- What runs aim at (AdaptiveMethod) ----

/// Vertices of samples stay that much below the bound, in voxels and as a part of the bound at
/// most: points between samples may lie farther. More takes more triangles, less more mending.
/// Above half a voxel it is that part of the bound at least: triangles are larger there, and so is
/// what comes apart around a place that can't be mended. Without it all of ch2bet came back at two
/// voxels.
inline constexpr double kSlackVoxels = 0.05, kSlackPart = 0.3, kLeastSlackPart = 0.1;
/// Distance of samples, voxels, that a count without a bound starts with. Largest distances then
/// stay below half a voxel.
inline constexpr double kCountDistance = 0.46;
/// Voxels: a star within this distance of its samples is a single sheet where the sheet test says
/// so. Half a voxel is what the test's 4 x 4 x 4 samples are proved for (isSingleSheet).
inline constexpr double kSheetDistance = 0.5;
/// Runs: towards a count a second one proves every star where the first left triangles that cross,
/// and aims lower by as many triangles as mending had added; towards a bound it keeps kSlackPart
/// below it.
inline constexpr int kMostRuns = 2;
/// Rounds of mending crossings in one run; rounds of mending distances that may gain little.
inline constexpr int kMostMends = 6, kMostIdleMends = 1;
/// Part of the triangles that mending crossings may leave below a wanted count, which is to be met
/// to as much; else the run is made again.
inline constexpr double kCountMissed = 0.001;
/// Part of the bound: samples stay as near where nothing is mended, so that few places lie beyond.
inline constexpr double kUnmended = 0.25;
/// Where nothing is mended, places go back to the full surface so often at most: what more brings
/// back is mostly all.
inline constexpr int kMostTakenBack = 4;
/// A round of mending gains little when it leaves more than this part of the triangles with places
/// beyond the bound.
inline constexpr double kMended = 0.5;
/// As a fraction of the bound: a thinner part of the surface is a web or a needle, where the height
/// over a sample's tangent plane says little about a point's distance to the surface. The allowed
/// distance is smaller there from the start. Chosen by runs that had to begin again: ch2 at 60.5
/// (three runs) and 100.5 (1,591 vertices undone) take one, for .5 and .2 % more triangles.
inline constexpr double kWeb = 0.5;
/// Voxels: by a bound above half a voxel wider parts are no webs, in a second run twice as wide
/// ones: tangent planes hold there. With half the bound a brain takes 2.5 times the triangles at
/// two voxels, a noisy head twice; with 0.25 voxel 1.4 times, 1.15 times.
inline constexpr double kWidestWeb = 0.15;
/// How often the square of the allowed distance is halved in a web.
inline constexpr int kWebHalvings = 5;
/// Vertices are fitted within this part of the allowed distance, or no farther than they were: then
/// few places come to lie beyond the bound.
inline constexpr double kFitDistance = 0.75;

// ---- Rounds (Simplification, PatchRound) ----

/// Limits of cost: of the bricks' round, and above which there is none.
inline constexpr double kFirstCost = 1e-3, kLastCost = 10;
/// Limits of cost of the first rounds towards a bound, each six times the one before: cheap
/// collapses first, everywhere, so that walls between patches do not show. A round at 3e-3 before
/// them takes a few per cent more time for as many triangles.
inline constexpr std::array kBoundCosts{1.8e-2, 0.108, 0.648};
/// Rounds towards a bound begin with changes that are small in every way: costs below this part of
/// the square of the allowed distance, distances below this part of it.
inline constexpr double kGentleCost = 2, kGentleDistance = 0.25;
/// A larger distance helped towards a count when it leaves less than this part of the triangles
/// that are still too many; after so many in a row that did not, the count is given up.
inline constexpr double kHelped = 0.95;
inline constexpr int kMostHelpless = 2;
/// Doubling the allowed distance was worth it when it leaves less than this part of the triangles.
/// Where the count is not met, what came after the last such doubling is taken back: the half of
/// ch2 to 7,000 would end at 9,522 triangles 27.6 mm off, and ends at 10,556, 7.6 mm off.
inline constexpr double kWorthDoubling = 0.9;
/// Times the count: no larger distance is allowed for the rest.
inline constexpr double kMet = 1.001;
/// Limit of cost before the first round after the allowed distance has grown on the way to a count:
/// what costs less was hardly refused for its distance.
inline constexpr double kCostAfterDistance = 0.16;
/// A round that leaves more than this part of the triangles, or of those that are too many for a
/// count, was hardly worth it; the second where a larger distance can be allowed instead.
inline constexpr double kWorthwhile = 0.99, kWorthwhileAsFar = 0.95;
/// A round without a limit of cost that leaves more than this part of the triangles is the last:
/// the next one, with the other cut, takes 2 % of a run's time and drops 0.05 to 0.3 % of them.
inline constexpr double kFutile = 0.97;
/// Above this part of the wanted count a round is not thought to lead below it.
inline constexpr double kFarFromCount = 1.6;
/// Up to this part of the wanted count the rest is dealt out by size: the patches' costs hardly
/// differ.
inline constexpr double kNearCount = 1.05;
/// A round that drops less than this part of the triangles that are too many hardly brings the
/// count nearer: the limit of cost grows sixteenfold then.
inline constexpr double kHardly = 0.05;
/// Up to the first cost cubes are as large as bricks, up to the second half as large again, above
/// twice as large: else too much would straddle them. Small ones stay in a processor's cache. With
/// 0.7 for the second, kBoundCosts' last has the middle cubes as well: by a bound 1 to 2 % fewer
/// triangles, but a mean distance 2 % larger on ch2bet.
inline constexpr double kFineCost = 0.13, kMiddleCost = 0.5;
/// Up to so many triangles are one patch, if they span no more cells: long ones would straddle a
/// wall of every cut. A cube of a scan's last rounds holds as many. With 2,048 a scan of 28,000
/// triangles to 3 % takes 15 % less time (two threads), but a ball and a torus of 1,500 triangles
/// have a mean distance 20 % larger, and a gyroid by a bound of .4 mm has 8 % more triangles.
inline constexpr std::int64_t kOnePatch = 8192;
inline constexpr double kOnePatchSide = 128;
/// Part of the triangles: where more are longer than that part of a cube's side, cubes are larger.
/// Scans have none; in a mesh of long and short triangles the long ones would keep all that they
/// touch.
inline constexpr double kMostLong = 0.1, kLongPart = 0.25;
/// Part of the vertices: where fewer are final, triangles between final ones stay in the patches,
/// as to find them would take more time than it saves.
inline constexpr double kFewFinal = 0.05;
/// Cells that a patch's new vertices may lie beyond its own triangles, where others of the patch's
/// cube are settled: vertices of a round part lie outside what they replace, by less.
inline constexpr double kBeyondOwn = 1;

// ---- Bricks (BrickRound, SheetClearance, SheetTest) ----

/// The middle of a full-resolution triangle is a sample where normals at its corners are farther
/// apart: between corners a ridge could pass unseen. Cosine of 20 degrees.
inline constexpr double kBentCosine = 0.94;
/// A brick is noise if this part of its cells is crossed, less than that part of its vertices lies
/// in a single sheet, and this part of its triangles bends. Without the first condition teapot's
/// thin walls would be noise, for a third more triangles, and with 0.4 bricks of ch2bet, for 2 %
/// more; without the last parallel sheets up to two voxels apart. With 0.5 and 0.05 bricks at a
/// closed border were simplified within noise that stays, which took four times as long for a tenth
/// of the triangles (noise blurred by a voxel, 64^3).
inline constexpr double kNoiseCrossed = 0.45, kNoiseSingle = 0.1, kNoiseBent = 0.5;
/// Lists of all bricks get room for this many times what the bricks so far took, scaled to all of
/// them; at least and at most so many times what they hold.
inline constexpr double kRoomToGrow = 1.1, kLeastGrowth = 1.125, kMostGrowth = 1024;
/// Voxels: where the surface crosses a line of the lattice on both sides of a sample, nearer to
/// each other than this, each is the other's neighbouring sheet whatever their normals. At 1 the
/// same crossings are avoided, and ch2bet takes a tenth more time.
inline constexpr double kNarrowGap = 0.3;
/// Another sheet is one whose normal differs by more: cosine of about 70 degrees.
inline constexpr float kOtherSheetCosine = 0.3F;

/// Cells: rounding of points by less cannot let triangles of different cells cross (see
/// VolumeSurface::cellsOf): it is a tenth of the least distance between them, and turns an edge by
/// a tenth of the least angle.
inline constexpr double kFineRounding = 1e-9;

// ---- Meshes (simplify(), MeshSurface) ----

/// As a fraction of the bound: collapsing needles (no area) may move vertices as far.
inline constexpr double kNeedlePart = 0.01;

/// Triangles for each voxel's face of surface, by which a mesh gets voxels: marching cubes' on
/// scans. Of them, the widest that they are made for the bound's sake.
inline constexpr double kTrianglesPerFace = 3, kWidestVoxel = 3;
/// As a fraction of the mesh's extent: below it places could not be numbered in 64 bits.
inline constexpr double kLeastVoxel = 1e-15;

// ---- Collapses (PatchSimplifier, ChangedStar, ErrorTracker, CrossingGuard) ----

/// On a flat part all places are as good to the quadrics: shorter edges go first.
inline constexpr double kLengthWeight = 1e-6;
/// How stiff a collapsed edge's new vertex is: the part of the planes' weight that holds it to the
/// edge's middle, also along creases. At 1e-3 the mean distance of an evenly remeshed head to a
/// tenth is 15 % larger, at 3e-4 4 % larger than vtkQuadricDecimation's (here 2.5 %), and the
/// default bound leaves 0.1 to 1.4 % more triangles of scans. At 1e-4 a thin bowl keeps 12
/// triangles of 320 instead of 6, at 1e-5 ch2 at 60.5 takes four runs.
inline constexpr double kPlaceStiffness = 1.5e-4;
/// How much the quadric counts beside the samples when a vertex is fitted, how stiff the fit is,
/// and how far it goes at most, voxels. Chosen by the mean distance on engine, ch2bet and the
/// meshes of simplifyMeshes.py: at a stiffness of 0.05 it is 2 to 7 % larger. Longer steps leave
/// the surface between samples (largest distance of ch2's head to a tenth .81 mm, .57 so).
inline constexpr double kQuadricWeight = 0.5, kFitStiffness = 5e-4, kFitStep = 0.2;
/// Least cosine between a triangle's normal and the star's mean normal before the change; or else
/// between it and the triangle's own before.
inline constexpr double kStarCosine = 0.3, kOwnCosine = 0.6;
/// Twice the area over the squared longest side: below it a triangle counts as flat.
inline constexpr double kFlatTriangle = 1e-5;
/// A star may come this part of the way to other sheets without a proof that it meets none: two
/// stars that come towards each other still pass, and what lies between samples strays little more
/// than they. To prove all that are nearer than 0.6 voxel to others as well takes twice the proofs
/// on ch2bet, 2 to 10 % more time, and refuses 18 changes of 670,000 instead of 17.
inline constexpr double kUsableClearance = 0.4;
/// Along edges sharper than this cosine points are looked at, this far apart (of the samples'
/// spacing, or of the allowed distance where that is larger), so many at most: a ridge may pass
/// between the samples of a rounder surface. By the spacing alone a brain with noise to 3 % takes 7
/// to 14 % more time, for a mean distance .14 % smaller.
inline constexpr double kRidgeCosine = 0.95, kRidgeSpacing = 0.5;
inline constexpr int kRidgeMostSteps = 16;
/// Side of the cubes by which near triangles are found: voxels at least, and mean longest sides of
/// the triangles' boxes, as later rounds make triangles larger. With the first alone a brain with
/// noise to 3 % takes a tenth more time, ch2's head to a tenth 3 % more; with 1 or 3 sides the
/// same.
inline constexpr double kNearCube = 2, kNearSides = 2;
/// Voxels that proofs leave between triangles.
inline constexpr double kProofGap = 1e-4;

// ---- The proof of the bound (DistanceProof) ----

/// How many triangles a walk may visit: from a full-resolution triangle; from one of the simplified
/// surface, this many and so many for each voxel's face that would cover it.
inline constexpr int kStepsOfFine = 40, kFewSteps = 100;
inline constexpr double kStepsPerFace = 20, kManySteps = 1e6;

// ---- Mending (SurfaceMender) ----

/// By its barycentric coordinates a place lies beside a vertex, or beside an edge.
inline constexpr double kAtVertex = 0.9, kAtEdge = 0.12;
/// The surface has left a place when it is farther from it than this part of the place's distance.
inline constexpr double kLeftPlace = 0.1;
/// A new vertex is put on the full-resolution surface, or else this part of the way to it: the
/// shorter the way, the less the triangles turn.
inline constexpr std::array kMendSteps{1.0, 0.6, 0.35};
/// Least cosine between the normals of a triangle before and after. A second try down to -.3 mended
/// 34 of 3,620 places on ch2, ch2bet, engine and noise, turning edges 20, moving a vertex that has
/// less of the place's weight 7.
inline constexpr double kMendCosine = 0.3;
/// Around places that mending does not help vertices come apart again, voxels: in the first
/// attempt, and twice as far in each next one.
inline constexpr double kUndoReach = 1;
/// By a bound above the default, and by one above half a voxel, a run ends when this part of the
/// vertices has come apart, and another keeps nearer: ch2bet at two voxels came back as a whole
/// around 39 places, ch2 at 40 within half a voxel too.
inline constexpr double kMostUndone = 0.25;
/// Where that does not help either, the bound is tightened to this part of it, down to the default.
inline constexpr double kTighterBound = 0.7;
/// So many times more comes apart to keep the surface a manifold.
inline constexpr int kMostWidenings = 8;

}  // namespace adaptiso::detail
