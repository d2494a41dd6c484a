// SPDX-License-Identifier: LGPL-2.1-or-later
// Run by the webgui when a scene begins, after `const added = {patches, legend}`.
// A patch is a filled surface of triangles: {name, color, opacity, flat, behind, position}.
const three = modules.THREE;

function patchObject(patch) {
  const bytes = Uint8Array.from(atob(patch.position), (c) => c.charCodeAt(0));
  const points = new Float32Array(bytes.buffer);
  const geometry = new three.BufferGeometry();
  geometry.setAttribute("position", new three.BufferAttribute(points, 3));
  geometry.computeVertexNormals();
  const look = {
    color: patch.color,
    opacity: patch.opacity,
    transparent: patch.opacity < 1,
    depthWrite: patch.opacity === 1,
    depthTest: !patch.flat,
    side: three.DoubleSide,
  };
  const Material = patch.flat ? three.MeshBasicMaterial : three.MeshMatcapMaterial;
  const mesh = new three.Mesh(geometry, new Material(look));
  mesh.matrixWorldAutoUpdate = false;
  mesh.frustumCulled = false;
  return {
    name: patch.name,
    // The webgui draws "update" first: what is behind never covers the coloured faces.
    render_modes: [patch.behind ? "update" : "default"],
    render(data) {
      if (!data.gui_status.Objects[patch.name]) return;
      mesh.matrixWorld.copy(data.controls.mat);
      data.renderer.render(mesh, data.camera);
    },
    updateRenderData() {},
    onResize() {},
    cleanupHTML() {},
  };
}

function legendObject(entries) {
  const box = document.createElement("div");
  box.style = "position: absolute; left: 20px; top: 52px; z-index: 1; user-select: none";
  Object.assign(box.style, { padding: "2px 6px", color: "black", background: "#ffffffc0" });
  for (const [word, color] of entries) {
    const line = box.appendChild(document.createElement("div"));
    const spot = line.appendChild(document.createElement("span"));
    spot.style = "display: inline-block; width: 0.8em; height: 0.8em; margin-right: 0.5em";
    spot.style.background = color;
    line.appendChild(document.createTextNode(word));
  }
  scene.container.appendChild(box);
  return {
    name: "Legend",
    render_modes: ["overlay"],
    render(data) {
      box.style.display = data.gui_status.Objects.Legend ? "block" : "none";
    },
    updateRenderData() {},
    onResize() {},
    cleanupHTML() {
      box.remove();
    },
  };
}

added.patches.forEach((patch) => scene.addRenderObject(patchObject(patch)));
if (added.legend.length > 0) scene.addRenderObject(legendObject(added.legend));
