#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/HeadModel/HeadFigure.h"

namespace adaptiso {

/// Usual ranges of heads of an age and of meshes for boundary elements. Values outside may be
/// right: they are noted, and nothing fails but what no head has.
struct UsualHead {
    static constexpr double kAdultYears = 18;

    /// \param ageYears  0: newborn; kAdultYears or more: adult
    explicit UsualHead(double ageYears = kAdultYears);

    double ageYears;
    /// Inside of the inner skull, cm3. Adults: the means of 49, women 1289 (SD 111), men 1469 (SD
    /// 102) [Matsumae1996], and three to four standard deviations. Children: the same shares of the
    /// means [Abbott2000, Sgouros1999]; a newborn has half of what it has at 9 months and a third
    /// of what it has at 6 years [Kamdar2009].
    double leastInnerSkullCm3, mostInnerSkullCm3;
    /// Median thickness over the upper half, mm, and the usual one. Adults' skulls have 6 at the
    /// temples to 10 at the forehead on average [Calisan2021]: half of the least to 2 mm above the
    /// most. From birth on they grow to three times; below 4 years most are thinner than 3 mm
    /// beside the middle [DomenechFernandez2021].
    double leastSkullMm, skullMm, mostSkullMm;
    /// The same of the scalp. No survey of whole scalps is known to us; sphere models take 5
    /// [Naess2017]; wide around these. From brain to skin a newborn has half of an adult's way
    /// [Beauchamp2011].
    double leastScalpMm, mostScalpMm;
    /// From brain to skin, mm, with a voxel's rounding: no guess of the brain comes nearer.
    double leastBrainToSkinMm;

    /// Over the upper half, but for 1 % of the vertices, the scalp is at most this thick (ch2 and
    /// its deformed copies: 14 mm; FreeSurfer's average head has 19 with its skull), and but for
    /// 5 % the skull [Calisan2021]; by the most of their medians. Its thick parts (95th percentile)
    /// are no more times as thick as its thin ones (5th) than this; sound models have 3.
    double mostScalpAnywhereMm() const { return 20.0 / 15 * mostScalpMm; }
    double mostSkullAnywhereMm() const { return 15.0 / 12 * mostSkullMm; }
    static constexpr double kMostSkullRatio = 4;

    /// No head of the age: an inner skull of a third of the least volume or twice the most, a
    /// median skull or scalp three times as thick as the thickest.
    static constexpr double kLeastVolumeShare = 1.0 / 3, kMostVolumeShare = 2;
    static constexpr double kMostThicknessShare = 3;

    bool isAdult() const { return ageYears >= kAdultYears; }
    /// Too thin for 1 mm voxels to show it apart from what lies beside it.
    bool isSkullThin() const { return skullMm < 4; }
    /// "adults", or "heads of 0.5 years".
    std::string whose() const;
    /// Depth of the inner skull's upper three fifths below their convex hull, mm. Models of ch2,
    /// its deformed copies and FreeSurfer's average head: at most 4.9.
    static constexpr double kMostDentMm = 8;

    static constexpr double kNeckBallMm = 8;       ///< as BoundaryOptions::cutNecksMm
    static constexpr double kFlatAreaShare = .01;  ///< of the surface, on one plane
    /// A vertex's edges, by the length of those round it: 1 where triangles are equilateral.
    static constexpr double kMostEdgeRatio = 3;
    /// Edges at a vertex by its gap to the next surface, and the share of vertices above it.
    static constexpr double kMostEdgesPerGap = 2, kEdgesPerGapShare = .05;
    static constexpr double kMostVertexRatio = 3;  ///< between neighbours
};

/// A property of a head model, and whether it is usual.
struct HeadNote {
    std::string_view key;             ///< "necks"
    std::string_view name;            ///< for people: "no narrow neck"
    std::size_t surface = 0;          ///< number of the surface
    std::optional<std::size_t> next;  ///< and of its neighbour, where it is about both
    bool isNoted = false;             ///< unusual: worth a look
    bool isImpossible = false;        ///< no head is so: there is no model
    std::string finding;              ///< the value measured, and its usual range
    std::vector<Vec3> pointsMm{};     ///< where to look; in the surfaces' frame
    /// Code of the warning where what is noted makes a head model doubtful; else empty.
    std::string_view warning{};
    std::vector<HeadFigure> figures{};  ///< what was judged
};

struct PlausibilityOptions {
    bool areNested = true;      ///< they lie in each other, the innermost first
    bool areHeadLayers = true;  ///< as many as headSurface() knows
    UsualHead usual{};
    /// The image that they were made from, in the surfaces' frame (LPS): how much lies on its
    /// faces. Without: how much lies on one plane across an axis.
    std::optional<ImageGeometry> image;
};

/// Judges what is usual of a head model of options.usual: no necks (the innermost, when nested),
/// not cut flat, edges in proportion (each); volume and dents of the inner skull, thickness of
/// skull and scalp (head layers, nested), edges against the gap and numbers of vertices (nested
/// neighbours).
///
/// Up is +z, as in RAS, LPS and tkRAS. What can't be measured of a surface (it is open, not finite,
/// not of a head's size) is left out. Triangles may name points that aren't there.
/// \param surfaces  mm
/// Cost: about a second for a head, most of it for necks (voxels of 1 mm).
std::vector<HeadNote> judgePlausibility(std::span<const TriangleMesh> surfaces,
                                        const PlausibilityOptions& options = {});

}  // namespace adaptiso
