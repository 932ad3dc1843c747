// Analyses of the scene: a form for each, started as a job.
import { $, app, ask, trouble } from "./ask.js";
import { watch } from "./jobs.js";
import { editor } from "./text.js";

let wished = 0;

async function fill() { // the latest wish wins
  const own = ++wished, found = await ask("forms", { kind: $("analysis").value || "effects" }), kept = $("analysis").value;
  if (own !== wished) return;
  $("analysis").replaceChildren(...Object.entries(found.kinds).map(([kind, title]) => new Option(title, kind)));
  if (kept) $("analysis").value = kept;
  $("fields").innerHTML = found.form;
  $("analysis-note").textContent = note($("analysis").value);
  $("analysis-state").replaceChildren();
}

function note(kind) {
  const count = Object.keys(app.now).length, words = ["By the scene's file."];
  if (count && kind === "what_if") words.push("The fields begin with what is moved.");
  else if (count) words.push(`${count} change${count > 1 ? "s" : ""} not kept: the tolerances of the file count; keep… writes changes there.`);
  if (editor.text() !== app.saved) words.push("The text is not saved: what is in the file counts.");
  return words.join(" ");
}

function given() {
  const fields = Object.create(null);
  for (const own of document.querySelectorAll("#fields [data-argument]")) {
    const { argument, item, of, each } = own.dataset, text = own.value.trim();
    if (item !== undefined) {
      if (own.checked) (fields[argument] ??= []).push(item);
    } else if (of !== undefined) {
      if (text) (fields[argument] ??= Object.create(null))[of] = text;
    } else if (each !== undefined) {
      if (text) (fields[argument] ??= []).push(text);
    } else fields[argument] = own.type === "checkbox" ? own.checked : text;
  }
  return fields;
}

function refuse({ argument, of, message }) {
  const words = document.createElement("p"), name = argument === "factor" ? "set" : argument;
  Object.assign(words, { className: "wrong", role: "alert", textContent: message });
  const all = [...document.querySelectorAll("#fields [data-argument]")].filter((own) => own.dataset.argument === name);
  const own = all.find(({ dataset, value }) => of && [dataset.of, dataset.item, value.trim()].includes(of)) ?? all[0];
  if (own?.closest("details")) own.closest("details").open = true;
  (own?.closest("td, [data-field]") ?? $("fields")).append(words);
  own?.focus();
}

$("analyses-button").addEventListener("click", async () => {
  try {
    await Promise.all([fill(), watch("")]); // not at its "close": browsers tell that with a later frame, at times after the next start
    $("analyses").showModal();
  } catch (error) {
    trouble(error);
  }
});
$("analysis").addEventListener("change", () => fill().catch(trouble));
$("close-analyses").addEventListener("click", () => $("analyses").close());
$("analysis-form").addEventListener("submit", async (event) => {
  event.preventDefault();
  for (const own of document.querySelectorAll("#fields .wrong")) own.remove();
  try {
    const asked = { kind: $("analysis").value, fields: given() };
    $("analysis-state").textContent = "checking …";
    let found;
    do found = await ask("fit", asked); while (found.waits);
    $("analysis-state").replaceChildren();
    if (!found.refused) found = await ask("analyse", asked);
    if (found.refused) refuse(found.refused);
    else await watch(found.id);
  } catch (error) {
    refuse(error);
  }
});
