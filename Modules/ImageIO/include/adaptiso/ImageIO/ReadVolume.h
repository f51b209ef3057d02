#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "adaptiso/Core/Volume.h"

namespace adaptiso {

struct ReadOptions {
    /// Which of a DICOM folder's image groups to read: its number (from 1) in the list that a
    /// refusal prints, or its SeriesInstanceUID. Unset: the folder must hold one group.
    std::optional<std::string> series;
};

/// A scan as read: the samples in the file's own pixel type, where they lie, and what a user
/// should know about the reading.
struct ReadVolume {
    Volume volume;
    std::string format;  ///< "NIfTI-1", "NIfTI-2", "NRRD", "MetaImage", "MGH", "DICOM"
    std::vector<std::string> warnings;  ///< one line each, without the file's name
};

/// Reads one scalar 3-D image: NIfTI (.nii, .nii.gz, .hdr/.img; versions 1 and 2), NRRD (.nrrd,
/// .nhdr), MetaImage (.mha, .mhd), MGH (.mgh, .mgz), a multi-frame DICOM file, or a folder that
/// holds the slices of one DICOM series. What a file is follows from its content, not its name.
///
/// The geometry comes from the format's own header fields, never from a reader's guess:
///   NIfTI      sform if its code > 0, else qform, else the voxel size alone with a warning (as
///              nibabel); xyzt_units metre and micron become mm; RAS -> LPS
///   NRRD       space LPS, RAS or LAS; without a space, spacings alone with a warning
///   MetaImage  Offset, TransformMatrix (its rows are the axes), ElementSpacing; LPS
///   MGH        Mdc and c_ras; RAS -> LPS
///   DICOM      slices sorted along the normal; the step from slice to slice is kept as it is, so
///              gantry tilt stays in the geometry as shear, with a warning
///
/// Samples keep their type. Scaled ones (NIfTI scl_slope, DICOM rescale) become float32, or
/// float64 where float32 could not hold the stored integers; a DICOM rescale by whole numbers with
/// slope 1 stays an integer type. A 4-D file must hold one volume.
///
/// \param input  a regular file, a link to one, or a folder (not searched below its top level).
/// \throws FileError  one line "<file>: <fault>; <remedy>", without patient data, when the input
///         is missing, no regular file, of no known format, truncated or damaged, holds no
///         orientation or a singular one, an unknown space, colour, vector or complex samples,
///         several volumes or series, a single slice, uneven or missing slices, or names data
///         outside its own folder. Nothing is padded and nothing is guessed.
/// \pre  not called from two threads at once for DICOM (GDCM's message switches are global).
/// Cost: one copy of the samples in memory, plus one DICOM file's or, for NRRD and MetaImage, one
///       transient copy inside ITK; one extra pass over compressed NRRD and MetaImage data.
ReadVolume readVolume(const std::filesystem::path& input, const ReadOptions& options = {});

}  // namespace adaptiso
