// A slider and a field for each tolerance that acts on the chosen measure.
import { $, app, ask, trouble } from "./ask.js";
import { show } from "./app.js";
import { estimate, forget, refresh } from "./card.js";

const STEP = 1.01, PAGE = 10; // factor of a slider's step, and steps of Page Up and Down

export async function slide() {
  const [scene, measure, now] = [app.scene, app.measure, app.now];
  let found;
  try {
    found = await ask("sliders");
  } catch (error) {
    trouble(error);
    return;
  }
  if (scene !== app.scene || measure !== app.measure) return;
  if (now !== app.now) return slide(); // something moved meanwhile
  if (document.querySelector("#sliders input:active")) return void setTimeout(slide, 300); // a hand is on it
  const focus = document.activeElement?.closest?.("#sliders") ? document.activeElement : null;
  const [line, type, typed] = [focus?.dataset.line, focus?.type, focus?.value];
  $("sliders").innerHTML = found.sliders;
  const again = line && [...document.querySelectorAll("#sliders input")].find((own) => own.dataset.line === line && own.type === type);
  if (again) {
    again.focus();
    if (type === "text") again.value = typed;
  }
  app.acting = found;
  lit();
  if (found.waits) setTimeout(() => scene === app.scene && measure === app.measure && slide(), 500);
}

function lit() {
  const entries = new Set(app.acting?.entries ?? []), parts = new Set(app.acting?.parts ?? []);
  for (const own of document.querySelectorAll("#tree button")) {
    const { section, name } = own.dataset;
    own.classList.toggle("acts", (section === "tolerances" && entries.has(name)) || (section === "measures" && name === app.measure)
      || (section === "parts" && parts.has(name)));
  }
  window.dispatchEvent(new CustomEvent("tol3d-acting", { detail: app.acting }));
}

function moved(line, words) {
  const now = { ...app.now };
  if (words === null) delete now[line];
  else now[line] = words;
  return now;
}

function factorWords(step) {
  return step === 0 ? null : `x${Number((STEP ** step).toPrecision(4))}`;
}

export async function take(now) {
  $("dropped").hidden = true;
  app.past.push(app.now);
  app.now = now;
  note();
  for (const own of document.querySelectorAll("#sliders li")) own.classList.toggle("moved", own.dataset.line in now);
  await refresh();
}

export function note() {
  ask("notes", { beside: app.beside, past: app.past }).catch(trouble);
}

async function released(own, line) {
  const { value } = own, factor = factorWords(Number(value));
  try {
    const words = factor && (await ask("rounded", { line, words: factor })).words;
    if (own.value === value) await take(moved(line, words)); // else it has gone on
  } catch (error) {
    trouble(error);
  }
}

$("sliders").addEventListener("keydown", (event) => {
  const own = event.target, by = { PageUp: PAGE, PageDown: -PAGE }[event.key];
  if (own.type !== "range" || !by) return;
  event.preventDefault(); // browsers go a tenth of the range
  own.value = Number(own.value) + by;
  for (const name of ["input", "change"]) own.dispatchEvent(new Event(name, { bubbles: true }));
});
$("sliders").addEventListener("input", (event) => {
  const { type, dataset, value } = event.target;
  if (type === "range") estimate(moved(dataset.line, factorWords(Number(value))), dataset.line);
});
$("sliders").addEventListener("change", async (event) => {
  const own = event.target, { line } = own.dataset;
  own.closest("li").querySelector(".wrong")?.remove();
  if (own.type === "range") {
    forget();
    own.closest("li").querySelector(".class-words")?.remove(); // its width is of no class
    app.moving = released(own, line);
    return;
  }
  const now = moved(line, own.value.trim() || null);
  if (!own.value.trim()) own.value = own.dataset.scene;
  try {
    await ask("estimate", { now });
  } catch (error) {
    const words = document.createElement("p");
    words.className = "wrong";
    words.textContent = error.message;
    own.closest("li").append(words);
    return;
  }
  await take(now);
  await slide();
});

export async function undo() {
  await app.moving;
  if (!app.past.length) return;
  app.now = app.past.pop();
  note();
  await show();
}
