#include "Common/Batch.h"
#include "Common/UsageWords.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/TextCells.h"
#include "adaptiso/Core/TextLines.h"

namespace adaptiso {

std::vector<BatchItem> listedItems(std::string_view text, const std::string& option,
                                   bool areOneItem, const NameInput& nameOf) {
    if (const std::string fault = faultOfText(text); !fault.empty()) {
        throw FileError(option + ": " + fault);
    }
    std::vector<BatchItem> items;
    TextLines lines(text);
    while (const auto line = lines.next()) {
        if (line->starts_with('#')) continue;
        std::vector<std::string> parts = cellsOf(*line, '\t').value();
        std::erase(parts, "");
        if (parts.empty()) continue;
        BatchItem item;
        if (areOneItem) {
            item = {nameOf(parts[0]), {parts.begin(), parts.end()}};
        } else if (parts.size() <= 2) {
            item = {parts.size() == 2 ? parts[1] : nameOf(parts[0]), {parts[0]}};
        } else {
            throw InvalidInput(option + ": " + linePlace(lines.number()) + shown(*line) +
                               " has more than two parts: an input and its name");
        }
        if (item.name.find('/') != std::string::npos || item.name == "." || item.name == "..") {
            throw InvalidInput(option + ": " + shown(item.name) + " is no name for files");
        }
        items.push_back(std::move(item));
    }
    if (items.empty()) throw InvalidInput(option + ": names no input");
    return items;
}

}  // namespace adaptiso
