// Jobs of the scene: the newest in the header, all of them and finished runs in a dialog; reports and answers.
import { $, app, ask, button, trouble } from "./ask.js";

const STOPPED = ["cancelled", "interrupted", "failed"], LONGEST = 40; // signs of a message in the header, a line of it
const KINDS = { what_if: "what if", changes: "what to change", rare: "rare events", methods: "methods side by side", sweep: "variants" };
const links = new Map(); // addresses of reports that are made, each opens once
let watched = ""; // the analysis that was asked in the open dialog

const title = (job) => KINDS[job.kind] ?? job.kind;
const act = (name, told) => ask(name, told).then(jobs, trouble);

export function watch(id) {
  watched = id;
  return jobs();
}

export async function jobs() {
  let found;
  clearTimeout(jobs.later);
  try {
    found = (await ask("jobs")).jobs;
  } catch {
    return; // the look for changes tells it
  } finally {
    clearTimeout(jobs.later);
    jobs.later = setTimeout(jobs, document.hidden ? 60000 : found?.some((job) => job.goes_on) ? 700 : 5000);
  }
  const own = found.filter((job) => job.scene === app.scene);
  put($("job"), own.slice(0, 1).flatMap((job) => told(job, LONGEST)));
  $("work-button").textContent = own.length ? `jobs (${own.length})` : "jobs";
  if ($("work").open) list(own);
  const asked = own.find((job) => job.id === watched);
  if (!asked) return;
  put($("analysis-state"), told(asked));
  if (asked.state === "done" && $("analyses").open) {
    watched = "";
    $("analyses").close();
    await answer(asked).catch(trouble);
  }
}

function put(place, nodes) { // what has not changed stays, with its focus
  const drawn = document.createElement("div");
  drawn.append(...nodes);
  if (place.dataset.drawn === drawn.innerHTML) return;
  const focus = place.contains(document.activeElement) ? document.activeElement.textContent : null;
  place.dataset.drawn = drawn.innerHTML;
  place.replaceChildren(...drawn.childNodes);
  if (focus) [...place.querySelectorAll("button, a")].find((own) => own.textContent === focus)?.focus();
}

function told(job, longest = Infinity) {
  const words = document.createElement("span"), more = job.state === "running" ? job.words : job.message;
  const share = job.of ? ` ${job.done} of ${job.of} trials` : "";
  words.textContent = `${title(job)} ${job.state}${share}${more ? `: ${more.length > longest ? `${more.slice(0, longest)}…` : more}` : ""}`;
  if (more && more.length > longest) words.title = more;
  words.dataset.job = job.id; // another job with the same words is another one
  const bar = document.createElement("progress");
  Object.assign(bar, { max: job.of, value: job.done, ariaLabel: `${title(job)}: trials` });
  const acts = [];
  if (job.goes_on && !app.readOnly) acts.push(button("cancel", () => act("cancel", { id: job.id })));
  if (STOPPED.includes(job.state) && !app.readOnly) acts.push(button(job.state === "failed" ? "try again" : "resume", () => act("resume", { id: job.id })));
  if (job.state === "done" && ["run", "report"].includes(job.kind)) acts.push(reported(job.run));
  else if (job.state === "done") acts.push(button("show", () => answer(job).catch(trouble)));
  return [words, " ", ...(job.state === "running" && job.of ? [bar, " "] : []), ...acts.flatMap((own) => [own, " "])];
}

// all of them -------------------------------------------------------------------------------------

let asking = ""; // the job that is about to be deleted
function list(own) {
  put($("jobs"), own.length ? own.map((job) => item(told(job), when(job.started), asking === job.id ? deletes(job) : ends(job))) : [item(["none yet"])]);
}

function item(...nodes) {
  const own = document.createElement("li");
  own.append(...nodes.flat());
  return own;
}

function when(iso) {
  const own = document.createElement("span");
  Object.assign(own, { className: "dim", textContent: `${new Date(iso).toLocaleString()} ` });
  return own;
}

function ends(job) {
  return job.goes_on || app.readOnly ? [] : [button("delete…", () => {
    asking = job.id;
    jobs();
  })];
}

function deletes(job) {
  const question = document.createElement("span"), box = document.createElement("input"), label = document.createElement("label");
  question.className = "asks";
  box.type = "checkbox";
  label.append(box, ` with the folder runs/${job.run} and its ${job.done} trials`);
  const leave = () => {
    asking = "";
    return jobs();
  };
  question.append("delete this job? ", ...(job.kind === "run" && job.state === "done" ? [label, " "] : []),
    button("delete it", () => ask("delete", { id: job.id, run: box.checked ? job.run : "" }).catch(trouble).then(leave).then(made)), " ", button("keep it", leave));
  return [question];
}

async function made() {
  try {
    const found = (await ask("runs")).runs;
    put($("made"), found.length ? found.map((run) => item(`runs/${run.name}: ${run.trials} trials `, when(run.made), run.is_of_now ? "" : "of another state of the scene ", reported(run.name)))
      : [item(["none in runs/ beside the scene"])]);
  } catch (error) {
    put($("made"), [item([error.message])]);
  }
}

$("work-button").addEventListener("click", () => {
  $("work-title").textContent = `jobs of ${app.scene}`;
  $("work").showModal();
  jobs();
  made();
});
$("close-work").addEventListener("click", () => $("work").close());

// reports and answers -----------------------------------------------------------------------------

function reported(run) {
  if (!links.has(run)) return button("report", () => report(run));
  const link = document.createElement("a");
  Object.assign(link, { href: links.get(run), target: "_blank", rel: "noopener", textContent: "open the report" });
  link.addEventListener("click", () => {
    links.delete(run);
    setTimeout(redraw, 100);
  });
  return link;
}

function redraw() {
  jobs();
  if ($("work").open) made();
}

async function report(run) {
  try {
    for (;;) {
      const found = await ask("report", { run });
      if (found.address) {
        links.set(run, found.address);
        setTimeout(() => links.delete(run) && redraw(), 55000); // the server forgets it after a minute
        return;
      }
      if (STOPPED.includes(found.state)) throw new Error(found.message || `the report was ${found.state}`);
      $("state").textContent = "making the report …";
      await new Promise((done) => setTimeout(done, 500));
    }
  } catch (error) {
    trouble(error);
  } finally {
    $("state").textContent = "";
    redraw();
  }
}

async function answer(job) {
  const found = await ask("answer", { id: job.id, title: $("title").textContent });
  $("found-title").textContent = `${title(job)} of ${job.scene}`;
  $("found-page").innerHTML = found.html;
  if (job.message) {
    const remark = document.createElement("p");
    Object.assign(remark, { className: "warning", textContent: job.message });
    $("found-page").prepend(remark);
  }
  $("numbers").onclick = () => numbers(job).catch(trouble);
  if (!$("found").open) $("found").showModal();
}

async function numbers(job) {
  const link = document.createElement("a");
  link.href = (await ask("numbers", { id: job.id })).address;
  link.download = `${job.scene.replace(/\.ya?ml$/, "")} ${title(job)}.csv`;
  link.click();
}

$("close-found").addEventListener("click", () => $("found").close());
$("run").addEventListener("click", async () => {
  try {
    const found = await ask("start", { fields: { trials: $("trials").value.trim() } });
    trouble(found.refused ? `${found.refused.argument}: ${found.refused.message}` : null);
    await jobs();
  } catch (error) {
    trouble(error);
  }
});
window.addEventListener("tol3d-scene", jobs);
document.addEventListener("visibilitychange", jobs);
