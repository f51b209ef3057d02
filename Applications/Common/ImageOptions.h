#pragma once

#include <filesystem>
#include <string>

#include "Common/CommonOptions.h"
#include "Common/RunApp.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso {

/// Options of every program that reads an image.
struct ImageOptions {
    ReadOptions read;
    bool listsSeries = false;  ///< list what a DICOM input holds, and do nothing else
    bool tellsInfo = false;    ///< tell what the image holds, and do nothing else
    bool showsPhi = false;     ///< either tells what may identify the patient too
};

/// Adds readOptions().
void declareReadOptions(CLI::App& app, ReadOptions& options, const std::string& heading);

/// Reads an image as readVolume() does. If the file is a surface, the error says so. Refuses
/// --series unless the input is DICOM.
/// \throws FileError, InvalidInput
ReadVolume readImage(const std::filesystem::path& file, const ReadOptions& options);

/// The same of an image that has no reading options of its own: one of several is refused.
ReadVolume readOnlyImage(const std::filesystem::path& file);

/// Adds --volume, an image beside a program's surfaces, and the same options, which then need it.
/// \return --volume
CLI::Option* declareVolume(CLI::App& app, std::filesystem::path& volume, ReadOptions& options,
                           const std::string& description, const std::string& heading);

/// Adds readOptions(), --list-series, --info and --show-phi.
void declareImageOptions(CLI::App& app, ImageOptions& options, const std::string& heading);

/// Lists the series of `input` on stdout: as text, or as JSON on stdout or in a file, as `common`
/// says. UIDs, descriptions and files' names are shown only with --show-phi.
/// \param program  the calling program's name, for the JSON
/// \return kExitOk, also when some of the series can't be read; kExitCheckFailed with --strict and
/// warnings
/// \throws FileError      the input is no DICOM, or holds no image
int runSeriesList(const std::filesystem::path& input, const ImageOptions& options,
                  const CommonOptions& common, const std::string& program);

}  // namespace adaptiso
