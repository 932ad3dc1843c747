// The 3D view of a report: parts of one model in the poses of several builds.
import {
  AmbientLight, Box3, DirectionalLight, Matrix4, Mesh, MeshStandardMaterial, OrthographicCamera, Scene, Sphere, Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import { toCreasedNormals } from "three/examples/jsm/utils/BufferGeometryUtils.js";

const CREASE = 0.6; // rad; edges between faces that lean less are shown round
const MARGIN = 1.1; // of the picture, around the model
const LINE = 15; // pixels between words of two names
const FROM = new Vector3(0.9, 0.75, 1.1);

function bytes(base64) {
  return Uint8Array.from(atob(base64), (sign) => sign.charCodeAt(0));
}

async function unpacked(base64) {
  const stream = new Blob([bytes(base64)]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

class View {
  constructor(figure, told, renderer, model) {
    this.figure = figure;
    this.told = told;
    this.renderer = renderer;
    this.scene = new Scene();
    this.geometries = this.#geometries(model);
    this.parts = told.parts.map((part) => this.#part(part));
    this.scene.add(...this.parts, new AmbientLight(0xffffff, 1.5));
    this.camera = new OrthographicCamera();
    this.camera.up.fromArray(told.up);
    const sun = new DirectionalLight(0xffffff, 2.1);
    sun.position.set(0.3, 0.5, 1);
    this.camera.add(sun, sun.target);
    this.scene.add(this.camera);
    this.controls = new OrbitControls(this.camera, renderer.domElement);
    this.controls.addEventListener("change", () => this.draw());
    this.names = document.createElement("div");
    this.names.className = "names";
    renderer.domElement.after(this.names);
    this.#bind();
    this.pose();
    this.fit();
    new ResizeObserver(() => this.resize()).observe(renderer.domElement.parentElement);
    this.resize();
  }

  #geometries(model) {
    const found = [];
    model.traverse((own) => {
      const number = /^mesh-(\d+)$/.exec(own.isMesh ? own.parent.name.length ? own.name || own.parent.name : own.name : "");
      if (own.isMesh) found[Number(number[1])] = toCreasedNormals(own.geometry, CREASE);
    });
    return found;
  }

  #part(part) {
    const clear = part.opacity < 1;
    const mesh = new Mesh(this.geometries[0], new MeshStandardMaterial({
      color: part.colour, roughness: 0.55, metalness: 0, transparent: clear, opacity: part.opacity, depthWrite: !clear,
    }));
    mesh.matrixAutoUpdate = false;
    return mesh;
  }

  #bind() {
    const find = (name) => this.figure.querySelector(`[name="${name}"]`);
    this.build = find("build");
    this.factor = find("factor");
    this.build.addEventListener("change", () => this.pose());
    this.factor.addEventListener("input", () => this.pose());
    this.number = this.figure.querySelector("output[data-factors]");
    find("fit").addEventListener("click", () => this.fit());
    find("names").addEventListener("change", (event) => {
      this.names.hidden = !event.target.checked;
    });
    for (const box of this.figure.querySelectorAll('[name="part"]')) {
      box.addEventListener("change", () => {
        this.parts[Number(box.value)].visible = box.checked;
        this.draw();
      });
    }
    this.renderer.domElement.addEventListener("dblclick", () => this.fit());
  }

  pose() {
    const states = this.told.builds[Number(this.build.value)].states;
    this.factor.max = states.length - 1;
    this.factor.disabled = states.length < 2;
    const state = states[Math.min(Number(this.factor.value), states.length - 1)];
    this.parts.forEach((part, index) => {
      part.geometry = this.geometries[state.meshes[index]];
      part.matrix.copy(new Matrix4().fromArray(state.poses[index]));
      part.updateMatrixWorld(true);
    });
    this.number.value = this.number.dataset.factors.split(" ")[states.indexOf(state)];
    this.factor.setAttribute("aria-valuetext", `${this.number.value} times`);
    this.figure.querySelector(".state").textContent = state.words;
    this.names.replaceChildren(...Object.entries(state.names).map(([name, place]) => {
      const label = document.createElement("span");
      label.append(document.createElement("b"));
      label.firstChild.textContent = name;
      label.place = new Vector3().fromArray(place);
      return label;
    }));
    this.draw();
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

async function show(figure) {
  const told = JSON.parse(document.getElementById("view-data").textContent);
  const canvas = figure.querySelector("canvas");
  const renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
  renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
  const packed = await unpacked(document.getElementById("view-model").textContent.trim());
  new GLTFLoader().parse(packed, "", (found) => {
    figure.classList.add("live");
    figure.view = new View(figure, told, renderer, found.scene);
    figure.dataset.ready = "yes";
    performance.mark("seen");
  }, () => {});
}

for (const figure of document.querySelectorAll("figure.view")) {
  show(figure).catch(() => {}); // without WebGL the still picture stays
}
