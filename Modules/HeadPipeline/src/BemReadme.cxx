#include "BemReadme.h"

#include <algorithm>

#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

std::string frameText(CoordinateFrame frame) {
    switch (frame) {
        case CoordinateFrame::Lps:
            return "scanner LPS";
        case CoordinateFrame::TkRas:
            return "FreeSurfer's surface RAS (tkRAS)";
        default:
            return "scanner RAS";
    }
}

std::string conductivityTuple(const BemModelOptions& options) {
    const ConductivityModel& c = options.conductivities;
    // MNE takes the outer three surfaces: CSF counts as brain there
    if (options.boundaries.innerSkullOnly) return "(" + formatNumber(c.brain) + ",)";
    return "(" + formatNumber(c.brain) + ", " + formatNumber(c.skull) + ", " +
           formatNumber(c.scalp) + ")";
}

/// "Three surfaces: inner skull, outer skull, outer skin."
std::string surfacesText(std::size_t count) {
    std::vector<std::string> names;
    for (std::size_t n = 0; n < count; ++n) {
        names.push_back(bemSurfaceName(n, count));
        std::replace(names.back().begin(), names.back().end(), '_', ' ');
    }
    const char* const number = count == 3 ? "Three" : count == 4 ? "Four" : "Five";
    return std::string(number) + " surfaces: " + joined(names, ", ") +
           (count > 3 ? "; CSF lies between brain and inner skull." : ".");
}

bool hasLandmarks(const BemModel& model) {
    return model.electrodes && model.electrodes->landmarks &&
           !model.electrodes->landmarks->areGuessed();
}

bool hasTransform(const BemModel& model) {
    return model.electrodes && model.electrodes->landmarks;
}

/// Rows of the table of files, for what else was asked for.
std::string toolboxRows(const BemModel& model, const BemFileOptions& options,
                        const std::string& frame) {
    const std::string mri = model.tkRasVolume ? "surface RAS (tkRAS) of the image" : "scanner RAS";
    std::string rows;
    if (options.writesGifti || options.writesVtp) {
        rows += "| `*.gii`, `*.vtp` | viewers | " + frame + "; millimetres |\n";
    }
    if (options.writesFif) {
        rows += std::string("| `bem.fif`") +
                (model.headShape ? ", `head-dense.fif`, `head-sparse.fif`" : "") + " | MNE | " +
                mri + " (\"MRI coordinates\"); metres |\n";
    }
    if (options.writesFieldTrip) {
        rows += "| `headmodel.mat` | FieldTrip | " + frame + "; millimetres |\n";
    }
    if (options.writesBrainstorm) {
        rows += std::string("| `tess_*_bem.mat` | Brainstorm | ") +
                (hasLandmarks(model) ? "SCS" : "scanner RAS (\"world\", not SCS)") + "; metres |\n";
    }
    if (options.writesStl()) {
        rows += std::string("| `csf.stl`, `bone.stl`, `skin.stl`") +
                (model.meshes.size() > 3 ? ", `gm.stl`" : "") +
                (model.meshes.size() > 4 ? ", `wm.stl`" : "") +
                (options.writesBemFmm ? " with `tissue_index.txt` | BEM-FMM (and SimNIBS)"
                                      : " | SimNIBS") +
                " | scanner RAS; millimetres |\n";
    }
    if (model.spongyBone) {
        rows += std::string("| `spongy_bone.surf`") +
                (options.writesStl() ? " (" + mri + "), `spongy.stl` (scanner RAS)" : "") +
                " | spongy bone within the skull | " + (options.writesStl() ? "" : mri + "; ") +
                "millimetres |\n";
    }
    if (model.tetrahedra) {
        std::vector<std::string> tissues;
        for (const TetrahedraRegion& tissue : allTissues(model.meshes.size())) {
            tissues.push_back(std::to_string(tissue.label) + " " + tissue.name);
        }
        const std::string first(1, tissues.front().front());
        rows +=
            "| `head.msh` (2.2), `head-4.1.msh`, `head.vtu` | SimNIBS and Gmsh, Gmsh, viewers; "
            "tissues " +
            joined(tissues, ", ") + "; `head.msh` has their outer surfaces too, 100" + first +
            " to 1005 | " + frame +
            "; millimetres |\n| `head.dgf` | DUNEuro; `head.cond` has the conductivities (S/m) of "
            "tissues 0 to " +
            std::to_string(tissues.size() - 1) + " of `head.dgf`, of " + first +
            " to 5 of `head.msh` | " + frame + "; millimetres |\n";
    }
    if (model.sources) {
        rows += "| `dipoles.txt` | OpenMEEG | " + frame + "; " +
                (options.unit == OpenMeegUnit::Metres ? "metres" : "millimetres") +
                " |\n| `sources-src.fif` | MNE | " + mri + "; metres |\n";
    }
    if (hasTransform(model)) {
        rows += "| `head-mri-trans.fif` | MNE | head coordinates, by nasion and ears, to " + mri +
                "; metres |\n";
    }
    if (model.leadField) {
        rows +=
            "| `lead-field.mat` | MATLAB, SciPy | potentials at `label`, `elecpos` (rows) of unit "
            "dipoles at `pos` along `ori` (columns), V/(A m), without a reference, by " +
            model.leadField->solver + "; " + frame + "; millimetres |\n";
        if (!model.leadField->forward.empty()) {
            rows +=
                "| `lead-field-fwd.fif` | MNE (read_forward_solution) | head coordinates; metres "
                "|\n";
        }
    }
    if (options.writesBesa) rows += "| `head.sfp` | BESA | " + frame + "; millimetres |\n";
    if (model.electrodes && !model.electrodes->all().empty()) {
        rows +=
            "| `electrodes.tsv` with `coordsystem.json`, `electrodes.elc`, `electrodes.sfp` | "
            "BIDS, ASA, "
            "BESA | " +
            frame + "; millimetres |\n| `electrodes-dig.fif` | MNE (read_dig_fif) | " + mri +
            "; metres |\n";
    }
    return rows;
}

