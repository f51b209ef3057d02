"""What the programs say to a wrong command line: one line that names option or file, says what
is wrong and what to do, and no word of the programs' insides."""

import json
import re
import subprocess

from support import (BAD_INPUT, BIN, SOURCE, USAGE, ApplicationTest, ball, from_function, main,
                     write_4d_nifti, write_nifti)
from headDefects import write_off

# what a user can't know: functions, C++ and CLI11's words, numbers of a hundred digits
INSIDES = re.compile(
    r"\b(?!tkRAS)[a-z]+[A-Z]\w*: |\bBlockGrid|\bVolumeView|std::|lexical|POSITIVE|NONNEGATIVE|\bTEXT\b|"
    r"\bFLOAT\b|\bUINT\b|Could not|not in range|At Most|At Least|\d required|excludes|requires |"
    r"not expected|\d{61}|\bnan mm|\binf mm|basic_string|vector::")

BALL = ("ball.nii", "--iso", "100")
MESH, CHECK, COMPARE, BEM = ("adaptiso-mesh", "adaptiso-check", "adaptiso-compare", "adaptiso-bem")
SIMPLIFY = "adaptiso-simplify"

# (exit code, what the line must match, program, arguments)
WRONG = [
    # nothing, or too little
    (USAGE, "INPUT is missing: the image", MESH, ()),
    (USAGE, "--iso is missing: .*--info .*or auto", MESH, ("ball.nii",)),
    (USAGE, "FILE is missing: the surfaces", CHECK, ()),
    (USAGE, "A is missing: adaptiso-compare takes A and B", COMPARE, ()),
    (USAGE, "B is missing: adaptiso-compare takes A and B", COMPARE, ("a.off",)),
    (USAGE, "one of --t1, --labels", BEM, ()),
    (USAGE, "MESH is missing: the surface", SIMPLIFY, ()),
    (USAGE, "--max-error, --triangles or --reduction is missing", SIMPLIFY, ("a.off",)),
    (USAGE, "--output is missing: a folder", SIMPLIFY, ("a.off", "a.off", "--max-error", "1")),
    (USAGE, "--iso: its value is missing; give V|auto", MESH, ("ball.nii", "--iso")),
    (USAGE, "--json: its value is missing; give FILE", CHECK, ("a.off", "--json")),
    (USAGE, "--output: its value is missing; --json is an option", MESH,
     (*BALL, "-o", "--json", "r.json")),
    (USAGE, "--json: its value is missing; -o is an option", MESH,
     ("ball.nii", "--iso", "100", "--json", "-o", "x.stl")),
    (USAGE, "--json: its value is missing; one that begins with dashes is given as --json=-o", CHECK,
     ("a.off", "--json", "-o")),
    (USAGE, "--max-mean: its value is missing; --quiet is an option", COMPARE,
     ("a.off", "a.off", "--max-mean", "--quiet")),
    # too much
    (USAGE, "c.off: is one argument too many; adaptiso-compare takes A and B", COMPARE,
     ("a.off", "a.off", "c.off")),
    (USAGE, "a.nii: is one argument too many; adaptiso-bem takes options only, "
     "such as --t1 IMG",  BEM,
     ("a.nii", "--t1", "ball.nii", "-o", "m")),
    (USAGE, "--threads: is given 2 times; give it once", MESH,
     (*BALL, "--threads", "1", "--threads", "2")),
    (USAGE, "--output: is given 2 times", MESH, (*BALL, "-o", "a.vtp", "-o", "b.vtp")),
    (USAGE, "--iso 100.0: given twice", MESH, (*BALL, "--iso", "100.0")),
    (USAGE, "--quiet: takes no value", MESH, (*BALL, "--quiet=maybe")),
    # options that do not exist
    (USAGE, r"--isso: there is no such option; did you mean --iso\?", MESH,
     ("ball.nii", "--isso", "100")),
    (USAGE, r"--isovalue: there is no such option; did you mean --iso\?", MESH,
     ("ball.nii", "--isovalue", "100")),
    (USAGE, r"--isovalue: there is no such option; did you mean --iso\?", MESH,
     ("ball.nii", "--isovalue=100")),
    (USAGE, r"-iso: there is no such option; did you mean --iso\?", MESH, ("ball.nii", "-iso",
                                                                          "100")),
    (USAGE, r"--tirangles: .*did you mean --triangles\?", MESH, (*BALL, "--tirangles", "5")),
    (USAGE, r"--max-eror: .*did you mean --max-error\?", MESH, (*BALL, "--max-eror", "5")),
    (USAGE, r"--thread: .*did you mean --threads\?", CHECK, ("a.off", "--thread", "2")),
    (USAGE, r"--voxels: .*did you mean --voxel\?", COMPARE, ("a.off", "a.off", "--voxels", "1")),
    (USAGE, r"--brain-msk: .*did you mean --brain-mask\?", BEM,
     ("--t1", "ball.nii", "--brain-msk", "x", "-o", "m")),
    # what other programs call them
    (USAGE, r"--hollow: there is no such option; no program makes shells", MESH, (*BALL, "--hollow", "2")),
    (USAGE, r"--verbose: there is no such option; progress .* unless --quiet", MESH, (*BALL, "--verbose")),
    (USAGE, r"--Target_Faces: .*did you mean --triangles\?", SIMPLIFY, ("a.off", "--Target_Faces=9")),
    (USAGE, r"--ico: there is no such option; --vertices 2562 is ico 4", BEM,
     ("--t1", "ball.nii", "-o", "m", "--ico", "4")),
    (USAGE, r"-i: there is no such option; inputs need no option", MESH, ("-i", "ball.nii", "--iso", "100")),
    (USAGE, r"-i: .*did you mean --t1\?", BEM, ("-i", "ball.nii", "-o", "m")),
    (USAGE, r"--threshold: .*did you mean --iso\?", MESH, ("ball.nii", "--threshold", "100")),
    (USAGE, r"--decimate: .*did you mean --reduction\?", SIMPLIFY, ("a.off", "--decimate", "0.5")),
    (USAGE, r"--overwrite: .*did you mean --force\?", BEM, ("--t1", "ball.nii", "-o", "m", "--overwrite")),
    (USAGE, r"--mask: .*did you mean --brain-mask\?", BEM, ("--t1", "ball.nii", "--mask", "x", "-o", "m")),
    (USAGE, r"--n_cpus: .*did you mean --jobs\?", MESH, (*BALL, "--n_cpus", "2")),
    (USAGE, r"--color: .*did you mean --picture-color\?", MESH, (*BALL, "--color", "red")),
    (USAGE, r"--qc: .*did you mean --report\?", MESH, (*BALL, "--qc", "x.html")),
    # what other programs take
    (USAGE, r"--reduction 50: must be a number from 0 to 1; 50 % is 0.5 \(see", MESH, (*BALL, "--reduction", "50")),
    (USAGE, "o.stl: there is no such input; an output is given as -o o.stl", MESH, ("ball.nii", "o.stl")),
    (USAGE, "o.stl: there is no such input; an output is given as -o o.stl", SIMPLIFY, ("a.off", "o.stl")),
    (USAGE, "o.stl: there is no such input; an output is given as -o o.stl", "adaptiso-mend", ("a.off", "o.stl")),
    (USAGE, "--output both: several INPUTs make a folder each, .* or with --join one map", "adaptiso-labels",
     ("ball.nii", "flat.nii", "-o", "both")),
    (USAGE, "--conductivity: its numbers have commas and no blanks between them; give 0.3,0.006,0.3 ", BEM,
     ("--t1", "ball.nii", "-o", "m", "--conductivity", "0.3,", "0.006", "0.3")),
    (BAD_INPUT, "--log ball.nii: exists and is no log; name a new file", MESH, (*BALL, "--log", "ball.nii")),
    # what a shell makes of --json *.off
    (BAD_INPUT, "--json a.off: exists and is no JSON report; name a new file", MESH, (*BALL, "--json", "a.off")),
    (BAD_INPUT, "--json a.off: exists and is no JSON report; name a new file", "adaptiso-giant",
     ("run", "w", "--input", "ball.nii", "--iso", "100", "--json", "a.off")),
    (BAD_INPUT, "--report a.off: exists and is no HTML page; name a new file", MESH, (*BALL, "--report", "a.off")),
    (BAD_INPUT, "--csv a.off: exists and is no table of runs; name a new file", MESH, ("ball.nii", "flat.nii", "--iso", "100", "--csv", "a.off")),
    (USAGE, "--eeg: there is no such option; three layers, as EEG needs, are the default", BEM, ("--t1", "ball.nii", "-o", "m", "--eeg")),
    (USAGE, "-f: .*bet IMAGE OUT -f 0.4", BEM, ("--t1", "ball.nii", "-o", "m", "-f", "0.4")),
    (USAGE, "--list: .*adaptiso-bids makes those of many", BEM, ("--t1", "ball.nii", "-o", "m", "--list", "x.txt")),
    # a folder that is named like a file
    (USAGE, r"--output bones.ply: is a folder to make.*-o bones --format ply", "adaptiso-labels",
     ("ball.nii", "-o", "bones.ply")),
    (USAGE, r"--output m.gii: is a folder to make.*-o model", BEM, ("--t1", "ball.nii", "-o", "m.gii")),
    (USAGE, r"--output-dir o.ply: is a folder to make", MESH, (*BALL, "--output-dir", "o.ply")),
    # options of another format
    (BAD_INPUT, "--level, .*ball.nii is NIfTI-1, and these are for Zarr and N5", BEM,
     ("--t1", "ball.nii", "-o", "m", "--level", "1")),
    (BAD_INPUT, "--series 1: .*ball.nii is NIfTI-1, which has no series", BEM,
     ("--t1", "ball.nii", "-o", "m", "--series", "1")),
    (USAGE, r"--frobnicate: there is no such option \(see", MESH, (*BALL, "--frobnicate")),
    (USAGE, r"--x: there is no such option \(see", CHECK, ("a.off", "--x")),
    (USAGE, r"--größe: there is no such option \(see", MESH, (*BALL, "--größe")),
    # empty strings
    (USAGE, "INPUT: its value is empty", MESH, ("", "--iso", "100")),
    (USAGE, "--iso: its value is empty; give V|auto", MESH, ("ball.nii", "--iso", "")),
    (USAGE, "--iso: its value is empty; give V|auto", MESH, ("ball.nii", "--iso=")),
    (USAGE, "--json: its value is empty; give FILE", MESH, (*BALL, "--json", "")),
    (USAGE, "--output: its value is empty; give OUT", MESH, (*BALL, "--output=", "a.vtp")),
    (USAGE, "FILE: its value is empty", CHECK, ("",)),
    (USAGE, "--volume: its value is empty; give IMG", COMPARE, ("a.off", "a.off", "--volume", "")),
    (USAGE, "--surfaces: its value is empty; give MESH...", BEM, ("--surfaces", "a.off", "", "c.off", "-o", "m")),
    (USAGE, "--t1: its value is empty; give IMG", BEM, ("--t1", "", "-o", "m")),
    (USAGE, "--report: its value is empty", BEM, ("--t1", "ball.nii", "-o", "m", "--report=")),
    # isovalues
    (USAGE, "--iso abc: must be a finite number, or auto", MESH, ("ball.nii", "--iso", "abc")),
    (USAGE, "--level -1: must be", MESH, (*BALL, "--level", "-1")),
    (BAD_INPUT, "--level, .*ball.nii is NIfTI-1, and these are for Zarr", MESH, (*BALL, "--level", "1")),
    (USAGE, "--iso nan: must be a finite number", MESH, ("ball.nii", "--iso", "nan")),
    (USAGE, "--iso inf: must be a finite number", MESH, ("ball.nii", "--iso", "inf")),
    (USAGE, "--iso -inf: must be a finite number", MESH, ("ball.nii", "--iso=-inf")),
    (USAGE, r"--iso 1e999: is larger than the largest number there is here, 1.8e308; must be", MESH,
     ("ball.nii", "--iso", "1e999")),
    (USAGE, r"--iso 1{60}\.\.\.: is larger than", MESH, ("ball.nii", "--iso", "1" * 309 + "000")),
    (USAGE, r"--iso 1e-999: is too close to 0", MESH, ("ball.nii", "--iso", "1e-999")),
    (USAGE, r"--iso 0,5: decimals follow a point \(0.5\); must be a finite number", MESH,
     ("ball.nii", "--iso", "0,5")),
    (USAGE, r"--triangles 10,000: has a comma: thousands are written without \(10000\), decimals with "
            r"a point \(10.000\); must be a whole number", MESH, (*BALL, "--triangles", "10,000")),
    (USAGE, r"--iso 1,234,567: has commas: thousands are written without \(1234567\); must be",
     MESH, ("ball.nii", "--iso", "1,234,567")),
    (USAGE, "--iso ' 5': must be a finite number", MESH, ("ball.nii", "--iso", " 5")),
    (USAGE, "--iso １００: must be", MESH, ("ball.nii", "--iso", "１００")),
    (USAGE, "--iso nan: must be a finite number", CHECK, ("a.off", "--volume", "ball.nii", "--iso",
                                                         "nan")),
    (BAD_INPUT, r"--iso 1e\+300: no voxel reaches it; the range of ball.nii is ", MESH,
     ("ball.nii", "--iso", "1e300")),
    (BAD_INPUT, r"--iso 500: no voxel reaches it; the range of ball.nii is 45 to 131$", MESH,
     ("ball.nii", "--iso", "500")),
    (BAD_INPUT, "--iso 7000: ball.nii: there is no surface; the range is", CHECK,
     ("a.off", "--volume", "ball.nii", "--iso", "7000")),
    (BAD_INPUT, "--iso auto: flat.nii: all its finite values are equal.*give an isovalue", MESH,
     ("flat.nii", "--iso", "auto")),
    (BAD_INPUT, r"/dev/null/out: the folder can't be made \(Not a directory\); choose another$", MESH,
     (*BALL, "--output-dir", "/dev/null/out")),
    # numbers of other options
    (USAGE, "--max-error 0: must be a number above 0, in mm", MESH, (*BALL, "--max-error", "0")),
    (USAGE, "--max-error inf: must be a number above 0, in mm", MESH,
     (*BALL, "--max-error", "inf")),
    (USAGE, "--max-error abc: must be a number above 0", MESH, (*BALL, "--max-error", "abc")),
    (USAGE, r"--max-error 0,1: decimals follow a point \(0.1\)", MESH,
     (*BALL, "--max-error", "0,1")),
    (USAGE, "--triangles -5: must be a whole number, 0 or more", MESH, (*BALL, "--triangles=-5")),
    (USAGE, "--triangles 1.5: must be a whole number", MESH, (*BALL, "--triangles", "1.5")),
    (USAGE, "--triangles many: must be a whole number", MESH, (*BALL, "--triangles", "many")),
    (USAGE, "--reduction 2: must be a number from 0 to 1", MESH, (*BALL, "--reduction", "2")),
    (USAGE, "--reduction 50%: must be a number from 0 to 1; 50 % is 0.5", MESH, (*BALL, "--reduction", "50%")),
    (USAGE, "--min-angle 41: must be a number from 0 to 40, in degrees", MESH,
     (*BALL, "--min-angle", "41")),
    (USAGE, "--min-volume -1: must be a number, 0 or more, in mm3", MESH,
     (*BALL, "--min-volume=-1")),
    (USAGE, "--threads 0: must be a whole number from 1 to 1024", MESH, (*BALL, "--threads", "0")),
    (USAGE, "--threads 99999999999999999999: must be a whole number from 1 to 1024", CHECK,
     ("a.off", "--threads", "9" * 20)),
    (USAGE, "--threads all: must be a whole number", BEM, ("--t1", "ball.nii", "-o", "m",
                                                          "--threads", "all")),
    (USAGE, "--jobs -2: must be a whole number from 1 to 1024", MESH, (*BALL, "--jobs=-2")),
    (USAGE, "--volume-index -1: must be a whole number, 0 or more", MESH,
     (*BALL, "--volume-index=-1")),
    (USAGE, "--volume-index last: must be a whole number", COMPARE,
     ("a.off", "a.off", "--volume", "ball.nii", "--volume-index", "last")),
    (USAGE, "--samples 0: must be a whole number from 1 to 1000000000", COMPARE,
     ("a.off", "a.off", "--samples", "0")),
    (USAGE, "--samples 1e6: must be a whole number", COMPARE,
     ("a.off", "a.off", "--samples", "1e6")),
    (USAGE, "--voxel 0: must be a number above 0, in mm", COMPARE,
     ("a.off", "a.off", "--voxel", "0")),
    (USAGE, "--max-hausdorff -1: must be a number, 0 or more, in mm", COMPARE,
     ("a.off", "a.off", "--max-hausdorff=-1")),
    (USAGE, "--max-mean 1mm: must be a number", COMPARE, ("a.off", "a.off", "--max-mean", "1mm")),
    (USAGE, "--max-pairs -1: must be a whole number from 0", CHECK, ("a.off", "--max-pairs=-1")),
    (USAGE, "--min-angle 61: must be a number from 0 to 60, in degrees", CHECK,
     ("a.off", "--min-angle", "61")),
    (USAGE, "--min-gap x: must be a number, 0 or more, in mm", CHECK,
     ("--nested", "a.off", "a.off", "--min-gap", "x")),
    (USAGE, "--vertices 3: must be a whole number from 42 to 200000", BEM,
     ("--t1", "ball.nii", "-o", "m", "--vertices", "3")),
    (USAGE, "--vertices many: must be a whole number from 42 to 200000", BEM,
     ("--t1", "ball.nii", "-o", "m", "--vertices", "many")),
    # words
    (USAGE, "--method adptive: must be adaptive, boxes, dmc, asc or mc; did you mean adaptive", MESH,
     (*BALL, "--method", "adptive")),
    (USAGE, r"--method x: must be adaptive, boxes, dmc, asc or mc \(see", MESH,
     (*BALL, "--method", "x")),
    (USAGE, "--block-size 3: must be 2, 4, 8 or 16", MESH, (*BALL, "--block-size", "3")),
    (USAGE, "--border Open: must be closed or open; did you mean open", MESH,
     (*BALL, "--border", "Open")),
    (USAGE, "--coordinates RAS: must be ras, lps, tkras or voxel", MESH,
     (*BALL, "--coordinates", "RAS")),
    (USAGE, "--interpolation cubic: must be linear, bspline or nearest", MESH,
     (*BALL, "--resample", "1", "--interpolation", "cubic")),
    (USAGE, "--profile cake: must be bem, print or view", CHECK, ("a.off", "--profile", "cake")),
    # contradictions
    (USAGE, "--interpolation needs --resample", MESH, (*BALL, "--interpolation", "linear")),
    (USAGE, "--symmetric and --one-sided: give one|--one-sided and --symmetric: give one", COMPARE,
     ("a.off", "a.off", "--one-sided", "--symmetric")),
    (USAGE, "--info and --list-series: give one|--list-series and --info: give one", MESH,
     ("ball.nii", "--info", "--list-series")),
    (USAGE, "--info: makes no surface", MESH, (*BALL, "--info")),
    (USAGE, "--min-volume and --fill-cavities need closed", MESH,
     (*BALL, "--border", "open", "--fill-cavities")),
    (USAGE, "--max-error, --triangles, .* are for --method adaptive", MESH, (*BALL, "--method", "mc", "--triangles", "5")),
    (USAGE, "--series needs --volume", CHECK, ("a.off", "--series", "1")),
    (USAGE, "--nested: needs at least two", CHECK, ("--nested", "a.off")),
    # series, placeholders
    (USAGE, "--series first: must be a number from the list of --list-series, from 1, or", MESH,
     (*BALL, "--series", "first")),
    (USAGE, "--series 0: must be a number", MESH, (*BALL, "--series", "0")),
    (USAGE, "--series -1: must be a number", MESH, (*BALL, "--series=-1")),
    (BAD_INPUT, "--series 1: ball.nii is NIfTI-1, which has no series; leave --series out", MESH,
     (*BALL, "--series", "1")),
    (BAD_INPUT, "--series 1: ball.nii is NIfTI-1", CHECK,
     ("a.off", "--volume", "ball.nii", "--series", "1")),
    (USAGE, r"--output \{foo\}.stl: \{foo\} stands for nothing here; there is \{iso\}, \{isolabel\} or \{name\}",
     MESH, ("missing.nii", "--iso", "1", "-o", "{foo}.stl")),
    (USAGE, r"--output \{iso\}: \{iso\} stands for nothing here; there is \{name\}", MESH,
     (*BALL, "-o", "{iso}/a.stl")),
    (USAGE, r"--output a\{\}.stl: \{\} stands for nothing", MESH, (*BALL, "-o", "a{}.stl")),
    (USAGE, r"--report \{iso\}.html: \{iso\} stands for nothing", MESH,
     (*BALL, "--report", "{iso}.html")),
    (USAGE, r"--json \{name\}.json: \{name\} stands for nothing here", MESH,
     (*BALL, "--json", "{name}.json")),
    (USAGE, r"--report \{name\}.html: \{name\} stands for nothing", CHECK,
     ("a.off", "--report", "{name}.html")),
    # files of the wrong kind
    (BAD_INPUT, "a.off: this is a surface, not an image; adaptiso-check", MESH,
     ("a.off", "--iso", "1")),
    (BAD_INPUT, "a.off: this is a surface", CHECK, ("a.off", "--volume", "a.off")),
    (BAD_INPUT, "ball.nii: this is an image, not a surface; adaptiso-mesh", CHECK, ("ball.nii",)),
    (BAD_INPUT, "ball.nii: this is an image, not a surface; adaptiso-mesh", COMPARE,
     ("a.off", "ball.nii")),
    (BAD_INPUT, r"folder: this is a folder, not a surface; give the files in it; of images", CHECK, ("folder",)),
    (BAD_INPUT, r"\.: this is a folder, not a surface; give the files in it, \./\*\.off$", CHECK, (".",)),
    (BAD_INPUT, "folder: this is a folder, not a surface", COMPARE, ("folder", "a.off")),
    (BAD_INPUT, "ball.nii: this is an image, not a surface; adaptiso-mesh", SIMPLIFY,
     ("ball.nii", "--max-error", "1", "-o", "small.stl")),
    (BAD_INPUT, "missing.nii.*no such file", MESH, ("missing.nii", "--iso", "1")),
    (BAD_INPUT, "missing.off: no such file", CHECK, ("missing.off",)),
    (BAD_INPUT, "naïve scan.nii", MESH, ("naïve scan.nii", "--iso", "1")),
    (BAD_INPUT, "folder", MESH, ("folder", "--iso", "1")),
    (BAD_INPUT, "folder.vtp: exists and is not a regular file", MESH, (*BALL, "-o", "folder.vtp")),
    (USAGE, "out.xyz: no surface format has the extension '.xyz'", MESH, (*BALL, "-o", "out.xyz")),
    (USAGE, "out.nii.gz: this is the name of an image|out.nii.gz: no surface format", MESH,
     (*BALL, "-o", "out.nii.gz")),
    (BAD_INPUT, "no/out.vtp: there is no folder no", MESH, (*BALL, "-o", "no/out.vtp")),
    (BAD_INPUT, "ball.nii: is the input, which is never overwritten", MESH,
     (*BALL, "--json", "ball.nii")),
    (BAD_INPUT, "folder: exists and is not a regular file", CHECK, ("a.off", "--json", "folder")),
    (BAD_INPUT, "nan.off: .*not finite|nan.off: .*coordinate", COMPARE, ("a.off", "nan.off")),
    # preprocessing
    (USAGE, "--crop 1:2: must be three ranges of voxel indices", MESH, (*BALL, "--crop", "1:2")),
    (BAD_INPUT, r"--crop 0:99,:,:: 0:99 along i: the image has voxels 0:12 \(ball.nii\)", MESH,
     (*BALL, "--crop", "0:99,:,:")),
    (USAGE, "--smooth 0: must be a number above 0, in mm", MESH, (*BALL, "--smooth", "0")),
    (BAD_INPUT, r"--smooth 50: a standard deviation of 50 mm .*12 mm \(ball.nii\)", MESH,
     (*BALL, "--smooth", "50")),
    (BAD_INPUT, r"--resample 100: voxels of 100 mm: .*\(ball.nii\)", MESH,
     (*BALL, "--resample", "100")),
    (BAD_INPUT, r"--smooth 1: 1 voxels? holds? no finite number.*\(nan.nii\)", MESH,
     ("nan.nii", "--iso", "1", "--smooth", "1", "--no-warnings")),
    (BAD_INPUT, r"--crop 0:99,:,:: 0:99 along i: .*\(ball.nii\)", CHECK,
     ("a.off", "--volume", "ball.nii", "--iso", "100", "--crop", "0:99,:,:")),
    (BAD_INPUT, "4d.nii: .*--volume-index|4d.nii: .*volumes", MESH, ("4d.nii", "--iso", "1")),
]


