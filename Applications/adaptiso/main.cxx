#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "Common/ChildProcess.h"
#include "Common/CommonOptions.h"
#include "Common/OptionValues.h"
#include "Common/RunApp.h"
#include "Common/UsageWords.h"

namespace adaptiso::starter {
namespace {

struct Entry {
    const char* word;  ///< the program's name without "adaptiso-"
    const char* purpose;
};

constexpr Entry kPrograms[] = {
    {"mesh", "surfaces of an image at one or more isovalues"},
    {"labels", "surfaces of all regions of a segmentation"},
    {"bem", "head models for EEG and MEG"},
    {"check", "soundness of surfaces, and a self-test"},
    {"compare", "distances between two surfaces"},
    {"simplify", "fewer triangles within a stated distance"},
    {"mend", "a sound solid of any mesh"},
    {"bids", "all of these for a BIDS dataset"},
    {"giant", "the surface of a volume larger than memory"},
};

std::string footer() {
    std::string text = "Programs:\n";
    for (const Entry& entry : kPrograms) {
        const std::string word = entry.word;
        text += "  " + word + std::string(10 - word.size(), ' ') + entry.purpose + "\n";
    }
    return text +
           "\nExamples:\n"
           "  adaptiso mesh brain.nii.gz --iso 100\n"
           "      the same as: adaptiso-mesh brain.nii.gz --iso 100\n"
           "  adaptiso mesh --help\n"
           "  adaptiso help mesh iso\n"
           "      of its --help the part on --iso\n"
           "  adaptiso help decimate\n"
           "      which program does it, by which option: words of other tools too\n\n"
           "Exit codes: those of the program; 2 when there is no such program.";
}

struct Options {
    std::vector<std::filesystem::path> words;
};

void declareOptions(CLI::App& app, Options& options) {
    OptionGroup(app).text("PROGRAM", "", options.words, "One of those below, then its arguments");
    declareVersion(app);
}

/// \throws UsageError
int refuse(const Options& options) {
    std::vector<std::string> words;
    for (const Entry& entry : kPrograms) words.emplace_back(entry.word);
    const std::string typed = options.words.empty() ? "" : options.words.front().string();
    const std::string near = suggestion(typed, words);
    throw UsageError(shown(typed) + ": there is no such program" +
                     (near.empty() ? "; `adaptiso help WORD` finds what does it" : near));
}

/// The same of a word after help. \throws UsageError
int refuseHelp(const Options& options) {
    throw UsageError("help " + shown(options.words.front().string()) +
                     ": no program or option is named so, and no help has the word");
}

bool isProgram(std::string_view word) {
    return std::ranges::any_of(kPrograms, [&](const Entry& entry) { return word == entry.word; });
}

std::filesystem::path ownFolder() {
    std::error_code error;
    return std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
}

/// Becomes the program that lies beside this one. \return only if it cannot be started
/// \param argv  its arguments follow the second
int start(const std::string& word, char** argv) {
    const std::string name = "adaptiso-" + word;
    const std::string program = (ownFolder() / name).string();
    std::string first = name;
    argv[1] = first.data();
    execv(program.c_str(), argv + 1);
    printError("adaptiso", program + ": can't be started: " + std::strerror(errno));
    return kExitBadInput;
}

/// Prints what each program's --help has on a word. \return  whether any has something
bool printHelpOn(const std::string& word) {
    bool isKnown = false;
    for (const Entry& entry : kPrograms) {
        const std::string name = std::string("adaptiso-") + entry.word;
        const ChildResult said = runChild(ownFolder() / name, {"--help", word});
        if (!said.isGood()) continue;
        std::cout << (isKnown ? "\n" : "") << name << '\n' << said.output;
        isKnown = true;
    }
    return isKnown;
}

}  // namespace
}  // namespace adaptiso::starter

int main(int argc, char** argv) {
    using namespace adaptiso::starter;
    const std::string word = argc > 1 ? argv[1] : "help";
    if (isProgram(word)) return start(word, argv);
    const bool helps = word == "help" || word == "--help" || word == "-h";
    if (helps && argc > 2 && isProgram(argv[2])) {  // "help mesh iso": "mesh --help iso"
        const std::string program = argv[2];
        std::string option = "--help";
        argv[2] = option.data();
        return start(program, argv);
    }
    std::string asked = argc > 2 ? argv[2] : "--help";  // "help fill holes": "fill-holes"
    for (int n = 3; n < argc; ++n) asked += std::string("-") + argv[n];
    if (helps && argc > 2 && asked.front() != '-' && printHelpOn(asked)) return 0;
    const bool isOwn = argc < 2 || word == "help";
    const bool isAsked = word == "help" && argc > 2;
    const char* const own[] = {argv[0], asked.c_str()};
    return adaptiso::runApp(
        isOwn ? 2 : argc, isOwn ? own : argv,
        {"adaptiso", "Starts the programs of adaptiso: adaptiso mesh ... is adaptiso-mesh ...",
         footer()},
        declareOptions, isAsked ? refuseHelp : refuse);
}
