#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "adaptiso/HeadPipeline/BemFiles.h"
#include "adaptiso/HeadPipeline/BemModel.h"
#include "adaptiso/Json/Json.h"

namespace adaptiso {

/// Parts of the report adaptiso-bem/1, as adaptiso-bem's README.md describes it, for the program
/// and for those who make head models without it. A number that is not known, or not finite, is
/// null. A file's name need not be UTF-8: dump with error_handler_t::replace.

/// `input`
Json bemInputJson(const BemModel& model);

/// `options`, without threads and strict.
Json bemOptionsJson(const BemModelOptions& options);

/// From `notes` to `findings`.
Json bemModelJson(const BemModel& model);

/// `output`
/// \param files         names and bytes of the folder's files
/// \param subjectFiles  names of what was put into a subject's folder
Json bemOutputJson(const BemModel& model, const BemFileOptions& options,
                   const std::vector<std::pair<std::string, std::uintmax_t>>& files,
                   const std::vector<std::string>& subjectFiles = {});

}  // namespace adaptiso
