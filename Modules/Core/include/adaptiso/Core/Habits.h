#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace adaptiso {

/// Advice on an option of another program: "did you mean --iso?", "--vertices 2562 is ico 4".
/// Names only options that this program has.
/// \param program  "adaptiso-mesh"
/// \param typed    without dashes
/// \param known    long names of the program's options, without dashes
std::optional<std::string> habitAnswer(std::string_view program, std::string_view typed,
                                       const std::vector<std::string>& known);

}  // namespace adaptiso
