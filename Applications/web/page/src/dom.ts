/** Small helpers over the document. */
export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (found === null) throw new Error(`no #${id}`);
  return found as T;
}

export function make<K extends keyof HTMLElementTagNameMap>(name: K, properties: Partial<HTMLElementTagNameMap[K]> = {},
    ...children: (Node | string)[]): HTMLElementTagNameMap[K] {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
}

/** Shows the names of what was given, each with a button that takes it back. */
export function showGiven(place: HTMLElement, names: string[], remove: (n: number) => void): void {
  place.replaceChildren(...names.map((name, n) => {
    const button = make("button", { type: "button", className: "remove" }, "×");
    button.setAttribute("aria-label", `Remove ${name}`);
    button.addEventListener("click", () => remove(n));
    return make("span", { className: "given" }, name, button);
  }));
}

/** A spot of a colour beside its name. */
export function swatch(color: number[]): HTMLElement {
  const spot = make("span", { className: "swatch" });
  spot.style.background = `rgb(${color.join(" ")})`;
  return spot;
}

/** Until View.showSurfaces() replaces it: a mesh of a million triangles takes seconds. */
export function showDrawing(): void { byId("caption").textContent = "drawing ..."; }

export const formatCount = (count: number): string => count.toLocaleString("en-US");
export const formatBytes = (bytes: number): string =>
  bytes >= 1e9 ? `${(bytes / 1e9).toFixed(1)} GB` : bytes >= 1e6 ? `${(bytes / 1e6).toFixed(1)} MB` : `${Math.ceil(bytes / 1e3)} kB`;

export function save(name: string, data: Blob | Uint8Array): void {
  const blob = data instanceof Blob ? data : new Blob([data as Uint8Array<ArrayBuffer>]);
  const link = make("a", { href: URL.createObjectURL(blob), download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

export async function sha256(bytes: Uint8Array): Promise<string> {
  const digest = new Uint8Array(await crypto.subtle.digest("SHA-256", bytes as Uint8Array<ArrayBuffer>));
  return [...digest].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}

/** An argument as a POSIX shell takes it. */
export const quoted = (text: string): string =>
  /^[A-Za-z0-9_@%+=:,./-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`;

export async function copy(text: string, button: HTMLButtonElement): Promise<void> {
  const label = button.textContent;
  try {
    await navigator.clipboard.writeText(text);
    button.textContent = "Copied";
  } catch {
    button.textContent = "Select the line and copy it";  // a file:// page may not
  }
  setTimeout(() => { button.textContent = label; }, 1500);
}
