/** The page. Everything heavy is kept packed in the file and unpacked when it is first wanted. */
import { byId } from "./dom";
import { takeStrayFiles } from "./drop";
import { Engine } from "./engine";
import { HeadTab } from "./head";
import { LabelsTab } from "./labels";
import { MeshTab } from "./mesh";
import { unpackBytes, unpackText } from "./packed";
import { Scan } from "./scan";
import { CheckTab, CompareTab, MendTab, SimplifyTab } from "./surfaces";
import { kVersion, type Page } from "./task";
import { View } from "./view";

function makeEngine(): Engine {
  const url = unpackText("worker").then((code) => URL.createObjectURL(new Blob([code], { type: "text/javascript" })));
  return new Engine(url, unpackBytes("wasm").then((bytes) => WebAssembly.compile(bytes)));
}

async function makeView(): Promise<View | undefined> {
  try {
    document.body.dataset.stage = "true";
    document.head.append(Object.assign(document.createElement("script"), { textContent: await unpackText("niivue") }));
    const library = (globalThis as unknown as { niivue: typeof import("@niivue/niivue") }).niivue;
    return await View.make(library, byId<HTMLCanvasElement>("gl"), byId("position"), byId("caption"));
  } catch (error) {
    byId("viewer-missing").textContent = (error as Error).message;
    byId("viewer-missing").hidden = false;
    return undefined;
  }
}

/** Tabs as the ARIA practices have them: arrows move, Home and End jump. */
function listenToTabs(): void {
  const tabs = [...document.querySelectorAll<HTMLButtonElement>("[role=tab]")];
  const choose = (chosen: HTMLButtonElement): void => {
    for (const tab of tabs) {
      tab.setAttribute("aria-selected", String(tab === chosen));
      tab.tabIndex = tab === chosen ? 0 : -1;
      byId(tab.getAttribute("aria-controls") ?? "").hidden = tab !== chosen;
    }
  };
  for (const [n, tab] of tabs.entries()) {
    tab.addEventListener("click", () => choose(tab));
    tab.addEventListener("keydown", (event) => {
      const next = { ArrowRight: n + 1, ArrowLeft: n - 1, Home: 0, End: tabs.length - 1 }[event.key];
      if (next === undefined) return;
      event.preventDefault();
      const chosen = tabs[(next + tabs.length) % tabs.length];
      choose(chosen);
      chosen.focus();
    });
  }
}

/** Disables the field of the way that is not chosen. Closes an explanation that loses the focus, or by Escape. */
function listenToFields(): void {
  const showWays = (): void => {
    for (const way of document.querySelectorAll<HTMLInputElement>(".field [type=radio]")) {
      for (const input of way.closest(".field")?.querySelectorAll("input") ?? []) input.disabled = input !== way && !way.checked;
    }
  };
  document.addEventListener("change", showWays);
  showWays();
  const close = (event: Event): void => (event.target as Element).closest?.("details.why")?.removeAttribute("open");
  document.addEventListener("focusout", close);
  document.addEventListener("keydown", (event) => { if (event.key === "Escape") close(event); });
}

function start(): void {
  const engine = makeEngine();
  let view: Promise<View | undefined> | undefined;
  byId("only-3d").addEventListener("click", async () => {
    const isAlone = byId("only-3d").getAttribute("aria-pressed") !== "true";
    byId("only-3d").setAttribute("aria-pressed", String(isAlone));
    (await view)?.show3dAlone(isAlone);
  });
  const page: Page = { engine, view: () => (view ??= makeView()) };
  const scan = new Scan(page);
  new MeshTab(page, scan);
  new HeadTab(page, scan);
  new LabelsTab(page, scan);
  new CheckTab(page);
  new MendTab(page);
  new SimplifyTab(page);
  new CompareTab(page);
  listenToTabs();
  listenToFields();
  byId("version").textContent = kVersion;
  takeStrayFiles();
  document.body.dataset.ready = "true";
}

start();
