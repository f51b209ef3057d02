/** Files as people give them: dropped, chosen, or a folder. */
import type { InputFile } from "./protocol";

async function filesOfEntry(entry: FileSystemEntry, path: string): Promise<InputFile[]> {
  if (entry.isFile) {
    const file = await new Promise<File>((resolve, reject) => (entry as FileSystemFileEntry).file(resolve, reject));
    return [{ path: path + file.name, data: file }];
  }
  const reader = (entry as FileSystemDirectoryEntry).createReader(), files: InputFile[] = [];
  for (;;) {  // a hundred at a time
    const some = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
    if (some.length === 0) return files;
    for (const each of some) files.push(...await filesOfEntry(each, `${path}${entry.name}/`));
  }
}

export async function filesOf(data: DataTransfer): Promise<InputFile[]> {
  const entries = [...data.items].map((item) => item.webkitGetAsEntry?.() ?? null);
  if (entries.some((entry) => entry !== null)) {
    const found = await Promise.all(entries.map((entry) => entry === null ? [] : filesOfEntry(entry, "")));
    return found.flat();
  }
  return [...data.files].map((file) => ({ path: file.name, data: file }));
}

const takers = new Map<Element, (files: InputFile[]) => void>();

/** Gives files dropped beside the zones to the first visible zone; the browser would open them in place of the page. */
export function takeStrayFiles(): void {
  takeFiles(document.body, (files) => {
    const zone = document.querySelector("[role=tabpanel]:not([hidden]) .drop");
    if (zone !== null && files.length > 0) takers.get(zone)?.(files);
  });
}

/** Programs take names that begin with a dash for options. */
const named = (files: InputFile[]): InputFile[] => files.map(({ path, data }) => ({ path: path.startsWith("-") ? `./${path}` : path, data }));

/** Calls `take` with what is dropped on `zone` or chosen with one of its inputs. */
export function takeFiles(zone: HTMLElement, take: (files: InputFile[]) => void): void {
  takers.set(zone, take);
  zone.addEventListener("dragover", (event) => { event.preventDefault(); zone.classList.add("over"); });
  zone.addEventListener("dragleave", () => zone.classList.remove("over"));
  zone.addEventListener("drop", async (event) => {
    event.preventDefault();
    event.stopPropagation();
    for (const each of takers.keys()) each.classList.remove("over");
    if (event.dataTransfer !== null) take(named(await filesOf(event.dataTransfer)));
  });
  if (zone === document.body) return;
  for (const input of zone.querySelectorAll<HTMLInputElement>("input[type=file]")) {
    input.addEventListener("change", () => {
      const files = [...input.files ?? []].map((file) => ({ path: file.webkitRelativePath || file.name, data: file }));
      if (files.length > 0) take(named(files));
      input.value = "";
    });
  }
}

/** The folders of slices and of masks that were chosen as files. */
export const kSlices = "slices";
export const kMasks = "masks";

/** Files that are an image by themselves, or the header of one. */
const imagesOf = (files: InputFile[]): InputFile[] =>
  files.filter((file) => /\.(nii|nii\.gz|nrrd|nhdr|mha|mhd|mgh|mgz|hdr)$/i.test(file.path));

const into = (folder: string, files: InputFile[]): { files: InputFile[]; path: string } =>
  ({ files: files.map(({ path, data }) => ({ path: `${folder}/${path}`, data })), path: folder });

/** The input of a program that reads `files`: the one image, or the folder that holds them. Slices chosen as files are put
 * into a folder; so are images for a label map, as its masks. \throws Error  they are several images, of no label map */
export function asInput(files: InputFile[], isLabels: boolean): { files: InputFile[]; path: string } {
  const first = files[0].path.split("/")[0], images = imagesOf(files);
  if (first !== "." && files.every((file) => file.path.startsWith(`${first}/`))) return { files, path: first };
  if (files.length === 1) return { files, path: files[0].path };
  if (images.length > 1) {
    if (isLabels && files.every(({ path }) => /^(\.\/)?[^/]+$/.test(path))) return into(kMasks, files);
    throw new Error(`${images.map(({ path }) => path).join(" and ")} are ${images.length} scans: give one here`
      + " (a mask has its own place, under Head model)");
  }
  if (images.length === 1) return { files, path: images[0].path };
  return into(kSlices, files);
}

/** A name for what is made of it. Braces stand for parts of a name to the programs. */
export const stemOf = (path: string): string =>
  path.split("/").at(-1)?.replace(/\.gz$/i, "").replace(/\.[^.]*$/, "").replace(/^-+/, "").replaceAll(/[{}]/g, "_") || "surface";
