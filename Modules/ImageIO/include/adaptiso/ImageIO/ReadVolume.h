#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Options.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso {

/// A frame of physical coordinates that a file's own may be meant in.
enum class ImageSpace { Lps, Ras };

struct ReadOptions {
    /// The DICOM folder's image group to read: its number (from 1) in the list that a
    /// refusal prints and listSeries() returns, or its SeriesInstanceUID. Unset: the folder must
    /// hold one volume; localizers, segmentations beside a scan and other stray images are left
    /// aside with a warning.
    std::optional<std::string> series{};

    /// The volume of a 4-D image to read, counted from 0. Unset: the image must hold one.
    std::optional<std::int64_t> volumeIndex{};

    /// The resolution of an OME-Zarr to read, 0 the finest (unset), and its channel and
    /// time points, counted from 0. Unset: it must hold one.
    std::optional<std::int64_t> level{}, channel{}, timePoint{};

    /// The space of an NRRD, Zarr or N5 that names none. Unset: an NRRD with space directions is
    /// refused, the others are taken for LPS with a warning.
    std::optional<ImageSpace> space{};

    /// A chunk of a Zarr that is not there (ENOENT) holds the fill value, by its specification, and
    /// a warning gives their number. Set: they are refused.
    bool refusesMissingChunks = false;

    /// DICOM slices that lie unevenly are blended linearly, each from its two neighbours, onto even
    /// steps of their usual distance; the samples become float. Unset: they are refused.
    bool resampleSlices = false;

    /// Run GDCM's decoders in a child process with limits on time and memory, so that their abort,
    /// crash, hang or hunger becomes a FileError. Without it they run in this process, for callers
    /// that must not fork, or that debug a decoder.
    bool sandbox = true;
};

/// Rows of what is read of an image: --series, --volume-index, --level, --channel, --time,
/// --image-space, --refuse-missing-chunks and --resample-slices.
const Options<ReadOptions>& readOptions();

/// A scan as read: the samples in the file's own pixel type, where they lie, and what a user
/// should know about the reading.
struct ReadVolume {
    Volume volume;
    std::string format;  ///< "NIfTI-1", "NIfTI-2", "NRRD", "MetaImage", "MGH", "DICOM", "Zarr 3",
                         ///< "OME-Zarr 0.4"
    std::vector<Warning> warnings;  ///< one line each, without the file's name
    /// How the header scales the stored values: "scl_slope 0.5, scl_inter 0". Empty: it does not.
    std::string scaling{};
};

/// An input holds several images, and the options choose none of them.
class ChoiceNeeded : public FileError {
public:
    enum class Among { Volumes, Series };
    /// \param count  images to choose from
    ChoiceNeeded(const std::string& line, Among among, std::int64_t count)
        : FileError(line), among_(among), count_(count) {}
    Among among() const { return among_; }
    std::int64_t count() const { return count_; }

private:
    Among among_;
    std::int64_t count_;
};

/// Reads one scalar 3-D image: NIfTI (.nii, .nii.gz, .hdr/.img; versions 1 and 2), NRRD (.nrrd,
/// .nhdr), MetaImage (.mha, .mhd), MGH (.mgh, .mgz), a multi-frame or mosaic DICOM file, a
/// DICOMDIR, or a folder that holds the slices of a DICOM series, in subfolders too. What a file is
/// follows from its content, not its name.
///
/// The geometry comes from the format's own header fields, never from a reader's guess:
///   NIfTI      sform if its code > 0, else qform, else the voxel size alone with a warning (as
///              nibabel); xyzt_units metre and micron become mm; RAS -> LPS
///   NRRD       space LPS, RAS or LAS; without a space, spacings alone with a warning;
///              options.space stands in
///   MetaImage  Offset, TransformMatrix (its rows are the axes), ElementSpacing; LPS
///   MGH        Mdc and c_ras; RAS -> LPS
///   DICOM      slices, frames (each with its own position) and mosaic tiles sorted along the
///              normal; the step from slice to slice is kept as it is, so gantry tilt stays in the
///              geometry as shear, with a warning. Segmentations: one segment, on the even steps
///              of its file's frames; slices without a frame are 0
///   Zarr       a folder, version 2 or 3, or N5: one array (1 mm, with a warning), an OME-Zarr of
///              0.4 or 0.5, or N5's group of s0, s1, ... with their pixelResolution and
///              downsamplingFactors: scale and translation of the level, then of the image, units
///              to mm; x, y and z taken for LPS, with a warning, or for options.space. Chunks raw
///              or packed by gzip, zlib, zstd, blosc, lz4, with crc32c, in shards or not; all else
///              is refused by name. Each is read once; beside the image, each thread holds one,
///              packed and unpacked
///   others     as ITK's readers place them, and plug-ins of ITK_AUTOLOAD_PATH, with a warning
///              where they do not know it (Documentation/Formats.md lists them); in a child
///              process, where libadaptisoItkIO.so is installed
///
/// Samples keep their type. Scaled ones (NIfTI scl_slope, DICOM rescale, MetaImage
/// ElementToIntensityFunction) become float32, or float64 where float32 could not hold the stored
/// integers; a DICOM rescale by whole numbers with slope 1 stays an integer type. MONOCHROME1 is
/// not inverted. Of a 4-D file one volume is read; the others must be there too. Warnings count
/// voxels that are not finite, and integers beyond 2^53.
///
/// Nor may more be there than the header says: another image, more slices, rows or frames, wider
/// samples. What else follows the samples is left out with a warning. The slices of a DICOM volume
/// must agree on what their values mean.
///
/// A header's data file lies in or below the header's folder; a link to it may lead to there, to
/// the folder of the file that the header's name links to, or into .git/annex/objects of a folder
/// above.
///
/// \param input  a regular file, a link to one, or a folder.
/// \throws FileError  one line "<file>: <fault>; <remedy>", without patient data, when the input
///         is missing, no regular file, of no known format, truncated or damaged, holds no
///         orientation or a singular one, an unknown space, colour, vector or complex samples,
///         several volumes or series, a single slice, uneven, missing or repeated slices, names
///         data outside its own folder, or contradicts its own data. Nothing is padded and nothing
///         is guessed.
/// \throws ChoiceNeeded  several volumes or series, of which the options choose none
/// \pre  not called from two threads at once for DICOM (GDCM's message switches are global).
/// \throws InvalidInput  options.series and the input is no DICOM, options.level, channel,
///         timePoint or refusesMissingChunks and it is no Zarr or N5, or options.space and it
///         is neither of these nor an NRRD
/// \throws FileError  as well when GDCM's decoder crashes or takes more than it may: 15 s
///         and 1 s for each MB of input, 1 GiB and 64 bytes for each byte (ReadOptions::sandbox)
/// \post no process or file of this call's is left
/// Cost: one copy of the samples, and one DICOM file's; one pass.
ReadVolume readVolume(const std::filesystem::path& input, const ReadOptions& options = {});

/// The reader of this library that readVolume() takes for a file or folder, by its first bytes or
/// name: "NIfTI", "NRRD", "MetaImage", "MGH", "DICOM", "Zarr". Empty where there is none, and where
/// the file cannot be opened. It may be refused all the same.
std::string_view recognizeImage(const std::filesystem::path& input);

}  // namespace adaptiso
