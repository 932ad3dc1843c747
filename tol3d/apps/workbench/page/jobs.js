// Jobs of the folder in the header, and reports of finished runs.
import { $, app, ask, button, trouble } from "./ask.js";

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
