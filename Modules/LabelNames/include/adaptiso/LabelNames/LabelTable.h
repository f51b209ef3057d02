#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso {

/// An RGB colour.
using LabelColor = std::array<std::uint8_t, 3>;

/// A row of a table: one value of a label image.
struct LabelEntry {
    std::int64_t value = 0;
    std::string name;  ///< UTF-8 without control characters; may be empty (only a colour is known)
    std::string abbreviation;  ///< likewise; may be empty
    std::optional<LabelColor> color;

    friend bool operator==(const LabelEntry&, const LabelEntry&) = default;
};

/// Names and colours of the values of a label image.
struct LabelTable {
    std::string format;               ///< for people: "BIDS", "FreeSurfer", "ITK-SNAP", ...
    std::vector<LabelEntry> entries;  ///< by value, each once
    std::vector<Warning> warnings;    ///< one line each, without the file's name

    /// \return nullptr when the table does not list the value
    const LabelEntry* find(std::int64_t value) const;
};

/// The file is not a label table of a known format; it may be anything else.
class NoLabelTable : public FileError {
public:
    using FileError::FileError;
};

namespace labelnames {
struct TableCodec;
}

/// A kind of table.
struct LabelTableKind {
    std::string_view name;                  ///< whose it is
    std::vector<std::string_view> endings;  ///< of tables of this kind beside an image
    const labelnames::TableCodec* codec;
    std::string_view looks;  ///< what it looks like, in Markdown
};

/// All kinds; the likeliest endings first.
std::span<const LabelTableKind> labelTableKinds();
/// "BIDS, CAT12, ..."
std::string labelTableNames();

/// The table that a file's bytes hold, recognised by content alone (labelTableKinds()).
///
/// Rows of other columns are refused, as numbers beside a name are no part of it. A colour that
/// can't be read is left out with a warning.
/// Files are taken for hostile. The first entry of a value counts; others give a warning. Text that
/// is not UTF-8 is read as Latin-1.
/// \param name  of the file, for messages
/// \throws NoLabelTable  "<name>: is no table of labels ..."
/// \throws FileError     "<name>: line 7: ...": a table with a fault
LabelTable decodeLabelTable(std::string_view bytes, std::string_view name);

/// \throws FileError as decodeLabelTable(), and when there is no such file or it is above 64 MiB
LabelTable readLabelTable(const std::filesystem::path& file);

/// The table inside a label image, for volume number `volume`: the segments in a NRRD header of
/// 3D Slicer (.seg.nrrd: those of one layer), or the LabelTable of Connectome Workbench in a NIfTI
/// extension. Reads headers of up to 16 MiB, no samples.
/// \return no entries if the image has no table
/// \throws FileError  the table has a fault; without a file's name
LabelTable readEmbeddedTable(const std::filesystem::path& image, std::int64_t volume = 0);
/// The same from a file's first bytes, unpacked.
LabelTable decodeEmbeddedTable(std::string_view bytes, std::int64_t volume = 0);

/// The tables found beside an image, merged.
struct FoundLabelTables {
    LabelTable table;  ///< its warnings name the files
    std::vector<std::filesystem::path> files;
};

/// Looks for tables beside a label image, by name, in this order: its own name with
/// LabelTableKind::endings, also after the image's ending (MRIcron's
/// aal.nii.txt and aal.nii.lut) or with _lut, -lut or _labels before it; then, for an image of a
/// BIDS dataset, the .tsv of its suffix, in its folder or one above it up to the dataset's, whose
/// entities are all the image's ("dseg.tsv", "sub-01_dseg.tsv", "desc-aseg_dseg.tsv").
///
/// The table inside the image comes last (readEmbeddedTable()); `files` then lists the image.
///
/// The first table that has names gives them; a table without names (a .lut) gives colours to those
/// that have none. Files of such names that are no tables are skipped; faulty ones give a warning.
/// \param volume  of a 4-D image
FoundLabelTables findLabelTables(const std::filesystem::path& image, std::int64_t volume = 0);

/// A strong colour for a value without one in any table, far from those of near values.
LabelColor labelColor(std::int32_t value);

/// Colours of the labels of one map, in their order: `given`, else labelColor(). Of up to 64
/// labels, one that would look like another takes a colour far from those of all others.
/// \pre  both are of one size
std::vector<LabelColor> labelColors(std::span<const std::int32_t> labels,
                                    std::span<const std::optional<LabelColor>> given);

/// "#ff8000"
std::string hexText(const LabelColor& color);

}  // namespace adaptiso
