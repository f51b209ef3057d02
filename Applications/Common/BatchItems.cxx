#include "Common/BatchItems.h"

#include <fstream>
#include <iostream>
#include <map>
#include <sstream>

#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> splitAtTabs(const std::string& line) {
    std::vector<std::string> parts;
    std::istringstream stream(line);
    for (std::string part; std::getline(stream, part, '\t');) {
        if (!part.empty()) parts.push_back(part);
    }
    return parts;
}

std::vector<std::string> readLines(const fs::path& list) {
    std::ifstream file;
    if (list != "-") {
        file.open(list);
        if (!file || fs::is_directory(list)) {
            throw FileError("--list " + list.string() + ": can't be read");
        }
    }
    std::istream& in = list == "-" ? std::cin : file;
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) {
        if (!line.empty() && line.back() == '\r') line.pop_back();
        if (!line.empty() && line.front() != '#') lines.push_back(line);
    }
    if (in.bad()) throw FileError("--list " + list.string() + ": can't be read");
    return lines;
}

}  // namespace

std::string folderName(const fs::path& file) {
    const fs::path folder = fs::weakly_canonical(fs::absolute(file)).parent_path();
    return folder.has_filename() ? folder.filename().string() : "surfaces";
}

std::vector<BatchItem> readBatchList(const fs::path& list, bool holdsSurfaces,
                                     const std::function<std::string(const fs::path&)>& nameOf) {
    std::vector<BatchItem> items;
    for (const std::string& line : readLines(list)) {
        const std::vector<std::string> parts = splitAtTabs(line);
        if (parts.empty()) continue;
        BatchItem item;
        if (holdsSurfaces) {
            item.inputs.assign(parts.begin(), parts.end());
            item.name = folderName(item.inputs.front());
        } else if (parts.size() > 2) {
            throw InvalidInput("--list " + list.string() + ": '" + line +
                               "' has more than two parts: an input and its name");
        } else {
            item.inputs = {parts[0]};
            item.name = parts.size() == 2 ? parts[1] : nameOf(item.inputs.front());
        }
        if (item.name.find('/') != std::string::npos || item.name == "." || item.name == "..") {
            throw InvalidInput("--list " + list.string() + ": '" + item.name +
                               "' is no name for files");
        }
        items.push_back(std::move(item));
    }
    if (items.empty()) throw InvalidInput("--list " + list.string() + ": names no input");
    return items;
}

void requireOwnNames(const std::vector<BatchItem>& items) {
    std::map<fs::path, const BatchItem*> known;
    for (const BatchItem& item : items) {
        const auto [place, isNew] = known.emplace(item.folder / item.name, &item);
        if (isNew) continue;
        throw InvalidInput(item.inputs.front().string() + " and " +
                           place->second->inputs.front().string() + ": both are named '" +
                           item.name + "'; give them names of their own in a --list");
    }
}

}  // namespace adaptiso
