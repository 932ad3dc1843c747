// The assembly in 3D.
import { $, app, ask } from "./ask.js";
import { editor } from "./text.js";

let view = null, showing = 0;
async function stage() {
  const which = $("build").value, wish = ++showing;
  $("stage-words").textContent = "building …";
  try {
    const trial = Number($("trial").value) || 0;
    const turn = Number($("turn").value) / 100;
    const bytes = await ask("view", {
      ...(which === "trial" ? { trial } : { builds: which === "nominal" ? [] : [which] }), ...(turn ? { turn } : {}),
    });
    if (wish !== showing) return;
    const length = new DataView(bytes).getUint32(0), told = JSON.parse(new TextDecoder().decode(bytes.slice(4, 4 + length)));
    const model = bytes.slice(4 + length);
    if (view) await view.replace(model, told);
    else {
      view = window.tol3dView($("stage"), model, told);
      view.onpick((part) => part && find("parts", part));
      await view.ready;
    }
    parts(told.parts);
    view.show(told.builds.length - 1, Number($("stage").querySelector('[name="factor"]').dataset.wanted ?? 1));
    light();
    const refused = Object.entries(told.refused).map(([name, why]) => `${name}: ${why}`);
    if (refused.length) $("stage-words").textContent = refused.join("; ");
  } catch (error) {
    if (wish === showing) $("stage-words").textContent = error.message;
  }
}

function parts(told) {
  $("parts").replaceChildren(...told.map((own, k) => {
    const label = document.createElement("label"), box = document.createElement("input");
    Object.assign(box, { type: "checkbox", name: "part", value: k, checked: true });
    label.append(box, ` ${own.name}`);
    return label;
  }));
}

function light() {
  if (view) view.light($("lit").checked && app.acting?.parts.length ? app.acting.parts : null);
}

function find(section, name) {
  const own = [...document.querySelectorAll("#tree button")].find((one) => one.dataset.section === section && one.dataset.name === name);
  own?.scrollIntoView({ block: "nearest" });
  own?.focus({ preventScroll: true });
  if (own?.dataset.line) editor.go(Number(own.dataset.line));
}

$("build").addEventListener("change", () => {
  $("trial").hidden = $("build").value !== "trial";
  stage();
});
$("trial").addEventListener("change", stage);
$("turn").addEventListener("input", () => {
  clearTimeout(stage.later);
  stage.later = setTimeout(stage, 60);
});
$("lit").addEventListener("change", light);
window.addEventListener("tol3d-acting", light);
window.addEventListener("tol3d-scene", stage);
window.addEventListener("tol3d-card", () => $("build").value !== "nominal" && stage());
