#include "Siblings.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "Common/ChildProcess.h"
#include "Common/Json.h"
#include "Common/RunApp.h"
#include "Common/UsageWords.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

std::string ask(const fs::path& program, const std::string& question) {
    const ChildResult said = runChild(program, {question});
    if (said.signal != 0 || said.exitCode != 0) {
        throw InvalidInput(program.string() + ": does not answer to " + question +
                           "; install adaptiso again");
    }
    return said.output;
}

/// "iso" of "iso=100" and of "iso"; empty: the part is no option.
std::string_view nameOf(std::string_view part) {
    const std::string_view name = part.substr(0, part.find('='));
    const bool isName = !name.empty() && std::islower(static_cast<unsigned char>(name[0])) != 0 &&
                        std::all_of(name.begin(), name.end(), [](unsigned char c) {
                            return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '-';
                        });
    return isName ? name : std::string_view();
}

std::vector<std::string> partsOf(const std::string& list) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
        end = list.find(',', begin);
        const std::string part = list.substr(begin, end == std::string::npos ? end : end - begin);
        if (parts.empty() || !nameOf(part).empty()) {
            parts.push_back(part);
        } else {
            parts.back() += "," + part;
        }
    }
    return parts;
}

}  // namespace

Sibling findSibling(const std::string& name) {
    std::error_code error;
    Sibling sibling{name, fs::read_symlink("/proc/self/exe", error).parent_path() / name, {}, {}};
    if (!fs::exists(sibling.executable, error)) {
        throw InvalidInput(name + ": is not beside adaptiso-bids, in " +
                           sibling.executable.parent_path().string() + "; install adaptiso whole");
    }
    sibling.version = ask(sibling.executable, "--version");
    while (sibling.version.ends_with('\n')) sibling.version.pop_back();
    const Json said = Json::parse(ask(sibling.executable, "--help-json"), nullptr, false);
    if (!said.is_object()) {
        throw InvalidInput(sibling.executable.string() + ": is of another version");
    }
    for (const Json& option : said.at("options")) {
        for (const Json& text : option.at("names")) {
            const std::string known = text.get<std::string>();
            if (known.starts_with("--")) sibling.options.push_back(known.substr(2));
        }
    }
    return sibling;
}

std::vector<std::string> siblingOptions(const std::string& option, const std::string& list,
                                        const Sibling& sibling,
                                        const std::vector<std::string>& refused) {
    std::vector<std::string> options;
    if (list.empty()) return options;
    for (const std::string& part : partsOf(list)) {
        const std::string name(nameOf(part));
        const auto isIn = [&](const std::vector<std::string>& words) {
            return std::find(words.begin(), words.end(), name) != words.end();
        };
        if (isIn(refused)) {
            throw UsageError(option + " " + shown(part) +
                             ": is set by adaptiso-bids and cannot be passed on");
        }
        if (!isIn(sibling.options)) {
            throw UsageError(option + " " + shown(part) + ": " + sibling.name +
                             " has no such option" + suggestion(name, sibling.options));
        }
        if (part.ends_with('=')) {
            throw UsageError(option + " " + shown(part) + ": its value is missing");
        }
        options.push_back("--" + part);
    }
    return options;
}

}  // namespace adaptiso
