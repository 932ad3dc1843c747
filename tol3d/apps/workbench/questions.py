"""Questions of the app's page on a scene and their answers: plain data, with pieces of HTML.

They are asked one at a time, in one thread, and each takes a fraction of a second; beside them one run of the scene is
made, from which shares of contributors come. The page names scenes by the workspace's list.
"""

import difflib
from collections.abc import Callable, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

from tol3d.analyses.kept_changes import scene_with
from tol3d.analyses.subject import Subject
from tol3d.apps.workbench.asked_analysis import refusal
from tol3d.apps.workbench.builds import FACTORS, Known, Row, Stage, positions_at, stands, turnable
from tol3d.apps.workbench.card import answer, histogram, limit_fields, result, sliders, written_words
from tol3d.apps.workbench.flags import flags
from tol3d.apps.workbench.forms import ANALYSES, FormScene, form, line_words
from tol3d.apps.workbench.place import FolderLock
from tol3d.apps.workbench.round_numbers import in_round_numbers
from tol3d.apps.workbench.session import AT_ONCE, FEW, NoEstimate, Session, Turn
from tol3d.apps.workbench.text_check import checked
from tol3d.apps.workbench.tree import parts_of, tree
from tol3d.apps.workbench.words import UnfitError, words_of
from tol3d.apps.workbench.workspace import MOST_KEPT, MOST_UNDONE, Notes, Told, Workspace, digest, written
from tol3d.errors import InputError
from tol3d.report.html.blocks import tag
from tol3d.scene.vary import numbers_of
from tol3d.simulate import Overrides, run_scene
from tol3d.study.runs.run import Run

MOST_OPEN: Final = 3
"""Scenes in memory."""
SHARED: Final = 20_000
"""Trials of the run that shares come from, at most; of a slow scene as many as take SHARES_WITHIN."""
SHARES_WITHIN: Final = 20.0  # s, about


class StaleError(InputError):
    """The file is not the one that was read."""


