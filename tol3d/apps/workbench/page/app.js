// The app's page: what it shows comes from the server; here are only focus, scroll, camera and the wish of the moment.
const $ = (id) => document.getElementById(id);
const KEY = "tol3d-token";
const WIDEST = 4, STEPS = 100; // factor at a slider's end, and its steps

if (location.hash.length > 1 && !location.hash.startsWith("#/")) {
  sessionStorage.setItem(KEY, location.hash.slice(1));
  history.replaceState(null, "", "/");
}

const app = {
  scene: "", measure: "", now: {}, beside: [], past: [], digest: "", saved: "", readOnly: false, wish: 0, solid: 0, stopped: false,
};

async function ask(name, told = {}) {
  let reply;
  try {
    reply = await fetch(`/api/${name}`, {
      method: "POST",
      headers: { "content-type": "application/json", "x-tol3d-token": sessionStorage.getItem(KEY) ?? "" },
      body: JSON.stringify({ scene: app.scene, measure: app.measure, now: app.now, ...told }),
    });
  } catch {
    throw new Error("the server does not answer: is tol3d app still running?");
  }
  if (reply.ok && reply.headers.get("content-type") === "application/octet-stream") return reply.arrayBuffer();
  const found = await reply.json().catch(async () => ({ error: `${reply.status}` }));
  if (!reply.ok) throw Object.assign(new Error(found.error ?? `${reply.status}`), { status: reply.status });
  return found;
}

function trouble(error) {
  $("trouble").textContent = error ? error.message ?? error : "";
  $("trouble").hidden = !error;
}

// the scene ---------------------------------------------------------------------------------------

