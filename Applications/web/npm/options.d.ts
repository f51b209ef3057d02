// Generated from the programs' rows of options: ADAPTISO_RENEW_PAGES=1 ctest -R OptionTablesTest. Do not edit.

export interface ImageRows {
  /** Which series of a DICOM input with several: its number in the list that --list-series prints, or its UID. */ series?: number | string;
  /** Which volume of a 4-D image (time points, echoes), counted from 0. */ volumeIndex?: number;
  /** Which resolution of an OME-Zarr or N5, 0 the finest (default: 0). */ level?: number;
  /** Which channel of an OME-Zarr or N5 with several, counted from 0. */ channel?: number;
  /** Which time point of an OME-Zarr or N5 with several, counted from 0. */ time?: number;
  /** Axes of an NRRD, OME-Zarr or N5 whose header does not name them. */ imageSpace?: "lps" | "ras";
  /** Refuse a Zarr in which chunks are missing; else the fill value stands for them, with a warning. */ refuseMissingChunks?: boolean;
  /** Blend unevenly spaced DICOM slices linearly onto even steps, in place of refusing them. */ resampleSlices?: boolean;
}

export interface BemRows extends ImageRows {
  /** Sulci of the brain's own surface narrower than twice this, and folds of white matter narrower than four times this, are closed (a number from 0 to 30, in mm; default: 3). */ sulciMm?: number;
  /** Standard deviation of the Gaussian that boundaries are smoothed with (a number from 0 to 10, in mm; default: 1.5). */ smoothingMm?: number;
  /** Gaps and canals narrower than twice this are closed (a number from 0 to 30, in mm; default: 10). */ closingMm?: number;
  /** Cut off what of the inner skull a ball of this radius can't enter and that reaches more than 10 mm, as leaks down a foramen do (a number from 0 to 20, in mm; default: 8; 0: cut nothing). */ cutNecksMm?: number;
  /** Side of the voxels that the head is worked on (a number from 0 to 5, in mm; default: the image's own if they are cubes of 0.7 to 1.5 mm, else 1). */ voxelMm?: number;
  /** T1: from the brain mask to the inner skull (a number from 0 to 20, in mm; default: 2). */ csfMm?: number;
  /** T1: thickness of the skull where the image does not show it (a number from 0 to 200, in mm; default: 6, below 18 years by --age: 2 of newborns, 4 at 5 years). */ skullMm?: number;
  /** Bone farther than this from the inner skull (face, neck) counts as scalp (a number from 0 to 200, in mm; default: 20). */ maxSkullMm?: number;
  /** Age, 0.5 for six months: T1s of infants and children need it; what is unusual is judged by it (a number from 0 to 120, in years; default: 18, adults). */ age?: number;
  /** CT: isovalue of bone (a finite number, in HU; default: 300). */ skullHu?: number;
  /** CT: isovalue of skin (a finite number, in HU; default: -300). */ skinHu?: number;
  /** Sources of each surface of the cortex, spread evenly (default: 4098). */ sourceCount?: number;
  /** Dipoles along x, y and z at the points of a grid instead of on a cortex, this far apart (a number from 1 to 50, in mm). */ sourceGridMm?: number;
}

export interface CheckRows {
  /** bem: a boundary of a head model (default with --nested); print: a solid (default); view: to look at. See below. */ profile?: "bem" | "print" | "view";
  /** With --nested: smallest gap between neighbours that passes, in any profile (a number, 0 or more, in mm; default: 0.5, in bem only). */ minGapMm?: number;
  /** Smallest angle of a triangle that passes, in any profile (a number from 0 to 60, in degrees; default: 1, in bem only). */ minAngleDeg?: number;
  /** Thinnest wall that passes, in any profile (a number above 0, in mm; default: with --profile print as given a warning below 0.8). */ minWallMm?: number;
  /** With --iso: largest distance from the isosurface that passes (a number, 0 or more, in mm; default: the mean within half a voxel). */ maxOffMm?: number;
  /** List up to so many pairs of triangles that cross in the report; all are counted (default: 1000). */ maxPairs?: number;
}

export interface LabelsRows extends ImageRows {
  /** Largest distance, both ways, of each wall to itself at full resolution; 0 keeps the full resolution (a number, 0 or more, in mm; default: 0.15 of the least distance between planes of voxels, unless a count is given). */ maxErrorMm?: number;
  /** Simplify to so many triangles in all walls together, as close to the full resolution as the method gets. */ triangles?: number;
  /** Share of the full resolution's triangles to drop (a number from 0 to 1). */ reduction?: number;
  /** Make no new angle below this, at the price of more triangles (a number from 0 to 40, in degrees; default: 0). */ minAngleDeg?: number;
  /** Multiply the file's coordinates by this, about the origin: the file then names no frame of the scan. auto: as small as --fit needs, never larger. */ scale?: number | string;
  /** Refuse a surface that, as it lies, is larger than this printer's bed, in mm. */ fit?: number | string;
}

