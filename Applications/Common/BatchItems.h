#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace adaptiso {

/// What one run of a batch works on.
struct BatchItem {
    std::string name;                           ///< stands for {name}, and names the record
    std::vector<std::filesystem::path> inputs;  ///< one, or the surfaces of one head
    std::filesystem::path folder;               ///< outputs and record go there
    std::string fault{};  ///< why it fails without being run; empty: it is run
};

/// The inputs that a list names: one a line, with a name after a tab where one is given; empty
/// lines and those that begin with # are left out. Paths are relative to the current folder. \param
/// list          a file; "-": stdin \param holdsSurfaces  lines hold the surfaces of one head, with
/// tabs between, instead; the name
///                      is that of the folder of the first
/// \param nameOf        name of an input without one
/// \throws FileError    the list can't be read
/// \throws InvalidInput  it names nothing, or a line has too many parts
std::vector<BatchItem> readBatchList(
    const std::filesystem::path& list, bool holdsSurfaces,
    const std::function<std::string(const std::filesystem::path&)>& nameOf);

/// The name of the folder that holds `file`.
std::string folderName(const std::filesystem::path& file);

/// \throws InvalidInput  two items would write under one name
void requireOwnNames(const std::vector<BatchItem>& items);

}  // namespace adaptiso
