#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace adaptiso {

/// Another of our programs, as it is installed beside this one.
struct Sibling {
    std::string name;  ///< "adaptiso-mesh"
    std::filesystem::path executable;
    std::string version;               ///< what its --version prints
    std::vector<std::string> options;  ///< long names without dashes
};

/// Asks the program of that name in this program's folder.
/// \throws InvalidInput  there is none, or it does not answer
Sibling findSibling(const std::string& name);

/// The options in `list`, "iso=100,largest,crop=:,:,40:", as the sibling takes them: "--iso=100",
/// "--largest", "--crop=:,:,40:". A part that begins with a letter and is a name, or a name and
/// '=', is an option; others belong to the value before them.
/// \param option    that `list` is the value of, for messages: "--surfaces"
/// \param refused   options that are this program's business
/// \throws UsageError  the sibling has no such option, or it is one of `refused`
std::vector<std::string> siblingOptions(const std::string& option, const std::string& list,
                                        const Sibling& sibling,
                                        const std::vector<std::string>& refused);

}  // namespace adaptiso
