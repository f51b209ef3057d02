#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "DicomFile.h"
#include "DicomStack.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso::detail {

/// Decodes and rescales (PS3.3, C.11.1) the planes of a stack, each file once, and blends them
/// where the stack says so.
///
/// Samples keep their stored type where nothing is rescaled; slope 1 and whole intercepts give the
/// smallest integer type that holds all values; all else, and blending, gives a float type.
/// \throws FileError when a file can't be decoded or memory is short
Volume decodeDicomStack(const std::filesystem::path& input, const std::vector<DicomFile>& files,
                        const DicomStack& stack, std::vector<Warning>& warnings);

}  // namespace adaptiso::detail