class WrongCommandLines(ApplicationTest):
    def setUp(self):
        super().setUp()
        write_nifti(self.path("ball.nii"), ball(12, 4))
        write_nifti(self.path("flat.nii"), from_function(6, "h", lambda x, y, z: 7))
        write_nifti(self.path("nan.nii"), from_function(
            8, "f", lambda x, y, z: float("nan") if x < -3 and y < -3 and z < -3 else 3 - abs(x)))
        write_4d_nifti(self.path("4d.nii"), [ball(8, 3), ball(8, 3)])
        tetrahedron = ([(0, 0, 0), (9, 0, 0), (0, 9, 0), (0, 0, 9)],
                       [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
        write_off(self.path("a.off"), tetrahedron, "RAS mm")
        self.path("nan.off").write_text(self.path("a.off").read_text().replace("9 0 0", "nan 0 0")
                                        .replace("9.0 0 0", "nan 0 0"))
        self.path("folder").mkdir()
        self.path("folder.vtp").mkdir()

    def test_get_one_line_that_helps(self):
        self.assertGreaterEqual(len(WRONG), 100)
        before = self.contents()
        for code, pattern, program, arguments in WRONG:
            with self.subTest(" ".join((program, *arguments))):
                done = subprocess.run([BIN / program, *arguments], cwd=self.folder, text=True,
                                      capture_output=True, timeout=60)
                lines = done.stderr.splitlines()
                self.assertEqual(done.returncode, code, done.stderr)
                self.assertEqual(len(lines), 1, done.stderr)
                self.assertTrue(lines[0].startswith(program + ": "), lines[0])
                self.assertRegex(lines[0].removeprefix(program + ": "), "^(" + pattern + ")")
                self.assertNotRegex(lines[0], INSIDES)
                self.assertLess(len(lines[0]), 350, lines[0])
                if code == USAGE:
                    self.assertTrue(lines[0].endswith(f" (see {program} --help)"), lines[0])
                if program != CHECK:  # which prints its table for the other files
                    self.assertEqual(done.stdout, "")
                self.take_failure_report("r.json")
                self.assertEqual(self.contents(), before)


class Habits(ApplicationTest):
    """The rows of Habits.cxx: what each names, the program has for which it is given."""

    def setUp(self):
        super().setUp()
        text = (SOURCE / "Modules/Core/src/Habits.cxx").read_text()
        body = re.search(r"kHabits\[\] = \{\n(.*?)\n\};", text, re.S)[1]
        body = re.sub(r"//.*", "", body)
        body = re.sub(r'"\s*\n\s*"', "", body)  # a string on two lines
        self.rows = [[part.split() if n < 2 else part for n, part in enumerate(row)] for row in
                     re.findall(r'\{"([^"]*)",\s*"([^"]*)",\s*"([^"]*)",\s*"([^"]*)"\}', body)]
        self.assertEqual(len(self.rows), body.count("{"))
        self.options = {}
        for program in sorted(path.name for path in BIN.glob("adaptiso-*")):
            said = json.loads(subprocess.run([BIN / program, "--help-json"], capture_output=True,
                                             check=True).stdout)
            names = [name for option in said["options"] for name in option["names"]]
            self.options[program.removeprefix("adaptiso-")] = names

    def test_name_options_of_the_program(self):
        used = set()
        for program, names in self.options.items():
            given = set()  # words that a row above answers
            for n, (words, programs, option, answer) in enumerate(self.rows):
                with self.subTest((program, words[0])):
                    if programs:
                        self.assertLessEqual(set(programs), set(self.options))
                        if program in programs and option:
                            self.assertIn("--" + option, names)
                    if programs and program not in programs or option and "--" + option not in names:
                        continue
                    new = {word for word in words if word not in given
                           and not {"-" + word, "--" + word} & set(names)}
                    given |= set(words)
                    if not new:
                        continue
                    used.update((n, word) for word in new)
                    self.assertTrue(option or answer)
                    for name in re.findall(r"--[a-z][a-z-]*", answer):
                        self.assertIn(name, names, answer)
                    for other in re.findall(r"adaptiso-([a-z]+)", answer):
                        self.assertIn(other, self.options)
                        self.assertNotEqual(other, program)
        dead = [word for n, row in enumerate(self.rows) for word in row[0] if (n, word) not in used]
        self.assertEqual(dead, [])


class Help(ApplicationTest):
    def test_is_in_words(self):
        for program in (MESH, CHECK, COMPARE, BEM):
            with self.subTest(program):
                text = subprocess.run([BIN / program, "--help"], text=True, check=True,
                                      capture_output=True).stdout
                self.assertNotRegex(text, INSIDES)
                self.assertNotRegex(text, r" in \[|\{[a-z]+,|:NUMBER|:INT")
                for line in text.splitlines():
                    self.assertLessEqual(len(line), 100, line)

    def test_of_one_option(self):
        def printed(*command):
            return subprocess.run([BIN / command[0], *command[1:]], text=True, check=True, capture_output=True).stdout
        said = printed(MESH, "--help", "--ISO")
        self.assertRegex(said, r"^  --iso V\|auto .*The isovalue: (.|\n)* for several surfaces\n$")
        self.assertNotIn("--info", said)
        self.assertEqual(printed("adaptiso", "help", "mesh", "iso"), said)
        self.assertRegex(printed(MESH, "-h", "threshold"), r"^threshold: did you mean --iso\?\n$")
        self.assertRegex(printed("adaptiso", "help"), "(?m)^  mesh  .*surfaces of an image")
        done = subprocess.run([BIN / MESH, "--help", "frobnicate"], text=True, capture_output=True)
        self.assertEqual((done.returncode, done.stdout), (USAGE, ""))

    def test_short_names_every_group(self):
        for program in (MESH, CHECK, COMPARE, BEM, SIMPLIFY, "adaptiso-mend", "adaptiso-labels", "adaptiso-bids",
                        "adaptiso-giant"):
            with self.subTest(program):
                text = subprocess.run([BIN / program, "-h"], text=True, check=True, capture_output=True).stdout
                self.assertNotRegex(text, r"(?m)^:")


class Numbers(ApplicationTest):
    """Text has as many digits as a person reads; JSON has all."""

    def test_have_few_digits(self):
        write_nifti(self.path("f.nii"), from_function(
            12, "f", lambda x, y, z: 1 / (3 + x * x + y * y + z * z)))
        for arguments in (("--iso", "auto", "-o", "a.vtp"), ("--info",)):
            text = self.mesh("f.nii", *arguments).stdout
            for number in re.findall(r"\d+\.\d+", text.replace("f-iso", "")):
                if number in text.split(":")[0]:
                    continue  # a file's name has all, so that no two are one
                self.assertLessEqual(len(number.replace(".", "").lstrip("0")), 7, number)
        report = self.report("f.nii", "--iso", "auto", "-o", "b.vtp")
        self.assertGreater(len(str(report["surfaces"][0]["isovalue"])), 8)

    def test_of_huge_values_are_short(self):
        huge = from_function(8, "f", lambda x, y, z: 1e38 if abs(x) < 2 else -1e38)
        write_nifti(self.path("huge.nii"), huge)
        for arguments in (("--iso", "0", "-o", "a.vtp"), ("--info",)):
            self.assertNotRegex(self.mesh("huge.nii", *arguments).stdout, r"\d{17}")


if __name__ == "__main__":
    main()
