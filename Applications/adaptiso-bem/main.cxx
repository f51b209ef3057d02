#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "Common/CommonFrame.h"
#include "Common/ImageOptions.h"
#include "Common/OptionValues.h"
#include "Common/RunApp.h"
#include "Pipeline.h"
#include "Run.h"
#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/HeadPipeline/BemRules.h"
#include "adaptiso/MeshIO/FiffSurfaces.h"
#include "adaptiso/MeshIO/PointFiles.h"

namespace adaptiso::bem {
namespace {

constexpr const char* kInput = "Input (one of --t1, --labels, --probabilities, --ct, --surfaces)";
constexpr const char* kHead = "Head";
constexpr const char* kMesh = "Surfaces";
constexpr const char* kOutput = "Output";
constexpr const char* kTetrahedra = "Tetrahedra";
constexpr const char* kElectrodes = "Electrodes and landmarks";
constexpr const char* kSources = "Sources of lead fields";
constexpr const char* kToolboxes =
    "Files for other programs, besides those of FreeSurfer and OpenMEEG";

const std::vector<std::string> kPresets = tissuePresetNames();

std::vector<std::string> parts(const std::string& text, char separator) {
    std::vector<std::string> result;
    std::size_t begin = 0;
    for (std::size_t end = 0; end != std::string::npos; begin = end + 1) {
        end = text.find(separator, begin);
        result.push_back(text.substr(begin, end == std::string::npos ? end : end - begin));
    }
    return result;
}

/// Takes numbers joined by a separator; `take` says whether they are as many as the rule wants.
/// \throws UsageError  naming option and rule
void takeNumbers(const std::string& option, const std::string& text, char separator,
                 const std::string& rule,
                 const std::function<bool(const std::vector<double>&)>& take) {
    std::vector<double> values;
    bool areNumbers = true;
    for (const std::string& part : parts(text, separator)) {
        const std::optional<double> value = parseFiniteNumber(trimmed(part));
        areNumbers = areNumbers && value;
        values.push_back(value.value_or(0));
    }
    if (!areNumbers || !take(values)) {
        throw UsageError(option + " " + text + ": must be " + rule);
    }
}

/// "brain=1,2,3"
void addTissue(TissueLabels& tissues, const std::string& text) {
    const auto refuse = [&] {
        throw UsageError("--tissue " + text +
                         ": must be white, brain, csf, skull, spongy or scalp, '=', and labels or "
                         "ranges of them with "
                         "commas between: brain=1,2,5-9");
    };
    const std::size_t equals = text.find('=');
    const std::string name = text.substr(0, equals);
    std::vector<std::int64_t>* const list = name == "white"    ? &tissues.white
                                            : name == "brain"  ? &tissues.brain
                                            : name == "csf"    ? &tissues.csf
                                            : name == "skull"  ? &tissues.skull
                                            : name == "scalp"  ? &tissues.scalp
                                            : name == "spongy" ? &tissues.spongy
                                                               : nullptr;
    if (equals == std::string::npos || list == nullptr) return refuse();
    for (const std::string& part : parts(text.substr(equals + 1), ',')) {
        constexpr std::uint64_t kMostLabels = 100'000;  // more than any atlas has
        std::int64_t first = 0;
        const char* const last = part.data() + part.size();
        std::from_chars_result read = std::from_chars(part.data(), last, first);
        std::int64_t final = first;
        if (read.ec == std::errc{} && read.ptr != last && *read.ptr == '-') {
            read = std::from_chars(read.ptr + 1, last, final);
        }
        if (read.ec != std::errc{} || read.ptr != last || final < first) return refuse();
        // unsigned: of any two numbers it is right
        const std::uint64_t more =
            static_cast<std::uint64_t>(final) - static_cast<std::uint64_t>(first);
        if (more > kMostLabels) return refuse();
        for (std::uint64_t n = 0; n <= more; ++n) {
            list->push_back(first + static_cast<std::int64_t>(n));
        }
    }
}

/// The preset's labels, and those that --tissue names besides.
void addPreset(TissueLabels& tissues, const TissueLabels& preset) {
    const auto add = [](std::vector<std::int64_t>& to, const std::vector<std::int64_t>& from) {
        to.insert(to.end(), from.begin(), from.end());
    };
    add(tissues.white, preset.white);
    add(tissues.brain, preset.brain);
    add(tissues.csf, preset.csf);
    add(tissues.skull, preset.skull);
    add(tissues.scalp, preset.scalp);
    tissues.othersAreBrain = preset.othersAreBrain;
}

void declareInput(CLI::App& app, BemOptions& options) {
    const OptionGroup input(app, kInput);
    input.text("--t1", "IMG", options.t1, "A T1-weighted MRI of the whole head");
    input.text("--brain-mask", "IMG", options.brainMask,
               "With --t1: the brain, from any brain extraction (a mask, or the T1 with the "
               "skull removed); without it the brain is guessed");
    input.text(
        "--aseg", "IMG", options.aseg,
        "With --t1: FreeSurfer's or FastSurfer's aseg; serves as brain mask if none is given, "
        "and with --layers 4 or 5 the surfaces of brain and white matter");
    input.text("--lesion", "IMG", options.lesion,
               "With --t1: a mask of lesions (tumour, cavity, bleeding) within the skull; they "
               "count as brain, whatever their grey values");
    input.text(
        "--pial", "MESH...", options.pial,
        "With --t1: the cortex (lh.pial rh.pial), which the inner skull then holds, and with "
        "--layers 4 or 5 the brain's own surface");
    input.text("--white", "MESH...", options.white,
               "With --t1 and --layers 5: the white matter's surfaces (lh.white rh.white), besides "
               "--aseg's labels or instead");
    input.text("--labels", "IMG", options.labels,
               "A segmentation; --tissue or --preset names its tissues");
    input.values(
        "--tissue", "NAME=LABELS",
        [&options](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) addTissue(options.tissues, text);
        },
        "Labels of a tissue: brain=1,2,5-9 (CSF and white matter included, or named apart: white=1 "
        "brain=2 csf=3), skull=4, scalp=5; spongy=8 for a surface of its spongy bone; one --tissue "
        "each");
    input.value(
        "--preset", choiceName(kPresets),
        [&options](const std::string& text) {
            options.preset = kPresets[parseChoice("--preset", text, kPresets)];
            addPreset(options.tissues, tissuePreset(options.preset));
        },
        "The labels of SimNIBS's charm or headreco, of GRACE, of FreeSurfer's aseg, of SAMSEG or "
        "SynthSeg, or of "
        "TotalSegmentator (task total: brain and skull; with --head-mask)");
    input.text("--head-mask", "IMG", options.headMask,
               "With --labels: a mask of all that lies within the skin (TotalSegmentator's body), "
               "on the same grid; what of it has no tissue counts as scalp");
    input.text("--probabilities", "IMG...", options.probabilities,
               "Tissue maps in SPM's order: c1 c2 c3 c4 c5 [c6]");
    input.text("--ct", "IMG", options.ct, "A CT of the whole head, in Hounsfield units");
    input.text("--surfaces", "MESH...", options.surfaces,
               "Ready surfaces, inside out: INNER OUTER SKIN (INNER alone with --meg, BRAIN "
               "INNER OUTER SKIN with --layers 4, the white matter before these with 5); "
               "checked, mended where need be, and kept as they are where not");
    declareInputCoordinates(
        input, options.inputCoordinates,
        "the surfaces of --surfaces, --pial, --white and --sources; given once for "
        "each, in this order, that of each");
    input.text("--volume", "IMG", options.volume,
               "With --surfaces: the image they belong to, for tkRAS and voxel coordinates");
    declareReadOptions(app, options.read, kInput);
}

void declareHead(CLI::App& app, BemOptions& options) {
    const OptionGroup group(app, kHead);
    BemModelOptions& model = options.model;
    group.value(
        "--layers", "1|3|4|5",
        [&model](const std::string& text) {
            const std::vector<std::string> counts{"1", "3", "4", "5"};
            setLayers(model, counts[parseChoice("--layers", text, counts)].front() - '0');
        },
        "3 (default): inner skull, outer skull, skin; 4: the brain within the inner skull as "
        "well, CSF between them; 5: the white matter within the brain too; 1: as --meg");
    group.flag("--meg", model.boundaries.innerSkullOnly, "The inner skull alone");
    group.value(
        "--min-gap", "MM[,MM[,MM[,MM]]]",
        [&model](const std::string& text) {
            takeNumbers("--min-gap", text, ',', kMinGapRule,
                        [&](const auto& gaps) { return setMinGaps(model, gaps); });
        },
        "Least thickness of skull, scalp and (with --layers 4) CSF and (with 5) grey matter, "
        "guaranteed (default: 2,2,1,1)");
    group.rows(boundaryOptions(), model.boundaries);
}

void declareSurfaces(CLI::App& app, BemOptions& options) {
    const OptionGroup mesh(app, kMesh);
    mesh.values(
        "--vertices", "N[,N,N]",
        [&options](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) {
                for (const std::string& count : parts(text, ',')) {
                    options.model.vertices.push_back(
                        parseCount("--vertices", count, kLeastBemVertices, kMostBemVertices));
                }
            }
        },
        "Vertices of each surface, evenly spread: 642, 1281, 2562 or any number (default: 2562; "
        "with --layers 4 or 5 by the layers' thickness, 10,000 in all at most); or one number for "
        "each surface, inside out: N,N,N");
    mesh.count(
        "--most-vertices", options.model.mostVertices, 168, kHeadSurfaceCount * kMostBemVertices,
        "With --layers 4 or 5, without --vertices and --edge-length: at most N vertices in all "
        "(default: 10000)");
    mesh.value(
        "--edge-length", "MIN:MAX",
        [&options](const std::string& text) {
            takeNumbers("--edge-length", text, ':', kEdgeLengthRule, [&](const auto& lengths) {
                return setEdgeLengths(options.model, lengths);
            });
        },
        "Adaptive: edges of MIN mm where a surface bends or another is near, up to MAX mm; with "
        "--vertices lengths are scaled to reach that number");
    mesh.value(
        "--conductivity", "[WHITE,]BRAIN,[CSF,]SKULL,SCALP",
        [&options](const std::string& text) {
            takeNumbers("--conductivity", text, ',', kConductivityRule, [&](const auto& sigmas) {
                return setConductivities(options.model, sigmas);
            });
        },
        "Conductivities in S/m (default: 0.3,0.006,0.3; with --layers 4: 0.3,1.79,0.006,0.3; with "
        "5, BRAIN being grey matter: 0.126,0.275,1.654,0.01,0.465)");
}

