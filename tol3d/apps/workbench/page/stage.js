// The assembly in 3D.
import { $, app, ask } from "./ask.js";
import { seen, standing, stands } from "./stands.js";
import { goTo } from "./text.js";

const STEPS = 200; // of a slider of positions
const MANY = 4; // sliders that are shown when they are asked for
let view = null, running = null, waiting = null, known = {}, chosen = null, scene = "", measure = "";
let travels = [], moving = false; // names of motions, and whether builds come with theirs

// One question under way, the latest wish wins; a promise of its picture. While a slider is held, a build is asked for
// with one factor alone.
export function stage(held = false) {
  if (running) waiting = { held: held === true };
  else running = drawn(held === true).finally(() => { running = null; });
  return running;
}

async function drawn(held) {
  const begun = setTimeout(() => ($("stage-words").textContent = "building …"), 150);
  try {
    await show(wish(held));
  } catch (error) {
    $("stage-words").textContent = error.message;
  }
  clearTimeout(begun);
  if (waiting) {
    const next = waiting;
    waiting = null;
    await drawn(next.held);
  }
}

function wish(held) {
  const which = $("build").value;
  return {
    ...(which === "trial" ? { trial: Number($("trial").value) || 0 } : { builds: which === "nominal" ? [] : [which] }),
    ...((held || moving) && { factor: Number($("factor").dataset.asked ?? 1) }),
    ...(moving && !held && { motion: travels[0] }),
    positions: positions(), standing: standing(), world: $("world").value, known,
  };
}

async function show(asked) {
  const of = app.scene, bytes = await ask("view", asked);
  if (of !== app.scene) return; // another scene was opened in the meantime
  const length = new DataView(bytes).getUint32(0), told = JSON.parse(new TextDecoder().decode(bytes.slice(4, 4 + length)));
  const model = bytes.slice(4 + length);
  if (!view) {
    view = window.tol3dView($("stage"), model, told);
    view.onpick(find);
    await view.ready;
  } else {
    parts(told.parts);
    await view.replace(model, told);
  }
  known = { collection: told.collection, meshes: told.meshes };
  travels = told.travels;
  $("travel").textContent = travels[0] ?? "";
  parts(told.parts);
  worlds(told.worlds);
  seen(told.world);
  view.flags(app.flags ?? []);
  measure = app.measure;
  view.measure(measure);
  view.show(told.builds.length - 1, asked.factor ?? Number($("factor").dataset.wanted ?? 1));
  light();
  const refused = Object.entries(told.refused).map(([name, why]) => (why.startsWith(name) ? why : `${name}: ${why}`));
  const unread = told.measured ? [] : [`where ${app.measure} is read is not drawn here`];
  const words = [...(refused.length ? refused : [$("stage-words").textContent]), ...unread];
  $("stage-words").textContent = words.filter((own) => own).join("; ");
}

function parts(told) {
  const names = told.map((own) => own.name), boxes = [...$("parts").querySelectorAll("input")];
  if (boxes.length === names.length && boxes.every((own, k) => own.dataset.part === names[k])) return;
  $("parts").replaceChildren(...names.map((name, k) => {
    const label = document.createElement("label"), box = document.createElement("input");
    Object.assign(box, { type: "checkbox", name: "part", value: k, checked: true });
    box.dataset.part = name;
    label.append(box, ` ${name}`);
    return label;
  }));
}

function worlds(names) {
  $("worlds").hidden = names.length < 2;
  const wanted = $("world").value;
  $("world").replaceChildren(new Option("as measured", ""), ...names.map((name) => new Option(name, name)));
  $("world").value = names.includes(wanted) ? wanted : "";
}

// positions: a slider each, and one for all ------------------------------------------------------

function sliders() {
  const every = app.positions ?? [], several = every.length > 1;
  $("turning").hidden = !every.length;
  $("turning").open = every.length < MANY;
  $("turns").replaceChildren(...[...(several ? [null] : []), ...every].map((own) => {
    const label = document.createElement("label"), slider = document.createElement("input"), number = document.createElement("output");
    Object.assign(slider, { type: "range", min: 0, max: STEPS, value: 0, step: 1 });
    slider.dataset.position = own ? own.name : "";
    label.append(own ? `${own.words} ` : "all together ", slider, " ", number);
    slider.addEventListener("input", () => turned(slider, own));
    slider.addEventListener("change", () => stage());
    return label;
  }));
  tell();
}

