#include "adaptiso/Core/Warning.h"

#include <algorithm>
#include <iterator>

#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

/// A line for each code, in alphabetical order; a test compares it with Documentation/Warnings.md.
constexpr WarningCode kCodes[] = {
    {"array-left-out",
     "values of the input are not in the output: of triangles, or what its format cannot hold"},
    {"attributes-left-out", "colours or numbers of an STL file's triangles were left out", true},
    {"blended-labels", "an image that may hold labels was smoothed or resampled with blending"},
    {"bound-exceeded", "the format's digits take the file beyond the bound that was asked for"},
    {"bound-over-size", "a bound in mm is more than a tenth of the surface's diagonal"},
    {"brain-doubtful", "a part of the brain may be missing, or muscle was taken for brain"},
    {"cap-moved-far", "electrodes were moved onto the skin by more than 10 mm on average"},
    {"colors-not-read", "a table of names has colours that cannot be read; the names were taken"},
    {"copies-left-out", "copies of files, compressed or exact, were left out"},
    {"count-missed", "the number of triangles asked for was not reached"},
    {"count-unset", "a surface's count is 0 or all ones; all that follow were read", true},
    {"distance-rough", "distances are rough or of fewer points: too many triangles lie as near"},
    {"electrodes-left-out", "electrodes have no place in their file (n/a, NaN, empty)", true},
    {"empty-slices",
     "a segmentation's frames have no neighbours; slices without a frame are empty"},
    {"entries-left-out", "pipes, links to folders and link loops of a folder were left out"},
    {"fewer-images", "headers count more slices, images or time points than there are"},
    {"file-left-out", "a file that is written by default was left out"},
    {"first-image-taken", "the input holds several images; the first was taken"},
    {"footer-cut-off", "the notes behind an MGH image are cut off"},
    {"gantry-tilt", "the slices are tilted against their stack; the shear was kept"},
    {"guessed-brain", "the brain of a T1 was guessed by thresholds"},
    {"guessed-frame", "a file does not say its coordinate frame; one was assumed"},
    {"guessed-landmarks", "nasion and ears, or the inion, were guessed by the shape of the head"},
    {"guessed-orientation", "the image does not say its orientation; one was assumed"},
    {"guessed-position", "the image does not say its position; one was assumed"},
    {"guessed-spacing", "the image does not say its voxel size; 1 mm was assumed"},
    {"guessed-unit", "a file does not say its unit of length; one was assumed"},
    {"head-cut", "the image cuts the head beside or above the brain, or the brain itself"},
    {"head-points-off", "digitized head points lie more than 5 mm from the skin on average"},
    {"inner-skull-dented",
     "the inner skull of a head model has a deep dent: a lesion, or lost brain"},
    {"label-listed-twice", "a table of names lists a label twice; the first entry counts"},
    {"label-missing", "the map holds no voxel of a label that was asked for"},
    {"label-nameless", "the table of names lacks labels of the map"},
    {"landmarks-unknown", "nasion and ears are neither given nor can be guessed"},
    {"large-integers", "voxels hold integers beyond 2^53, which isovalues cannot distinguish"},
    {"lines-left-out", "lines or points beside a surface's polygons were left out", true},
    {"looks-like-labels", "labels may have been cut above the first, or be a brain mask"},
    {"many-vertices", "the head model has more vertices than solvers can usually handle"},
    {"mask-covered", "all voxels of a mask lie in masks that keep them, so it has no region"},
    {"mask-empty", "a mask holds no voxel, so it has no region", true},
    {"masks-overlap", "masks hold the same voxels; a rule decides which keeps them", true},
    {"missing-chunks", "chunks of a Zarr are missing; the fill value stands for them"},
    {"mixed-signedness", "some slices hold signed samples and some unsigned ones"},
    {"names-not-used", "a table of names beside the map cannot be read"},
    {"noise-kept", "the default bound left noise at full resolution; a stated one thins it", true},
    {"not-finite", "voxels hold NaN or infinity"},
    {"objects-left-aside", "a vendor's DICOM objects without an image were left aside"},
    {"other-model", "the subject's bem folder keeps files of another head model"},
    {"overlap-unmeasured", "the overlap (Dice) could not be measured"},
    {"participants-not-read", "participants.tsv cannot be read, so no participant was looked up"},
    {"parts-dropped",
     "parts too thin for the bound, more than a twentieth of the surface, were dropped"},
    {"pial-outside", "pial surfaces reach beyond the head model's inner skull"},
    {"pieces-inside-out", "pieces of the surface face inward where they should face outward"},
    {"pixdim-sform-differ",
     "the voxel sizes by pixdim and by the sform differ; the sform was taken"},
    {"polygons-cross",
     "polygons cross themselves, or have parts without width; each is a fan of triangles"},
    {"polygons-cut", "a surface's polygons or triangle strips were cut into triangles", true},
    {"qform-sform-differ", "qform and sform place the image differently; the sform was taken"},
    {"resample-filled", "resampling filled what lies around the image with its smallest value"},
    {"scaling-ignored", "the header's scaling is incomplete; the stored values were taken"},
    {"series-left-aside", "images of other series in the folder were left aside"},
    {"several-solids", "a file holds several solids or meshes, read as one surface", true},
    {"sides-doubtful", "names of electrodes, or nasion and ears, contradict the sides of the head"},
    {"size-doubtful", "a surface is smaller than 1 mm; its unit may not be mm", true},
    {"skull-closed", "a hole in the segmentation's skull is closed in the head model"},
    {"skull-thickened", "much of the head model's skull is thicker than the segmentation's"},
    {"skull-unseen", "the skull shows on too few of the rays to the scalp"},
    {"slices-resampled", "uneven slices were resampled to even ones"},
    {"sources-moved", "many sources lay outside the brain's compartment, or were moved far"},
    {"spongy-bone-missing", "the labels' spongy bone lies outside of the head model's skull"},
    {"stray-bits", "bits that are no part of the samples were left out"},
    {"subject-not-listed", "participants.tsv does not list a participant of the dataset"},
    {"subject-not-there", "participants.tsv lists a participant without a folder"},
    {"supports-left-out", "a 3MF's supports, and objects that are no solid, were left out", true},
    {"surface-moved", "a head model's surface does not lie where it was given"},
    {"surface-scaled",
     "coordinates were scaled about the origin; the file does not lie on the scan", true},
    {"surface-unsound", "the surface has faults (holes aside)"},
    {"t2-weighted", "CSF is brighter than brain in an image given as a T1"},
    {"thickness-unusual", "skull or scalp of a head model is unusually thick, thin or uneven"},
    {"thin-walls", "a solid has walls thinner than a printer makes"},
    {"trailing-bytes", "bytes follow the image or surface that a file counts; they were left out"},
    {"uids-differ", "slices have UIDs of their own; they were read as one series"},
    {"unit-converted", "lengths were converted to millimetres"},
    {"values-scaled", "values are scaled as the header says, which some programs ignore"},
    {"whole-image-read", "the image is no Zarr, so each step reads all of it"},
};

}  // namespace

bool isNote(const Warning& warning) {
    const auto known = std::ranges::find(kCodes, warning.code, &WarningCode::code);
    return known != std::end(kCodes) && known->isNote;
}

std::span<const WarningCode> warningCodes() {
    return kCodes;
}

void addWarnings(std::vector<Warning>& warnings, std::span<const Warning> more,
                 const std::string& file) {
    for (const Warning& warning : more) {
        warnings.push_back(warning);
        if (warning.file.empty()) warnings.back().file = file;
    }
}

std::optional<Warning> boundOverSize(const std::string& name, double mm, double diagonalMm,
                                     const std::string& file) {
    constexpr double kLargestPart = 0.1;
    if (!(diagonalMm > 0) || !(mm > kLargestPart * diagonalMm)) return std::nullopt;
    return Warning{"bound-over-size",
                   name + " of " + formatShort(mm) +
                       " mm is more than a tenth of the surface's diagonal, " +
                       formatShort(diagonalMm) + " mm; are its coordinates in mm?",
                   file};
}

std::vector<std::string> linesOf(std::span<const Warning> warnings) {
    std::vector<std::string> lines;
    for (const Warning& warning : warnings) lines.push_back(warning.line());
    return lines;
}

}  // namespace adaptiso
