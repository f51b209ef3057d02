"use strict";
// The interactive part of a report, by niivue. What it needs is in the page: #data (JSON), #volume
// (NIfTI, gzip, base64) and #surface-<n> (MZ3, gzip, base64). Points are RAS mm throughout.
(function () {
  const byId = (id) => document.getElementById(id);
  const data = JSON.parse(byId("data").textContent);
  const AXIAL = 0, CORONAL = 1, SAGITTAL = 2;
  // of a slice: the axis across it, the one to the right, the one up
  const AXES = { [AXIAL]: [2, 0, 1], [CORONAL]: [1, 0, 2], [SAGITTAL]: [0, 1, 2] };

  // Both sides are lit; what is seen from its inside is red (of a region, dark: where they are cut
  // that is nearly all there is to see); what lies beyond the plane is cut away.
  const INSIDE = data.areRegions ? "0.55 * vClr.rgb" : "vec3(0.84, 0.27, 0.25)";
  const SHADER = `#version 300 es
precision highp int;
precision highp float;
uniform float opacity;
uniform vec4 cutPlane;
in vec4 vClr;
in vec3 vN;
in vec4 vP;
out vec4 color;
void main() {
  if (dot(vP.xyz, cutPlane.xyz) > cutPlane.w) discard;
  // through a transparent surface its own far side would be seen
  if (!gl_FrontFacing && opacity < 0.99) discard;
  vec3 n = normalize(vN);
  vec3 base = gl_FrontFacing ? vClr.rgb : ${INSIDE};
  float light = 0.3 + 0.7 * abs(dot(n, normalize(vec3(-0.35, 0.45, -0.9))));
  color = vec4(base * light, opacity);
}`;

  const fail = (message) => {
    byId("viewer-missing").textContent = message;
    byId("viewer-missing").hidden = false;
    document.querySelector(".stage").hidden = true;
    byId("viewer").after(...document.querySelectorAll("figure.stands-in"));
    for (const spot of document.querySelectorAll("button[data-spot]")) spot.replaceWith(...spot.childNodes);
    for (const hint of document.querySelectorAll(".spots-hint")) hint.remove();
    document.body.dataset.viewer = "missing";
  };

  const bytesOf = (id) => {
    const binary = atob(byId(id).textContent.trim());
    const bytes = new Uint8Array(binary.length);
    for (let n = 0; n < binary.length; ++n) bytes[n] = binary.charCodeAt(n);
    return bytes.buffer;
  };

  /** Where a mesh meets the plane: pairs of points, flat [x, y, z, x, y, z, ...]. */
  const cutMesh = (mesh, { normal, at }) => {
    const { pts, tris } = mesh, found = [], heights = new Float64Array(pts.length / 3);
    for (let n = 0; n < heights.length; ++n) {
      heights[n] = normal[0] * pts[3 * n] + normal[1] * pts[3 * n + 1] + normal[2] * pts[3 * n + 2];
    }
    for (let t = 0; t < tris.length; t += 3) {
      for (let side = 0; side < 3; ++side) {
        const from = tris[t + side], to = tris[t + (side + 1) % 3], a = 3 * from, b = 3 * to;
        if ((heights[from] >= at) === (heights[to] >= at)) continue;
        const part = (at - heights[from]) / (heights[to] - heights[from]);
        for (let k = 0; k < 3; ++k) found.push(pts[a + k] + part * (pts[b + k] - pts[a + k]));
      }
    }
    return found;
  };

  class Viewer {
    constructor(nv) {
      this.nv = nv;
      this.surfaces = [];  // { mesh, color, isShown, cuts: [per axis { at, points }] }
      this.cutAxis = -1;
      this.cutSide = 1;
      this.showsSolid = false;
    }

    async load() {
      const nv = this.nv;
      nv.addVolume(await niivue.NVImage.loadFromBase64({
        base64: byId("volume").textContent.trim(), name: "image.nii.gz", colormap: "gray",
        cal_min: 0, cal_max: 255 }));
      const shader = nv.setCustomMeshShader(SHADER, "Report");
      this.program = nv.meshShaders[shader].shader.program;
      for (const [n, surface] of data.surfaces.entries()) {
        const rgba = new Uint8Array([...surface.color, 255]);
        const mesh = await niivue.NVMesh.readMesh(
          bytesOf(`surface-${n}`), "surface.mz3", nv.gl, surface.opacity, rgba, true);
        mesh.meshShaderIndex = shader;
        nv.meshes.push(mesh);  // addMesh() would load the image anew for each of hundreds
        this.surfaces.push({ mesh, color: surface.color, isShown: true, cuts: [] });
      }
      nv.updateGLVolume();
      this.hook();
    }

    /** niivue draws; this adds the cut, leaves the image out of 3-D, and draws the outlines. */
    hook() {
      const nv = this.nv, gl = nv.gl;
      const drawMesh = nv.drawMesh3D.bind(nv), drawImage = nv.drawImage3D.bind(nv);
      const drawScene = nv.drawScene.bind(nv);
      nv.drawMesh3D = (...given) => {
        gl.useProgram(this.program);
        gl.uniform4fv(gl.getUniformLocation(this.program, "cutPlane"), this.cutPlane());
        // niivue leaves out what faces away; here it is to be seen
        const enable = gl.enable;
        gl.enable = (what) => what === gl.CULL_FACE ? gl.disable(what) : enable.call(gl, what);
        try {
          return drawMesh(...given);
        } finally {
          gl.enable = enable;
        }
      };
      nv.drawImage3D = (...given) => this.showsSolid && drawImage(...given);
      nv.drawScene = (...given) => {
        const result = drawScene(...given);
        this.drawOutlines();
        this.tellPosition();
        return result;
      };
    }

    crosshair() {
      return Array.from(this.nv.frac2mm(this.nv.scene.crosshairPos)).slice(0, 3);
    }

    moveTo(point) {
      this.nv.scene.crosshairPos = this.nv.mm2frac(point);
      this.nv.drawScene();
    }

    cutPlane() {
      if (this.cutAxis < 0) return [0, 0, 0, 1];
      const plane = [0, 0, 0, this.cutSide * this.crosshair()[this.cutAxis]];
      plane[this.cutAxis] = this.cutSide;
      return plane;
    }

    /** The plane of voxels that niivue shows: oblique where the image is. */
    slicePlane(axis) {
      const share = (point) => this.nv.mm2frac(point)[axis];
      const zero = share([0, 0, 0]);
      // 100 mm: the shares are floats
      const normal = [[100, 0, 0], [0, 100, 0], [0, 0, 100]].map((end) => (share(end) - zero) / 100);
      return { normal, at: this.nv.scene.crosshairPos[axis] - zero };
    }

    /** The cut of one surface by one slice, kept as long as the slice stays. */
    cutOf(surface, axis, plane) {
      if (surface.cuts[axis]?.at !== plane.at) {
        surface.cuts[axis] = { at: plane.at, points: cutMesh(surface.mesh, plane) };
      }
      return surface.cuts[axis].points;
    }

    drawOutlines() {
      const shown = byId("gl"), layer = byId("outlines");
      if (layer.width !== shown.width || layer.height !== shown.height) {
        layer.width = shown.width;
        layer.height = shown.height;
      }
      const context = layer.getContext("2d");
      context.clearRect(0, 0, layer.width, layer.height);
      const pixel = shown.width / shown.clientWidth;
      for (const tile of this.nv.screenSlices) {
        if (!(tile.axCorSag in AXES) || !(tile.fovMM?.length > 1)) continue;
        const [left, top, width, height] = tile.leftTopWidthHeight;
        const [axis, across, up] = AXES[tile.axCorSag];
        const plane = this.slicePlane(axis);
        const toX = (mm) => left + width * (mm - tile.leftTopMM[0]) / tile.fovMM[0];
        const toY = (mm) => top + height * (1 - (mm - tile.leftTopMM[1]) / tile.fovMM[1]);
        context.save();
        context.beginPath();
        context.rect(left, top, width, height);
        context.clip();
        const outlines = this.surfaces.filter((surface) => surface.isShown).map((surface) => {
          const points = this.cutOf(surface, axis, plane), path = new Path2D();
          for (let n = 0; n + 5 < points.length; n += 6) {
            path.moveTo(toX(points[n + across]), toY(points[n + up]));
            path.lineTo(toX(points[n + 3 + across]), toY(points[n + 3 + up]));
          }
          return { path, color: `rgb(${surface.color.join(" ")})` };
        });
        // on bright tissue a line is seen by its dark rim; all rims lie under all lines
        context.lineCap = "round";
        context.strokeStyle = "black";
        context.lineWidth = 3.5 * pixel;
        for (const { path } of outlines) context.stroke(path);
        context.lineWidth = 1.5 * pixel;
        for (const { path, color } of outlines) {
          context.strokeStyle = color;
          context.stroke(path);
        }
        context.restore();
      }
    }

    tellPosition() {
      const text = this.crosshair().map((v) => v.toFixed(1)).join(", ") + " mm";
      if (byId("position").textContent !== text) byId("position").textContent = text;
    }
  }

  const makeSurfaceControls = (viewer) => {
    for (const [n, surface] of data.surfaces.entries()) {
      const box = document.createElement("div");
      box.className = "surface";
      const label = document.createElement("label");
      const shown = Object.assign(document.createElement("input"), { type: "checkbox", checked: true });
      const swatch = Object.assign(document.createElement("span"), { className: "swatch" });
      swatch.style.background = `rgb(${surface.color.join(" ")})`;
      label.append(shown, " ", swatch, " ", surface.name);
      const opacity = Object.assign(document.createElement("input"),
        { type: "range", min: 0, max: 100, value: 100 * surface.opacity });
      opacity.setAttribute("aria-label", `Opacity of ${surface.name}`);
      shown.addEventListener("change", () => {
        viewer.surfaces[n].isShown = shown.checked;
        viewer.nv.setMeshProperty(viewer.surfaces[n].mesh.id, "visible", shown.checked);
      });
      opacity.addEventListener("input", () =>
        viewer.nv.setMeshProperty(viewer.surfaces[n].mesh.id, "opacity", opacity.value / 100));
      box.append(label, opacity);
      byId("surfaces").append(box);
    }
  };

  /** Regions are many: a list to search. A click on a name shows that region alone and goes there, a
   * click with Ctrl or Cmd besides the others; the boxes show and hide. */
  const makeRegionControls = (viewer) => {
    const list = byId("surfaces"), rows = [];
    list.className = "regions";
    byId("region-tools").hidden = false;
    byId("surfaces-title").textContent = "Regions";
    byId("inside-hint").textContent = "A click on a region's name shows it alone and goes there; "
      + "with Ctrl it is added to what is shown.";
    const tell = () => {
      const shown = viewer.surfaces.filter((surface) => surface.isShown).length;
      byId("region-count").textContent = `${shown} of ${rows.length} shown`;
      viewer.nv.drawScene();
    };
    const show = (n, isShown) => {
      viewer.surfaces[n].isShown = isShown;
      viewer.surfaces[n].mesh.visible = isShown;
      rows[n].box.checked = isShown;
    };
    for (const [n, surface] of data.surfaces.entries()) {
      const row = document.createElement("div");
      row.className = "region";
      const box = Object.assign(document.createElement("input"), { type: "checkbox", checked: true });
      box.setAttribute("aria-label", `Show ${surface.name}`);
      const swatch = Object.assign(document.createElement("span"), { className: "swatch" });
      swatch.style.background = `rgb(${surface.color.join(" ")})`;
      const button = Object.assign(document.createElement("button"),
        { type: "button", textContent: surface.name });
      row.append(box, swatch, button);
      list.append(row);
      rows.push({ row, box, button, text: surface.name.toLowerCase() });
      box.addEventListener("change", () => { show(n, box.checked); tell(); });
      button.addEventListener("click", (event) => {
        for (const [m, other] of rows.entries()) {
          if (!event.ctrlKey && !event.metaKey) show(m, m === n);
          other.button.removeAttribute("aria-current");
        }
        show(n, true);
        button.setAttribute("aria-current", "true");
        viewer.moveTo(surface.point);
        tell();
      });
    }
    for (const [id, isShown] of [["show-all", true], ["show-none", false]]) {
      byId(id).addEventListener("click", () => {
        for (const n of rows.keys()) show(n, isShown);
        tell();
      });
    }
    byId("find").addEventListener("input", () => {
      const wanted = byId("find").value.toLowerCase();
      for (const { row, text } of rows) row.hidden = !text.includes(wanted);
    });
    tell();
  };

  const listen = (viewer) => {
    const spots = document.querySelectorAll("button[data-spot]");
    for (const button of spots) {
      button.addEventListener("click", () => {
        for (const other of spots) other.removeAttribute("aria-current");
        button.setAttribute("aria-current", "true");
        viewer.moveTo(data.spots[button.dataset.spot]);
        byId("viewer").scrollIntoView({ block: "nearest" });
      });
    }
    byId("cut").addEventListener("change", (event) => {
      const [axis, side] = event.target.value;
      viewer.cutAxis = axis === undefined ? -1 : Number(axis);
      viewer.cutSide = side === "-" ? -1 : 1;
      viewer.nv.drawScene();
    });
    byId("solid-label").hidden = !data.hasImage;
    byId("solid").addEventListener("change", (event) => {
      viewer.showsSolid = event.target.checked;
      viewer.nv.drawScene();
    });
    for (const button of document.querySelectorAll("button[data-turn]")) {
      button.addEventListener("click", () =>
        viewer.nv.setRenderAzimuthElevation(...button.dataset.turn.split(" ").map(Number)));
    }
    const steps = { ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowUp: [0, 1, 0],
      ArrowDown: [0, -1, 0], PageUp: [0, 0, 1], PageDown: [0, 0, -1] };
    byId("gl").addEventListener("keydown", (event) => {
      const step = steps[event.key];
      if (!step) return;
      event.preventDefault();
      event.stopImmediatePropagation();
      const far = event.shiftKey ? 10 : 1;
      viewer.moveTo(viewer.crosshair().map((v, axis) => v + far * step[axis]));
    }, true);
  };

  const start = async () => {
    if (!document.createElement("canvas").getContext("webgl2")) {
      fail("The viewer needs WebGL 2, which this browser does not have or has turned off. "
        + "The picture shows the same surfaces.");
      return;
    }
    const nv = new niivue.Niivue({
      logLevel: "error", dragAndDropEnabled: false, isSliceMM: true, meshThicknessOn2D: 0,
      multiplanarShowRender: niivue.SHOW_RENDER.ALWAYS,
      multiplanarLayout: niivue.MULTIPLANAR_TYPE.GRID, multiplanarPadPixels: 4,
      isOrientCube: false, show3Dcrosshair: true, crosshairWidth: 0.35, crosshairWidthUnit: "percent",
      crosshairColor: [1, 0.28, 0.28, 0.8], crosshairGap: 3, backColor: [0, 0, 0, 1],
      fontColor: [0.75, 0.78, 0.82, 1], dragMode: niivue.DRAG_MODE.pan });
    await nv.attachToCanvas(byId("gl"), true);
    const viewer = new Viewer(nv);
    await viewer.load();
    nv.setSliceType(niivue.SLICE_TYPE.MULTIPLANAR);
    nv.setRenderAzimuthElevation(145, 12);
    (data.areRegions ? makeRegionControls : makeSurfaceControls)(viewer);
    listen(viewer);
    viewer.moveTo(data.start);
    window.adaptisoViewer = viewer;
    document.body.dataset.viewer = "ready";
  };

  start().catch((error) => fail("The viewer could not be started: " + error.message));
})();
