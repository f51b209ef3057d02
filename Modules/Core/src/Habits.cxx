#include "adaptiso/Core/Habits.h"

#include <algorithm>

#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

/// Options of FSL, FreeSurfer, MNE, SimNIBS, Slicer, Meshmixer, MeshLab, PyVista, scikit-image and
/// BIDS Apps that ask for one thing.
struct Habit {
    std::string_view words;     ///< lower case, with hyphens
    std::string_view programs;  ///< "mesh check"; empty: all
    std::string_view option;    ///< that the program must have; empty: none
    std::string_view answer;    ///< empty: "did you mean --<option>?"
};

/// The first row that fits counts. WordsTest reads the rows.
constexpr Habit kHabits[] = {
    // inputs
    {"i in input image mri anat t1w", "bem", "t1", ""},
    {"i in image infile in-file input-file", "giant", "input", ""},
    {"i in input bids-dir", "bids", "", "BIDS_DIR is the first argument"},
    {"i in input image infile in-file input-file", "", "",
     "inputs need no option; give the file alone"},
    {"seg segmentation dseg aparc parcellation", "bem", "labels", ""},
    {"mask brain brainmask bet", "bem", "brain-mask", ""},
    {"watershed preflood atlas gcaatlas", "bem", "brain-mask",
     "--brain-mask takes the brain of any extraction, mri_watershed's too"},
    {"mask masks", "labels", "join", ""},
    {"mask", "mesh", "crop", "fslmaths IMAGE -mas MASK OUT masks it; --crop cuts a box"},
    {"label labels seg segmentation region atlas aparc", "mesh", "",
     "adaptiso-labels makes the surfaces of all regions"},
    {"region regions roi structures ids", "labels", "labels", ""},
    {"lut ctab colors colours color-table label-table lookup", "labels", "names", ""},
    {"sid subjid subject-id", "bem", "subject", ""},
    {"sd fs-dir fs-subjects-dir", "bem", "subjects-dir", ""},
    {"s subject sub subjects participant participants participant-id", "bids", "participant-label",
     ""},
    {"session ses sessions", "bids", "session-label", ""},
    {"s subject d sd subjects-dir", "mesh", "", "give the file: subjects/NAME/mri/brain.mgz"},
    {"s subject d sd subjects-dir", "labels", "",
     "give the file: subjects/NAME/mri/aparc+aseg.mgz"},
    {"roi bbox bounding-box extent clip", "", "crop", ""},
    {"recursive", "", "list", "find FOLDER -name '*.nii.gz' lists files; --list - takes that"},
    // surfaces
    {"threshold thresh thr t contour isovalue iso-value isolevel iso-level isosurface isosurfaces "
     "hu",
     "", "iso", ""},
    {"ico bem-ico", "bem", "vertices",
     "--vertices 2562 is ico 4, 642 ico 3, 10242 ico 5; MNE-Python takes these by ico=None"},
    {"eeg", "bem", "meg", "three layers, as EEG needs, are the default; --electrodes takes a cap"},
    {"f frac", "bem", "brain-mask", "bet IMAGE OUT -f 0.4 gives what --brain-mask takes"},
    {"list batch", "bem", "", "one head a run; adaptiso-bids makes those of many"},
    {"decimate reduce subdivision ntri npoints n-vertices triangles faces reduction", "bem",
     "vertices", ""},
    {"oct spacing src source-space", "bem", "source-count", ""},
    {"thickness min-thickness gap distance", "bem", "min-gap", ""},
    {"decimate decimation reduce target-reduction reduction-factor", "", "reduction", ""},
    {"ratio keep percent percentage target-perc", "", "reduction",
     "--reduction is the share to drop: 0.9 keeps a tenth"},
    {"decimate decimation reduce reduction triangles faces", "mend compare check giant", "",
     "adaptiso-simplify makes fewer triangles"},
    {"faces polygons tris target-faces target-count target-face-num face-count num-faces nfaces "
     "n-triangles "
     "target-number-of-triangles",
     "", "triangles", ""},
    {"simplify adaptive", "mesh labels", "max-error",
     "surfaces are simplified; --max-error says how far, --triangles to how many"},
    {"angle minimum-angle", "", "min-angle", ""},
    {"tolerance tol error deviation accuracy max-distance", "", "max-error", ""},
    {"fwhm", "", "smooth", "--smooth takes the standard deviation: FWHM / 2.355"},
    {"sigma blur gaussian smoothing", "", "smooth", ""},
    {"smooth-iterations iterations n-iter smooth-iter taubin laplacian lambda relaxation", "",
     "smooth", "--smooth MM smooths the image, which the surface follows"},
    {"smooth smooth-iterations iterations taubin laplacian", "", "smoothing", ""},
    {"smooth smoothing smooth-iterations iterations n-iter taubin laplacian",
     "simplify mend labels", "", "surfaces keep their place; adaptiso-mesh smooths images"},
    {"downsample step-size subsample shrink", "", "resample",
     "--resample takes the new spacing in mm"},
    {"voxel-size voxelsize resolution spacing", "", "resample", ""},
    {"keep-largest biggest extract-largest connected connectivity lcc", "", "largest", ""},
    {"min-size min-component island islands remove-small", "", "min-volume", ""},
    {"fill fill-holes fillholes holes close-holes", "mesh", "fill-cavities", ""},
    {"cavity cavities", "", "fill-cavities", ""},
    {"fill fill-holes fillholes holes close-holes hole-size", "", "max-hole", ""},
    {"watertight closed manifold", "mesh", "border",
     "results are watertight without --border open"},
    {"watertight closed manifold make-solid solid", "mend", "open",
     "results are watertight without --open"},
    {"watertight closed manifold", "labels bem", "", "results are always watertight"},
    {"watertight closed manifold printable", "check", "profile", ""},
    {"repair fix clean make-solid", "mesh check simplify compare", "",
     "adaptiso-mend makes a solid of any mesh"},
    {"boolean union unite merge-meshes", "mend", "",
     "bodies of one file that overlap are united without an option"},
    {"boolean union unite merge-meshes", "mesh check simplify compare", "",
     "adaptiso-mend unites bodies of one file that overlap"},
    {"hollow shell wall-thickness", "mesh labels simplify mend", "",
     "no program makes shells; a slicer's infill makes prints hollow"},
    {"hausdorff", "", "max-hausdorff", "it is always measured; --max-hausdorff limits it"},
    {"mean", "", "max-mean", ""},
    {"n-samples nsamples n-points", "", "samples", ""},
    {"dice overlap", "compare", "volume", "--volume IMG gives the overlap (Dice)"},
    {"reference ref", "compare", "", "B is the reference"},
    // outputs
    {"o out output outdir out-dir output-dir derivatives", "bids", "",
     "OUT_DIR is the second argument"},
    {"outdir out-dir outputdir output-folder output-directory destination", "", "output-dir", ""},
    {"out outfile out-file output-file save outdir out-dir output-dir output-directory", "",
     "output", ""},
    {"format type", "bem", "vtp", "--vtp and --gifti add files to FreeSurfer's"},
    {"format type extension ext", "mesh simplify mend giant", "output",
     "the extension of --output decides"},
    {"ascii binary", "mesh labels simplify mend giant", "",
     "STL and PLY are binary, OBJ and OFF text"},
    {"f r", "mesh simplify", "reduction", "--reduction is the share to drop: 0.9 keeps a tenth"},
    {"overwrite replace clobber f y yes", "", "force", ""},
    {"force overwrite replace clobber f y yes", "bids giant", "",
     "what has changed is made again; remove a result to make it anew"},
    {"force overwrite replace clobber f y yes", "", "", "files of an earlier run are replaced"},
    {"dry-run test no-write simulate", "", "info",
     "--info prints geometry, range and isovalues, and writes nothing"},
    {"dry-run", "giant", "", "the step plan writes the plan alone"},
    {"csv tsv table stats qc html report", "bids", "",
     "the level group writes quality.tsv and summary.html"},
    {"tsv table stats spreadsheet", "", "csv", ""},
    {"csv tsv table stats", "", "json", ""},
    {"qc html page", "", "report", ""},
    {"color colour colormap cmap heatmap", "compare", "colored", ""},
    {"color colour", "", "picture-color", ""},
    {"background bg", "", "picture-background", ""},
    {"view camera azimuth", "", "picture-view", ""},
    {"window-size image-size", "", "picture-size", ""},
    {"screenshot png snapshot render plot figure thumbnail", "", "pictures", ""},
    {"space frame coordinate-system coords ras lps tkr", "", "coordinates", ""},
    {"center centre rotate mirror flip translate transform", "", "",
     "surfaces stay where the scan is; Python's transform() moves them"},
    {"trans coreg coregistration head-mri-trans", "bem", "electrodes",
     "--nasion, --left-ear and --right-ear, or a cap file (--electrodes), make head-mri-trans.fif"},
    {"unit scale", "bem", "units", ""},
    {"bed printer build-volume", "", "fit", ""},
    {"size print-size target-size model-size", "", "scale",
     "--scale FACTOR scales the file; --fit X,Y,Z --scale auto brings it down to a box"},
    {"resize shrink", "", "scale", ""},
    {"units unit scale", "", "", "lengths are in mm, as images and surfaces have them"},
    // running
    {"j n-cpus n-jobs n-procs nproc nprocs num-workers workers parallel", "", "jobs", ""},
    {"j jobs n-cpus n-jobs n-procs nproc nprocs num-workers parallel", "", "workers", ""},
    {"j n-cpus n-jobs n-procs nproc nprocs n-threads nthreads num-threads omp-nthreads openmp "
     "cores cpus",
     "", "threads", ""},
    {"resume continue no-clobber", "", "skip-existing", ""},
    {"verbose debug log-level progress", "", "quiet",
     "progress and results are printed unless --quiet is given"},
    {"silent no-progress", "", "quiet", ""},
    {"gpu cuda device", "", "threads", "all work is the processor's; --threads sets its share"},
    {"work-dir w tmp tmpdir scratch", "giant", "", "WORK is the second argument"},
    {"work-dir w tmp tmpdir scratch", "", "", "temporary files lie beside the outputs"},
    {"seed random-seed", "", "", "the same input gives the same result"},
    {"memory mem-mb mem max-memory", "mesh", "", "adaptiso-giant takes volumes larger than memory"},
};

bool holdsWord(std::string_view words, std::string_view word) {
    const std::string all = " " + std::string(words) + " ";
    return all.find(" " + std::string(word) + " ") != std::string::npos;
}

}  // namespace

std::optional<std::string> habitAnswer(std::string_view program, std::string_view typed,
                                       const std::vector<std::string>& known) {
    std::string word = lowerCase(typed);
    std::ranges::replace(word, '_', '-');
    const std::string_view own = program.substr(program.find('-') + 1);
    for (const Habit& habit : kHabits) {
        const bool fits =
            holdsWord(habit.words, word) &&
            (habit.programs.empty() || holdsWord(habit.programs, own)) &&
            (habit.option.empty() || std::ranges::find(known, habit.option) != known.end());
        if (!fits) continue;
        if (!habit.answer.empty()) return std::string(habit.answer);
        return "did you mean --" + std::string(habit.option) + "?";
    }
    return std::nullopt;
}

}  // namespace adaptiso
