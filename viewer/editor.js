// The text of a scene in the app: CodeMirror with YAML, marks at lines that are wrong, and a strict content policy.
import { basicSetup } from "codemirror";
import { yaml } from "@codemirror/lang-yaml";
import { lintGutter, setDiagnostics } from "@codemirror/lint";
import { EditorSelection, EditorState } from "@codemirror/state";
import { EditorView, keymap } from "@codemirror/view";

window.tol3dEditor = (place, { nonce, changed, save }) => {
  let quiet = false;
  const view = new EditorView({
    parent: place,
    state: EditorState.create({
      extensions: [
        EditorView.cspNonce.of(nonce),
        keymap.of([{ key: "Mod-s", run: () => (save(), true) }]),
        basicSetup,
        yaml(),
        lintGutter(),
        EditorView.contentAttributes.of({ "aria-label": "scene as text" }),
        EditorView.updateListener.of((update) => update.docChanged && !quiet && changed()),
      ],
    }),
  });
  const line = (number) => view.state.doc.line(Math.min(Math.max(number || 1, 1), view.state.doc.lines));
  return {
    text: () => view.state.sliceDoc(),
    set(text) {
      quiet = true;
      if (text !== view.state.sliceDoc()) view.dispatch({ changes: { from: 0, to: view.state.doc.length, insert: text } });
      quiet = false;
    },
    mark(problems) {
      const found = problems.map((own) => {
        const { from, to } = line(own.line);
        return { from, to, severity: "error", message: own.message };
      });
      view.dispatch(setDiagnostics(view.state, found));
    },
    go(number) {
      const { from, to } = line(number);
      view.dispatch({ selection: EditorSelection.single(from, to), effects: EditorView.scrollIntoView(from, { y: "center" }) });
    },
  };
};
