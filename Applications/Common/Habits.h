#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace adaptiso {

/// What to do in place of an option that users know from other programs: "did you mean --iso?",
/// "--vertices 2562 is ico 4". Names options that the program has only.
/// \param program  "adaptiso-mesh"
/// \param typed    without dashes
/// \param known    long names of the program's options, without dashes
std::optional<std::string> habitAnswer(std::string_view program, std::string_view typed,
                                       const std::vector<std::string>& known);

}  // namespace adaptiso
