#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "Common/ChildProcess.h"
#include "Common/RunApp.h"
#include "Run.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/HeadPipeline/BemFiles.h"

namespace adaptiso::bem {
namespace {

namespace fs = std::filesystem;
using Command = std::vector<std::string>;

constexpr double kMmPerMetre = 1000;

/// Runs in a folder of the model's files, in metres. Arguments: the move from these to MRI
/// coordinates, row by row, and the electrodes' names. Prints MNE's version.
constexpr const char* kMneScript = R"(import os, struct, sys
import mne
import numpy as np

mne.set_log_level("error")
to_mri = np.reshape(np.array(sys.argv[1:13], float), (3, 4))
names = sys.argv[13:]
trans = mne.Transform("head", "mri")
if os.path.exists("head-mri-trans.fif"):
    trans = mne.read_trans("head-mri-trans.fif")
to_head = np.linalg.inv(trans["trans"]) @ np.vstack([to_mri, (0, 0, 0, 1)])
electrodes, dipoles = (np.loadtxt(name, ndmin=2) for name in ("electrodes.txt", "dipoles.txt"))
info = mne.create_info(names, 1000.0, "eeg")
for channel, place in zip(info["chs"], mne.transforms.apply_trans(to_head, electrodes)):
    channel["loc"][:3] = place
bem = mne.make_bem_solution(mne.read_bem_surfaces("bem.fif"))
forward = mne.make_forward_solution(info, trans, mne.read_source_spaces("sources-src.fif"), bem, meg=False, mindist=0)
# along x, y, z of the head; dipoles.txt has one direction a place, or three
free = forward["sol"]["data"].reshape(len(names), -1, 3)
directions = (dipoles[:, 3:] @ to_head[:3, :3].T).reshape(free.shape[1], -1, 3)
places = mne.transforms.apply_trans(to_head, dipoles[:, :3])[::directions.shape[1]]
if np.abs(places - forward["source_rr"]).max() > 1e-5:
    sys.exit("MNE took other places than those of dipoles.txt")
gain = np.einsum("esk,sdk->sde", free, directions)
gain.astype("<f8").tofile("gain.bin")
with forward["info"]._unlock():
    forward["info"].update(working_dir=None, command_line=None)
mne.write_forward_solution("lead-field-fwd.fif", forward)
# neither machine nor time: numbers of ids (type 31) but their version become 0; no empty interpolator (67 MB of a grid)
data, tags, at = open("lead-field-fwd.fif", "rb").read(), [], 0
while at < len(data):
    what, kind, size, _ = struct.unpack_from(">4i", data, at)
    tag = data[at:at + 16 + size]
    if what != 3597:
        tags.append(tag[:20] + bytes(16) if kind == 31 else tag)
    at += len(tag)
open("lead-field-fwd.fif", "wb").write(b"".join(tags))
print(mne.__version__)
)";

/// Finds a Python with MNE: the user's own, or Debian's. Runs it in an empty folder, as Python
/// imports from the current one first. \return  its name; empty: not installed
std::string pythonWithMne() {
    const ScratchFolder folder;
    for (const char* const python : {"python3", "/usr/bin/python3"}) {
        // by env, so that Python sees its own name and finds its modules by it
        const bool isGood = runChild("env",
                                     {python, "-c",
                                      "import importlib.util as u, sys; "
                                      "sys.exit(u.find_spec('mne') is None)"},
                                     folder.path())
                                .isGood();
        if (isGood) return python;
    }
    return "";
}

bool isMne(const BemModelOptions& options) {
    return options.leadField == "mne";
}

std::vector<Command> commandsFor(const BemModel& model, const BemFileOptions& files) {
    if (!isMne(model.options)) return openMeegCommands(true, true);
    Command python{pythonWithMne(), "-c", kMneScript};
    const AffineTransform toMri = toMriCoordinates(model, files);
    for (int row = 0; row < 3; ++row) {
        for (const Vec3& column : toMri.linear.column) python.push_back(formatNumber(column[row]));
        python.push_back(formatNumber(toMri.offset[row] / kMmPerMetre));
    }
    for (const NamedPoint& electrode : model.electrodes->points) {
        python.push_back(electrode.name);
    }
    return {python};
}

/// "; what it printed is in FILE", a new file; empty where none can be written.
std::string printedIn(const std::string& text) {
    std::string path = (temporaryFolder() / "adaptiso-lead-field-XXXXXX.log").string();
    const int file = mkstemps(path.data(), 4);
    if (file < 0) return "";
    close(file);
    std::ofstream stream(path);
    stream << text;
    stream.close();
    if (stream) return "; what it printed is in " + path;
    unlink(path.c_str());
    return "";
}

std::string bytesIn(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// OpenMEEG's text: a line for each electrode. \return  column by column
std::vector<double> gainOfText(const std::string& text, std::size_t rows) {
    std::vector<double> byRow;
    char* end = nullptr;
    for (const char* at = text.c_str();; at = end) {
        const double value = std::strtod(at, &end);
        if (end == at) break;
        byRow.push_back(value);
    }
    std::vector<double> gain;
    const std::size_t columns = byRow.size() / rows;
    if (byRow.size() != rows * columns) return gain;
    for (std::size_t column = 0; column < columns; ++column) {
        for (std::size_t row = 0; row < rows; ++row) gain.push_back(byRow[row * columns + column]);
    }
    return gain;
}

std::vector<double> gainOfBytes(const std::string& bytes) {
    std::vector<double> gain(bytes.size() / sizeof(double));
    std::memcpy(gain.data(), bytes.data(), gain.size() * sizeof(double));
    return gain;
}

/// The word after "version" in what a program of OpenMEEG prints, or MNE's only one.
std::string versionIn(const std::string& printed) {
    const std::string_view before = "version ";
    const std::size_t at = printed.find(before);
    const std::size_t begin = at == std::string::npos ? 0 : at + before.size();
    const std::string word = printed.substr(begin, printed.find_first_of(" \n", begin) - begin);
    return at == std::string::npos && word.find('.') == std::string::npos ? "" : " " + word;
}

}  // namespace

std::string missingSolver(const BemModelOptions& options) {
    if (options.leadField.empty()) return "";
    temporaryFolder();  // there must be one
    if (isMne(options)) {
        if (!pythonWithMne().empty()) return "";
        return "MNE-Python, which neither python3 nor /usr/bin/python3 has (on Debian: apt install "
               "python3-mne)";
    }
    std::set<std::string> missing;
    for (const Command& command : openMeegCommands(true, true)) {
        if (!isInstalled(command.front())) missing.insert(command.front());
    }
    if (missing.empty()) return "";
    return joined(missing) + " of OpenMEEG (from openmeeg.github.io)";
}

void solveLeadField(BemRun& run) {
    BemModel& model = run.model;
    BemFileOptions files;
    files.unit = OpenMeegUnit::Metres;  // of potentials in volts
    files.frame = run.options.files.frame;
    files.writesFif = isMne(model.options);
    ScratchFolder folder;
    writeBemFiles(model, files, "", [&](const std::string& name) { return folder.place(name); });
    const std::string result = isMne(model.options) ? "gain.bin" : "gain.txt";
    for (const char* const name : {"hm.mat", "hm_inv.mat", "dsm.mat", "h2em.mat"}) {
        folder.place(name);
    }
    folder.place(result);
    folder.place(kFiffForward);

    std::string printed, log;
    const auto fail = [&](const std::string& program, const std::string& reason) {
        throw FileError("--lead-field " + model.options.leadField + ": " + program +
                        " made no lead field (" + reason + ")" + printedIn(log));
    };
    for (Command& command : commandsFor(model, files)) {
        const std::string program = command.front();
        if (const auto threads = run.options.common.threads) {
            command.insert(command.begin(), "OMP_NUM_THREADS=" + std::to_string(*threads));
        }
        const ChildResult done = runChild("env", command, folder.path());
        printed += done.output;
        log += program + "\n" + done.output + done.errors;
        if (!done.isGood()) fail(program, done.reason());
    }
    BemLeadField made;
    made.solver =
        std::string(isMne(model.options) ? "MNE-Python" : "OpenMEEG") + versionIn(printed);
    const std::string bytes = bytesIn(folder.path() / result);
    const std::size_t electrodes = model.electrodes->points.size();
    made.gain = isMne(model.options) ? gainOfBytes(bytes) : gainOfText(bytes, electrodes);
    made.forward = bytesIn(folder.path() / kFiffForward);
    const std::int64_t dipoles = model.sources->dipoles();
    const bool isWhole = std::ssize(made.gain) == std::ssize(model.electrodes->points) * dipoles &&
                         std::all_of(made.gain.begin(), made.gain.end(),
                                     [](double value) { return std::isfinite(value); });
    if (isMne(model.options) && made.forward.empty()) fail(made.solver, "it wrote no .fif file");
    if (!isWhole) fail(made.solver, "it wrote too few numbers, or not finite ones");
    model.notes.push_back("lead field: " + formatCount(std::ssize(model.electrodes->points)) +
                          " electrodes by " + formatCount(dipoles) +
                          " dipoles, V/(A m), without a reference, by " + made.solver);
    model.leadField = std::move(made);
}

}  // namespace adaptiso::bem
