#pragma once

#include <string>

#include "Common/CliNames.h"

namespace adaptiso {

/// All that --help says, for machines (`adaptiso-mesh --help-json`): manual pages and completions
/// of shells are made from it when building (Applications/manual), so that they say what --help
/// says.
///
/// One JSON object: `schema` ("adaptiso-options/1"), `program`, `version`, `description`, `footer`
/// and `options`, a list in the order of --help of `names` (empty: positional), `value` (as --help
/// names it; empty: a flag), `repeats`, `required`, `group`, `description`, `needs` and `excludes`.
std::string optionsJson(const CLI::App& app);

}  // namespace adaptiso