void declareOutput(CLI::App& app, BemOptions& options) {
    const OptionGroup output(app, kOutput);
    output.text("-o,--output", "DIR", options.output,
                "The folder to make; it holds the whole model or, when none can be guaranteed, "
                "report.json alone");
    output.flag("--force", options.mayReplace,
                "Replace a folder that this program made, and the subject's surfaces");
    output.text("-d,--subjects-dir", "DIR", options.subjectsDir,
                "FreeSurfer's SUBJECTS_DIR (default: of the environment), where --subject is");
    output.text(
        "-s,--subject", "NAME", options.subject,
        "A subject of FreeSurfer: the .surf files are put into its folder bem as well. Without an "
        "image --t1 is its mri/T1.mgz, --brain-mask its mri/brainmask.mgz (--aseg its mri/aseg.mgz "
        "without that, or with --layers 4 or 5) and, without --input-coordinates, --pial its "
        "surf/?h.pial, with --layers 5 --white its surf/?h.white and, for --lead-field, --sources "
        "its surf/?h.white; -o is SUBJECT/adaptiso-bem by default");
    output.choice<OpenMeegUnit>(
        "--units", options.files.unit,
        {{"mm", OpenMeegUnit::Millimetres}, {"m", OpenMeegUnit::Metres}},
        "Unit of OpenMEEG's .tri files: mm (default) or m (potentials in volts)");
    declareCoordinates(output, options.files.frame,
                       "Frame of all files but FreeSurfer's, which are in tkRAS: scanner RAS "
                       "(default), scanner LPS, or tkRAS",
                       {"ras", "lps", "tkras"});
    output.flag("--dry-run", options.isDryRun,
                "Do and check everything, write nothing but the reports asked for by name");
    declareReportOptions(app, options.report, kOutput);
}