export interface MendRows {
  /** Largest distance, both ways, between the given surface and the result, but for holes that are closed and parts that are dropped, in the unit of its coordinates (a number above 0, in mm; default: 0.2 % of the diagonal of the surface's box). */ maxErrorMm?: number;
  /** Refuse (exit code 1) holes wider than this (a number, 0 or more, in mm; default: 5 % of the diagonal). */ maxHoleMm?: number;
  /** Leave wider holes open instead. */ open?: boolean;
  /** Cut or fill every handle, by the smallest flat disc found, so that each piece is of genus 0. */ ball?: boolean;
  /** Keep the piece with the most material only (of an open surface: the largest area). */ largest?: boolean;
  /** Drop pieces with less material than this, and fill cavities with less (a number, 0 or more, in mm3). */ minVolumeMm3?: number;
  /** Drop inner surfaces, and all that lies inside them. */ fillCavities?: boolean;
  /** Multiply the file's coordinates by this, about the origin: the file then names no frame of the scan. auto: as small as --fit needs, never larger. */ scale?: number | string;
  /** Refuse a surface that, as it lies, is larger than this printer's bed, in mm. */ fit?: number | string;
}

export interface MeshRows extends ImageRows {
  /** First keep these voxels only: indices from 0, the end not included; a bound left out is the image's border: 10:90,:,20:. */ crop?: number | string;
  /** Then smooth with a Gaussian of this standard deviation, the same in every direction in space (a number above 0, in mm). */ smoothMm?: number;
  /** Then resample to cubic voxels with sides of this length (a number above 0, in mm). */ resampleMm?: number;
  /** How --resample finds values between voxels: linear, bspline (cubic), or nearest (for labels) (default: linear). */ interpolation?: "linear" | "bspline" | "nearest";
  /** adaptive: few triangles within a stated distance of the surface, none crossing another; boxes: cubes of several sizes, merged where the surface is flat; dmc: discretized marching cubes, coplanar facets between edge midpoints merged; asc: adaptive skeleton climbing, rectangular boxes, unmerged; mc: marching cubes, every voxel at full resolution (default: adaptive). */ method?: "adaptive" | "boxes" | "dmc" | "asc" | "mc";
  /** Method adaptive: largest distance, both ways, between the surface of marching cubes and the mesh (a number above 0, in mm; default: 0.15 of the least distance between planes of voxels, unless a count is given). */ maxErrorMm?: number;
  /** Method adaptive: simplify to so many triangles, of the pieces that are kept, as close to that surface as the method gets. */ triangles?: number;
  /** Method adaptive: share of the triangles of marching cubes to drop (a number from 0 to 1). */ reduction?: number;
  /** Make no new angle below this, at the price of more triangles (a number from 0 to 40, in degrees; default: 0). */ minAngleDeg?: number;
  /** Move the vertices of the method dmc from the midpoints to where the image reaches the isovalue. */ adjustVertices?: boolean;
  /** Merge facets of the method dmc within blocks of --block-size voxels only. */ mergeWithinBlocks?: boolean;
  /** Voxels a side of the index's blocks, and of the largest box of the methods boxes and asc (default: 4). */ blockSize?: 2 | 4 | 8 | 16;
  /** Where a surface meets the border of the image: closed there, or left open (default: closed). */ border?: "closed" | "open";
  /** How the blocks that a surface touches are found: kd-tree over their minima and maxima, octree, or a look at every block. The surface is the same (default: kdtree). */ search?: "kdtree" | "octree" | "linear";
  /** Keep the piece with the most material only (of an open surface: the largest area). */ largest?: boolean;
  /** Drop pieces with less material than this, and fill cavities with less (a number, 0 or more, in mm3). */ minVolumeMm3?: number;
  /** Drop inner surfaces, and all that lies inside them. */ fillCavities?: boolean;
  /** Multiply the file's coordinates by this, about the origin: the file then names no frame of the scan. auto: as small as --fit needs, never larger. */ scale?: number | string;
  /** Refuse a surface that, as it lies, is larger than this printer's bed, in mm. */ fit?: number | string;
}

export interface SimplifyRows {
  /** Largest distance, both ways, between the given surface and the result, in the unit of its coordinates (a number above 0, in mm). */ maxErrorMm?: number;
  /** Simplify to so many triangles, as close to the surface as the method gets. */ triangles?: number;
  /** Share of the triangles to drop (a number from 0 to 1). */ reduction?: number;
  /** Make no new angle below this, at the price of more triangles (a number from 0 to 40, in degrees; default: 0). */ minAngleDeg?: number;
  /** Leave the points of open borders where they are, to the bit. */ keepBorders?: boolean;
  /** Join points with equal coordinates first: programs that store a normal or a colour for each corner (Blender, glTF) part the surface there. */ weld?: boolean;
  /** Multiply the file's coordinates by this, about the origin: the file then names no frame of the scan. auto: as small as --fit needs, never larger. */ scale?: number | string;
  /** Refuse a surface that, as it lies, is larger than this printer's bed, in mm. */ fit?: number | string;
}
