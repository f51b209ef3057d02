#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/Progress.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/HeadModel/Finding.h"
#include "adaptiso/HeadModel/FractionField.h"
#include "adaptiso/HeadModel/HeadFigure.h"
#include "adaptiso/HeadModel/SegmentedSkull.h"

namespace adaptiso {

/// The boundaries of a head model, from inside out. Between brain and inner skull lies the CSF,
/// between white matter and brain the grey matter.
enum class HeadSurface { WhiteMatter, Brain, InnerSkull, OuterSkull, OuterSkin };
inline constexpr std::size_t kHeadSurfaceCount = 5;

/// "white_matter", "brain", "inner_skull", "outer_skull", "outer_skin": the last three are the
/// names that MNE's files have.
std::string_view toString(HeadSurface surface);

/// Surface n, from inside out, of a model of `count`: the inner skull alone (1), or the outermost
/// 3, 4 or 5. \pre n < count \throws InvalidInput  another count
HeadSurface headSurface(std::size_t n, std::size_t count);

struct BoundaryOptions {
    bool innerSkullOnly = false;  ///< MEG: one surface
    /// Surfaces within the inner skull: 1 the brain's, 2 the white matter's as well; not with
    /// innerSkullOnly.
    std::size_t innerSurfaces = 0;
    std::size_t surfaceCount() const { return innerSkullOnly ? 1 : 3 + innerSurfaces; }

    /// Side of the working grid's voxels, mm; 0: the image's own voxels if they are cubes of 0.7
    /// to 1.5 mm, else 1 mm.
    double stepMm = 0;
    /// Gaussian (standard deviation, mm) that every boundary is smoothed with at the end: more
    /// than the voxel stairs, less than the edges of a BEM mesh. A sphere of radius R moves
    /// inwards by smoothingMm^2 / R: 0.03 mm at 80 mm.
    double smoothingMm = 1.5;
    /// Closing (radius, mm) of the skin and of the brain: gaps, sulci, canals narrower than twice
    /// this are filled.
    double closingMm = 10;
    double minSkullMm = 2;  ///< least thickness of the skull; thinner places are pushed outwards
    double minScalpMm = 2;  ///< the same for the scalp
    /// Least thickness of the CSF between brain and inner skull; the brain gives way. Real CSF is
    /// thinner where the head rests: no usual number of triangles resolves that.
    double minCsfMm = 1;
    /// Least thickness of the grey matter between white matter and brain; the white matter gives
    /// way. Cortex is 1 to 4.5 mm thick [Fischl2000].
    double minGreyMm = 1;
    /// Closing (radius, mm) of the brain's own surface, and, twice as wide, of the white matter's:
    /// sulci narrower than twice this are filled, as edges of some mm can't follow them.
    double sulciMm = 3;
    double maxSkullMm = 20;  ///< bone farther from the inner skull (face, neck) counts as scalp
    /// Necks of the inner skull, as leaks down a foramen are, that a ball of this radius (mm) can't
    /// enter and that reach more than 10 mm are cut off. Wider than any foramen but the foramen
    /// magnum (jugular: 10 x 17 mm), narrower than the lobes' poles. 0: nothing is cut. Surfaces
    /// are not cut: boundariesFromSurfaces() makes them anew as they are.
    double cutNecksMm = 8;

    double csfMm = 2;    ///< T1: from a brain mask out to the inner skull
    double skullMm = 0;  ///< T1: thickness where it shows no skull; 0: usual at the age (6)
    /// T1: a child's brain lies nearer to the skin than an adult's, and is smaller (UsualHead).
    double ageYears = 18;
    double skullHu = 300;  ///< CT: isovalue of bone
    double skinHu = -300;  ///< CT: isovalue of skin
    ProgressCallback progress{};