/// How toolboxes take their files, for what else was asked for.
std::string toolboxText(const BemModel& model, const BemFileOptions& options) {
    const bool isOne = model.options.boundaries.innerSkullOnly;
    std::string text;
    if (options.writesFif) {
        text +=
            "\nMNE-Python without FreeSurfer's folders:\n```python\nimport mne\n"
            "bem = mne.make_bem_solution(mne.read_bem_surfaces('bem.fif'))\n```\n";
    }
    if (model.sources && hasTransform(model)) {
        text +=
            "\nMNE's lead field; `info` names the electrodes (or sensors) of the recording:\n"
            "```python\nmontage = mne.channels.read_custom_montage('electrodes.elc', "
            "head_size=None)\ninfo = mne.create_info(montage.ch_names, 1000, 'eeg')"
            ".set_montage(montage)\nfwd = mne.make_forward_solution(info, 'head-mri-trans.fif', "
            "'sources-src.fif', bem, meg=False)\n```\n";
    }
    if (options.writesFieldTrip) {
        text += isOne ? "\nFieldTrip (`type` is singleshell, which needs no more):\n```matlab\n"
                        "load headmodel.mat\n```\n"
                      : std::string(model.options.boundaries.innerSurfaces > 0
                                        ? "\nFieldTrip, with OpenMEEG:\n"
                                        : "\nFieldTrip, with OpenMEEG (or ft_headmodel_dipoli, "
                                          "_bemcp):\n") +
                            "```matlab\nload headmodel.mat\n"
                            "headmodel = ft_headmodel_openmeeg(headmodel.bnd, 'conductivity', "
                            "headmodel.cond, 'tissue', headmodel.tissue);\n```\n";
    }
    if (options.writesBrainstorm && !hasLandmarks(model)) {
        text +=
            "\nBrainstorm takes the points of `tess_*_bem.mat` for SCS coordinates, which follow "
            "from nasion and ears; these are the scanner's: convert them with `cs_convert(sMri, "
            "'world', 'scs', Vertices)`, or import the `.gii` files as \"GIFTI / World "
            "coordinates\".\n";
    }
    return text;
}