/// "X,Y,Z" in scanner RAS mm
void addPoint(CLI::App& app, const std::string& name, std::optional<Vec3>& target,
              const std::string& description) {
    const OptionGroup group(app, kElectrodes);
    group.value(
        name, "X,Y,Z",
        [&target, name](const std::string& text) {
            takeNumbers(name, text, ',', "three numbers of mm: X,Y,Z", [&](const auto& p) {
                if (p.size() == 3) target = Vec3{p[0], p[1], p[2]};
                return p.size() == 3;
            });
        },
        description);
}

void declareElectrodes(CLI::App& app, BemOptions& options) {
    const OptionGroup group(app, kElectrodes);
    group.text("--electrodes", "FILE", options.electrodes,
               "Electrodes, moved onto the skin and written back: " + pointExtensions() +
                   " (of BIDS with the _coordsystem.json beside it)");
    group.choice<CoordinateFrame>(
        "--electrodes-in", options.model.electrodes.frame,
        {{"ras", CoordinateFrame::Ras},
         {"lps", CoordinateFrame::Lps},
         {"tkras", CoordinateFrame::TkRas}},
        "Their frame (default: what the file says; else by its nasion and ears; without these the "
        "file is refused)");
    const auto takeMontage = [&target = options.model.electrodes.montage](const std::string& name) {
        const std::vector<std::string> names = montageNames();
        target = names[parseChoice("--montage", name, names)];
    };
    group.value(
        "--montage", "NAME", takeMontage,
        "Electrode positions computed on the skin from nasion and ears: of the systems or caps " +
            joined(montageNames()));
    addPoint(app, "--nasion", options.nasion,
             "Nasion, scanner RAS mm (default: the electrodes' file's, else guessed)");
    addPoint(app, "--left-ear", options.leftEar, "Left preauricular point, the same");
    addPoint(app, "--right-ear", options.rightEar, "Right preauricular point, the same");
    addPoint(app, "--inion", options.inion,
             "Inion, scanner RAS mm, for --montage (default: guessed by nasion and ears)");
}

