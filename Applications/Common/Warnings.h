#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "Common/CommonOptions.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso {

/// Each warning as a line on stderr, "adaptiso-mesh: warning: ball.nii: ...", unless
/// --no-warnings is given. --quiet does not silence them.
void printWarnings(const std::string& program, const CommonOptions& common,
                   std::span<const Warning> warnings);

/// The warning "count-missed": "has 108 triangles, not 3 as asked for: keeping all its pieces left
/// little to gain; they lie up to 0.25 mm off, and more triangles lie closer".
///
/// \param what  "triangles"
///
/// \param kept  "all its pieces"
Warning countMissed(const std::string& file, const std::string& what, std::int64_t written,
                    std::int64_t wanted, const std::string& kept, double errorBoundMm);

/// Those that printWarnings() has been given so far, hidden or not.
std::span<const Warning> printedWarnings();

/// `text`, a code of warningCodes(). \throws UsageError  it is not; names the nearest
std::string warningCode(const std::string& option, const std::string& text);

/// --strict is given and there are warnings that --allow does not let pass: the run is to end with
/// kExitCheckFailed.
bool failsStrict(const CommonOptions& common, std::span<const Warning> warnings);

/// The message of --strict, in one line: "--strict: 2 warnings, so no surface was written:
/// ball.nii: ...; ball.nii: ...".
/// \param consequence  "so no surface was written"; empty: none
std::string strictFailure(const CommonOptions& common, std::span<const Warning> warnings,
                          const std::string& consequence);

}  // namespace adaptiso
