#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso {

/// An RGB colour.
using LabelColor = std::array<std::uint8_t, 3>;

/// What a table says of one value of a label image.
struct LabelEntry {
    std::int32_t value = 0;
    std::string name;          ///< UTF-8 without control characters; empty: only a colour is known
    std::string abbreviation;  ///< likewise; empty: none
    std::optional<LabelColor> color;

    friend bool operator==(const LabelEntry&, const LabelEntry&) = default;
};

/// Names and colours of the values of a label image.
struct LabelTable {
    std::string format;               ///< for people: "BIDS", "FreeSurfer", "ITK-SNAP", ...
    std::vector<LabelEntry> entries;  ///< by value, each once
    std::vector<Warning> warnings;    ///< one line each, without the file's name

    /// \return nullptr when the table does not list the value
    const LabelEntry* find(std::int32_t value) const;
};

/// The file is none of the kinds of tables that are read: it may be something else altogether.
class NoLabelTable : public FileError {
public:
    using FileError::FileError;
};

/// The table that a file's bytes hold. What kind it is follows from the content alone:
///   BIDS         tab-separated, a header with `index` and `name`; `abbreviation`, `color`
///   3D Slicer    the same with commas and LabelValue, Name, Color_R, Color_G, Color_B; and .ctbl
///   or
///                .txt, rows as FreeSurfer's under "# Color table file", `_` for blanks in names
///   FreeSurfer   rows of index, name, R G B A; # begins a comment
///   ITK-SNAP     rows of index, R G B A, two flags and a name in quotes
///   MRIcron      rows of index and name, or index, name and code; or 768 bytes, the reds, greens
///                and blues of the values 0 to 255; black is none
///   nii2mesh     rows of index;name
///   GIFTI        the LabelTable of a .gii
///   FSL          an atlas in XML: of a probabilistic one label n is the value n + 1, of others n
///   JSON         {"1": "name"}, {"1": {"name": .., "color": ..}}, a list of objects with index (or
///                key, id, value), name (or label) and color (or rgb, or red, green, blue), or
///                niivue's {"R": [], "G": [], "B": [], "I": [], "labels": []}
///
/// Files are taken for hostile. A value that is listed twice counts as it was first, with a
/// warning. Text that is not UTF-8 is taken for Latin-1. \param name        of the file, for
/// messages \throws NoLabelTable  "<name>: is no table of labels ..." \throws FileError "<name>:
/// line 7: ...": a table with a fault
LabelTable decodeLabelTable(std::string_view bytes, std::string_view name);

/// \throws FileError as decodeLabelTable(), and when there is no such file or it is above 64 MiB
LabelTable readLabelTable(const std::filesystem::path& file);

/// The table inside a label image, for the volume of that number: the segments in a NRRD header of
/// 3D Slicer (.seg.nrrd: those of one layer), the LabelTable of Connectome or AFNI's
/// VALUE_LABEL_DTABLE in a NIfTI extension. Headers are read, up to 16 MiB, no samples. \return no
/// entries if there is none \throws FileError  the table has a fault; without a file's name
LabelTable readEmbeddedTable(const std::filesystem::path& image, std::int64_t volume = 0);
/// The same from a file's first bytes, unpacked.
LabelTable decodeEmbeddedTable(std::string_view bytes, std::int64_t volume = 0);

/// What was found beside an image, put together.
struct FoundLabelTables {
    LabelTable table;  ///< its warnings name the files
    std::vector<std::filesystem::path> files;
};

/// Looks for tables beside a label image, by name, in this order: its own name with .tsv, .txt,
/// .ctbl, .csv, .json, .xml, .label.gii or .lut, also after the image's ending (MRIcron's
/// aal.nii.txt and aal.nii.lut) or with _lut, -lut or _labels before it; then, for an image of a
/// BIDS dataset, the .tsv of its suffix, in its folder or one above it up to the dataset's, whose
/// entities are all the image's ("dseg.tsv", "sub-01_dseg.tsv", "desc-aseg_dseg.tsv").
///
/// Last comes the table inside the image (readEmbeddedTable()), which `files` then has as the
/// image.
///
/// The first table that has names gives them; a table without names (a .lut) gives colours to those
/// that have none. A file of such a name that is no table is passed over, one with a fault is told
/// in a warning. Nothing is thrown for want of a table.
/// \param volume  of a 4-D image
FoundLabelTables findLabelTables(const std::filesystem::path& image, std::int64_t volume = 0);

/// A colour for a value that no table has one for: strong, and far from those of values near it.
LabelColor labelColor(std::int32_t value);

/// "#ff8000"
std::string hexText(const LabelColor& color);

}  // namespace adaptiso
