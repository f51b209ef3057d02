#pragma once

#include <filesystem>
#include <string>

#include "Common/RunApp.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Preprocessing/Preprocess.h"

namespace adaptiso {

/// Adds --crop, --smooth, --resample and --interpolation, for programs that look at an image's
/// values. Parsing throws a CLI::ParseError or a UsageError for values that make no sense.
void declarePreprocessingOptions(CLI::App& app, PreprocessOptions& options,
                                 const std::string& heading);

/// preprocess(), whose refusals name the option and the file: "--smooth 50: ... (in.nii)".
/// \throws InvalidInput
Preprocessed preprocessImage(Volume volume, const PreprocessOptions& options,
                             const std::filesystem::path& file);

/// "crop 10:90,0:256,5:236, smooth 1 mm, resample 0.8 mm (linear)": what was done to an image of
/// this size.
std::string preprocessingText(const PreprocessOptions& options, const Index3& size);

}  // namespace adaptiso
