// Joints and paths: sliders by which parts stand otherwise than in the poses of the scene.
import { $, app, button } from "./ask.js";
import { stage, still } from "./stage.js";

let moved = "", playing = false; // of joints all count, of paths the one that was moved

export function standing() { // nothing: in the poses of the scene
  const own = app.stands?.find((one) => one.name === moved);
  if (!own) return {};
  const counts = own.unit ? app.stands.filter((one) => one.unit) : [own];
  return Object.fromEntries(counts.map(({ name }) => [name, Number(slider(name).value)]));
}

function slider(name) {
  return [...$("stands").querySelectorAll("input")].find((own) => own.dataset.coordinate === name);
}

export function stands() {
  const every = app.stands ?? [], poses = Object.keys(every.find(named)?.poses ?? {});
  moved = "";
  playing = false;
  $("standing").hidden = !every.length;
  $("standing").querySelector("summary").textContent = every.some((own) => own.unit) ? "joints" : every.every(named) ? "poses" : "paths";
  const label = document.createElement("label"), pose = document.createElement("select");
  pose.append(new Option("as measured", ""), ...poses.map((name) => new Option(name, name)));
  label.append("pose ", pose);
  pose.addEventListener("change", () => choose(pose.value));
  $("stands").replaceChildren(label, ...every.map(line));
  for (const own of every) set(own, first(own));
}

export function seen(pose) { // which is shown, as long as none is set
  if (!moved) for (const own of app.stands ?? []) set(own, own.poses[pose] ?? first(own));
}

function named(own) { // of a joint, or of the poses of loops, not of a path
  return Object.keys(own.poses).length > 0;
}

function first(own) {
  return Object.values(own.poses)[0] ?? 0;
}

function line(own) {
  const label = document.createElement("label"), input = document.createElement("input"), number = document.createElement("output");
  Object.assign(input, { type: "range", min: own.low, max: own.high, step: own.unit ? 0.1 : 1 });
  input.dataset.coordinate = own.name;
  label.append(`${own.name} `, input, " ", number);
  input.addEventListener("input", () => {
    playing = false;
    move(own, input.value);
    stage(true);
  });
  input.addEventListener("change", () => stage());
  if (own.unit) return label;
  const both = document.createElement("span");
  both.append(label, " ", button("play", () => play(own)));
  return both;
}

function move(own, value) {
  moved = own.name;
  still();
  $("stands").querySelector("select").selectedIndex = -1; // in none of them
  set(own, value);
}

function set(own, value) {
  const input = slider(own.name);
  input.value = value;
  const number = Number(input.value), pose = Object.keys(own.poses).find((name) => own.poses[name] === number);
  const words = own.unit ? `${number.toFixed(1)}${own.unit === "deg" ? "°" : ` ${own.unit}`}` : pose ?? `step ${number} of ${own.high}`;
  input.closest("label").querySelector("output").value = words;
  input.setAttribute("aria-valuetext", words);
}

function choose(pose) {
  playing = false;
  still();
  for (const own of app.stands) set(own, own.poses[pose] ?? first(own));
  moved = pose ? app.stands.find(named).name : "";
  stage();
}

async function play(own) { // on to its end, a picture a step
  playing = !playing;
  const from = Number(slider(own.name).value);
  for (let step = from < own.high ? from : own.low; playing && step <= own.high; step += 1) {
    move(own, step);
    await stage(true);
  }
  playing = false;
  stage();
}