void declareSources(CLI::App& app, BemOptions& options) {
    const OptionGroup group(app, kSources);
    group.text("--sources", "MESH...", options.sources,
               "Dipoles along the normals of the cortex (lh.white rh.white): dipoles.txt for "
               "OpenMEEG, sources-src.fif for MNE");
    group.rows(sourceOptions(), options.model.sources);
    group.choice<std::string>(
        "--lead-field", options.model.leadField, {{"mne", "mne"}, {"openmeeg", "openmeeg"}},
        "Potentials of these dipoles at the electrodes, by this program, which must be installed: "
        "lead-field.mat (V/(A m), without a reference), and lead-field-fwd.fif of MNE");
}

void declareToolboxes(CLI::App& app, BemOptions& options) {
    const OptionGroup group(app, kToolboxes);
    BemFileOptions& files = options.files;
    const auto addFlag = [&](const char* name, bool& target, const char* description) {
        group.flag(name, target, description);
    };
    addFlag("--fif", files.writesFif,
            "MNE: bem.fif (all surfaces), head-dense.fif and head-sparse.fif (the skin, for "
            "coregistration); with --subject in the subject's folder too");
    addFlag("--fieldtrip", files.writesFieldTrip,
            "FieldTrip: headmodel.mat (bnd, cond, tissue, unit, coordsys)");
    addFlag("--brainstorm", files.writesBrainstorm,
            "Brainstorm: tess_innerskull_bem.mat, ... (scanner RAS, metres)");
    addFlag("--simnibs", files.writesSimNibs, "SimNIBS: csf.stl, bone.stl, skin.stl (scanner RAS)");
    addFlag("--bem-fmm", files.writesBemFmm,
            "BEM-FMM: tissue_index.txt with the same .stl files, and headmodel.mat");
    addFlag("--besa", files.writesBesa,
            "BESA: head.sfp (landmarks, electrodes, points of the skin)");
    addFlag("--gifti", files.writesGifti, "Viewers: .gii");
    addFlag("--vtp", files.writesVtp, "Viewers: .vtp");
}