function turned(slider, own) {
  if (!own) for (const other of $("turns").querySelectorAll("input")) other.value = slider.value;
  tell();
  stage(true);
}

function tell() {
  for (const slider of $("turns").querySelectorAll("input")) {
    const own = app.positions.find((one) => one.name === slider.dataset.position);
    if (own) value(slider, slider.parentElement.querySelector("output"), own);
  }
}

function value(slider, number, own) {
  const at = own.low + (own.high - own.low) * (slider.value / STEPS), unit = own.unit === "deg" ? "°" : ` ${own.unit}`;
  const drawn = !Object.keys(positions()).length && ["worst", "trial"].includes($("build").value);
  number.value = drawn ? "as in the trial" : `${at.toFixed(1)}${unit}`;
  slider.setAttribute("aria-valuetext", number.value);
}

function positions() { // none of them: those of the trial
  const found = [...$("turns").querySelectorAll("input")].filter((own) => own.dataset.position);
  if (found.every((own) => own.value === "0")) return {};
  return Object.fromEntries(found.map((own) => {
    const { share } = app.positions.find((one) => one.name === own.dataset.position);
    return [own.dataset.position, share * (own.value / STEPS)];
  }));
}

// Builds stand still again: they are asked for otherwise than in the poses of a motion.
export function still() {
  moving = false;
}

// what is lit, and what leads to it --------------------------------------------------------------

function light() {
  if (!view) return;
  view.prefer([...(app.acting?.entries ?? []), ...(app.acting?.parts ?? [])]);
  const acting = !chosen && $("lit").checked && app.acting?.parts.length ? app.acting : null;
  view.light(chosen ?? acting?.parts ?? null, acting?.entries);
}

function find(part, feature) {
  if (chosen) choose(null);
  const every = [...document.querySelectorAll('#tree button[data-section="parts"]')];
  const { is } = window.tol3dView;
  const own = every.find((one) => feature && one.dataset.feature && is(feature, one.dataset.feature))
    ?? every.find((one) => part && !one.dataset.feature && is(part, one.dataset.name));
  if (!own) return;
  for (let above = own.closest("details"); above; above = above.parentElement.closest("details")) above.open = true;
  own.scrollIntoView({ block: "nearest" });
  own.focus({ preventScroll: true });
  if (own.dataset.line) goTo(Number(own.dataset.line));
}

function choose(names) {
  chosen = names;
  light();
}

$("tree").addEventListener("click", (event) => {
  const own = event.target.closest("button");
  if (!own) return;
  const { section, name, feature } = own.dataset;
  if (section === "parts") choose([feature ?? name]);
  else if (section === "tolerances") choose((app.flags ?? []).find((flag) => flag.name === name)?.of ?? null);
  else choose(null);
});

$("build").addEventListener("change", () => {
  $("trial").hidden = $("build").value !== "trial";
  still();
  tell();
  stage();
});
$("factor").addEventListener("input", () => {
  $("factor").dataset.wanted = $("factor").dataset.asked;
});
$("trial").addEventListener("change", () => stage());
$("world").addEventListener("change", () => {
  still();
  stage();
});
$("stage").querySelector('[name="play"]').addEventListener("click", async () => {
  if (moving) return; // the view plays what it has
  moving = true;
  await stage();
  view.play();
});
$("lit").addEventListener("change", () => choose(null));
window.addEventListener("tol3d-acting", light);
window.addEventListener("tol3d-leave", () => {
  view?.clear();
  $("stage-words").textContent = "";
});
window.addEventListener("tol3d-scene", () => {
  if (scene !== app.scene) {
    view?.clear();
    $("world").replaceChildren();
  }
  scene = app.scene;
  chosen = null;
  known = {};
  still();
  sliders();
  stands();
  stage();
});
window.addEventListener("tol3d-card", () => {
  if (scene === app.scene && ($("build").value !== "nominal" || app.measure !== measure)) stage();
});