/// From the model to the gain matrix, as far as the files of this folder lead.
std::string openMeegText(const BemModel& model, const std::string& frame, const std::string& unit) {
    const bool isMeg = model.options.boundaries.innerSkullOnly;
    const bool hasDipoles = model.sources.has_value();
    const bool hasElectrodes = model.electrodes && !model.electrodes->all().empty();
    std::string text =
        "\nOpenMEEG (not in Debian; openmeeg.github.io), in this folder:\n```sh\n"
        "om_check_geom -g model.geom\n";
    for (const auto& command : openMeegCommands(hasDipoles, hasElectrodes)) {
        text += joined(command, " ") + "\n";
    }
    text += "```\n";
    const std::string where = "; in " + frame + ", " + unit;
    if (hasDipoles) {
        text += "`dipoles.txt` has a line `x y z ox oy oz` for each dipole (place, orientation)" +
                where + ".\n";
    }
    if (hasElectrodes) {
        text += "`electrodes.txt` has a line `x y z` for each electrode" + where + ".\n";
    }
    if (hasDipoles && hasElectrodes) {
        text += "`gain.txt` has a row for each electrode and a column for each dipole.\n";
    } else {
        text += std::string("A gain matrix also takes ") +
                (hasDipoles ? "" : "dipoles (`--sources`, or a line `x y z ox oy oz` for each)") +
                (hasDipoles || hasElectrodes ? "" : " and ") +
                (hasElectrodes ? ""
                 : isMeg       ? "the sensors (a line `x y z ox oy oz` for each)"
                               : "electrodes (`--electrodes`, `--montage`, or a line `x y z` for "
                                 "each)") +
                where + ".\n";
    }
    return text +
           "\nTriangles and normals of `*.tri` point outward. OpenMEEG takes either orientation; "
           "\"Global reorientation of interface\" is no fault.\n";
}

}  // namespace

std::string bemReadme(const BemModel& model, const BemFileOptions& options,
                      const std::string& maker) {
    const bool isMetres = options.unit == OpenMeegUnit::Metres;
    const bool isOne = model.options.boundaries.innerSkullOnly;
    const std::string frame = frameText(options.frame);
    const std::string unit = isMetres ? "metres" : "millimetres";
    std::string text =
        "# Boundary element head model\nMade by " + maker + ". " +
        (isOne ? "One surface (inner skull), for MEG." : surfacesText(model.meshes.size())) +
        " Each is closed, of genus 0, outward" +
        (isOne ? ".\n" : ", and lies strictly inside the next.\n");
    text += "\n| files | for | frame and unit |\n|---|---|---|\n";
    text += std::string("| `*.surf` | FreeSurfer, MNE | ") +
            (model.tkRasVolume ? "surface RAS (tkRAS) of the image; the footer leads to scanner RAS"
                               : "scanner RAS (of a volume around the scanner's origin)") +
            "; millimetres |\n";
    text += "| `model.geom`, `model.cond`, `*.tri` | OpenMEEG | " + frame + "; " + unit +
            (isMetres ? " (potentials in volts)" : "") + " |\n";
    text += toolboxRows(model, options, frame);
    text += "| `report.json` | what was made, measured and checked | scanner LPS; millimetres |\n";

    text +=
        "\nMNE-Python, with the `.surf` files in `SUBJECTS_DIR/SUBJECT/bem` (or a copy of this "
        "folder under that name):\n```python\nimport mne\nmodel = mne.make_bem_model('SUBJECT', "
        "ico=None, conductivity=" +
        conductivityTuple(model.options) +
        ", subjects_dir='SUBJECTS_DIR')\nbem = mne.make_bem_solution(model)\n```\n";
    return text + openMeegText(model, frame, unit) + toolboxText(model, options);
}

}  // namespace adaptiso