/// A subject of FreeSurfer stands for its images, where no others are given, and for the output.
void takeSubject(BemOptions& options) {
    if (options.subject.empty() && options.subjectsDir.empty()) return;
    if (const char* const folder = std::getenv("SUBJECTS_DIR");
        folder != nullptr && options.subjectsDir.empty()) {
        options.subjectsDir = folder;
    }
    if (options.subject.empty() || options.subjectsDir.empty()) {
        throw UsageError(
            "--subjects-dir and --subject need each other; SUBJECTS_DIR in the environment may "
            "stand for the first");
    }
    if (options.subject.find('/') != std::string::npos || options.subject == ".." ||
        options.subject == ".") {
        throw UsageError("--subject " + options.subject + ": must be the name of a folder");
    }
    const std::filesystem::path folder = options.subjectsDir / options.subject;
    if (options.output.empty()) options.output = folder / "adaptiso-bem";
    if (!options.t1.empty() || !options.labels.empty() || !options.probabilities.empty() ||
        !options.ct.empty() || !options.surfaces.empty()) {
        return;
    }
    options.t1 = folder / "mri" / "T1.mgz";
    requireIn(options.t1, folder);
    using Paths = std::vector<std::filesystem::path>;
    const auto take = [&](auto& option, const Paths& files) {
        std::error_code error;
        for (const auto& file : files) {
            if (!option.empty() || !std::filesystem::exists(folder / file, error)) return;
        }
        for (const auto& file : files) requireIn(folder / file, folder);
        if constexpr (std::is_same_v<decltype(option), Paths&>) {
            for (const auto& file : files) option.push_back(folder / file);
        } else {
            option = folder / files.front();
        }
    };
    if (options.aseg.empty()) take(options.brainMask, {"mri/brainmask.mgz"});
    if (options.brainMask.empty() || options.model.boundaries.innerSurfaces > 0) {
        take(options.aseg, {"mri/aseg.mgz"});
    }
    if (!options.inputCoordinates.empty()) return;  // which are those of files that the user names
    take(options.pial, {"surf/lh.pial", "surf/rh.pial"});
    const Paths white{"surf/lh.white", "surf/rh.white"};
    if (options.model.boundaries.innerSurfaces > 1) take(options.white, white);
    if (!options.model.leadField.empty() && !options.model.sources.gridMm) {
        take(options.sources, white);
    }
}

/// Checks options against each other: those of the model by bemFault(), then the program's own.
void checkCombinations(const CLI::App& app, const BemOptions& options) {
    const auto require = [](bool isGood, const std::string& message) {
        if (!isGood) throw UsageError(message);
    };
    BemRequest request{{},
                       options.tissues,
                       options.surfaces.size(),
                       options.sources.size(),
                       options.preset,
                       missingSolver(options.model)};
    for (const std::string& name : givenOptions(app)) request.given.insert(name.substr(2));
    // of --subject
    if (!options.t1.empty()) request.given.insert("t1");
    if (!options.brainMask.empty()) request.given.insert("brain-mask");
    if (!options.aseg.empty()) request.given.insert("aseg");
    if (!options.white.empty()) request.given.insert("white");
    if (!options.sources.empty()) request.given.insert("sources");
    const std::string fault =
        bemFault(options.model, request, [](const std::string& name) { return "--" + name; });
    require(fault.empty(), fault);
    checkInputCoordinates(options.inputCoordinates, options.surfaces.size() + options.pial.size() +
                                                        options.white.size() +
                                                        options.sources.size());
    const bool namesLandmarks = options.nasion || options.leftEar || options.rightEar;
    require(!namesLandmarks || (options.nasion && options.leftEar && options.rightEar),
            "--nasion, --left-ear and --right-ear need each other");
    require(!options.inion || namesLandmarks, "--inion needs --nasion, --left-ear and --right-ear");
    require(!options.files.writesBesa || options.model.hasSkin(),
            "--besa needs a skin: not with --meg");
    require(options.isDryRun || !options.output.empty(), "-o DIR is needed (or --dry-run)");
    requireFolderName(
        "--output", options.output,
        "give a folder, -o model; it gets .surf, and .gii and .vtp by --gifti, --vtp");
}

