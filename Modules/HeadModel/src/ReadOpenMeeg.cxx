#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <set>
#include <string_view>

#include "OpenMeegNames.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Core/TextLines.h"
#include "adaptiso/HeadModel/ExportOpenMeeg.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

bool isControl(char c) {
    return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
}

/// A word of a file in single quotes, as a message may show it.
std::string inQuotes(std::string_view word) {
    constexpr std::size_t kLongest = 40;
    std::string shown(word.substr(0, kLongest));
    std::replace_if(shown.begin(), shown.end(), isControl, '?');
    return "'" + shown + (word.size() > kLongest ? "...'" : "'");
}

/// Lines of a small text file, blank ones skipped, with their numbers.
class Lines {
public:
    explicit Lines(const fs::path& path) : name_(path.string()) {
        constexpr std::uintmax_t kMostBytes = 1 << 20;
        std::error_code error;
        if (!fs::is_regular_file(path, error)) throw FileError(name_ + ": is no regular file");
        if (fs::file_size(path, error) > kMostBytes) {
            throw FileError(name_ + ": is larger than any such file (1 MB)");
        }
        std::ifstream file(path, std::ios::binary);
        for (std::string line; std::getline(file, line);) lines_.push_back(line);
        if (!file.eof() || lines_.empty()) throw FileError(name_ + ": can't be read, or is empty");
    }

    /// The first line, which must be `expected` to the letter.
    void requireHeader(std::string_view expected) {
        if (lines_[0] != expected) {
            at_ = 1;
            fail("must be \"" + std::string(expected) + "\"");
        }
        at_ = 1;
    }

    bool hasMore() {
        while (at_ < lines_.size() && lines_[at_].find_first_not_of(" \t") == std::string::npos) {
            ++at_;
        }
        return at_ < lines_.size();
    }

    /// The words of the next line that is not blank.
    std::vector<std::string> words(std::string_view expected) {
        if (!hasMore()) {
            at_ = lines_.size();
            fail("the file ends where " + std::string(expected) + " should be");
        }
        const std::string& line = lines_[at_++];
        std::vector<std::string> result;
        for (std::size_t begin = line.find_first_not_of(" \t"); begin != std::string::npos;) {
            const std::size_t end = line.find_first_of(" \t", begin);
            result.push_back(line.substr(begin, end - begin));
            begin = line.find_first_not_of(" \t", end);
        }
        return result;
    }

    [[noreturn]] void fail(const std::string& what) const {
        throw FileError(name_ + ": line " + std::to_string(at_) + ": " + what);
    }

private:
    std::string name_;
    std::vector<std::string> lines_;
    std::size_t at_ = 0;
};

std::size_t countAfter(Lines& lines, const char* keyword) {
    constexpr std::size_t kMost = 100;
    const std::vector<std::string> words = lines.words(std::string("'") + keyword + " N'");
    std::size_t count = 0;
    if (words.size() != 2 || words[0] != keyword) {
        lines.fail(std::string("must be '") + keyword + " N'");
    }
    const auto [end, error] =
        std::from_chars(words[1].data(), words[1].data() + words[1].size(), count);
    if (error != std::errc{} || end != words[1].data() + words[1].size() || count < 1 ||
        count > kMost) {
        lines.fail(inQuotes(words[1]) + " must be a number from 1 to 100");
    }
    return count;
}

/// "Name" of "Name:", after `keyword`.
std::string nameAfter(Lines& lines, const std::vector<std::string>& words, const char* keyword) {
    if (words.size() < 3 || words[0] != keyword || !words[1].ends_with(':')) {
        lines.fail(std::string("must begin with '") + keyword + " Name:', one name without spaces");
    }
    std::string name = words[1].substr(0, words[1].size() - 1);
    const auto isAllowed = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               c == '_' || c == '-';
    };
    if (name.empty() || !std::all_of(name.begin(), name.end(), isAllowed)) {
        lines.fail(inQuotes(name) + " is no name (letters, digits, '_', '-')");
    }
    return name;
}

template <class Items>
void requireNew(Lines& lines, const Items& items, const std::string& name) {
    if (std::any_of(items.begin(), items.end(),
                    [&](const auto& item) { return item.name == name; })) {
        lines.fail("the name " + name + " is given twice");
    }
}

/// A relative name below the folder of the .geom.
std::string fileName(Lines& lines, const std::vector<std::string>& words) {
    if (words.size() != 3 || words[2].size() < 3 || words[2].front() != '"' ||
        words[2].back() != '"') {
        lines.fail("must end with one file name in double quotes, without spaces");
    }
    std::string file = words[2].substr(1, words[2].size() - 2);
    if (!staysBelow(file) || fs::path(file).extension() != ".tri") {
        lines.fail("the file's name must be relative, below this folder, and end in .tri");
    }
    if (std::any_of(file.begin(), file.end(), isControl)) {
        lines.fail("its file's name holds control characters");
    }
    return file;
}

