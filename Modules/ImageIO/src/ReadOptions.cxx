#include <array>

#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso {
namespace {

/// A series' number from 1, or a UID: digits and dots.
bool isSeries(std::string_view text) {
    const bool hasDigits = text.find_first_of("123456789") != text.npos &&
                           text.find_first_not_of("0123456789.") == text.npos &&
                           text.front() != '.';
    return hasDigits && text.size() <= 64;  // no UID is longer
}

constexpr std::array<std::string_view, 2> kSpaces{"lps", "ras"};  // as ImageSpace

}  // namespace

const Options<ReadOptions>& readOptions() {
    static const Options<ReadOptions> kRows{
        option<&ReadOptions::series>(
            {.name = "series",
             .key = "series",
             .valueName = "N|UID",
             .help = "Which series of a DICOM input with several: its number in the list that "
                     "--list-series prints, or its UID",
             .isUsable = isSeries,
             .textRule = "a number from the list of --list-series, from 1, or a series' UID"}),
        option<&ReadOptions::volumeIndex>(
            {.name = "volume-index",
             .key = "volumeIndex",
             .valueName = "N",
             .help = "Which volume of a 4-D image (time points, echoes), counted from 0"}),
        option<&ReadOptions::level>({.name = "level",
                                     .key = "level",
                                     .valueName = "N",
                                     .help = "Which resolution of an OME-Zarr or N5, 0 the finest",
                                     .standard = "0"}),
        option<&ReadOptions::channel>(
            {.name = "channel",
             .key = "channel",
             .valueName = "N",
             .help = "Which channel of an OME-Zarr or N5 with several, counted from 0"}),
        option<&ReadOptions::timePoint>(
            {.name = "time",
             .key = "time",
             .valueName = "N",
             .help = "Which time point of an OME-Zarr or N5 with several, counted from 0"}),
        option<&ReadOptions::space>({.name = "image-space",
                                     .key = "imageSpace",
                                     .help = "Axes of an NRRD, OME-Zarr or N5 whose header does "
                                             "not name them",
                                     .words = kSpaces}),
        option<&ReadOptions::refusesMissingChunks>(
            {.name = "refuse-missing-chunks",
             .key = "refuseMissingChunks",
             .help = "Refuse a Zarr in which chunks are missing; else the fill value stands for "
                     "them, with a warning"}),
        option<&ReadOptions::resampleSlices>(
            {.name = "resample-slices",
             .key = "resampleSlices",
             .help = "Blend unevenly spaced DICOM slices linearly onto even steps, in place of "
                     "refusing them"})};
    return kRows;
}

}  // namespace adaptiso