constexpr const char* kFooter = R"(Examples:
  adaptiso-bem --t1 T1.nii.gz --brain-mask brain.nii.gz -o model
      FreeSurfer and OpenMEEG files, README.md and report.json in the folder model
  adaptiso-bem -s anna -d subjects
  adaptiso-bem --t1 T1.mgz --aseg aseg.mgz --pial lh.pial rh.pial --layers 4 -o model
  adaptiso-bem --labels final_tissues.nii.gz --preset charm --vertices 642 -o model
  adaptiso-bem --probabilities c1.nii c2.nii c3.nii c4.nii c5.nii -o model
  adaptiso-bem --ct ct.nii.gz --meg -o model --report model.html
  adaptiso-bem --surfaces inner.stl outer.stl skin.stl --min-gap 3,2 -o model
  adaptiso-bem --labels seg.nii.gz --preset charm --layers 4 --tetrahedra tetgen -o model
  adaptiso-bem --t1 T1.nii.gz --electrodes sub-1_electrodes.tsv -o model
  adaptiso-bem --t1 T1.nii.gz --montage 10-10 --nasion 0,85,-35 --left-ear=-80,-28,-41 \
      --right-ear 80,-28,-41 -o model
  adaptiso-bem --t1 T1.mgz --pial lh.pial rh.pial --sources lh.white rh.white --fif \
      --electrodes cap.elc -o model
  adaptiso-bem --t1 T1.nii.gz --fif --fieldtrip --brainstorm -o model

Exit codes: 0 done, 1 no model could be guaranteed, or a warning with --strict
(the folder holds report.json alone), 2 wrong usage, 3 bad input (or no memory
or disk left), 4 internal error. When it is above 1, nothing was written.)";

Program bemProgram() {
    return {"adaptiso-bem",
            "Makes the nested surfaces of a boundary element head model (EEG: inner skull, outer "
            "skull,\nouter skin, or the brain within them as well; MEG: inner skull) for MNE, "
            "FreeSurfer,\nOpenMEEG, FieldTrip, Brainstorm, SimNIBS and BESA; electrodes and "
            "tetrahedra for them.",
            kFooter};
}

void declareBemOptions(CLI::App& app, BemOptions& options) {
    declareInput(app, options);
    declareHead(app, options);
    declareSurfaces(app, options);
    declareOutput(app, options);
    declareElectrodes(app, options);
    declareSources(app, options);
    declareMesherOptions(app, options.tetrahedra,
                         "head.msh (SimNIBS, DUNEuro), head-4.1.msh, head.vtu, head.dgf and "
                         "head.geo (DUNEuro) with the conductivities",
                         kTetrahedra);
    declareToolboxes(app, options);
    declareCommonOptions(app, options.common, "of the model only the report is then written");
    afterParsing(app, [&app, &options] {
        if (options.surfaces.size() == 1) options.surfaces = surfacePaths(options.surfaces.front());
        takeSubject(options);
        checkCombinations(app, options);
        options.model.wantsHeadShape = options.files.writesFif;
        options.model.electrodes.wantsLandmarks = options.files.writesBesa;
        for (const CoordinateFrame frame : options.inputCoordinates) {
            options.model.inputCoordinates.emplace_back(frameWord(frame));
        }
    });
}

}  // namespace
}  // namespace adaptiso::bem

int main(int argc, char** argv) {
    return adaptiso::runApp(argc, argv, adaptiso::bem::bemProgram(),
                            adaptiso::bem::declareBemOptions, adaptiso::bem::runBem);
}
