#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "DicomFile.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/ImageIO/ListSeries.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::detail {

/// The images that an input holds.
struct DicomInput {
    std::vector<DicomFile> files;     ///< with pixel data, by path
    std::size_t otherFiles = 0;       ///< DICOM, but no images: reports, plans, DICOMDIR
    std::size_t vendorFiles = 0;      ///< of these, objects of a vendor's own kind
    std::vector<Warning> warnings;    ///< entries that were left out, without names
    std::vector<DicomFault> damaged;  ///< when damaged files are to be listed
};

/// \return a FileError's message without the file's name that it begins with
std::string withoutName(const std::string& message, const std::filesystem::path& file);

/// "file 7 (by name)": its place among all files in and under `folder`. Names of slices often are
/// those of patients, so that messages go by it.
std::string fileNumber(const std::filesystem::path& file, const std::filesystem::path& folder);

/// Calls `read`; errors that begin with the name of a file below `folder` begin with that of the
/// input and fileNumber() instead. \throws as `read`
ReadVolume numberingFiles(const std::filesystem::path& input, const std::filesystem::path& folder,
                          const std::function<ReadVolume()>& read);

/// \throws FileError when it is no gzip file, or a damaged one
bool isGzippedDicom(const std::filesystem::path& file);

/// Policy for damaged files.
enum class DamagedFiles { Refuse, List };

/// Walks through all of a folder, subfolders too. Links to files are followed where liesIn()
/// accepts them, links to folders and hidden folders are not. Files that are no DICOM are left
/// alone, unless they are named like the slices beside them or stand in a slice's place (a pointer,
/// a placeholder, a web page, zeros). Exact copies of a file are left out, with a warning. \param
/// keepsDescription  also keep the series' descriptions, which may identify the patient \throws
/// FileError  a folder can't be listed, a link points nowhere, and for DamagedFiles::Refuse
///         a damaged file (a slice could be missing without a word)
DicomInput readDicomHeaders(const std::filesystem::path& folder, DamagedFiles damaged,
                            bool keepsDescription);

/// The same for one file: of a DICOMDIR the files it names, in its own folder or below.
DicomInput readDicomFileHeaders(const std::filesystem::path& file, DamagedFiles damaged,
                                bool keepsDescription);

}  // namespace adaptiso::detail
