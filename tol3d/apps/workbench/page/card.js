// The card: verdict and distribution of the chosen measure, and what-ifs beside each other.
import { $, app, ask, button, signed, trouble } from "./ask.js";
import { show } from "./app.js";
import { note, take } from "./sliders.js";

export async function refresh() {
  const wish = ++app.wish;
  app.stopped = false;
  without("");
  $("reset").disabled = !Object.keys(app.now).length;
  $("aside").disabled = $("reset").disabled || app.beside.length >= 3;
  $("keep").disabled = $("reset").disabled || Boolean(app.readOnly);
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
    fields(found.written);
    if (found.answer) {
      $("answer").innerHTML = found.answer;
      $("chart").innerHTML = found.chart;
      limits(found.limits);
    }
    const going = found.done < found.of && !app.stopped;
    $("progress").hidden = !going;
    if (!going) {
      $("result").textContent = found.result; // heard once, when all is there
      break;
    }
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
export async function estimate(now, held) { // one request under way, the latest wish wins
  if (flying) {
    waiting = [now, held];
    return;
  }
  flying = true;
  const wish = ++app.wish;
  try {
    const found = await ask("estimate", { now, held });
    if (app.solid < wish) { // nothing newer has come before it
      if (found.chart) $("chart").innerHTML = found.chart;
      fields(found.written);
      without(wish === app.wish ? found.none : "");
      trouble(null);
      if (found.waits && wish === app.wish) waiting ??= [now, held]; // as long as nothing else is asked for
    }
  } catch (error) {
    if (app.solid < wish) trouble(error);
  }
  flying = false;
  if (waiting) {
    const next = waiting;
    waiting = null;
    await estimate(...next);
  }
}

function without(words) { // why there is no estimate, or not yet
  if (words) $("state").textContent = `estimate: ${words} …`;
  else if ($("state").textContent.startsWith("estimate:")) {
    $("state").textContent = "";
    changesTold();
  }
}

export function forget() { // what waits to be estimated
  waiting = null;
}

function fields(written) {
  for (const own of document.querySelectorAll("#sliders input[type=text]")) {
    const words = (written ?? {})[own.dataset.line] ?? own.dataset.scene;
    if (own !== document.activeElement) own.value = words;
    own.closest("li").querySelector("input[type=range]")?.setAttribute("aria-valuetext", words); // its steps tell nothing
  }
}

// limits ------------------------------------------------------------------------------------------

const LIMITS = ["lower_limit", "upper_limit"];

function limits(told) {
  for (const name of LIMITS) {
    const own = $(name), { now, scene, is } = told[name];
    own.disabled = !is;
    own.dataset.scene = scene;
    own.classList.toggle("moved", now !== scene);
    if (own !== document.activeElement) own.value = now;
  }
}

$("limits").addEventListener("change", async () => {
  const key = `limits: ${app.measure}`, now = { ...app.now };
  const stated = LIMITS.map((name) => {
    const text = $(name).value.trim();
    if (!text) $(name).value = $(name).dataset.scene;
    return text === $(name).dataset.scene ? "" : text;
  });
  delete now[key];
  if (stated.some(Boolean)) now[key] = stated.join("..");
  try {
    await ask("estimate", { now });
  } catch (error) {
    $("limits-wrong").textContent = error.message;
    $("limits-wrong").hidden = false;
    return;
  }
  $("limits-wrong").hidden = true;
  await take(now);
});

// what-ifs beside each other ----------------------------------------------------------------------

export async function aside() {
  const wish = app.wish, found = [];
  for (const [k, own] of app.beside.entries()) {
    let card;
    try {
      do card = await ask("card", { now: own }); while (!card.answer && wish === app.wish);
    } catch (error) {
      card = { answer: error.message };
    }
    const article = document.createElement("article");
    article.innerHTML = card.answer;
    const words = document.createElement("p");
    words.className = "dim";
    words.textContent = Object.entries(own)
      .map(([line, text]) => `${line.replace(/^limits: /, "limits of ")} ${signed(text.replace(/^x/, "× "))}`).join(", ");
    const back = button("take", () => takeBack(k)), drop = button("drop", () => dropOne(k));
    article.prepend(words, back, " ", drop);
    found.push(article);
  }
  if (wish === app.wish || !found.length) $("beside").replaceChildren(...found);
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
