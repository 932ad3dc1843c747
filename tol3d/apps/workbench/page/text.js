// The scene's text: checked as it is typed, saved, and changed by what is kept.
import { $, app, ask, button, trouble } from "./ask.js";
import { choose, open } from "./app.js";

export const editor = window.tol3dEditor($("editor"), {
  nonce: document.querySelector('meta[name="style-nonce"]').content,
  changed: () => textChanged(),
  save: () => save(),
});

export function showText(text, digest) {
  app.digest = digest;
  editor.set(text);
  app.saved = editor.text();
  $("save").disabled = true;
  $("saved").textContent = $("copied").textContent = "";
  $("changed").hidden = true;
}

const ROOM = 60; // px, for the message below a line

export function goTo(line) { // the column moves no further than it must: the assembly stays in sight
  const column = $("middle"), before = column.scrollTop;
  editor.go(line);
  requestAnimationFrame(() => {
    column.scrollTop = before;
    const own = $("editor").querySelector(".cm-activeLine")?.getBoundingClientRect(), { top, bottom } = column.getBoundingClientRect();
    if (own) column.scrollTop += Math.max(0, own.bottom + ROOM - bottom) + Math.min(0, own.top - ROOM - top);
  });
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

export function problems(wrong, warnings) {
  editor.mark(wrong);
  const told = [...wrong.map((own) => ["error", own]), ...warnings.map((own) => ["warning", own])];
  $("problems").replaceChildren(...told.map(([kind, own]) => {
    const item = document.createElement("li");
    item.className = kind;
    const { line, message } = typeof own === "string" ? { message: own } : own;
    item.append(line ? button(message, () => editor.go(line)) : message);
    return item;
  }));
  $("wrong").textContent = wrong.length ? `${wrong.length} error${wrong.length > 1 ? "s" : ""}, below the text` : "";
  marks(wrong);
}

export function marks(wrong) {
  const lines = wrong.map((own) => own.line);
  const every = [...document.querySelectorAll("#tree button[data-line]")].sort((a, b) => a.dataset.line - b.dataset.line);
  for (const own of every) own.classList.remove("wrong");
  for (const line of lines) every.filter((own) => Number(own.dataset.line) <= line).at(-1)?.classList.add("wrong");
}

export async function save() {
  if ($("save").disabled) return;
  try {
    const text = editor.text(), found = await ask("save", { text, digest: app.digest });
    app.digest = found.digest;
    await open(app.scene);
  } catch (error) {
    trouble(error);
  }
}

export async function keep() {
  await app.moving;
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
