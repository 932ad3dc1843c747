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
const TRIES = [0, 1, -1, 2, -2, 3, -3]; // lines by which words move to where there is room
const BESIDE = [2, -2, 3, -3, 4, -4]; // those of a measure's number, which leaves its line free
const NEAR = 12; // pixels from a place within which a pointer is over it
const DOT = 6; // and within which a click is on its dot
const SIGNS = {
  "⌖": "M8 1v14M1 8h14M8 3.5a4.5 4.5 0 1 0 .01 0z", "⌭": "M8 4.5a3.5 3.5 0 1 0 .01 0zM1.5 14l4-12M10.5 14l4-12",
  "⌓": "M2 11a6 6 0 0 1 12 0z", "⌒": "M2 11a6 6 0 0 1 12 0", "⌯": "M4 5h8M1 8h14M4 11h8", "⏤": "M1 8h14",
  "⌰": "M2 13h7M2 13l5-10M9 13l5-10M4.4 5l2.6-2 .3 3.3M11.4 5l2.6-2 .3 3.3",
};
const DRAWN = /([⌖⌭⌓⌒⌯⏤⌰Ⓐ-Ⓩ])/u;
const MOST_LINES = 4; // of a flag; all, and the names of tolerances, where a pointer is over its place
const HEAD = 9; // pixels, of an arrow
const ON = 0.02; // of the size of the model: how far off a feature a click may be
const SVG = "http://www.w3.org/2000/svg";
const DIGITS = 3; // of a factor that a build allows
const STILL = 4; // pixels that a pointer may move in a click
const FRAME = 60, REST = 1200; // ms, of a frame of a motion, and of one in which measures are read
const ERRORS = ":errors"; // in the place of a measure: errors of places, as pictures have them
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
  #acting = null; // names of tolerances, or all
  #shown = { build: 0, state: 0 };
  #geometries = [];
  #asked = 0; // models
  #flags = []; // of tolerances and datums
  #first = new Set(); // names whose words are placed before those of others
  #measure = "";
  #labels = [];
  #lines = []; // of the measure
  #over = null; // the label under the pointer
  #hides = {}; // kinds of labels
  #moment = 0; // frame of a motion
  #ahead = 1;
  #playing = 0; // the request of its next frame
  #moves = new WeakMap(); // numbers of motions

  constructor(figure, renderer) {
    this.figure = figure;
    this.renderer = renderer;
    this.told = { up: [0, 1, 0], parts: [], builds: [], features: {} };
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
    this.lines = document.createElementNS(SVG, "svg");
    this.lines.setAttribute("class", "measured");
    renderer.domElement.after(this.names, this.lines);
    this.#bind();
  }

  // Show another model with its builds, from where the camera is; a promise of when it is drawn. Where told.first is
  // not 0 the model has only meshes from that number on, or is null: the others stay.
  async replace(model, told) {
    this.#asked += 1;
    const asked = this.#asked, kept = told.first || 0;
    const scene = model?.byteLength ? (await new GLTFLoader().parseAsync(model, "")).scene : null;
    if (asked !== this.#asked) return; // another model was asked for since
    const other = this.told.world !== told.world;
    const name = this.told.builds[this.#shown.build]?.name;
    if (!kept) this.#geometries.splice(0).forEach((own) => own.dispose());
    if (scene) Object.assign(this.#geometries, creased(scene));
    if (JSON.stringify(told.parts) !== JSON.stringify(this.told.parts)) {
      this.#clear();
      this.parts = told.parts.map((part) => this.#part(part));
      this.scene.add(...this.parts);
    }
    this.told = told;
    const known = told.builds.findIndex((own) => own.name === name);
    this.#shown = { build: Math.max(known, 0), state: known < 0 ? 0 : this.#shown.state };
    this.figure.querySelectorAll('[name="part"]').forEach((box) => this.#choose(box));
    this.figure.classList.add("live");
    this.renderer.domElement.parentElement.hidden = false;
    if (other) this.#turned(told.up);
    this.pose();
    if (other) {
      this.fit();
      this.pose();
    } else this.resize();
  }

  // Show nothing, until there is another model.
  clear() {
    this.#asked += 1;
    this.#clear();
    this.told = { up: [0, 1, 0], parts: [], builds: [], features: {} };
    this.#labels = this.#lines = [];
    this.names.replaceChildren();
    this.lines.replaceChildren();
    this.figure.classList.remove("live");
    this.renderer.domElement.parentElement.hidden = true;
  }

  // Flags of tolerances and datums: each with the names of parts and features that it is of, its own name and words.
  flags(every) {
    this.#flags = every;
    this.pose();
  }

  // Draw where a measure is read, by its name; "": of none.
  measure(name) {
    this.#measure = name;
    this.pose();
  }

  // Place words of these parts, features and tolerances before those of others where there is no room for all.
  prefer(names) {
    this.#first = new Set(names);
    this.pose();
  }

  #clear() {
    this.scene.remove(...this.parts);
    this.parts.forEach((part) => Object.values(part.userData.materials).forEach((own) => own.dispose()));
    this.parts = [];
  }

  // Another direction up: the camera turns about it.
  #turned(up) {
    this.camera.up.fromArray(up);
    if (this.controls) this.controls.dispose();
    else new ResizeObserver(() => this.resize()).observe(this.renderer.domElement.parentElement);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener("change", () => this.draw());
  }

  // Show a build by its name or its place, its deviations so many times as large if it allows that, else less.
  show(build, factor = 1) {
    const { builds } = this.told;
    const place = typeof build === "number" ? build : builds.findIndex((own) => own.name === build);
    if (!builds[place]) return;
    const off = builds[place].states.map((own) => Math.abs(Math.log(own.asked / factor)));
    this.#shown = { build: place, state: off.indexOf(Math.min(...off)) };
    this.pose();
  }

  // Leave parts and features of these names in their colours, all others grey; null: all in colours. Where tolerances are
  // named too, flags of others and of datums on other parts are grey.
  light(names, tolerances = null) {
    this.#lit = names && new Set(names);
    this.#acting = names && tolerances && new Set(tolerances);
    this.pose();
  }

  // True of a flag that is grey.
  #isIdle(flag) {
    if (!this.#acting) return false;
    if (flag.name) return !this.#acting.has(flag.name);
    return !flag.of.some((name) => this.#lit.has(name) || this.#lit.has(this.told.features[name]?.part));
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
    const isLit = (name) => [...this.#lit].some((own) => is(name, own));
    const whole = !this.#lit || isLit(part);
    const lit = whole ? [] : features.filter(([name]) => isLit(name));
    mesh.geometry.clearGroups();
    if (!lit.length) {
      mesh.material = whole ? materials.own : materials.grey;
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
      names: (own) => { this.#hides.name = !own.checked; },
      flags: (own) => { this.#hides.flag = !own.checked; },
      measured: (own) => this.#read_measure(own.value),
      moment: (own) => {
        this.pause();
        this.#moment = Number(own.value);
      },
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
      if (target.name === "play") this.#playing ? this.pause() : this.play();
    });
    const canvas = this.renderer.domElement;
    canvas.addEventListener("dblclick", () => this.fit());
    canvas.addEventListener("pointermove", (event) => this.#look(event));
    canvas.addEventListener("pointerleave", () => this.#look(null));
    let from = null;
    canvas.addEventListener("pointerdown", (event) => { from = event; });
    canvas.addEventListener("pointerup", (event) => {
      const still = from && Math.hypot(event.clientX - from.clientX, event.clientY - from.clientY) < STILL;
      from = null;
      if (still && event.button === 0) this.#picked(...(this.#dot(event) ?? this.#at(event)));
    });
  }

  // Names of the part and the feature whose dot is under a pointer; null where there is none.
  #dot(event) {
    const { features } = this.told, seen = new Set(this.parts.filter((own) => own.visible).map((own) => own.userData.part));
    const isDot = (label) => !label.element.classList.contains("covered") && seen.has(features[label.feature]?.part);
    const own = this.#nearestLabel(event, DOT, isDot);
    return own && [features[own.feature].part, own.feature];
  }

  // Names of the part and the feature under a pointer: through what is clear, to what is opaque or lies within it.
  #at(event) {
    const box = this.renderer.domElement.getBoundingClientRect();
    const place = new Vector2((event.clientX - box.x) / box.width, (box.y - event.clientY) / box.height);
    const ray = new Raycaster();
    ray.setFromCamera(place.multiplyScalar(2).add(new Vector2(-1, 1)), this.camera);
    const hits = ray.intersectObjects(this.parts.filter((part) => part.visible));
    if (!hits.length) return [null, null];
    const isClear = (own) => own.object.userData.opacity < 1 && !marked(own);
    const hit = hits.reduce((kept, own) => (isClear(kept) && (!isClear(own) || within(own.object, kept.object)) ? own : kept));
    return [hit.object.userData.part, marked(hit) ?? this.#nearest(hit)];
  }

  // The feature on whose face a part is hit, where it lies undeviated: of those that are as near the smallest.
  #nearest(hit) {
    const index = this.parts.indexOf(hit.object), here = hit.object.matrix.clone();
    const nominal = new Matrix4().fromArray(this.told.builds[0].states[0].poses[index]);
    const place = hit.point.clone().applyMatrix4(nominal.multiply(here.invert()));
    const near = Object.entries(this.told.features ?? {}).filter(([, own]) => own.part === hit.object.userData.part).map(([name, own]) => {
      const local = place.clone().applyMatrix4(new Matrix4().fromArray(own.frame).invert());
      const reach = new Vector3().fromArray(own.reach);
      return { name, off: local.distanceTo(local.clone().clamp(reach.clone().negate(), reach)), size: reach.length() };
    }).filter((own) => own.off < ON * this.reach);
    near.sort((one, other) => one.size - other.size);
    return near.length ? near[0].name : null;
  }

  #state() {
    return this.told.builds[this.#shown.build].states[this.#shown.state];
  }

  pose() {
    const { states } = this.told.builds[this.#shown.build] ?? { states: [] };
    if (!states.length) return;
    const place = Math.min(this.#shown.state, states.length - 1);
    const state = states[place];
    this.#shown.state = place;
    this.parts.forEach((part, index) => {
      part.geometry = this.#geometries[state.meshes[index]];
      part.matrix.copy(new Matrix4().fromArray(state.poses[index])).premultiply(this.#move(state, index, this.#frame(state)));
      part.updateMatrixWorld(true);
      this.#paint(part);
    });
    this.#tell(states, place);
    this.#label(state);
    this.draw();
  }

  // Names of places, flags and the measure's number, as labels; and the lines of the measure.
  #label(state) {
    const found = [], flags = this.#hides.flag ? new Map() : this.#placed(state);
    const named = this.#hides.name ? [] : Object.entries(state.names);
    for (const [name, place] of named) {
      const feature = Object.hasOwn(state.features ?? {}, name) ? name : name.slice(0, Math.max(name.lastIndexOf(", "), 0));
      if (!flags.has(feature)) found.push({ kind: "name", lines: [name], of: [name, feature], place: this.#carried(state, feature, place), feature });
    }
    for (const { name, place, own } of flags.values()) {
      const datum = own.some((flag) => !flag.name), isIdle = (flag) => this.#isIdle(flag);
      const named = own.filter((flag) => flag.name).sort((one, other) => isIdle(one) - isIdle(other));
      const lines = [datum ? `${name} ◣` : name, ...named.map((flag) => flag.words)];
      const full = [datum ? `${name}, datum` : name, ...named.map((flag) => `${flag.name}: ${flag.words}`)];
      const idle = named.filter(isIdle).length; // the last of them
      found.push({ kind: own.every(isIdle) ? "flag idle" : "flag", lines, full, idle, of: own.flatMap((flag) => [flag.name, ...flag.of]), place, feature: name });
    }
    const { measured, errors } = this.#read(state), read = this.#measure === ERRORS ? errors : [this.#measure];
    this.#lines = read.flatMap((name) => (measured[name] ?? []).map(([points, error]) => {
      const [start, ...others] = points.map((point) => new Vector3().fromArray(point)), times = error ? state.enlarged : 1;
      return { name, points: [start, ...others.map((own) => own.sub(start).multiplyScalar(times).add(start))], error };
    }));
    for (const name of read) if (measured[name]?.length) found.unshift(this.#number(state, name));
    this.#labels = found.map((own) => {
      const element = document.createElement("span"), words = document.createElement("b");
      element.className = own.kind;
      element.place = own.place;
      element.append(words);
      fill(words, own.lines, own.idle);
      return { ...own, element, words };
    });
    this.#over = null;
    this.names.replaceChildren(...this.#labels.map((own) => own.element));
    for (const own of this.#labels) own.size = [own.words.offsetWidth, own.words.offsetHeight];
    this.lines.replaceChildren(...this.#lines.flatMap((line) => {
      line.path = document.createElementNS(SVG, "path");
      line.path.setAttribute("class", line.error ? "error" : "");
      line.aside = document.createElementNS(SVG, "path");
      line.aside.setAttribute("class", "aside");
      return [line.aside, line.path];
    }));
  }

  // Name and value of a measure, at the middle of what is measured; of an error the factor of its arrow, and of a
  // component the whole of it too.
  #number(state, name) {
    const value = state.values?.[name], { points, error } = this.#lines.find((own) => own.name === name);
    const words = [value ? `${name} ${value}` : name];
    const plain = this.told.builds[this.#shown.build].states.find((own) => own.factor === 1);
    if (error && points.length > 2 && plain) {
      const [start, end] = [0, -1].map((k) => new Vector3().fromArray(this.#read(plain).measured[name][0][0].at(k)));
      words.push(`${length(start.distanceTo(end))} off its nominal place`);
    }
    const drawn = error && points[0].distanceTo(points[1]) > ON * (this.reach ?? 0);
    if (drawn) words.push(`arrow × ${Number((state.factor * state.enlarged).toPrecision(DIGITS))}`);
    return { kind: "number", lines: words, of: [], place: points[0].clone().add(points[1] ?? points[0]).multiplyScalar(0.5) };
  }

  // Flags by the feature or part at which they stand, with their place.
  #placed(state) {
    const found = new Map();
    for (const flag of this.#flags) {
      const places = flag.of.map((name) => this.#where(state, name)).filter((own) => own);
      if (!places.length) continue;
      const name = flag.of.join(", ");
      const place = places.reduce((sum, own) => sum.add(own.place), new Vector3()).divideScalar(places.length);
      const key = places.length === 1 ? places[0].name : name;
      if (!found.has(key)) found.set(key, { name: key, place, own: [] });
      found.get(key).own.push(flag);
    }
    return found;
  }

  // The place of a feature, the first of a pattern, or the middle of a part that is seen; null where there is none.
  #where(state, name) {
    const places = state.features ?? {};
    const feature = Object.hasOwn(places, name) ? name : Object.keys(places).find((own) => is(own, name));
    if (feature) return { name: feature, place: this.#carried(state, feature, places[feature]) };
    const part = this.parts.find((own) => own.visible && [own.userData.part, own.userData.name].includes(name))
      ?? this.parts.find((own) => own.visible && is(own.userData.part, name));
    if (!part) return null;
    part.geometry.computeBoundingBox();
    const box = part.geometry.boundingBox;
    return { name, place: box.getCenter(new Vector3()).applyMatrix4(part.matrix) };
  }

  // motions: a state's parts go through poses ------------------------------------------------------

  // The frame that is shown of a state's motion; 0 of one that stands still.
  #frame({ motion }) {
    return motion ? Math.min(this.#moment, motion.captions.length - 1) : 0;
  }

  // The motion of a part in a frame, from where it stands in the state.
  #move({ motion }, part, frame) {
    const found = new Matrix4(), place = motion ? motion.moved.indexOf(part) : -1;
    if (place < 0) return found;
    if (!this.#moves.has(motion)) this.#moves.set(motion, new Float64Array(bytes(motion.frames).buffer));
    const first = 12 * (frame * motion.moved.length + place);
    return found.set(...this.#moves.get(motion).subarray(first, first + 12), 0, 0, 0, 1);
  }

  // The place of a feature, carried along with its part.
  #carried(state, feature, place) {
    const part = this.parts.findIndex((own) => own.userData.part === this.told.features[feature]?.part);
    return new Vector3().fromArray(place).applyMatrix4(this.#move(state, part, this.#frame(state)));
  }

  // The pose of a motion in which measures are read, if it is shown.
  #stop({ motion }, frame) {
    return motion && Object.values(motion.stops).find((own) => own.frames.includes(frame));
  }

  // Lines of measures where parts stand, and names of the errors that pictures have; none on the way.
  #read(state) {
    const nothing = { measured: {}, errors: [] };
    return (state.motion ? this.#stop(state, this.#frame(state)) : { ...nothing, ...state }) ?? nothing;
  }

  // A measure that is read in another pose is shown there.
  #read_measure(name) {
    this.#measure = name;
    const state = this.#state();
    if (!state.motion || Object.hasOwn(this.#read(state).measured, name)) return;
    const there = Object.values(state.motion.stops).find((own) => Object.hasOwn(own.measured, name));
    if (!there) return;
    this.pause();
    [this.#moment] = there.frames;
  }

  // Go on with the motion, to its end and back, or to its end and from its beginning again.
  play() {
    this.pause();
    let until = performance.now();
    const next = (now) => {
      const state = this.#state();
      if (!state?.motion) return this.pause();
      this.#playing = requestAnimationFrame(next);
      if (now < until) return null;
      this.#advance(state.motion);
      until = now + (this.#stop(state, this.#moment) ? REST : FRAME);
      return this.pose();
    };
    this.#playing = requestAnimationFrame(next);
    this.pose();
  }

  pause() {
    cancelAnimationFrame(this.#playing);
    this.#playing = 0;
    const button = this.figure.querySelector('[name="play"]');
    if (button) button.textContent = "play";
  }

  #advance({ captions, back }) {
    const last = captions.length - 1;
    if (!back) this.#ahead = 1;
    else if (this.#moment >= last) this.#ahead = -1;
    else if (this.#moment <= 0) this.#ahead = 1;
    this.#moment = this.#moment + this.#ahead > last ? 0 : this.#moment + this.#ahead;
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
      factor.dataset.asked = states[place].asked;
      factor.setAttribute("aria-valuetext", `${times(states[place])} times`);
    }
    if (number) number.value = times(states[place]);
    if (words) words.textContent = states[place].words;
    const { motion } = states[place], moving = of(".moving");
    if (!moving) return;
    const [play, moment, caption, swing] = ['[name="play"]', '[name="moment"]', ".caption", ".swing"].map(of);
    moving.hidden = !motion && !this.told.travels?.length; // a page may ask for it
    moment.disabled = !motion;
    play.textContent = this.#playing ? "pause" : "play";
    if (!motion) [caption, swing].forEach((own) => own.replaceChildren());
    if (!motion) return;
    const frame = this.#frame(states[place]);
    moment.max = motion.captions.length - 1;
    moment.value = frame;
    moment.setAttribute("aria-valuetext", motion.captions[frame]);
    caption.textContent = motion.captions[frame];
    swing.textContent = motion.words;
  }

  fit() {
    const box = new Box3();
    this.parts.filter((part) => part.visible).forEach((part) => box.expandByObject(part));
    if (box.isEmpty()) this.parts.forEach((part) => box.expandByObject(part));
    const boxes = this.#boxes();
    boxes.forEach((own) => box.union(own));
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
    this.half = this.#half(boxes.length ? boxes : [box], centre);
    this.resize();
    this.draw();
  }

  // Boxes about each part that is seen, in every pose of their motion; none of parts that stand still.
  #boxes() {
    const state = this.#state(), frames = state.motion?.captions.length ?? 0;
    return this.parts.flatMap((part, index) => (part.visible ? Array.from({ length: frames }, (_, frame) => (
      part.geometry.boundingBox.clone().applyMatrix4(new Matrix4().fromArray(state.poses[index]).premultiply(this.#move(state, index, frame)))
    )) : []));
  }

  // Half of the width and of the height of boxes about a place, as the camera sees them.
  #half(boxes, place) {
    const found = [1e-6, 1e-6], centre = place.clone().applyMatrix4(this.camera.matrixWorldInverse);
    for (const box of boxes) for (let corner = 0; corner < 8; corner += 1) {
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
    const seen = (place) => {
      const own = place.clone().project(this.camera);
      return [((own.x + 1) / 2) * width, ((1 - own.y) / 2) * height];
    };
    for (const line of this.#lines) {
      line.seen = line.points.map(seen);
      this.#draw(line, line.seen);
    }
    this.#labels.forEach((own) => { [own.x, own.y] = seen(own.place); });
    this.#arrange(width, height);
  }

  // The first stretch of a line is what is measured, the others lead to the place; an error has a head.
  #draw({ points, error, path, aside }, seen) {
    const way = (own) => own.map(([x, y], k) => `${k ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`).join("");
    const measured = seen.slice(0, 2), [[x, y], [u, v]] = [seen[0], seen[1] ?? seen[0]];
    const long = Math.hypot(u - x, v - y);
    let head = "";
    if (points.length < 2 || long < HEAD) head = `M${x - HEAD} ${y}h${2 * HEAD}M${x} ${y - HEAD}v${2 * HEAD}`; // a place
    else if (error) {
      const [ahead, side] = [[(u - x) / long, (v - y) / long], [(y - v) / long, (u - x) / long]];
      const back = Math.min(HEAD, long);
      const corner = (sign) => `${u - back * ahead[0] + sign * 0.4 * back * side[0]} ${v - back * ahead[1] + sign * 0.4 * back * side[1]}`;
      head = `M${corner(1)}L${u} ${v}L${corner(-1)}`;
    }
    path.setAttribute("d", way(measured) + head);
    aside.setAttribute("d", way(seen.slice(1)));
  }

  // Words where they cover none that count more; others are hidden until a pointer is over their place.
  #arrange(width, height) {
    const weight = (own) => own === this.#over ? 0 : own.kind === "number" ? 1 : own.kind === "flag idle" ? 5
      : own.of.some((name) => this.#first.has(name)) ? 2 : own.kind === "name" ? 3 : 4;
    const taken = this.#lines.flatMap((line) => line.seen.slice(0, 2).map(([x, y]) => [x - HEAD, y - HEAD, 2 * HEAD, 2 * HEAD]));
    const ends = taken.length;
    for (const own of [...this.#labels].sort((one, other) => weight(one) - weight(other))) {
      const { element, words, x, y, size: [wide, high] } = own;
      element.hidden = x < 0 || y < 0 || x > width || y > height;
      if (element.hidden) continue;
      const left = Math.max(Math.min(x + 8, width - wide - 2), 0) - x;
      const boxes = (own.kind === "number" ? BESIDE : TRIES).map((lines) => [x + left, y - LINE / 2 + lines * LINE, wide, high]).filter((box) => box[1] >= 0 && box[1] + high <= height);
      const box = boxes.find((one) => !taken.some((other) => covers(one, other)))
        ?? (own === this.#over ? [x + left, Math.max(y - LINE / 2, 0), wide, high] : null);
      element.classList.toggle("crowded", !box);
      element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
      if (!box) continue;
      taken.push(box);
      words.style.left = `${left.toFixed(1)}px`;
      words.style.top = `${(box[1] - y).toFixed(1)}px`;
    }
    for (const { element, x, y } of this.#labels) {
      element.classList.toggle("covered", taken.slice(ends).some((box) => covers([x, y, 0, 0], box)));
    }
  }

  // The label whose place is nearest to a pointer, of some, within so many pixels; null where there is none.
  #nearestLabel(event, most, isOne) {
    const box = this.renderer.domElement.getBoundingClientRect();
    const off = (own) => Math.hypot(own.x - event.clientX + box.x, own.y - event.clientY + box.y);
    const near = this.#labels.filter((own) => !own.element.hidden && isOne(own) && off(own) < most);
    return near.sort((one, other) => off(one) - off(other))[0] ?? null;
  }

  // The label whose place is under the pointer shows all of its words.
  #look(event) {
    let over = null;
    if (event && !event.buttons) over = this.#nearestLabel(event, NEAR, () => true);
    if (over === this.#over) return;
    const before = this.#over;
    this.#over = over;
    if (before) fill(before.words, before.lines, before.idle);
    if (over) fill(over.words, over.full ?? over.lines, over.idle, Infinity);
    for (const own of [before, over].filter((one) => one)) own.size = [own.words.offsetWidth, own.words.offsetHeight];
    const { clientWidth: width, clientHeight: height } = this.names;
    this.#arrange(width, height);
  }
}

function covers([x, y, wide, high], [u, v, broad, tall]) {
  return x < u + broad && u < x + wide && y < v + tall && v < y + high;
}

// True of a name itself, and of one of several that a scene states once: "bore 2" of "bore", "P1 of planet 2" of "P1".
function is(name, stated) {
  return name === stated || (name.startsWith(`${stated} `) && /^(\d+$|of )/.test(name.slice(stated.length + 1)));
}

// The feature whose own triangles are hit, by its name.
function marked({ object, faceIndex }) {
  return object.userData.features.find(([, first, count]) => faceIndex >= first && faceIndex < first + count)?.[0];
}

// True if a part lies in the box about another.
function within(part, other) {
  return new Box3().setFromObject(other).containsBox(new Box3().setFromObject(part));
}

// Lines of a label, no more than so many; the last ones, so many, are grey.
function fill(words, every, idle = 0, most = MOST_LINES) {
  const more = every.length - most, lines = more > 0 ? [...every.slice(0, most), `and ${more} more`] : every;
  words.replaceChildren(...lines.flatMap((line, k) => {
    const own = document.createElement("i");
    if (k >= every.length - idle) own.className = "idle";
    own.append(...signed(line));
    return k ? [document.createElement("br"), own] : [own];
  }));
}

// Words with the signs of drawings drawn: many systems have no font with them.
function signed(line) {
  return line.split(DRAWN).filter(Boolean).map((own) => (DRAWN.test(own) ? sign(own) : own));
}

function sign(own) {
  const svg = document.createElementNS(SVG, "svg"), add = (kind, told, words = "") => {
    const found = svg.appendChild(document.createElementNS(SVG, kind));
    for (const [key, value] of Object.entries(told)) found.setAttribute(key, value);
    found.textContent = words;
  };
  svg.setAttribute("viewBox", "0 0 16 16");
  svg.setAttribute("class", "sign");
  add("title", {}, own);
  if (SIGNS[own]) add("path", { d: SIGNS[own] });
  else { // a letter in a circle
    add("circle", { cx: 8, cy: 8, r: 7 });
    add("text", { x: 8, y: 12 }, own.normalize("NFKD"));
  }
  return svg;
}

// The factor with which a build is shown, as its words have it.
function times({ factor }) {
  return Number(factor.toPrecision(DIGITS));
}

// A length in words, of mm.
function length(mm) {
  return mm < 1 ? `${(1000 * mm).toPrecision(3)} µm` : `${mm.toPrecision(4)} mm`;
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
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", "parts in 3D");
    stage.append(canvas);
    figure.prepend(stage);
  }
  const renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
  renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
  const view = new View(figure, renderer);
  const measure = figure.querySelector('[name="measured"]');
  if (measure) view.measure(measure.value);
  view.ready = view.replace(model, told).then(() => {
    figure.dataset.ready = "yes";
    performance.mark("seen");
  });
  return view;
}

tol3dView.is = is;
window.tol3dView = tol3dView;

async function show(figure, told, model) {
  const view = tol3dView(figure, await unpacked(model.textContent.trim()), JSON.parse(told.textContent));
  await view.ready;
  figure.view = view;
  if (figure.dataset.plays && !window.matchMedia("(prefers-reduced-motion: reduce)").matches) view.play();
}

const [told, model] = ["view-data", "view-model"].map((own) => document.getElementById(own));
if (told && model) {
  for (const figure of document.querySelectorAll("figure.view")) {
    show(figure, told, model).catch(() => {}); // without WebGL the still picture stays
  }
}