@dataclass(eq=False)
class Questions:
    """Scenes that the app has open, and its answers on them.

    Args:
        workspace: the folder.
        trust_parts, run_builders: as `tol3d run` has them.
        lock: the right to write in the folder.
    """

    workspace: Workspace
    lock: FolderLock
    trust_parts: bool = False
    run_builders: bool = False
    sessions: dict[str, Session] = field(default_factory=dict)
    runs: dict[str, "Future[Run]"] = field(default_factory=dict)
    stages: dict[str, Stage] = field(default_factory=dict)
    beside: ThreadPoolExecutor = field(default_factory=partial(ThreadPoolExecutor, 1, "shares"))
    looks: ThreadPoolExecutor = field(default_factory=partial(ThreadPoolExecutor, 1, "looks"))
    scratch: TemporaryDirectory[str] = field(default_factory=partial(TemporaryDirectory, prefix="tol3d-app-"))

    @property
    def read_only(self) -> bool:
        """True where another app writes in this folder."""
        return bool(self.lock.refusal)

    def session(self, name: str) -> Session:
        """An open scene; it is read again where its file has changed.

        Raises:
            SceneError, InputError: as `tol3d check` says.
        """
        path = self.workspace.scene(name)
        known = self.sessions.pop(name, None)
        if known is None or known.content != path.read_bytes():
            known = Session.opened(path, trust_parts=self.trust_parts, run_builders=self.run_builders)
            known.require_contributors()
        self.sessions[name] = known
        while len(self.sessions) > MOST_OPEN:
            del self.sessions[next(iter(self.sessions))]
        return known

    def scene(self, asked: Told) -> Told:
        """A scene as the page shows it first: its text, its tree and its measures, or what is wrong with it."""
        name = str(asked["scene"])
        path, notes = self.workspace.scene(name), self.workspace.notes(name)
        if not self.read_only and self.workspace.last != name:
            with suppress(InputError):  # a full disk hinders nobody to look at a scene
                self.workspace.note_opened(name)
        content = path.read_bytes()
        found: dict[str, Any] = {
            "text": content.decode("utf-8", "replace"),
            "digest": digest(content),
            "notes": {"now": dict(notes.now), "beside": [], "past": [], "measure": notes.measure},
            "problems": [],
        }
        try:
            session = self.session(name)
        except InputError as error:
            return found | {"problems": _problems(error)}
        measures = [{"name": own.name, "unit": own.unit} for own in session.response.measures]
        now, dropped = session.still(notes.now)
        beside, past = (
            [still for own in each if (still := session.still(own)[0]) or not own]
            for each in (notes.beside, notes.past)
        )
        found["notes"] |= {"now": now, "beside": beside, "past": past}
        return found | {
            "dropped": [*dropped],
            "title": session.scene.scene,
            "description": session.scene.description,
            "measures": measures,
            "tree": tree(session.scene),
            "warnings": [*session.simulation.warnings],
            "trials": session.simulation.study.trials,
            "positions": turnable(session.simulation.system),
            "stands": stands(session.simulation.system),
            "flags": flags(session),
            "compiled": session.simulation.system.is_compiled(session.simulation.study.engine),
        }

    def card(self, asked: Told) -> Told:
        """A measure by the tolerances that are tried, by as many builds as could be evaluated by now."""
        turn = Turn()
        session, measure, now = self._asked(asked)
        base = session.evaluated(measure, {})
        tried = session.evaluated(measure, now) if now else base
        both = [base, tried] if tried is not base else [base]  # limits alone evaluate nothing
        for own in both:
            own.go_on(turn, FEW)
        tried.go_on(turn, base.done)  # no more than the scene has: methods know parts of builds from there
        base.go_on(turn, base.count)
        tried.go_on(turn, base.done)
        going = [own for own in both if own.done < own.count] or [tried]
        told = {
            "written": written_words(session, now),
            "done": sum(own.done for own in going),
            "of": sum(own.count for own in going),
            "left": round(sum(own.left for own in going), 1),
        }
        if not all(own.is_shown for own in both):
            return told
        judged = tried.within(session.limits(now))
        shown = {"answer": answer(base, judged), "result": result(judged), "limits": limit_fields(base, judged)}
        return told | shown | {"chart": histogram(base, judged, None)}

    def estimate(self, asked: Told) -> Told:
        """The distribution while a tolerance moves: by slopes, on kept builds; words on them while they are made.

        A line that is named as held by a slider is in round numbers.
        """
        turn = Turn()
        session, measure, now = self._asked(asked)
        if (held := asked.get("held")) is not None and str(held) in now:
            now = {**now, str(held): in_round_numbers(session, str(held), now[str(held)])}
        base, limits = session.evaluated(measure, {}), session.limits(now)
        base.within(limits)  # words that are none are refused before anything takes time
        estimate = session.estimate(measure, now, turn)
        told = {"written": written_words(session, now)}
        if isinstance(estimate, NoEstimate):
            return told | {"none": estimate.words, "waits": estimate.is_coming}
        return told | {"chart": histogram(base.within(limits), None, estimate if session.changes(now) else None)}

    def rounded(self, asked: Told) -> Told:
        """Words of a tolerance that a slider was moved to, by a factor."""
        session = self.session(str(asked["scene"]))
        return {"words": in_round_numbers(session, str(asked["line"]), str(asked["words"]))}

    def sliders(self, asked: Told) -> Told:
        """A slider for each tolerance that acts on a measure; by shares as soon as a run knows them."""
        session, measure, now = self._asked(asked)
        if not self._is_looked_at(session):
            words = tag("p", "trying which tolerances act …", class_="note")
            return {"sliders": words, "looks": True, "waits": True, "acting": [], "parts": [], "entries": []}
        run = self._run(str(asked["scene"]), session)
        summary = run.result().found.measures.get(measure) if run.done() and run.exception() is None else None
        lines = session.acting(measure)
        entries = {own.name: own.entries for own in session.simulation.lines}
        return {
            "sliders": sliders(session, measure, now, summary),
            "waits": not run.done(),
            "acting": [*lines],
            "parts": parts_of(session.scene, lines, entries),
            "entries": [entry for line in lines for entry in entries.get(line, (line,))],
        }

    def view(self, asked: Told) -> Callable[[], bytes]:
        """Builds in 3D, the nominal one and another: see `Stage.picture`.

        Solids take seconds: what makes them is called where nobody waits.
        """
        session, measure, now = self._asked(asked)
        rows, refused = self._rows(session, measure, now, asked)
        shares, known, factor = asked.get("positions") or {}, asked.get("known") or {}, asked.get("factor")
        if factor is not None and factor not in FACTORS:
            raise InputError(f"expected a factor of {', '.join(f'{own:g}' for own in FACTORS)}, got {factor!r}")
        at = positions_at(session.simulation.system, {str(key): float(own) for key, own in shares.items()})
        stage = self.stages.pop(str(asked["scene"]), None)
        if stage is None or stage.simulation is not session.simulation:
            stage = Stage(session.simulation)
        self.stages[str(asked["scene"])] = stage
        while len(self.stages) > MOST_OPEN:
            del self.stages[next(iter(self.stages))]
        return partial(
            stage.picture,
            rows,
            known=Known(str(known.get("collection", "")), int(known.get("meshes", 0))),
            world=str(asked.get("world", "")),
            refused=refused,
            measure=measure,
            at=at if shares else None,
            standing={str(key): float(own) for key, own in (asked.get("standing") or {}).items()},
            motion=str(asked.get("motion", "")),
            factors=FACTORS if factor is None else (float(factor),),
        )

    def _rows(
        self, session: Session, measure: str, now: Mapping[str, str], asked: Told
    ) -> tuple[Mapping[str, Row], Mapping[str, str]]:
        """Builds that are asked for; and those that are not there, with the reason."""
        evaluated, builds = session.evaluated(measure, now).within(session.limits(now)), asked.get("builds", ())
        if "mean" in builds:
            return {"mean": Row(session.changed(now).mean)}, {}
        if "worst" in builds:
            if not len(evaluated.good):
                why = "no trial could be assembled" if evaluated.done else "no trial is simulated yet"
                return {}, {"worst": f"{why}; shown is the nominal build"}
            return {
                "worst": Row(*evaluated.trial(evaluated.worst), f"trial {evaluated.worst} of {evaluated.done}, ")
            }, {}
        if (trial := asked.get("trial")) is not None:
            if not 0 <= int(trial) < evaluated.count:
                raise InputError(f"expected a trial from 0 to {evaluated.count - 1}, got {trial}")
            return {f"trial {int(trial)}": Row(*evaluated.trial(int(trial)))}, {}
        return {}, {}

    def forms(self, asked: Told) -> Told:
        """Fields of an analysis of a scene; moved tolerances are those of what-if."""
        session, _, now = self._asked(asked)
        lines = {line: line_words(session.response, line) for line in session.response.lines}
        measures = [own.name for own in session.response.measures]
        kind = str(asked["kind"])
        if kind not in ANALYSES:
            raise InputError(f"expected {', '.join(ANALYSES)}, got {kind!r}")
        numbers = numbers_of(session.scene) if kind == "sweep" else {}
        fields = form(kind, FormScene(measures, lines, written_words(session, now), numbers))
        return {"form": fields, "kinds": {key: title for key, (title, _) in ANALYSES.items()}}

    def fit(self, asked: Told) -> Told:
        """The field of an analysis that its command refuses, with its words; nothing where it begins."""
        session, kind = self.session(str(asked["scene"])), str(asked["kind"])
        if not self._is_looked_at(session):
            return {"waits": True}
        if kind not in ANALYSES:
            raise InputError(f"expected {', '.join(ANALYSES)}, got {kind!r}")
        try:
            words = words_of(kind, dict(asked.get("fields") or {}))
        except UnfitError:
            return {}  # the folder's question says it
        subject = session.scene if kind == "sweep" else Subject(session.simulation, loaded=session.scene)
        refused = refusal(kind, subject, words)
        return {} if refused is None else {"refused": refused}

    def notes(self, asked: Told) -> Told:
        """Keep what is moved beside the scene, so that it is there after a reload."""
        name, now = str(asked["scene"]), _changes(asked.get("now"))
        beside = tuple(_changes(own) for own in asked.get("beside", ())[:MOST_KEPT])
        past = tuple(_changes(own) for own in asked.get("past", ())[-MOST_UNDONE:])
        self.workspace.scene(name)
        if not self.read_only:
            self.workspace.note(name, Notes(now, beside, str(asked.get("measure", "")), past))
        return {}

    def check(self, asked: Told) -> Told:
        """Messages of `tol3d check` on a text that is not written yet."""
        path = self.workspace.scene(str(asked["scene"]))
        _, problems, warnings = checked(str(asked["text"]), path)
        return {"problems": [*problems], "warnings": [*warnings]}

    def keep(self, asked: Told) -> Told:
        """Keep moved tolerances in the scene's text: the difference first, then the file."""
        session, _, now = self._asked(asked)
        text = scene_with(session.response, session.scene, session.changes(now), session.limits(now)).text
        before = session.content.decode("utf-8")
        if not asked.get("write"):
            return {"diff": _difference(before, text, session.path.name), "digest": session.digest}
        beside = [
            dict(written_words(session, _changes(own))) for own in asked.get("beside", ())
        ]  # factors were of before
        self._write(session.path, text, str(asked["digest"]))
        self.notes({**asked, "now": {}, "beside": beside})
        return {"digest": digest(text.encode())}

    def save(self, asked: Told) -> Told:
        """Write the text, right or wrong, as any editor does."""
        path = self.workspace.scene(str(asked["scene"]))
        self._write(path, str(asked["text"]), str(asked["digest"]))
        return {"digest": digest(path.read_bytes())}

    def _write(self, path: Path, text: str, known: str) -> None:
        if self.read_only:
            raise InputError(self.lock.refusal)
        if digest(path.read_bytes()) != known:
            raise StaleError(f"{path.name} was changed by another program since it was read here: load its text first")
        content = text.encode()
        written(
            path,
            content.replace(b"\n", b"\r\n") if b"\r\n" in path.read_bytes() and b"\r\n" not in content else content,
        )

    def _asked(self, asked: Told) -> tuple[Session, str, Mapping[str, str]]:
        session = self.session(str(asked["scene"]))
        return session, session.measure(str(asked.get("measure", ""))).name, _changes(asked.get("now"))

    def _is_looked_at(self, session: Session) -> bool:
        """True if it is known what acts: of many measures dozens of builds tell, which are made beside."""
        first, *_ = session.response.measures
        if not session.simulation.method.threads:
            session.acting(first.name)
            return True
        if session.look is None:
            session.look = self.looks.submit(session.acting, first.name)
        try:
            session.look.result(timeout=AT_ONCE)
        except TimeoutError:
            return False
        return True

    def _run(self, name: str, session: Session) -> "Future[Run]":
        """A run of the scene, which knows shares; it is made once for each state of the file."""
        key = f"{name}-{session.digest[:16]}"
        if key not in self.runs:
            self.runs[key] = self.beside.submit(self._made_run, session, Path(self.scratch.name) / key)
        return self.runs[key]

    def _made_run(self, session: Session, folder: Path) -> Run:
        builds = min(session.simulation.study.trials, SHARED)
        paces = [own.pace for own in session._evaluated.values() if own.done > FEW]
        if paces and builds * max(paces) * len(session.response.measures) > SHARES_WITHIN:
            builds = min(builds, FEW)
        return run_scene(session.scene, overrides=Overrides(trials=builds, witness=0), out=folder, force=True)

    def close(self) -> None:
        """Let its threads end and remove what it made for itself."""
        for own in (self.looks, self.beside):
            own.shutdown(wait=True, cancel_futures=True)
        self.scratch.cleanup()


def _changes(told: Any) -> dict[str, str]:
    return {str(key): str(value) for key, value in (told or {}).items()}


def _problems(error: InputError) -> list[dict[str, Any]]:
    return [own.data() for own in error.problems]


def _difference(before: str, after: str, name: str) -> str:
    lines = difflib.unified_diff(
        before.splitlines(), after.splitlines(), name, name, "as it is", "kept", n=1, lineterm=""
    )
    return "\n".join(lines)
