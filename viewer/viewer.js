// The 3D view of a report and of the local app: parts of one model in the poses of several builds.
//
// tol3dView(figure, model, told) shows a GLB (ArrayBuffer) and the builds told of it (tol3d.report.html.view_model) in
// an element, and returns a View. Controls named build, factor, fit, names and part within the element act on it if they
// are there, and an output named times and an element of class state tell what is shown. `ready` is a promise of the
// first picture. It throws where there is no WebGL. The page of a report starts by itself, from the data in it.
import {
  AmbientLight, Box3, DirectionalLight, Matrix4, Mesh, MeshStandardMaterial, OrthographicCamera, Raycaster, Scene, Sphere,
  Vector2, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import { toCreasedNormals } from "three/examples/jsm/utils/BufferGeometryUtils.js";

const CREASE = 0.6; // rad; edges between faces that lean less are shown round
const MARGIN = 1.1; // of the picture, around the model
const LINE = 15; // pixels between words of two names
const STILL = 4; // pixels that a pointer may move in a click
const GREY = "#b4bac0";
const FROM = new Vector3(0.9, 0.75, 1.1);

function bytes(base64) {
  return Uint8Array.from(atob(base64), (sign) => sign.charCodeAt(0));
}

async function unpacked(base64) {
  const stream = new Blob([bytes(base64)]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

class View {
  #picked = () => {};
  #lit = null; // names of parts and features, or all
  #shown = { build: 0, state: 0 };
  #geometries = [];
  #asked = 0; // models

  constructor(figure, renderer) {
    this.figure = figure;
    this.renderer = renderer;
    this.told = { up: [0, 1, 0], parts: [], builds: [] };
    this.parts = [];
    this.scene = new Scene();
    this.scene.add(new AmbientLight(0xffffff, 1.5));
    this.camera = new OrthographicCamera();
    const sun = new DirectionalLight(0xffffff, 2.1);
    sun.position.set(0.3, 0.5, 1);
    this.camera.add(sun, sun.target);
    this.scene.add(this.camera);
    this.names = document.createElement("div");
    this.names.className = "names";
    renderer.domElement.after(this.names);
    this.#bind();
  }

  // Show another model with its builds, from where the camera is; a promise of when it is drawn.
  async replace(model, told) {
    this.#asked += 1;
    const asked = this.#asked;
    const { scene } = await new GLTFLoader().parseAsync(model, "");
    if (asked !== this.#asked) return; // another model was asked for since
    const first = this.parts.length === 0;
    const name = this.told.builds[this.#shown.build]?.name;
    this.scene.remove(...this.parts);
    this.#geometries.forEach((own) => own.dispose());
    this.parts.forEach((part) => Object.values(part.userData.materials).forEach((own) => own.dispose()));
    this.told = told;
    this.#geometries = creased(scene);
    this.parts = told.parts.map((part) => this.#part(part));
    this.scene.add(...this.parts);
    const known = told.builds.findIndex((own) => own.name === name);
    this.#shown = { build: Math.max(known, 0), state: known < 0 ? 0 : this.#shown.state };
    if (first) {
      this.figure.classList.add("live");
      this.camera.up.fromArray(told.up);
      this.controls = new OrbitControls(this.camera, this.renderer.domElement);
      this.controls.addEventListener("change", () => this.draw());
      new ResizeObserver(() => this.resize()).observe(this.renderer.domElement.parentElement);
    }
    this.figure.querySelectorAll('[name="part"]').forEach((box) => this.#choose(box));
    this.pose();
    if (first) this.fit();
    else this.resize();
  }

  // Show a build by its name or its place, its deviations so many times as large, or as near to that as there is.
  show(build, factor = 1) {
    const { builds } = this.told;
    const place = typeof build === "number" ? build : builds.findIndex((own) => own.name === build);
    if (!builds[place]) return;
    const off = builds[place].states.map((own) => Math.abs(Math.log(own.factor / factor)));
    this.#shown = { build: place, state: off.indexOf(Math.min(...off)) };
    this.pose();
  }

  // Leave parts and features of these names in their colours, all others grey; null: all in colours.
  light(names) {
    this.#lit = names && new Set(names);
    this.pose();
  }

  // Call back at a click that is no drag with the names of the part and the feature there, null where there is none.
  onpick(callback) {
    this.#picked = callback;
  }

  #part(part) {
    const clear = part.opacity < 1;
    const own = new MeshStandardMaterial({
      color: part.colour, roughness: 0.55, metalness: 0, transparent: clear, opacity: part.opacity, depthWrite: !clear,
    });
    const grey = own.clone();
    grey.color.set(GREY);
    const feature = own.clone();
    feature.setValues({ transparent: false, opacity: 1, depthWrite: true });
    const mesh = new Mesh(undefined, own);
    mesh.matrixAutoUpdate = false;
    mesh.userData = { ...part, materials: { own, grey, feature } };
    return mesh;
  }

  // Materials of a part: one, or grey and that of its features that are in colour.
  #paint(mesh) {
    const { materials, part, features } = mesh.userData;
    const lit = this.#lit && !this.#lit.has(part) ? features.filter(([name]) => this.#lit.has(name)) : [];
    mesh.geometry.clearGroups();
    if (!lit.length) {
      mesh.material = this.#lit && !this.#lit.has(part) ? materials.grey : materials.own;
      return;
    }
    mesh.material = [materials.grey, materials.feature];
    let next = 0;
    for (const [, first, count] of lit) {
      mesh.geometry.addGroup(3 * next, 3 * (first - next), 0);
      mesh.geometry.addGroup(3 * first, 3 * count, 1);
      next = first + count;
    }
    mesh.geometry.addGroup(3 * next, Infinity, 0);
  }

  #choose(box) {
    if (this.parts[Number(box.value)]) this.parts[Number(box.value)].visible = box.checked;
  }

  #bind() {
    const acts = {
      build: (own) => { this.#shown.build = Number(own.value); },
      factor: (own) => { this.#shown.state = Number(own.value); },
      part: (own) => this.#choose(own),
      names: (own) => { this.names.hidden = !own.checked; },
    };
    for (const kind of ["input", "change"]) {
      this.figure.addEventListener(kind, ({ target }) => {
        if (!Object.hasOwn(acts, target.name)) return;
        acts[target.name](target);
        this.pose();
      }, { capture: true });
    }
    this.figure.addEventListener("click", ({ target }) => {
      if (target.name === "fit") this.fit();
    });
    const canvas = this.renderer.domElement;
    canvas.addEventListener("dblclick", () => this.fit());
    let from = null;
    canvas.addEventListener("pointerdown", (event) => { from = event; });
    canvas.addEventListener("pointerup", (event) => {
      const still = from && Math.hypot(event.clientX - from.clientX, event.clientY - from.clientY) < STILL;
      from = null;
      if (still && event.button === 0) this.#picked(...this.#at(event));
    });
  }

  // Names of the part and the feature under a pointer.
  #at(event) {
    const box = this.renderer.domElement.getBoundingClientRect();
    const place = new Vector2((event.clientX - box.x) / box.width, (box.y - event.clientY) / box.height);
    const ray = new Raycaster();
    ray.setFromCamera(place.multiplyScalar(2).add(new Vector2(-1, 1)), this.camera);
    const [hit] = ray.intersectObjects(this.parts.filter((part) => part.visible));
    if (!hit) return [null, null];
    const { part, features } = hit.object.userData;
    const feature = features.find(([, first, count]) => hit.faceIndex >= first && hit.faceIndex < first + count);
    return [part, feature ? feature[0] : null];
  }

  pose() {
    const { states } = this.told.builds[this.#shown.build] ?? { states: [] };
    if (!states.length) return;
    const place = Math.min(this.#shown.state, states.length - 1);
    const state = states[place];
    this.#shown.state = place;
    this.parts.forEach((part, index) => {
      part.geometry = this.#geometries[state.meshes[index]];
      part.matrix.copy(new Matrix4().fromArray(state.poses[index]));
      part.updateMatrixWorld(true);
      this.#paint(part);
    });
    this.#tell(states, place);
    this.names.replaceChildren(...Object.entries(state.names).map(([name, place]) => {
      const label = document.createElement("span");
      label.append(document.createElement("b"));
      label.firstChild.textContent = name;
      label.place = new Vector3().fromArray(place);
      return label;
    }));
    this.draw();
  }

  // Controls and words of the state that is shown.
  #tell(states, place) {
    const of = (selector) => this.figure.querySelector(selector);
    const [build, factor, number, words] = ['[name="build"]', '[name="factor"]', '[name="times"]', ".state"].map(of);
    if (build) build.value = this.#shown.build;
    if (factor) {
      factor.max = states.length - 1;
      factor.value = place;
      factor.disabled = states.length < 2;
      factor.setAttribute("aria-valuetext", `${states[place].factor} times`);
    }
    if (number) number.value = states[place].factor;
    if (words) words.textContent = states[place].words;
  }

  fit() {
    const box = new Box3();
    this.parts.filter((part) => part.visible).forEach((part) => box.expandByObject(part));
    if (box.isEmpty()) this.parts.forEach((part) => box.expandByObject(part));
    const sphere = box.getBoundingSphere(new Sphere());
    this.reach = Math.max(sphere.radius, 1e-6);
    const up = this.camera.up.clone().normalize();
    const side = new Vector3(1, 0, 0).projectOnPlane(up);
    if (side.lengthSq() < 1e-6) side.set(0, 0, 1).projectOnPlane(up);
    side.normalize();
    const ahead = new Vector3().crossVectors(side, up);
    const from = side.multiplyScalar(FROM.x).addScaledVector(up, FROM.y).addScaledVector(ahead, FROM.z).normalize();
    const centre = box.getCenter(new Vector3());
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(from, 4 * this.reach);
    this.camera.near = 0.01 * this.reach;
    this.camera.far = 20 * this.reach;
    this.camera.zoom = 1;
    this.controls.update();
    this.camera.updateMatrixWorld(true);
    this.half = this.#half(box);
    this.resize();
    this.draw();
  }

  // Half of the width and of the height of a box, as the camera sees it.
  #half(box) {
    const found = [1e-6, 1e-6];
    const centre = box.getCenter(new Vector3()).applyMatrix4(this.camera.matrixWorldInverse);
    for (let corner = 0; corner < 8; corner += 1) {
      const [x, y, z] = [0, 1, 2].map((axis) => (corner >> axis) & 1 ? box.max : box.min);
      const seen = new Vector3(x.x, y.y, z.z).applyMatrix4(this.camera.matrixWorldInverse).sub(centre);
      found[0] = Math.max(found[0], Math.abs(seen.x));
      found[1] = Math.max(found[1], Math.abs(seen.y));
    }
    return found;
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.renderer.domElement.parentElement;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    const scale = MARGIN * Math.max(this.half[0] / width, this.half[1] / height);
    const [across, upward] = [scale * width, scale * height];
    Object.assign(this.camera, { left: -across, right: across, top: upward, bottom: -upward });
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  draw() {
    this.renderer.render(this.scene, this.camera);
    const { clientWidth: width, clientHeight: height } = this.names;
    const placed = [...this.names.children].map((label) => {
      const seen = label.place.clone().project(this.camera);
      return { label, x: ((seen.x + 1) / 2) * width, y: ((1 - seen.y) / 2) * height };
    });
    placed.sort((one, other) => one.y - other.y);
    let free = -LINE; // words below each other; their dots stay
    for (const { label, x, y } of placed) {
      label.hidden = x < 0 || y < 0 || x > width || y > height;
      if (label.hidden) continue;
      const line = Math.max(y, free);
      free = line + LINE;
      label.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
      label.firstChild.style.top = `${(line - y).toFixed(1)}px`;
    }
  }
}

// Geometries by the number in their name, with normals that show round faces round.
function creased(model) {
  const found = [];
  model.traverse((own) => {
    if (own.isMesh) found[Number(/^mesh-(\d+)$/.exec(own.name || own.parent.name)[1])] = toCreasedNormals(own.geometry, CREASE);
  });
  return found;
}

function tol3dView(figure, model, told) {
  let canvas = figure.querySelector("canvas");
  if (!canvas) {
    const stage = document.createElement("div");
    stage.className = "stage";
    canvas = document.createElement("canvas");
    stage.append(canvas);
    figure.prepend(stage);
  }
  const renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
  renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
  const view = new View(figure, renderer);
  view.ready = view.replace(model, told).then(() => {
    figure.dataset.ready = "yes";
    performance.mark("seen");
  });
  return view;
}

window.tol3dView = tol3dView;

async function show(figure, told, model) {
  const view = tol3dView(figure, await unpacked(model.textContent.trim()), JSON.parse(told.textContent));
  await view.ready;
  figure.view = view;
}

const [told, model] = ["view-data", "view-model"].map((own) => document.getElementById(own));
if (told && model) {
  for (const figure of document.querySelectorAll("figure.view")) {
    show(figure, told, model).catch(() => {}); // without WebGL the still picture stays
  }
}
