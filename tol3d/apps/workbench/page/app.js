// The app's page: what it shows comes from the server; here are only focus, scroll, camera and the wish of the moment.
import { $, app, ask, trouble } from "./ask.js";
import { aside, refresh } from "./card.js";
import "./analyses.js";
import "./jobs.js";
import { note, slide, take, undo } from "./sliders.js";
import "./stage.js";
import { editor, goTo, keep, marks, problems, save, showText } from "./text.js";

async function start() {
  const folder = await ask("folder");
  app.readOnly = folder.read_only;
  $("run").disabled = Boolean(app.readOnly);
  trouble(null);
  listed(folder);
  const asked = decodeURIComponent(location.hash.replace(/^#\/scene\//, ""));
  await open(folder.scenes.includes(asked) ? asked : folder.first || folder.scenes[0]);
}

function listed(folder) {
  app.listed = folder.listed;
  const names = folder.scenes, gone = app.scene && !names.includes(app.scene) ? [app.scene] : [];
  $("which").hidden = names.length + gone.length < 2;
  $("scene").replaceChildren(...names.map((name) => new Option(name, name)), ...gone.map((name) => new Option(`${name}, gone`, name)));
  if (app.scene) $("scene").value = app.scene;
}

export async function open(name) {
  const other = name !== app.scene;
  if (other) leave();
  app.scene = name;
  app.measure = "";
  app.past = [];
  history.replaceState(null, "", `#/scene/${encodeURIComponent(name)}`);
  $("scene").value = name;
  $("state").textContent = "reading the scene …";
  const found = await ask("scene");
  if (app.scene !== name) return; // another one was opened in the meantime
  showText(found.text, found.digest);
  if (other) $("editor").querySelector(".cm-scroller").scrollTop = 0;
  problems(found.problems, found.warnings ?? []);
  $("title").textContent = found.title ?? name;
  document.title = `${found.title ?? name} · tol3d`;
  const broken = !found.measures;
  document.body.classList.toggle("broken", broken); // what was computed before stays in sight, out of reach
  for (const name of ["card", "stage"]) $(name).inert = broken;
  $("analyses-button").disabled = broken;
  $("run").disabled = app.readOnly || broken;
  if (broken) {
    $("state").textContent = "the scene cannot be read: mend its text";
    $("tree").replaceChildren();
    app.now = {};
    app.beside = [];
    return;
  }
  ({ now: app.now, beside: app.beside, past: app.past } = found.notes);
  $("dropped").textContent = found.dropped.join(" ");
  $("dropped").hidden = !found.dropped.length;
  $("tree").innerHTML = found.tree;
  $("trials").placeholder = found.trials;
  app.positions = found.positions;
  app.stands = found.stands;
  app.flags = found.flags;
  $("measure").replaceChildren(...found.measures.map((own) => new Option(own.name, own.name)));
  const names = found.measures.map((own) => own.name);
  $("measure").value = app.measure = names.includes(found.notes.measure) ? found.notes.measure : names[0];
  $("state").textContent = found.compiled ? "" : "compiling kernels, once on this machine …";
  marks(found.problems);
  await show();
  window.dispatchEvent(new CustomEvent("tol3d-scene"));
}

function leave() { // nothing of a scene stands under the name of another
  for (const own of ["answer", "chart", "result", "sliders", "beside"]) $(own).replaceChildren();
  window.dispatchEvent(new CustomEvent("tol3d-leave"));
}

export async function show() {
  await Promise.all([refresh(), slide()]);
  aside();
}

// what others change ------------------------------------------------------------------------------

let looked = 0;
setInterval(async () => {
  if (!app.scene || (document.hidden && Date.now() - looked < 60000)) return;
  looked = Date.now();
  try {
    const found = await ask("changed");
    if (found.listed !== app.listed) listed(await ask("folder"));
    if (found.digest === app.digest) return;
    if (!found.digest) {
      trouble(`${app.scene} is gone: it was moved or deleted; its text is still here to copy`);
      return;
    }
    if (editor.text() === app.saved) await open(app.scene);
    else $("changed").hidden = false;
  } catch (error) {
    trouble(error);
  }
}, 2000);

window.addEventListener("beforeunload", (event) => { // jobs go on, what is moved is noted
  if (app.scene && editor.text() !== app.saved) event.preventDefault();
});

// controls ----------------------------------------------------------------------------------------

export async function choose(measure) {
  app.measure = $("measure").value = measure;
  note();
  await show();
}

$("scene").addEventListener("change", () => open($("scene").value).catch(trouble));
$("measure").addEventListener("change", () => choose($("measure").value).catch(trouble));
$("reset").addEventListener("click", () => take({}).then(slide));
$("undo").addEventListener("click", undo);
$("keep").addEventListener("click", keep);
$("cancel").addEventListener("click", () => $("diff").close());
$("save").addEventListener("click", save);
$("copy").addEventListener("click", async () => {
  try {
    await navigator.clipboard.writeText(editor.text());
    $("copied").textContent = "copied";
  } catch {
    $("copied").textContent = "the browser does not allow it: select the text and copy it";
  }
});
$("load").addEventListener("click", () => open(app.scene).catch(trouble));
$("stop").addEventListener("click", () => (app.stopped = true));
$("aside").addEventListener("click", async () => {
  await app.moving;
  app.beside.push(app.now);
  note();
  $("aside").disabled = app.beside.length >= 3;
  await aside();
  $("beside").scrollIntoView({ block: "nearest" }); // it lies below the sliders
});
$("help-button").addEventListener("click", () => $("help").showModal());
$("close-help").addEventListener("click", () => $("help").close());
$("filter").addEventListener("input", () => {
  const words = $("filter").value.trim().toLowerCase();
  for (const own of document.querySelectorAll("#tree li")) own.hidden = !own.textContent.toLowerCase().includes(words);
});
$("tree").addEventListener("click", (event) => {
  const own = event.target.closest("button");
  if (!own) return;
  if (own.dataset.section === "measures" && !event.target.closest("summary")) choose(own.dataset.name).catch(trouble);
  if (own.dataset.line) {
    $("text").open = true;
    goTo(Number(own.dataset.line));
  }
});
document.addEventListener("keydown", (event) => {
  const typing = event.target.closest("#editor, input[type=text], input[type=search]");
  if ((event.ctrlKey || event.metaKey) && event.key === "s") {
    if (event.defaultPrevented) return; // the editor has saved
    event.preventDefault();
    (event.target.closest("#editor") ? save : keep)();
  } else if ((event.ctrlKey || event.metaKey) && event.key === "z" && !typing) {
    event.preventDefault();
    undo();
  } else if (event.key === "?" && !typing) $("help").showModal();
});

const narrow = matchMedia("(max-width: 46rem)"); // there the text comes last, by Tab too
function place() {
  (narrow.matches ? $("left").parentElement : $("middle")).append($("text"));
}
narrow.addEventListener("change", place);
place();

window.tol3dApp = { app, ask, trouble, editor, choose };
start().catch(trouble);