    /// Least distance from a surface to the next one around it. \pre not the skin's
    double minGapMm(HeadSurface inner) const {
        return std::array{minGreyMm, minCsfMm, minSkullMm,
                          minScalpMm}[static_cast<std::size_t>(inner)];
    }
};

/// The solids that the surfaces of a head model bound: each one component without cavity or
/// handle (a ball), each inside the next with at least the gaps asked for (to about a voxel; the
/// mesh steps that follow see to the rest).
struct HeadBoundaries {
    std::vector<FractionField> solids;  ///< by headSurface()
    std::vector<std::string> notes;     ///< guesses and changes, one line each
    std::vector<Warning> warnings;      ///< doubts about the result
    std::vector<Finding> doubts{};      ///< those of them that have a place (LPS mm)
    std::vector<HeadFigure> figures{};  ///< of a T1: what was judged
    /// For each solid the places (LPS mm) where the image itself shows its surface: sides of
    /// labels, levels that are passed, ends of the skull's dark band. The rest was closed, filled,
    /// cut, grown or taken as usual. Empty where nobody looked (surfaces).
    std::vector<std::vector<Vec3>> seenMm{};
    std::optional<SegmentedHead> segmented{};  ///< of labels and probabilities with a skull
};

/// From a T1-weighted image, alone or with a brain mask (brain > 0.5 of the mask's range or, of a
/// skull-stripped image, brain where it is not zero).
///
/// Outer skin: the largest piece above a threshold between air and tissue, closed, with every
/// cavity filled, also those that open at the image's border (airways at the neck).
/// Inner skull: the brain mask closed and grown by csfMm. Without a mask the brain is found by
/// thresholds around the level of the head's middle, opened until it comes loose from the scalp;
/// a note says so.
/// Outer skull: along rays from the inner skull, where the T1's dark skull band ends at the
/// scalp; thickness smoothed over the surface, and skullMm where no band is seen. Kept inside the
/// scalp.
///
/// \param brainMask  on any grid in the same space
/// Where CSF is brighter than brain (a T2), the guess is all that is bright within the skull,
/// without csfMm; a warning says so.
///
/// \throws InvalidInput  no head, or no brain, is found (an infant's without its age: by that
/// name); the skull shows on less than 20 % of the
///                       rays (a skull-stripped image); the mask is empty, outside the image, not
///                       of a brain's size (200 to 2500 cm3), or not below the skin of this head
HeadBoundaries boundariesFromT1(const VolumeView& t1, const std::optional<VolumeView>& brainMask,
                                const BoundaryOptions& options = {});

/// Sources for the brain besides a T1. All in the same space.
struct BrainSources {
    std::optional<VolumeView> mask;  ///< as above
    /// Labels of FreeSurfer or FastSurfer (aseg): all but 0, CSF and what lies outside of the brain
    /// are the brain. It is the mask as well where there is none.
    std::optional<VolumeView> aseg;
    std::vector<TriangleMesh> pial;   ///< closed surfaces of the cortex, LPS mm
    std::vector<TriangleMesh> white;  ///< the same of the white matter
    /// Lesions of the brain (not 0), whatever their grey values: they count as brain.
    std::optional<VolumeView> lesion{};
};

/// The same, and with options.innerSurfaces the brain's own surface: what lies within the pial
/// surfaces and aseg's labels or, where the cortex is not told by either, what of the mask (or of
/// the guess) is brighter than half of the brain's level, as CSF is not. Sulci narrower than 2
/// sulciMm are filled, and the surface keeps minCsfMm from the inner skull. White matter: what lies
/// within the white surfaces and aseg's labels of it, made whole as boundariesFromLabels() does.
/// \throws InvalidInput  as above; pial or white surfaces that enclose nothing in this head; white
///                       matter wanted without either source
HeadBoundaries boundariesFromT1(const VolumeView& t1, const BrainSources& brain,
                                const BoundaryOptions& options = {});

/// Which labels of a segmentation belong to what. Each list is a tissue of its own: the inner
/// skull encloses `brain`, the outer skull brain and `skull`, the skin all of them.
struct TissueLabels {
    std::vector<std::int64_t> brain;  ///< brain and CSF; the rest of it where these are named apart
    std::vector<std::int64_t> skull;
    std::vector<std::int64_t> scalp;
    /// Labels not named above that are not 0 count as brain (FreeSurfer's aseg).
    bool othersAreBrain = false;
    std::vector<std::int64_t> csf{};    ///< within the inner skull, outside of the brain
    std::vector<std::int64_t> white{};  ///< white matter, and what counts as it; part of the brain
    std::vector<std::int64_t>
        spongy{};  ///< spongy bone; may be listed as skull too, and counts as it
};

/// The programs whose labels are known: "charm", "aseg", ...
std::vector<std::string> tissuePresetNames();
/// \throws InvalidInput  another name
TissueLabels tissuePreset(std::string_view name);

/// From a label map. Labels become parts of voxels by smoothing and interpolating each boundary's
/// own indicator, so that surfaces are not stairs. White matter is made one solid: folds narrower
/// than 4 sulciMm and all within it that is shut off then (ventricles, deep grey matter) are
/// filled; loose pieces are left out; notes give the volumes. \param headMask  on the labels' grid:
/// what is not 0 there lies within the skin, whatever its label \throws InvalidInput  a mask on
/// another grid; a tissue has no label in the image; labels listed for two tissues; tissues
///                       that don't lie round each other in their order; innerSurfaces without CSF
HeadBoundaries boundariesFromLabels(const VolumeView& labels, const TissueLabels& tissues,
                                    const BoundaryOptions& options = {},
                                    const std::optional<VolumeView>& headMask = std::nullopt);

/// From tissue probabilities in SPM's order: c1 grey, c2 white, c3 CSF, c4 skull, c5 scalp (c6 air
/// is not needed). All on one grid; values are parts of a voxel (0 to 1; integers are scaled by
/// the largest value of all maps).
/// \throws InvalidInput  fewer than five maps (three for innerSkullOnly), grids that differ, or
///                       tissues as above
HeadBoundaries boundariesFromProbabilities(std::span<const VolumeView> maps,
                                           const BoundaryOptions& options = {});

/// From a CT in Hounsfield units: skin at skinHu, bone at skullHu; the inner skull is the cavity
/// of the bone that a ball of 18 mm radius cannot leave.
/// \throws InvalidInput  no head, no bone, or no cavity in it; innerSurfaces: a CT shows no cortex
HeadBoundaries boundariesFromCt(const VolumeView& ct, const BoundaryOptions& options = {});

/// From three to five surfaces (or the inner skull alone) that need mending: each is made a solid
/// again by majority of its winding along three axes, so that holes, crossings and stray pieces go.
/// \param surfaces  as many as the options ask for, LPS mm, inside out
/// \throws InvalidInput  another number; a surface without volume
HeadBoundaries boundariesFromSurfaces(std::span<const TriangleMesh> surfaces,
                                      const BoundaryOptions& options = {});

}  // namespace adaptiso
