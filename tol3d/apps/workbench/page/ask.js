// Questions to the server, and what the page is asked for now.
export const $ = (id) => document.getElementById(id);
const KEY = "tol3d-token";

if (location.hash.length > 1 && !location.hash.startsWith("#/")) {
  sessionStorage.setItem(KEY, location.hash.slice(1));
  history.replaceState(null, "", "/");
}

export const app = {
  scene: "", measure: "", now: {}, beside: [], past: [], digest: "", saved: "", readOnly: "", wish: 0, solid: 0, stopped: false,
  moving: null, // a move on its way to round numbers
};

export async function ask(name, told = {}) {
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
  if (!reply.ok) throw Object.assign(new Error(signed(found.error ?? `${reply.status}`)), { status: reply.status });
  return found;
}

export function signed(words) { // as reports show units
  return words.replace(/(?<=[\s\d])um\b/g, "µm");
}

export function trouble(error) {
  const words = error?.message ?? error ?? app.readOnly; // why nothing can be kept stays in sight
  if ($("trouble").textContent !== words) $("trouble").textContent = words; // else it would be heard again
  $("trouble").hidden = !words;
}

export function button(words, act) {
  const own = document.createElement("button");
  own.type = "button";
  own.textContent = words;
  own.addEventListener("click", act);
  return own;
}