async function start() {
  const folder = await ask("folder");
  app.readOnly = Boolean(folder.read_only);
  $("run").disabled = app.readOnly;
  if (folder.read_only) trouble(folder.read_only);
  $("which").hidden = folder.scenes.length < 2;
  $("scene").replaceChildren(...folder.scenes.map((name) => new Option(name, name)));
  const asked = decodeURIComponent(location.hash.replace(/^#\/scene\//, ""));
  await open(folder.scenes.includes(asked) ? asked : folder.first || folder.scenes[0]);
}

async function open(name) {
  app.scene = name;
  app.measure = "";
  app.past = [];
  history.replaceState(null, "", `#/scene/${encodeURIComponent(name)}`);
  $("scene").value = name;
  $("state").textContent = "reading the scene …";
  const found = await ask("scene");
  showText(found.text, found.digest);
  problems(found.problems, found.warnings ?? []);
  $("title").textContent = found.title ?? name;
  document.title = `${found.title ?? name} · tol3d`;
  document.body.classList.toggle("broken", !found.measures);
  if (!found.measures) {
    $("state").textContent = "the scene cannot be read: mend its text";
    $("tree").replaceChildren();
    return;
  }
  app.now = found.notes.now;
  app.beside = found.notes.beside;
  $("tree").innerHTML = found.tree;
  $("turning").hidden = !found.turns;
  $("turn").value = 0;
  $("measure").replaceChildren(...found.measures.map((own) => new Option(own.name, own.name)));
  const names = found.measures.map((own) => own.name);
  $("measure").value = app.measure = names.includes(found.notes.measure) ? found.notes.measure : names[0];
  $("state").textContent = found.compiled ? "" : "compiling kernels, once on this machine …";
  marks(found.problems);
  await show();
  window.dispatchEvent(new CustomEvent("tol3d-scene"));
}

async function show() {
  await Promise.all([refresh(), slide()]);
  aside();
}

// the card ----------------------------------------------------------------------------------------

async function refresh() {
  const wish = ++app.wish;
  app.stopped = false;
  $("reset").disabled = !Object.keys(app.now).length;
  $("aside").disabled = $("reset").disabled || app.beside.length >= 3;
  $("keep").disabled = $("reset").disabled || app.readOnly;
  $("undo").disabled = !app.past.length;
  changesTold();
  for (;;) {
    let found;
    try {
      found = await ask("card");
    } catch (error) {
      if (wish === app.wish) trouble(error);
      return;
    }
    if (wish !== app.wish) return;
    app.solid = wish;
    trouble(null);
    if ($("state").textContent.startsWith("compiling")) $("state").textContent = "";
    $("answer").innerHTML = found.answer;
    $("chart").innerHTML = found.chart;
    fields(found.written);
    const going = found.done < found.of && !app.stopped;
    $("progress").hidden = !going;
    if (!going) break;
    $("progress").querySelector("progress").value = found.done / found.of;
    $("progress").querySelector("span").textContent = `${found.done} of ${found.of} trials, ${found.left} s left`;
  }
  window.dispatchEvent(new CustomEvent("tol3d-card"));
}

function changesTold() {
  const count = Object.keys(app.now).length;
  if (!$("state").textContent.endsWith("…")) $("state").textContent = count ? `${count} change${count > 1 ? "s" : ""} not kept` : "";
}

let flying = false, waiting = null;
async function estimate(now) { // one request under way, the latest wish wins
  if (flying) {
    waiting = now;
    return;
  }
  flying = true;
  const wish = ++app.wish;
  try {
    const found = await ask("estimate", { now });
    if (app.solid < wish) { // nothing newer has come before it
      $("chart").innerHTML = found.chart;
      fields(found.written);
      trouble(null);
    }
  } catch (error) {
    if (app.solid < wish) trouble(error);
  }
  flying = false;
  if (waiting) {
    const next = waiting;
    waiting = null;
    await estimate(next);
  }
}

function fields(written) {
  for (const [line, words] of Object.entries(written ?? {})) {
    const field = [...document.querySelectorAll("#sliders input[type=text]")].find((own) => own.dataset.line === line);
    if (field && field !== document.activeElement) field.value = words;
  }
}

// sliders -----------------------------------------------------------------------------------------

async function slide() {
  const [scene, measure] = [app.scene, app.measure];
  let found;
  try {
    found = await ask("sliders");
  } catch (error) {
    trouble(error);
    return;
  }
  if (scene !== app.scene || measure !== app.measure) return;
  const focus = document.activeElement?.closest?.("#sliders") ? document.activeElement : null;
  const [line, type] = [focus?.dataset.line, focus?.type];
  $("sliders").innerHTML = found.sliders;
  if (line) [...document.querySelectorAll("#sliders input")].find((own) => own.dataset.line === line && own.type === type)?.focus();
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
  return step === 0 ? null : `x${Number((WIDEST ** (step / STEPS)).toPrecision(4))}`;
}

async function take(now) {
  app.past.push(app.now);
  app.now = now;
  note();
  for (const own of document.querySelectorAll("#sliders li")) own.classList.toggle("moved", own.dataset.line in now);
  await refresh();
}

function note() {
  ask("notes", { beside: app.beside }).catch(trouble);
}

$("sliders").addEventListener("input", (event) => {
  const { type, dataset, value } = event.target;
  if (type === "range") estimate(moved(dataset.line, factorWords(Number(value))));
});
$("sliders").addEventListener("change", async (event) => {
  const own = event.target, { line } = own.dataset;
  own.closest("li").querySelector(".wrong")?.remove();
  if (own.type === "range") {
    waiting = null;
    await take(moved(line, factorWords(Number(own.value))));
    return;
  }
  const now = moved(line, own.value.trim() || null);
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

async function undo() {
  if (!app.past.length) return;
  app.now = app.past.pop();
  note();
  await show();
}

// what-ifs beside each other ----------------------------------------------------------------------

async function aside() {
  const wish = app.wish, found = [];
  for (const [k, own] of app.beside.entries()) {
    let card;
    try {
      card = await ask("card", { now: own });
    } catch (error) {
      card = { answer: error.message };
    }
    const article = document.createElement("article");
    article.innerHTML = card.answer;
    const words = document.createElement("p");
    words.className = "dim";
    words.textContent = Object.entries(own).map(([line, text]) => `${line} ${text.replace(/^x/, "× ")}`).join(", ");
    const back = button("take", () => takeBack(k)), drop = button("drop", () => dropOne(k));
    article.append(words, back, " ", drop);
    found.push(article);
  }
  if (wish === app.wish || !found.length) $("beside").replaceChildren(...found);
}

function button(words, act) {
  const own = document.createElement("button");
  own.type = "button";
  own.textContent = words;
  own.addEventListener("click", act);
  return own;
}

async function takeBack(k) {
  app.past.push(app.now);
  app.now = app.beside[k];
  note();
  await show();
}

async function dropOne(k) {
  app.beside.splice(k, 1);
  note();
  $("aside").disabled = !Object.keys(app.now).length;
  await aside();
}

// the text ----------------------------------------------------------------------------------------

const editor = window.tol3dEditor($("editor"), {
  nonce: document.querySelector('meta[name="style-nonce"]').content,
  changed: () => textChanged(),
  save: () => save(),
});

function showText(text, digest) {
  app.digest = digest;
  editor.set(text);
  app.saved = editor.text();
  $("save").disabled = true;
  $("saved").textContent = "";
}

let later = 0;
function textChanged() {
  const text = editor.text();
  $("save").disabled = text === app.saved || app.readOnly;
  $("saved").textContent = text === app.saved ? "" : "not saved";
  clearTimeout(later);
  later = setTimeout(async () => {
    try {
      const found = await ask("check", { text });
      if (text === editor.text()) problems(found.problems, found.warnings);
    } catch (error) {
      trouble(error);
    }
  }, 300);
}

function problems(wrong, warnings) {
  editor.mark(wrong);
  const told = [...wrong.map((own) => ["error", own]), ...warnings.map((own) => ["warning", own])];
  $("problems").replaceChildren(...told.map(([kind, own]) => {
    const item = document.createElement("li");
    item.className = kind;
    const { line, message } = typeof own === "string" ? { message: own } : own;
    item.append(line ? button(message, () => editor.go(line)) : message);
    return item;
  }));
  marks(wrong);
}

function marks(wrong) {
  const lines = wrong.map((own) => own.line);
  const every = [...document.querySelectorAll("#tree button[data-line]")].sort((a, b) => a.dataset.line - b.dataset.line);
  for (const own of every) own.classList.remove("wrong");
  for (const line of lines) every.filter((own) => Number(own.dataset.line) <= line).at(-1)?.classList.add("wrong");
}

async function save() {
  if ($("save").disabled) return;
  try {
    const text = editor.text(), found = await ask("save", { text, digest: app.digest });
    app.digest = found.digest;
    await open(app.scene);
  } catch (error) {
    trouble(error);
  }
}

async function keep() {
  if ($("keep").disabled) return;
  if (editor.text() !== app.saved) {
    trouble("save the text first: what is kept is a change of the scene's file, which is then read again");
    return;
  }
  try {
    const found = await ask("keep");
    const lines = found.diff.split("\n").map((line) => {
      const own = document.createElement("span");
      own.className = line.startsWith("+") ? "plus" : line.startsWith("-") ? "minus" : "";
      own.textContent = `${line}\n`;
      return own;
    });
    $("diff").querySelector("pre").replaceChildren(...lines);
    $("diff").dataset.digest = found.digest;
    $("diff").showModal();
  } catch (error) {
    trouble(error);
  }
}

$("write").addEventListener("click", async () => {
  $("diff").close();
  try {
    await ask("keep", { write: true, digest: $("diff").dataset.digest, beside: app.beside });
    const measure = app.measure;
    await open(app.scene);
    if (measure !== app.measure) await choose(measure);
  } catch (error) {
    trouble(error);
  }
});

// what others change ------------------------------------------------------------------------------

let looked = 0;
setInterval(async () => {
  if (!app.scene || (document.hidden && Date.now() - looked < 60000)) return;
  looked = Date.now();
  try {
    const found = await ask("changed");
    if (found.digest === app.digest) return;
    if (editor.text() === app.saved) await open(app.scene);
    else trouble("the file was changed by another program: save is refused until you reload the page");
  } catch (error) {
    trouble(error);
  }
}, 2000);

// controls ----------------------------------------------------------------------------------------

async function choose(measure) {
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
$("stop").addEventListener("click", () => (app.stopped = true));
$("aside").addEventListener("click", async () => {
  app.beside.push(app.now);
  note();
  $("aside").disabled = app.beside.length >= 3;
  await aside();
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
    editor.go(Number(own.dataset.line));
  }
});
document.addEventListener("keydown", (event) => {
  const typing = event.target.closest("#editor, input[type=text], input[type=search]");
  if ((event.ctrlKey || event.metaKey) && event.key === "s") {
    event.preventDefault();
    (event.target.closest("#editor") ? save : keep)();
  } else if ((event.ctrlKey || event.metaKey) && event.key === "z" && !typing) {
    event.preventDefault();
    undo();
  } else if (event.key === "?" && !typing) $("help").showModal();
});

// in 3D -------------------------------------------------------------------------------------------

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

// jobs --------------------------------------------------------------------------------------------

const ENDED = ["done", "failed", "cancelled", "interrupted"];
async function jobs() {
  let found;
  try {
    found = (await ask("jobs")).jobs;
  } catch {
    return;
  }
  const own = found.filter((job) => job.scene === app.scene).slice(0, 1);
  $("job").replaceChildren(...own.flatMap((job) => {
    const share = job.of ? ` ${job.done} of ${job.of}` : "";
    const words = document.createElement("span");
    words.textContent = `${job.kind} ${job.state}${share} ${job.state === "running" ? job.words : job.message}`;
    const act = ENDED.includes(job.state) ? [] : [button("cancel", () => ask("cancel", { id: job.id }).then(jobs, trouble))];
    if (["cancelled", "interrupted"].includes(job.state)) act.push(button("resume", () => ask("resume", { id: job.id }).then(jobs, trouble)));
    if (job.state === "done" && ["run", "report"].includes(job.kind)) act.push(button("report", () => report(job.id)));
    return [words, ...act];
  }));
  clearTimeout(jobs.later);
  jobs.later = setTimeout(jobs, own.some((job) => !ENDED.includes(job.state)) ? 700 : 5000);
}

async function report(id) {
  try {
    for (;;) {
      const found = await ask("report", { id });
      if (found.address) {
        const link = document.createElement("a");
        Object.assign(link, { href: found.address, target: "_blank", rel: "noopener", textContent: "open the report" });
        link.addEventListener("click", () => link.remove()); // the address opens once
        $("job").append(" ", link);
        link.focus();
        return;
      }
      if (["failed", "cancelled", "interrupted"].includes(found.state)) throw new Error(found.message || `the report was ${found.state}`);
      $("state").textContent = "making the report …";
      await new Promise((done) => setTimeout(done, 500));
    }
  } catch (error) {
    trouble(error);
  } finally {
    $("state").textContent = "";
  }
}

$("run").addEventListener("click", () => ask("start").then(jobs, trouble));
window.addEventListener("tol3d-scene", jobs);

window.tol3dApp = { app, ask, trouble, editor, choose };
start().catch(trouble);