void addBorders(Lines& lines, const std::vector<std::string>& words, const OpenMeegModel& model,
                OpenMeegDomain& domain) {
    for (std::size_t n = 2; n < words.size(); ++n) {
        const char sign = words[n].front();
        if (sign != '-' && sign != '+') {
            lines.fail(inQuotes(words[n]) +
                       " must be '-' (inside) or '+' (outside) and an interface");
        }
        const std::string name = words[n].substr(1);
        const auto found = std::find_if(model.interfaces.begin(), model.interfaces.end(),
                                        [&](const auto& i) { return i.name == name; });
        if (found == model.interfaces.end()) lines.fail("there is no interface " + inQuotes(name));
        const auto number = static_cast<std::size_t>(found - model.interfaces.begin());
        (sign == '-' ? domain.inside : domain.outside).push_back(number);
    }
}

void requireTwoSides(Lines& lines, const OpenMeegModel& model) {
    for (std::size_t n = 0; n < model.interfaces.size(); ++n) {
        std::size_t inside = 0, outside = 0;
        for (const OpenMeegDomain& domain : model.domains) {
            inside += std::count(domain.inside.begin(), domain.inside.end(), n);
            outside += std::count(domain.outside.begin(), domain.outside.end(), n);
        }
        if (inside != 1 || outside != 1) {
            lines.fail("the interface " + model.interfaces[n].name +
                       " must be '-' of one domain and '+' of one other");
        }
    }
    const auto isAir = [](const OpenMeegDomain& domain) { return domain.inside.empty(); };
    if (std::count_if(model.domains.begin(), model.domains.end(), isAir) != 1) {
        lines.fail("one domain, and one only, must be inside of nothing (the air)");
    }
}

void readInterfaceMesh(const fs::path& path, TriangleMesh& mesh) {
    MeshFile file = readMesh(path);
    if (!file.warnings.empty()) {
        throw FileError(path.string() + ": " + file.warnings.front().text);
    }
    mesh = std::move(file.mesh);
    if (!(enclosedVolume(mesh) > 0)) {
        throw FileError(path.string() + ": its triangles are not counter-clockwise from outside");
    }
    std::vector<Vec3> outward(mesh.points.size());
    for (const Triangle& t : mesh.triangles) {
        const Vec3 area = areaVector2(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]);
        for (const VertexId vertex : t) outward[vertex] += area;
    }
    for (std::size_t n = 0; n < mesh.points.size(); ++n) {
        const Vec3 normal = toVec3(mesh.normals[n]);
        // nine digits in the file, single precision here
        if (std::abs(norm(normal) - 1) > 1e-5 || !(dot(normal, outward[n]) > 0)) {
            throw FileError(path.string() + ": the normal of vertex " + std::to_string(n) +
                            " is no unit vector that points outward");
        }
    }
}

void readConductivities(Lines& lines, OpenMeegModel& model) {
    std::set<std::string> seen;
    lines.requireHeader(openmeeg::kConductivityHeader);
    while (lines.hasMore()) {
        const std::vector<std::string> words = lines.words("a conductivity");
        if (words.size() != 2) lines.fail("must be 'Name value'");
        const auto domain = std::find_if(model.domains.begin(), model.domains.end(),
                                         [&](const auto& d) { return d.name == words[0]; });
        if (domain == model.domains.end()) lines.fail("there is no domain " + inQuotes(words[0]));
        if (!seen.insert(words[0]).second) lines.fail(words[0] + " is given twice");
        const char* const last = words[1].data() + words[1].size();
        const auto [end, error] = std::from_chars(words[1].data(), last, domain->conductivity);
        const double value = domain->conductivity;
        const bool isNumber = error == std::errc{} && end == last && std::isfinite(value);
        const bool isAir = domain->inside.empty();
        if (!isNumber || (isAir ? value != 0 : !(value > 0))) {
            lines.fail("the conductivity of " + words[0] +
                       (isAir ? " (the air) must be 0" : " must be a number above 0"));
        }
    }
    for (const OpenMeegDomain& domain : model.domains) {
        if (!seen.contains(domain.name)) lines.fail("the domain " + domain.name + " has none");
    }
}

}  // namespace

OpenMeegModel readOpenMeegModel(const fs::path& geometry, const fs::path& conductivities) {
    OpenMeegModel model;
    Lines lines(geometry);
    lines.requireHeader(openmeeg::kGeometryHeader);
    for (std::size_t left = countAfter(lines, "Interfaces"); left > 0; --left) {
        const std::vector<std::string> words = lines.words("an interface");
        const std::string name = nameAfter(lines, words, "Interface");
        requireNew(lines, model.interfaces, name);
        model.interfaces.push_back({name, fileName(lines, words), {}});
    }
    for (std::size_t left = countAfter(lines, "Domains"); left > 0; --left) {
        const std::vector<std::string> words = lines.words("a domain");
        OpenMeegDomain domain;
        domain.name = nameAfter(lines, words, "Domain");
        requireNew(lines, model.domains, domain.name);
        addBorders(lines, words, model, domain);
        model.domains.push_back(std::move(domain));
    }
    if (lines.hasMore()) {
        lines.words("nothing");
        lines.fail("there is more after the last domain");
    }
    requireTwoSides(lines, model);
    for (OpenMeegModel::Interface& interface : model.interfaces) {
        const fs::path file = geometry.parent_path() / interface.file;
        requireBeside(file, geometry);
        readInterfaceMesh(file, interface.mesh);
    }
    Lines conductivityLines(conductivities);
    readConductivities(conductivityLines, model);
    return model;
}

}  // namespace adaptiso
